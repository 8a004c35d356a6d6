#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "host/campaign/boxes/box_path.h"
#include "host/campaign/family.h"
#include "host/campaign/furniture/timed_path.h"
#include "host/campaign/judge_arm.h"
#include "host/campaign/sphere_path.h"
#include "host/people/capsule_path.h"

namespace sidestep::campaign {

constexpr double kPeriod_s = 0.01;
constexpr int64_t kPeriod_us = 10'000;
constexpr double kSphereRadius_m = 0.05;
constexpr double kBoxEdge_m = 0.3;          ///< of the boxes that move
constexpr double kArrived_m = 0.01;         ///< the arm has arrived if the tool error is below this
constexpr double kArrived_rad = 0.05;       ///< the same of the orientation, where the goal has one
constexpr double kReturned_m = 0.005;       ///< the same after a dodge
constexpr double kArrivedJoint_rad = 0.01;  ///< the same of every joint (m if prismatic), for a posture
constexpr double kDwell_s = 0.1;            ///< among boxes the trial ends when the arm has arrived for this long
constexpr double kPlantLag_s = 0.030;       ///< family real: first-order lag of the joint velocity
constexpr double kPlantAcceleration_radps2 = 1e6;  ///< family real: practically no limit

/// One task among obstacles, from t = 0 to periods * kPeriod_s.
struct Scene {
  const Family* family;
  uint64_t seed;
  const JudgeArm* arm;
  int periods;
  Joints start_rad;
  Joints goal_rad;   ///< end of the witness; in a dodge the same as the start
  double witness_s;  ///< duration of the witness's motion; 0 in a dodge, among people and among boxes, which have none
  TimedPath witness_path;  ///< furniture: the witness; else it is straight, see witness_rad()
  std::vector<SpherePath> spheres;
  std::vector<BoxPath> boxes;
  double crossing_s = 0.0;               ///< dodge: the time at which the spheres reach the arm's start configuration
  std::vector<CapsulePath> capsules;     ///< of persons
  std::vector<sim::Obstacle> furniture;  ///< boxes, cylinders and spheres at rest; among boxes the ground
  bool reports_velocities = true;        ///< of obstacles; false: the controller receives zeros
  double ahead_s = 0.0;                  ///< the controller receives obstacles as they will be so much later
  bool shuffles_obstacles = false;       ///< each set that the controller receives has another order
  bool goal_has_orientation = false;     ///< furniture: the goal is also the tool's orientation at goal_rad
  /// People: the target is first the tool's position at the goal, then changes moves - 1 times between those at start
  /// and goal, each time after this duration.
  double move_s = 0.0;
  int moves = 1;

  double duration_s() const { return periods * kPeriod_s; }
};

/// Limit of the tool error at the end of a successful trial.
double arrived_within_m(const Family& family);

/// The witness: a joint path that solves the scene. It moves on the straight line from start to goal in joint space
/// with the profile 3u^2 - 2u^3, or on witness_path; then it rests.
Joints witness_rad(const Scene& scene, double t_s);
Joints witness_radps(const Scene& scene, double t_s);

/// Target of the tool's position, base frame. Before t = 0 it rests where it is at t = 0.
PointMotion target_at(const Scene& scene, double t_s);

/// Target of the tool's orientation and angular velocity, base frame.
struct OrientationTarget {
  Eigen::Quaterniond orientation;
  Vector3 velocity_radps;
};

/// Absent if the task is only a position of the tool.
std::optional<OrientationTarget> orientation_target_at(const Scene& scene, double t_s);

/// The capsules of the persons at time t.
std::vector<Capsule> capsules_at(const Scene& scene, double t_s);

/// The boxes that move, at time t. Base frame; their ids are not set.
std::vector<sim::Obstacle> boxes_at(const Scene& scene, double t_s);

/// Least clearance between the arm and all obstacles at time t. Returns within_m if the clearance is not less.
double clearance_at(const Scene& scene, const ArmPose& pose, double t_s, double within_m = sim::kNothingNear);

/// The same to the spheres alone.
double sphere_clearance_at(const Scene& scene, const ArmPose& pose, double t_s, double within_m = sim::kNothingNear);

/// Dodge: the pass, the time in which the spheres are within kPassReach_m of their crossing points. The tool's
/// deviation is measured over the pass.
constexpr double kPassReach_m = 0.35;
double pass_begins_s(const Scene& scene);
double pass_ends_s(const Scene& scene);

}  // namespace sidestep::campaign
