#pragma once

#include <Eigen/Dense>
#include <memory>
#include <string>
#include <vector>

#include "firmware/io/config/config.h"
#include "host/sim/truth.h"

namespace sidestep::campaign {

struct Family;
using Joints = sim::JointVector;
using Limits = JointLimits;
using ToolJacobian = PointJacobian;

/// An arm at one posture. Base frame, m.
struct ArmPose {
  std::vector<Vector3> corners;  ///< its skeleton: the foot, where the axes of the joints are, the tool
  Matrix3 tool_rotation = Matrix3::Identity();
  std::vector<Vector3> axes;                ///< unit, of each joint
  std::vector<Vector3> origins;             ///< a point of each joint's axis
  std::shared_ptr<const sim::Truth> truth;  ///< its surface, unless the corners say it all
  std::vector<Capsule> capsules;            ///< what the controller takes for it, likewise

  const Vector3& tool() const { return corners.back(); }
  const Vector3& wrist() const { return corners[corners.size() - 2]; }
};

/// What the simulator and the controller read to have the same arm.
struct ArmSource {
  std::string urdf, base, tip, config;
};

/// An arm as the judge sees it. Where it is and what it touches shares nothing with the controller's model, so that an
/// error there cannot hide itself. For any number of threads at once.
class JudgeArm {
 public:
  virtual ~JudgeArm() = default;

  virtual ArmPose pose(const Joints& q_rad) const = 0;

  /// Least distance between the arm's surface, links that do not move included, and a sphere's, negative when they
  /// overlap; within_m when it is not below that.
  virtual double clearance(const ArmPose& pose, const Vector3& center_m, double radius_m,
                           double within_m = sim::kNothingNear) const = 0;

  /// The same as the controller believes it, never more: a witness that is clear by this clearance can be followed.
  virtual double believed_clearance(const ArmPose& pose, const Vector3& center_m, double radius_m) const {
    return clearance(pose, center_m, radius_m);
  }

  /// Whether its links keep as far from each other as the controller asks for.
  virtual bool keeps_clear_of_itself(const ArmPose&) const { return true; }

  virtual Limits limits(const Family& family) const = 0;

  /// Where scenes begin and end: a share of this range around its middle. Finite.
  virtual Limits range() const = 0;

  virtual ArmSource source(const Family& family) const = 0;

  /// In how many instants of a period the judge looks for contact.
  virtual int looks_per_period() const = 0;
};

/// The judge's arm for a controller's: the benchmark's own where it is that, and any other as its URDF describes it.
/// Throws std::runtime_error where surroundings are configured.
std::unique_ptr<JudgeArm> judge_arm_of(const Config& config);

/// Velocity of the tool over the joint velocities; with joint velocities, of its turning.
ToolJacobian tool_jacobian(const ArmPose& pose);
Vector3 tool_radps(const ArmPose& pose, const Joints& qd_radps);

}  // namespace sidestep::campaign
