#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "firmware/control/message_order.h"
#include "firmware/control/motion_estimator.h"
#include "firmware/model/obstacle.h"

namespace sidestep {

/// Merges the obstacle sets of several senders into one set in the base frame: the own OBSTACLES channel (part 0) and
/// the links of each neighbour arm (parts 1 to n, in the world frame).
///
/// The merged set is as old as its oldest part; newer parts are extrapolated back to that time. A neighbour that stops
/// sending thus makes the whole set time out, exactly as missing obstacles do. Obstacle i of neighbour k gets the id
/// -(10000 k + i), where i counts within the neighbour's message.
class ObstacleMerger {
 public:
  /// timeout_s: largest age of a part, timeouts.obstacles_s. estimates_motion: of each part (motion_estimator.h), the
  /// links of other arms without a lead.
  ObstacleMerger(size_t neighbours, const Eigen::Isometry3d& base_from_world, double timeout_s, bool estimates_motion);
  ~ObstacleMerger();

  /// The set to decode the next message of a part into; its previous content is arbitrary.
  ObstacleSet& draft(size_t part);

  /// Takes the draft of a part, received at now_s, and completes its velocities; drops it when it is late or repeated.
  bool accept(size_t part, int64_t utime, double now_s);

  struct Merged {
    int64_t utime;  ///< of the merge, increasing with every merged set
    double age_s;   ///< of the oldest part
  };
  /// Writes the merged set; nothing while a part is missing or too old, or when the set would exceed kMaxObstacles.
  /// Does not allocate.
  std::optional<Merged> merge(double now_s, ObstacleSet& merged);

  /// The last merge() failed because of the number of obstacles.
  bool too_many() const { return too_many_; }

 private:
  struct Part;
  double oldest_s() const;
  void add(const Part& part, int number, double at_s, ObstacleSet& merged);

  double timeout_s_;
  bool estimates_motion_;
  int64_t utime_ = 0;
  bool too_many_ = false;
  std::vector<std::unique_ptr<Part>> parts_;
};

}  // namespace sidestep
