#pragma once

#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "host/sim/arm.h"
#include "host/sim/self_distance.h"
#include "host/sim/world.h"

namespace sidestep::sim {

constexpr double kNothingNear = std::numeric_limits<double>::infinity();

/// The closest pair of arm and obstacles; without obstacles (or shapes) the clearance is infinite.
struct Nearest {
  double clearance_m = kNothingNear;  ///< surface to surface, negative when penetrating (see signed_distance_m)
  int obstacle = -1;                  ///< index into the obstacles
  std::string link;
};

/// Lower bound of the distance between the surfaces of a solid and an obstacle, m; cheap.
double lower_bound_m(const Solid& solid, const Eigen::Isometry3d& base_from_solid, const Obstacle& obstacle);

/// Distances between the arm, as its URDF describes it, and obstacles, and between its links. Independent of the
/// controller's kinematics, distances and pairs of links, which it checks. Copies share what does not change.
class Truth {
 public:
  explicit Truth(Arm arm) : arm_(std::move(arm)), self_(std::make_shared<SelfDistance>(arm_)) {}

  const Arm& arm() const { return arm_; }
  int joints() const { return arm_.joints(); }
  /// Moves the arm to this configuration, to which all results below refer.
  void place(const JointVector& q_rad) { arm_.place(q_rad); }

  /// Position of the tool, base frame.
  Eigen::Vector3d tool_m() const { return arm_.base_from_tool().translation(); }

  /// The closest pair of a link, moved by a joint or not, and an obstacle, among the pairs closer than within_m.
  /// Most obstacles cost only a comparison of bounding volumes.
  Nearest nearest(const std::vector<Obstacle>& obstacles, double within_m = kNothingNear) const {
    return nearest(obstacles, kMaxJoints, within_m);
  }

  /// The same for all obstacles of a world. What the tool holds counts as a link: to all obstacles, and to the links
  /// but those of the last two bodies. The links of the last body, and what the tool holds, may touch allowed
  /// obstacles.
  Nearest nearest_in(const World& world) const;

  /// The closest links that must not touch each other, among those closer than within_m (self_distance.h).
  NearestLinks nearest_links(double within_m = kNothingNear) const { return self_->nearest(arm_, within_m); }
  const SelfDistance& self_distance() const { return *self_; }

  /// The links as obstacles at rest, in the base frame of another arm.
  std::vector<Obstacle> links(const Eigen::Isometry3d& other_from_base) const;

  /// Clearance of one obstacle to the nearest link, as in nearest().
  double clearance_m(const Obstacle& obstacle) const { return nearest({obstacle}).clearance_m; }

  /// The paper's distance: from the centre of the obstacle to the axes of the moving links (docs/paper.md, "The arm").
  /// The axis of a cylinder is the segment between its end faces, of a box or a mesh in its bounding box the one along
  /// the longest edge; a sphere is its centre.
  double axis_distance_m(const Obstacle& obstacle) const;

  /// The smallest axis distance of the obstacles; infinite without obstacles.
  double axis_distance_m(const std::vector<Obstacle>& obstacles) const;

 private:
  /// Only links of bodies up to last_body.
  Nearest nearest(const std::vector<Obstacle>& obstacles, int last_body, double within_m) const;

  Arm arm_;
  std::shared_ptr<const SelfDistance> self_;
};

}  // namespace sidestep::sim
