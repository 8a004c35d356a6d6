#include "firmware/foresight/tree_planner.h"

#include <algorithm>
#include <cmath>

#include "firmware/control/shield/required_clearance.h"
#include "firmware/foresight/inverse_kinematics.h"
#include "firmware/foresight/rollout.h"
#include "firmware/model/prediction.h"

namespace sidestep {
namespace {

constexpr int kChecksPerSlice = 800;
constexpr int kFirstPatience_slices = 30;     // 99 % of 3000 searches into an open box found a way earlier
constexpr int kLongestPatience_slices = 480;  // about what fills a tree
constexpr int kGoalTriesPerSlice = 6;
constexpr int kFirstGoalTriesPerSlice = 25;  // while there is none
constexpr double kStep_rad = 0.75;
constexpr int kShortcuts = 80;
constexpr double kLeastSaving_rad = 0.05;
constexpr int kMostPoints = 8;       // of a path, so that a guide has knots enough
constexpr double kLimitShare = 0.9;  // of the velocity and acceleration limits; the rest is left to the shield

// To what rests, a way keeps so much more than the shield: for the blends and between two samples of it.
constexpr double kRestAllowance_m = 0.001;

// A target that is slower rests.
constexpr double kTargetRests_mps = 0.01;
constexpr double kTargetRests_radps = 0.02;

constexpr double kStayAtGoal_s = 1.0;  // a guide ends so much before the horizon
constexpr double kPauses_s[] = {0.0, 0.4, 0.8, 1.5};
constexpr double kSampleEvery_s = 0.06;

bool rests(const Target& target) {
  return target.velocity_mps.norm() < kTargetRests_mps && target.angular_velocity_radps.norm() < kTargetRests_radps;
}

/// The path up to point `last`, the new points, and the path from point `next` on.
JointPath with_shortcut(const JointPath& path_rad, int last, int next, std::initializer_list<JointVector> points_rad) {
  JointPath shorter_rad;
  for (int i = 0; i <= last; ++i) shorter_rad.add(path_rad[i]);
  for (const JointVector& q_rad : points_rad) shorter_rad.add(q_rad);
  for (int i = next; i < path_rad.size(); ++i) shorter_rad.add(path_rad[i]);
  return shorter_rad;
}

}  // namespace

TreePlanner::TreePlanner(const Model& model) : model_(model), random_(model.settings.foresight.seed), free_(model) {}

void TreePlanner::reset() {
  random_ = SplitMix64(model_.settings.foresight.seed);
  valid_ = false;
}

bool TreePlanner::is_current(const Snapshot& now) const {
  return valid_ && is_same_goal(now.target, target_, model_.arm.joint_scale) && free_.is_current(now);
}

/// What is not exactly known needs the full clearance.
double TreePlanner::rest_clearance_m() const {
  const Settings& settings = model_.settings;
  if (!is_exact(settings.obstacle_trust)) return settings.foresight.clearance_m;
  return settings.shield.rest_clearance_m + kRestAllowance_m;
}

void TreePlanner::begin(const Snapshot& from) {
  free_.set(from, model_.settings.foresight.clearance_m, rest_clearance_m());
  target_ = from.target;
  patience_ = slices_left_ = kFirstPatience_slices;
  start_rad_ = from.arm.position_rad;
  goals_rad_.clear();
  path_.clear();
  clear_trees();
  valid_ = true;
}

/// After a search in vain.
void TreePlanner::begin_anew(const Snapshot& from) {
  const int patience = std::min(2 * patience_, kLongestPatience_slices);
  begin(from);
  patience_ = slices_left_ = patience;
}

void TreePlanner::clear_trees() {
  for (Tree& tree : trees_) tree.clear();
  trees_[0].add({start_rad_, -1});
  for (const JointVector& goal_rad : goals_rad_) trees_[1].add({goal_rad, -1});
}

/// Uniformly distributed within the position limits; a joint without limits makes half a turn to either side of where
/// it is.
JointVector TreePlanner::random_configuration() {
  const JointLimits& limits = model_.arm.limits;
  JointVector q_rad(model_.arm.joints);
  for (Eigen::Index i = 0; i < q_rad.size(); ++i)
    q_rad[i] = random_.uniform(lower_or_half_turn(limits, start_rad_, i), upper_or_half_turn(limits, start_rad_, i));
  return q_rad;
}

/// A posture is the only goal.
void TreePlanner::find_goals() {
  if (target_.is_posture()) {
    if (goals_rad_.size() > 0 || !free_.contains(target_.posture_rad)) return;
    goals_rad_.add(target_.posture_rad);
    trees_[1].add({target_.posture_rad, -1});
    return;
  }
  const int tries = goals_rad_.size() == 0 ? kFirstGoalTriesPerSlice : kGoalTriesPerSlice;
  for (int i = 0; i < tries && !goals_rad_.is_full() && !trees_[1].is_full(); ++i) {
    JointVector goal_rad = goals_rad_.size() == 0 && i == 0 ? start_rad_ : random_configuration();
    if (!solve_ik(model_.arm, target_, goal_rad) || !free_.contains(goal_rad)) continue;
    goals_rad_.add(goal_rad);
    trees_[1].add({goal_rad, -1});
  }
}

double TreePlanner::length_rad(const JointVector& from_rad, const JointVector& to_rad) const {
  return euclidean_norm(to_rad - from_rad, model_.arm.joint_scale);
}

int TreePlanner::nearest(const Tree& tree, const JointVector& q_rad) const {
  int best = 0;
  double least = std::numeric_limits<double>::infinity();
  const JointVector per_scale = model_.arm.joint_scale.cwiseInverse();
  for (int k = 0; k < tree.size(); ++k) {
    const double distance = (tree[k].q_rad - q_rad).cwiseProduct(per_scale).squaredNorm();
    if (distance < least) least = distance, best = k;
  }
  return best;
}

TreePlanner::Extension TreePlanner::extend(Tree& tree, const JointVector& toward_rad) {
  const int parent = nearest(tree, toward_rad);
  const JointVector from_rad = tree[parent].q_rad;
  const double distance = length_rad(from_rad, toward_rad);
  const bool reaches = distance <= kStep_rad;
  const JointVector to_rad =
      reaches ? toward_rad : JointVector(from_rad + (toward_rad - from_rad) * kStep_rad / distance);
  --checks_left_;
  if (!free_.contains(to_rad) || !free_.contains_way(from_rad, to_rad, checks_left_)) return Extension::kTrapped;
  tree.add({to_rad, parent});
  return reaches ? Extension::kReached : Extension::kAdvanced;
}

TreePlanner::Extension TreePlanner::connect(Tree& tree, const JointVector& toward_rad) {
  Extension extension = Extension::kAdvanced;
  while (extension == Extension::kAdvanced && !tree.is_full()) extension = extend(tree, toward_rad);
  return extension;
}

/// Grows the trees until they meet or the slice is over.
void TreePlanner::grow() {
  while (checks_left_ > 0 && path_.size() == 0) {
    if (trees_[0].is_full() || trees_[1].is_full()) clear_trees();
    const int smaller = trees_[0].size() <= trees_[1].size() ? 0 : 1;
    Tree &growing = trees_[smaller], &other = trees_[1 - smaller];
    if (extend(growing, random_configuration()) == Extension::kTrapped) continue;
    const JointVector reached_rad = growing[growing.size() - 1].q_rad;
    if (other.is_full() || connect(other, reached_rad) != Extension::kReached) continue;
    if (!join()) clear_trees();
  }
}

/// The way through both trees, whose last nodes are the same configuration. Returns false if it has too many points.
bool TreePlanner::join() {
  path_.clear();
  for (int k = trees_[0].size() - 1; k >= 0 && !path_.is_full(); k = trees_[0][k].parent) path_.add(trees_[0][k].q_rad);
  std::reverse(path_.begin(), path_.end());
  for (int k = trees_[1][trees_[1].size() - 1].parent; k >= 0 && !path_.is_full(); k = trees_[1][k].parent)
    path_.add(trees_[1][k].q_rad);
  if (path_.is_full()) path_.clear();
  shortcuts_left_ = kShortcuts;
  pruned_ = 0;
  return path_.size() > 0;
}

/// Leaves out corners, then replaces parts between random points of the path by straight ways.
void TreePlanner::shorten() {
  for (; pruned_ + 2 < path_.size() && checks_left_ > 0; ++pruned_)
    for (int to = path_.size() - 1; to > pruned_ + 1; --to)
      if (free_.contains_way(path_[pruned_], path_[to], checks_left_)) {
        path_ = with_shortcut(path_, pruned_, to, {});
        break;
      }
  for (; shortcuts_left_ > 0 && checks_left_ > 0; --shortcuts_left_) try_shortcut();
}

void TreePlanner::try_shortcut() {
  double first = random_.uniform(0.0, path_.size() - 1.0), second = random_.uniform(0.0, path_.size() - 1.0);
  if (second < first) std::swap(first, second);
  const int a = static_cast<int>(first), b = static_cast<int>(second);
  if (a == b || path_.size() + 2 - (b - a) > kMostPoints) return;
  const auto point = [&](double at, int i) { return JointVector(path_[i] + (at - i) * (path_[i + 1] - path_[i])); };
  const JointVector from_rad = point(first, a), to_rad = point(second, b);
  double around_rad = length_rad(from_rad, path_[a + 1]) + length_rad(path_[b], to_rad);
  for (int i = a + 1; i < b; ++i) around_rad += length_rad(path_[i], path_[i + 1]);
  if (around_rad - length_rad(from_rad, to_rad) < kLeastSaving_rad) return;
  if (free_.contains_way(from_rad, to_rad, checks_left_)) path_ = with_shortcut(path_, a, b + 1, {from_rad, to_rad});
}

/// Up to the horizon, of obstacles that move or turn, however slowly. They are required to be as far away as in
/// required_clearance.h.
bool TreePlanner::is_clear_of_movers(const Snapshot& from, const Guide& guide) const {
  const ForesightSettings& settings = model_.settings.foresight;
  const double enough_m = settings.clearance_m;
  BoundedList<Obstacle, kMaxNearbyObstacles> movers;
  BoundedList<double, kMaxNearbyObstacles> allowance_m;
  for (int i = 0; i < from.nearby.count; ++i) {
    const Obstacle& obstacle = from.nearby.obstacles[i];
    if (!is_moving(obstacle)) continue;
    movers.add(obstacle);
    allowance_m.add(enough_m - required_clearance_m(enough_m, rest_clearance_m(), obstacle));
  }
  if (movers.size() == 0) return true;
  const OtherFrames others = place_others(model_.arm, from.others, from.attachments);
  for (int sample = 0; sample * kSampleEvery_s <= settings.horizon_s; ++sample) {
    const double after_s = sample * kSampleEvery_s;
    const LinkPoses poses = forward_kinematics(model_.arm, point_of(guide, from.now_s + after_s).position_rad, others);
    if (clearance_after(model_.arm, poses, movers.begin(), movers.size(), after_s, enough_m, allowance_m.begin(),
                        true) < enough_m)
      return false;
  }
  return true;
}

/// From where the arm is now; it has moved on since the trees began. An arm under way leaves out all points that it
/// need not pass, so that it does not turn back; an arm in a dead end has hardly moved. Empty if the way there is not
/// free.
JointPath TreePlanner::path_from(const JointVector& q_rad, bool under_way) const {
  int checks = 0, first = under_way ? path_.size() - 1 : 0;
  while (first > 0 && !free_.contains_way(q_rad, path_[first], checks)) --first;
  JointPath path;
  path.add(q_rad);
  for (; first < path_.size(); ++first)
    if (length_rad(path[path.size() - 1], path_[first]) > 1e-3) path.add(path_[first]);
  if (path.size() < 2 || !free_.contains_way(path[0], path[1], checks)) path.clear();
  return path;
}

/// The path as a guide.
Guide TreePlanner::finish(const Snapshot& from, double fastest_mps) {
  const JointPath path = path_from(from.arm.position_rad, std::isfinite(fastest_mps));
  valid_ = false;
  if (path.size() == 0) return {};
  for (const double pause_s : kPauses_s) {
    const auto is_free = [&](const JointVector& q_rad) { return free_.contains(q_rad); };
    Guide guide = timed_guide(model_.arm, path, kLimitShare, from.now_s + pause_s, is_free, fastest_mps);
    if (guide.knots == 0 || guide.end_s() > from.now_s + model_.settings.foresight.horizon_s - kStayAtGoal_s) return {};
    if (is_clear_of_movers(from, guide)) return guide;
  }
  return {};
}

bool TreePlanner::is_blocked(const Snapshot& from) {
  if (!from.target.is_posture()) return false;
  if (!is_current(from)) begin(from);
  return !free_.contains(from.target.posture_rad);
}

Guide TreePlanner::run_slice(const Snapshot& from, double fastest_mps) {
  if (!rests(from.target)) return {};
  if (!is_current(from)) begin(from);
  if (path_.size() == 0 && slices_left_-- == 0) begin_anew(from);
  checks_left_ = kChecksPerSlice;
  find_goals();
  if (goals_rad_.size() == 0) return {};
  if (path_.size() == 0) grow();
  if (path_.size() == 0) return {};
  shorten();
  return shortcuts_left_ == 0 ? finish(from, fastest_mps) : Guide{};
}

}  // namespace sidestep
