#pragma once

#include <Eigen/Dense>
#include <memory>
#include <string>
#include <vector>

#include "firmware/io/config/config.h"
#include "firmware/model/kinematics.h"
#include "host/sim/truth.h"

namespace sidestep::campaign {

struct Family;
using Joints = sim::JointVector;
using Limits = JointLimits;
using ToolJacobian = PointJacobian;

/// An arm at one configuration. Base frame, m.
struct ArmPose {
  std::vector<Vector3> corners;  ///< polyline of the arm: base, joint origins, tool
  Matrix3 tool_rotation = Matrix3::Identity();
  std::vector<Vector3> axes;                ///< unit direction of each joint's axis
  std::vector<bool> prismatic;              ///< of each joint; empty: none is
  std::vector<Vector3> origins;             ///< a point of each joint's axis
  std::shared_ptr<const sim::Truth> truth;  ///< the arm's surface; null if the corners define it
  LinkPoses links;                          ///< of the controller's model; not set if the corners define the surface

  bool is_prismatic(size_t joint) const { return joint < prismatic.size() && prismatic[joint]; }
  const Vector3& tool() const { return corners.back(); }
  const Vector3& wrist() const { return corners[corners.size() - 2]; }
};

/// Where the simulator (urdf, base, tip) and the controller (config) load this arm from.
struct ArmSource {
  std::string urdf, base, tip, config;
};

/// The judge's model of an arm. Its kinematics and contact computations share nothing with the controller's model, so
/// that an error in the controller's model shows up as a contact. All functions may be called from several threads.
class JudgeArm {
 public:
  virtual ~JudgeArm() = default;

  virtual ArmPose pose(const Joints& q_rad) const = 0;

  /// Least distance between the surfaces of the arm, fixed links included, and of a sphere; negative if they overlap.
  /// Returns within_m if the distance is not less.
  virtual double clearance(const ArmPose& pose, const Vector3& center_m, double radius_m,
                           double within_m = sim::kNothingNear) const = 0;

  /// The same for the nearest of several capsules.
  virtual double clearance(const ArmPose& pose, const std::vector<Capsule>& capsules,
                           double within_m = sim::kNothingNear) const = 0;

  /// The same for the nearest of several boxes and cylinders.
  virtual double solid_clearance(const ArmPose& pose, const std::vector<sim::Obstacle>& solids,
                                 double within_m = sim::kNothingNear) const = 0;

  /// Capsules that enclose the links, fixed ones included. Much cheaper than pose() and clearance().
  virtual std::vector<Capsule> enclosing_capsules(const Joints& q_rad) const = 0;

  /// Least distance between the surfaces of two links that do not touch by construction; negative (or 0) if they touch.
  /// Returns within_m if the distance is not less. The pairs are the judge's own, not the controller's.
  virtual double self_clearance(const ArmPose& pose, double within_m = sim::kNothingNear) const = 0;

  /// The same distance as clearance() in the controller's model, which is never larger. If a witness keeps this
  /// clearance, the controller can follow it.
  virtual double controller_clearance(const ArmPose& pose, const Vector3& center_m, double radius_m) const {
    return clearance(pose, center_m, radius_m);
  }

  /// The same for the nearest of several boxes and cylinders.
  virtual double controller_solid_clearance(const ArmPose& pose, const std::vector<sim::Obstacle>& solids) const {
    return solid_clearance(pose, solids);
  }

  /// Whether a goal among furniture has an orientation, or is only a position of the tool.
  virtual bool goal_has_orientation() const { return true; }

  /// Whether the links keep the controller's self-clearance from each other.
  virtual bool keeps_clear_of_itself(const ArmPose&) const { return true; }

  virtual Limits limits(const Family& family) const = 0;

  /// Joint range from which the start and the goal of a scene are drawn (a share of it around its middle). Finite.
  virtual Limits range() const = 0;

  virtual ArmSource source(const Family& family) const = 0;

  /// Number of instants of a period at which the judge checks for contact.
  virtual int contact_checks_per_period() const = 0;
};

/// The judge's model of the configured arm: Lwa3Arm if the arm is the benchmark's LWA3, or else UrdfArm. Throws
/// std::runtime_error if surroundings are configured.
std::unique_ptr<JudgeArm> judge_arm_of(const Config& config);

/// Jacobian of the tool's position, base frame.
ToolJacobian tool_jacobian(const ArmPose& pose);

/// Angular velocity of the tool, base frame, rad/s.
Vector3 tool_angular_velocity(const ArmPose& pose, const Joints& qd_radps);

}  // namespace sidestep::campaign
