#include "host/campaign/people/way_out.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "firmware/model/nearest_points.h"
#include "host/campaign/judge.h"
#include "host/campaign/random.h"
#include "host/campaign/stopping.h"

namespace sidestep::campaign {
namespace {

constexpr int kMostMotions = 400;
constexpr int kStride = 2;  // periods a step
constexpr double kStep_s = kStride * kPeriod_s;
constexpr double kClearance_m = 0.01;
constexpr double kReaches_rad[] = {0.4, 1.0, 2.0, 6.0};

/// A motion of the arm from the first instant of the search, an instant each step.
using Motion = std::vector<ArmInstant>;

/// An instant of a motion at which another one branches off.
struct Branch {
  std::shared_ptr<const Motion> motion;
  size_t index;
};

/// By the judge's surfaces; exact where something is near.
struct Clearances {
  double persons_m, links_m;

  bool touched() const { return persons_m < 0.0 || links_m <= 0.0; }
  bool near() const { return persons_m < kNear_m || links_m < kSelfNear_m; }
};

class Search {
 public:
  Search(const Scene& scene, const ArmInstant& from)
      : scene_(scene), limits_(scene.arm->limits(*scene.family)), random_("way-out", scene.seed) {
    tree_.push_back({std::make_shared<Motion>(1, from), 0});
    for (int k = 0; k <= scene.periods + kStride; ++k) persons_.push_back(capsules_at(scene, k * kPeriod_s));
    needed_m_ = std::min(kClearance_m, clearance(from));
  }

  bool run() {
    for (int motion = 0; motion < kMostMotions; ++motion) {
      const int latest = static_cast<int>(tree_.size()) - 1;
      const size_t chosen = random_.uniform(0.0, 1.0) < 0.5 ? 0 : static_cast<size_t>(random_.integer(0, latest));
      const Branch branch = tree_[chosen];
      const Joints& q_rad = (*branch.motion)[branch.index].q_rad;
      if (succeeds(branch, motion == 0 ? q_rad : draw_posture(q_rad))) return true;
    }
    return false;
  }

 private:
  double clearance(const ArmInstant& arm) const {
    double least_m = sim::kNothingNear;
    for (const Capsule& link : scene_.arm->enclosing_capsules(arm.q_rad)) {
      for (const Capsule& person : persons_[static_cast<size_t>(arm.period)]) {
        const double radii_m = link.radius_m + person.radius_m;
        const double centres_m = (link.centre() - person.centre()).norm();
        if (centres_m - link.extent_m() - person.extent_m() > least_m) continue;
        const NearestPoints nearest = nearest_on_axes(link, person);
        least_m = std::min(least_m, (nearest.a - nearest.b).norm() - radii_m);
      }
    }
    return least_m;
  }

  Joints draw_posture(const Joints& q_rad) {
    const double reach_rad = kReaches_rad[random_.integer(0, 3)];
    Joints posture_rad = q_rad;
    for (int i = 0; i < posture_rad.size(); ++i)
      posture_rad[i] = std::clamp(q_rad[i] + random_.uniform(-reach_rad, reach_rad), range(i, false), range(i, true));
    return posture_rad;
  }

  double range(int joint, bool upper) const {
    const Limits range = scene_.arm->range();
    return upper ? std::min(range.upper_rad[joint], limits_.upper_rad[joint])
                 : std::max(range.lower_rad[joint], limits_.lower_rad[joint]);
  }

  ArmInstant advanced(const ArmInstant& arm, const Joints& to_rad) const {
    ArmInstant next{arm.period + kStride, arm.q_rad, arm.qd_radps};
    for (int i = 0; i < to_rad.size(); ++i) {
      const double gap_rad = to_rad[i] - arm.q_rad[i], a = limits_.acceleration_radps2[i];
      const double speed = std::min({stoppable_radps(std::abs(gap_rad), a, 0.5 * kStep_s), limits_.velocity_radps[i],
                                     std::abs(gap_rad) / kStep_s});
      next.qd_radps[i] =
          std::clamp(std::copysign(speed, gap_rad), arm.qd_radps[i] - a * kStep_s, arm.qd_radps[i] + a * kStep_s);
      next.q_rad[i] += next.qd_radps[i] * kStep_s;
    }
    return next;
  }

  /// Moves to a posture and stays. Adds branches of the motion to the tree.
  bool succeeds(const Branch& from, const Joints& to_rad) {
    Motion motion(from.motion->begin(), from.motion->begin() + static_cast<long>(from.index) + 1);
    bool clear = true;
    while (clear && motion.back().period < scene_.periods) {
      motion.push_back(advanced(motion.back(), to_rad));
      clear = clearance(motion.back()) >= needed_m_;
    }
    if (clear && within_limits(motion) && judged_clear(motion)) return true;
    const auto failed = std::make_shared<const Motion>(std::move(motion));
    for (const double before_s : {0.2, 0.5, 1.0}) {
      const size_t steps = static_cast<size_t>(before_s / kStep_s) + 1;
      if (failed->size() > from.index + 1 + steps) tree_.push_back({failed, failed->size() - steps});
    }
    return false;
  }

  bool within_limits(const Motion& motion) const {
    return std::all_of(motion.begin(), motion.end(), [&](const ArmInstant& arm) {
      return (arm.q_rad - limits_.lower_rad).minCoeff() >= -1e-6 && (limits_.upper_rad - arm.q_rad).minCoeff() >= -1e-6;
    });
  }

  /// Clearances `periods` after an instant of a motion, on the way to the next one.
  Clearances clearances(const ArmInstant& from, const ArmInstant& to, double periods) const {
    const ArmPose pose = scene_.arm->pose(from.q_rad + periods / kStride * (to.q_rad - from.q_rad));
    return {clearance_at(scene_, pose, (from.period + periods) * kPeriod_s, kNear_m),
            scene_.arm->self_clearance(pose, kSelfNear_m)};
  }

  /// Whether no contact occurs, by the judge's surfaces, at the instants at which the judge looks.
  bool judged_clear(const Motion& motion) const {
    const int checks = contact_checks(scene_);
    for (size_t step = 1; step < motion.size(); ++step) {
      for (int period = 1; period <= kStride; ++period) {
        const Clearances end = clearances(motion[step - 1], motion[step], period);
        if (end.touched()) return false;
        for (int i = 1; i < checks && end.near(); ++i) {
          const double back = static_cast<double>(i) / checks;
          if (clearances(motion[step - 1], motion[step], period - back).touched()) return false;
        }
      }
    }
    return true;
  }

  const Scene& scene_;
  const Limits limits_;
  Random random_;
  std::vector<Branch> tree_;
  std::vector<std::vector<Capsule>> persons_;  ///< at each period
  double needed_m_ = kClearance_m;
};

}  // namespace

bool has_way_out(const Scene& scene, const ArmInstant& from) {
  return Search(scene, from).run();
}

double clearance_at_rest(const Scene& scene) {
  const ArmPose pose = scene.arm->pose(scene.start_rad);
  const int checks = contact_checks(scene);
  double least_m = sim::kNothingNear;
  for (int k = 0; k <= scene.periods; ++k) {
    const double t_s = k * kPeriod_s, clearance_m = clearance_at(scene, pose, t_s, std::max(kNear_m, least_m));
    least_m = std::min(least_m, clearance_m);
    for (int i = 1; i < checks && clearance_m < kNear_m; ++i)
      least_m = clearance_at(scene, pose, t_s - static_cast<double>(i) / checks * kPeriod_s, least_m);
  }
  return least_m;
}

}  // namespace sidestep::campaign
