#include "host/campaign/plain_tracking.h"

#include <algorithm>
#include <cmath>

#include "firmware/model/square_matrix.h"
#include "host/campaign/stopping.h"

namespace sidestep::campaign {
namespace {

// Independent of the configuration, because plain tracking decides which scenes the benchmark has.
constexpr double kPosition_per_s2 = 20.0, kVelocity_per_s = 8.94, kLargestSpeed_mps = 1.0;
constexpr double kLambda = 0.08, kSigma = 0.08;  // largest damping factor; least singular value below which it acts

Joints damped_inverse(const ToolJacobian& jacobian, const Vector3& tool_mps) {
  Matrix3 gram = jacobian.lazyProduct(jacobian.transpose());
  const double sigma = std::sqrt(std::max(0.0, least_eigenvalue(gram)));
  const double lambda = sigma < kSigma ? kLambda * (1.0 - sigma / kSigma) : 0.0;
  gram.diagonal().array() += lambda * lambda;
  return jacobian.transpose() * solve_ldlt(gram, tool_mps);
}

}  // namespace

Joints plain_tracking(const JudgeArm& arm, const Limits& limits, const PointMotion& target, const Joints& q_rad,
                      const Joints& qd_radps) {
  const ArmPose now = arm.pose(q_rad);
  const ToolJacobian jacobian = tool_jacobian(now);
  const Vector3 tool_mps = jacobian * qd_radps;
  const Vector3 force =
      kPosition_per_s2 * (target.position_m - now.tool()) + kVelocity_per_s * (target.velocity_mps - tool_mps);
  Vector3 nominal_mps = tool_mps + force * kPeriod_s;
  nominal_mps *= std::min(1.0, kLargestSpeed_mps / std::max(1e-9, nominal_mps.norm()));

  Joints velocity = damped_inverse(jacobian, nominal_mps);
  velocity /= std::max(1.0, velocity.cwiseAbs().cwiseQuotient(limits.velocity_radps).maxCoeff());
  for (int i = 0; i < velocity.size(); ++i) {
    const double a = limits.acceleration_radps2[i], step = a * kPeriod_s;
    const double up = stoppable_radps(std::max(0.0, limits.upper_rad[i] - q_rad[i]), a, kPeriod_s);
    const double down = stoppable_radps(std::max(0.0, q_rad[i] - limits.lower_rad[i]), a, kPeriod_s);
    velocity[i] = std::clamp(std::clamp(velocity[i], -down, up), qd_radps[i] - step, qd_radps[i] + step);
  }
  return velocity;
}

bool plain_tracking_hits(const Scene& scene) {
  const Limits limits = scene.arm->limits(*scene.family);
  Joints q_rad = scene.start_rad, qd_radps = Joints::Zero(q_rad.size());
  for (int k = 0; k <= scene.periods; ++k) {
    const double t_s = k * kPeriod_s;
    if (clearance_at(scene, scene.arm->pose(q_rad), t_s, 0.0) < 0.0) return true;
    qd_radps = plain_tracking(*scene.arm, limits, target_at(scene, t_s), q_rad, qd_radps);
    q_rad += qd_radps * kPeriod_s;
  }
  return false;
}

}  // namespace sidestep::campaign
