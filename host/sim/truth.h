#pragma once

#include <limits>
#include <string>
#include <vector>

#include "host/sim/arm.h"
#include "host/sim/world.h"

namespace sidestep::sim {

constexpr double kNothingNear = std::numeric_limits<double>::infinity();

/// The closest pair of arm and obstacles; without obstacles (or shapes) the clearance is infinite.
struct Nearest {
  double clearance_m = kNothingNear;  ///< surface to surface, negative when penetrating (see signed_distance_m)
  int obstacle = -1;                  ///< index into the obstacles
  std::string link;
};

/// Independent judge of what happened: distances between the arm, as its URDF describes it, and obstacles.
class Truth {
 public:
  explicit Truth(Arm arm) : arm_(std::move(arm)) {}

  const Arm& arm() const { return arm_; }
  int joints() const { return arm_.joints(); }
  void place(const JointVector& q_rad) { arm_.place(q_rad); }

  /// Base frame.
  Eigen::Vector3d tool_m() const { return arm_.base_from_tool().translation(); }

  /// Over all links, also those that no joint moves; pairs that are not nearer than within_m do not count. The work
  /// grows with the number of obstacles, most of which cost only a comparison of bounding volumes.
  Nearest nearest(const std::vector<Obstacle>& obstacles, double within_m = kNothingNear) const;

  /// The links, each an obstacle where it is now, for another arm to keep clear of.
  std::vector<Obstacle> links(const Eigen::Isometry3d& other_from_base) const;

  /// From one obstacle to the nearest link, as in nearest().
  double clearance_m(const Obstacle& obstacle) const { return nearest({obstacle}).clearance_m; }

  /// The paper's distance: from the centre of the obstacle to the axes of the moving links (paper-notes, "The arm").
  /// The axis of a cylinder is the segment between its end faces, of a box or a mesh in its bounding box the one along
  /// the longest edge; a sphere is its centre.
  double axis_distance_m(const Obstacle& obstacle) const;

  /// The least of them, infinite without obstacles.
  double axis_distance_m(const std::vector<Obstacle>& obstacles) const;

 private:
  Arm arm_;
};

}  // namespace sidestep::sim
