#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/people/capsule_path.h"
#include "host/sim/joints.h"
#include "host/sim/path.h"
#include "host/sim/solid.h"

namespace sidestep::sim {

/// Pose and velocity of a rigid body. Its velocity is constant or, with a path, follows the path; its angular velocity
/// is constant. A limb of a person moves and turns as its capsule does. Base frame.
struct Motion {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d velocity_mps = Eigen::Vector3d::Zero();
  Eigen::Vector3d angular_velocity_radps = Eigen::Vector3d::Zero();
  std::shared_ptr<const Path> path;         ///< null: constant velocity; shared by all copies
  std::shared_ptr<const CapsulePath> limb;  ///< null: no limb of a person; shared by all copies
  double path_s = 0.0;                      ///< current time on the path, or of the limb

  Eigen::Isometry3d base_from_body() const;
};

/// At t = 0 of the path.
Motion motion_of_limb(CapsulePath path);

struct Obstacle {
  int32_t id = 0;
  Solid solid;
  Motion motion;
  bool is_person = false;
  std::string name{};  ///< of the scenario; empty: none
};

/// The goal of the tool, or of all joints.
struct Target {
  Motion motion;  ///< with joints_rad: of the tool there, at rest
  bool tracks_orientation = false;
  JointVector joints_rad{};  ///< a posture; size 0: the goal is of the tool
};

/// What the tool of an arm holds and may touch.
struct Grip {
  std::vector<Obstacle> held;    ///< obstacles of the world, here in the tool's frame
  std::vector<int32_t> allowed;  ///< ids of obstacles that the tool and what it holds may touch

  bool holds(int32_t id) const;
  bool allows(int32_t id) const;
};

/// Target and obstacles of an arm at one instant.
struct World {
  std::optional<Target> target;        ///< absent: another process sends one, or nobody
  bool obstacles_from_others = false;  ///< other processes send the obstacles; `obstacles` is empty
  std::vector<Obstacle> obstacles;
  std::vector<Obstacle> surroundings;  ///< at rest; in the configuration of the controller, not in messages
  std::optional<Grip> grip;            ///< absent in a scenario in which nothing is grasped

  /// Obstacles, then surroundings.
  std::vector<Obstacle> all() const;
};

/// The world after dt_s. Rotation by the constant angular velocity is exact.
World advanced(const World& world, double dt_s);

/// Target and obstacles, given in frame a, in frame b; the frames do not move against each other.
World transformed(const Eigen::Isometry3d& b_from_a, const World& world);

}  // namespace sidestep::sim
