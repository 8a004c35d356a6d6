#include "firmware/control/task_compatibility.h"

#include <Eigen/Cholesky>

namespace sidestep {
namespace {

// Tuned on the campaign's follow6d. Gains that move joints at a tenth of their limits bring little.
constexpr double kGain_s = 10.0;
constexpr double kDamping_mps = 0.1;  // lambda

/// The gradient of y^T J velocity_radps by the joint positions, at constant y and velocities, n x 1. J: 6 x n.
JointVector twist_gradient(const TaskJacobian& jacobian, const JointVector& velocity_radps, const TaskVector& y) {
  TaskVector beyond = jacobian.lazyProduct(velocity_radps);  // by this joint and those after it
  Vector3 before_radps = Vector3::Zero();                    // the turn by the joints before this one
  JointVector gradient(velocity_radps.size());
  for (Eigen::Index i = 0; i < gradient.size(); ++i) {
    const Vector3 linear = jacobian.col(i).head<3>(), axis = jacobian.col(i).tail<3>();
    gradient[i] = y.head<3>().dot(axis.cross(beyond.head<3>()) + before_radps.cross(linear)) +
                  y.tail<3>().dot(axis.cross(beyond.tail<3>()));
    beyond -= velocity_radps[i] * jacobian.col(i);
    before_radps += velocity_radps[i] * axis;
  }
  return gradient;
}

}  // namespace

JointVector toward_task_compatibility(const LawInput& input) {
  const TaskJacobian& jacobian = input.tool_jacobian;
  const JointVector& limit_radps = input.arm.limits.velocity_radps;
  TaskVector twist(6);
  twist << input.target.velocity_mps, kTurnWeight_m * input.target.angular_velocity_radps;
  if (jacobian.rows() != 6 || twist.isZero(0.0)) return JointVector::Zero(jacobian.cols());

  TaskJacobian scaled = weighted_task(jacobian);
  for (Eigen::Index i = 0; i < scaled.cols(); ++i) scaled.col(i) *= limit_radps[i];
  TaskMatrix gram = scaled.lazyProduct(scaled.transpose());
  gram.diagonal().array() += kDamping_mps * kDamping_mps;
  const Eigen::LDLT<TaskMatrix> decomposition(gram);
  TaskVector y = decomposition.solve(twist);
  const JointVector velocity_radps = limit_radps.cwiseProduct(scaled.transpose().lazyProduct(y));
  y.tail<3>() *= kTurnWeight_m;  // from here on with the rows of J itself

  // In shares of the velocity limits.
  JointVector descent = kGain_s * limit_radps.cwiseProduct(twist_gradient(jacobian, velocity_radps, y));
  descent -= scaled.transpose().lazyProduct(decomposition.solve(scaled.lazyProduct(descent)));
  const double largest = descent.cwiseAbs().maxCoeff();
  if (largest > 1.0) descent /= largest;
  return descent.cwiseProduct(limit_radps);
}

}  // namespace sidestep
