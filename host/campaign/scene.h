#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "host/campaign/family.h"
#include "host/campaign/judge_arm.h"
#include "host/campaign/sphere_path.h"

namespace sidestep::campaign {

constexpr double kPeriod_s = 0.01;
constexpr int64_t kPeriod_us = 10'000;
constexpr double kSphereRadius_m = 0.05;
constexpr double kArrived_m = 0.01;    ///< tool error of an arm that has arrived
constexpr double kBack_m = 0.005;      ///< of one that is back after a dodge
constexpr double kPlantLag_s = 0.030;  ///< family real, first order on the velocity
constexpr double kPlantAcceleration_radps2 = 1e6;

/// One problem, from t = 0 to periods * kPeriod_s.
struct Scene {
  const Family* family;
  uint64_t seed;
  const JudgeArm* arm;
  int periods;
  Joints start_rad;
  Joints goal_rad;   ///< where the witness ends; in a dodge the start
  double witness_s;  ///< duration of the witness's motion; 0 in a dodge
  std::vector<SpherePath> spheres;
  double crossing_s = 0.0;  ///< dodge: when the spheres cross the arm at its start

  double duration_s() const { return periods * kPeriod_s; }
};

/// Tool error at the end of an arm that has done its task.
double arrived_within_m(const Family& family);

/// The witness at time t: from start to goal on the joint line with the profile 3u^2 - 2u^3, then at rest.
Joints witness_rad(const Scene& scene, double t_s);
Joints witness_radps(const Scene& scene, double t_s);

/// Where the tool shall be. Frozen before t = 0.
Moving target_at(const Scene& scene, double t_s);

/// How the tool shall be turned, and turn.
struct Turning {
  Eigen::Quaterniond orientation;
  Vector3 velocity_radps;
};

/// Absent where only the tool's position matters.
std::optional<Turning> turning_at(const Scene& scene, double t_s);

/// Least clearance of the arm to all spheres at time t; within_m when it is not below that.
double clearance_at(const Scene& scene, const ArmPose& pose, double t_s, double within_m = sim::kNothingNear);

/// Dodge: the time while a sphere is so near to its crossing that the tool's deviation counts.
constexpr double kPassReach_m = 0.35;
double pass_begins_s(const Scene& scene);
double pass_ends_s(const Scene& scene);

}  // namespace sidestep::campaign
