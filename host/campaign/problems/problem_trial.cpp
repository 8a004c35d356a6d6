#include "host/campaign/problems/problem_trial.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>

#include "firmware/base/fail.h"
#include "host/campaign/parallel.h"
#include "host/campaign/problems/problem_config.h"
#include "host/campaign/progress.h"
#include "host/campaign/scene.h"
#include "host/campaign/solids.h"
#include "host/campaign/trial_controller.h"
#include "host/sim/plant.h"

namespace sidestep::campaign {
namespace {

constexpr double kWithin_m = 0.01;
constexpr double kNear_m = 0.02;       // nearer than this, the way between two cycles is looked at
constexpr double kMoverNear_m = 0.05;  // the same for what moves
constexpr int kChecksPerPeriod = 5;
constexpr int64_t kLatestStart_us = 6'000'000;

class ProblemTrial {
 public:
  ProblemTrial(const Problem& problem, const Config& config, const sim::Truth& truth)
      : problem_(problem),
        truth_(truth),
        model_(config_for(problem, config).model),
        controller_(make_controller(model_)),
        plant_({}, problem.start_rad) {
    truth_.place(problem.goal_rad);
    goal_ = truth_.arm().base_from_tool();
    for (const sim::Obstacle& object : problem.obstacles) measurement_.obstacles.push_back(reported(object));
    if (problem.mover) measurement_.obstacles.emplace_back();
    mover_.solid.size_m.x() = kSphereRadius_m;
  }

  ProblemResult run() {
    result_.kind = problem_.kind;
    result_.name = problem_.name;
    result_.clearance_m = sim::kNothingNear;
    result_.self_clearance_m = kNear_m;
    while (!cycle().ready)
      if (now_us_ > kLatestStart_us) fail("{} {}: the controller did not track", problem_.kind, problem_.name);
    const auto cycles = static_cast<int>(kProblemDuration_s / kPeriod_s);
    for (int k = 0; k < cycles; ++k) {
      const Joints before_rad = plant_.q_rad();
      t_s_ = k * kPeriod_s;
      if (cycle().guided) result_.guided += 1.0 / cycles;
      measure(before_rad, plant_.q_rad());
      if (!result_.arrived(kWithin_m)) result_.arrival_s = (k + 1) * kPeriod_s;
    }
    return result_;
  }

 private:
  ControllerOutput cycle() {
    const Joints q_rad = plant_.q_rad(), qd_radps = plant_.qd_radps();
    if (problem_.mover) {
      const PointMotion mover = problem_.mover->at(t_s_);
      measurement_.obstacles.back() = sphere_obstacle(mover.position_m, kSphereRadius_m);
      measurement_.obstacles.back().velocity_mps = mover.velocity_mps;
    }
    measurement_.received_us = now_us_;
    ++measurement_.count;
    const PointMotion target{goal_.translation(), Vector3::Zero()};
    const std::optional<OrientationTarget> orientation{{Quaternion(goal_.linear()), Vector3::Zero()}};
    ControllerOutput output = controller_->cycle({now_us_, q_rad, qd_radps, &target, orientation, measurement_});
    if (output.velocity_radps.size() > 0) plant_.command(output.velocity_radps);
    plant_.advance(kPeriod_us);
    now_us_ += kPeriod_us;
    return output;
  }

  /// Of the cycle from t_s_ on, in which the ideal plant moves at constant joint velocity.
  void measure(const Joints& from_rad, const Joints& to_rad) {
    bool near = is_near_at(to_rad, t_s_ + kPeriod_s);
    for (int i = 1; i < kChecksPerPeriod && near; ++i) {
      const double share = static_cast<double>(i) / kChecksPerPeriod;
      is_near_at(from_rad + share * (to_rad - from_rad), t_s_ + share * kPeriod_s);
    }
    truth_.place(to_rad);
    const Eigen::Isometry3d& tool = truth_.arm().base_from_tool();
    result_.error_m = (tool.translation() - goal_.translation()).norm();
    result_.error_rad = Quaternion(tool.linear()).angularDistance(Quaternion(goal_.linear()));
  }

  /// Records the clearances. Returns whether something is near.
  bool is_near_at(const Joints& q_rad, double t_s) {
    truth_.place(q_rad);
    result_.self_clearance_m =
        std::min(result_.self_clearance_m, truth_.nearest_links(result_.self_clearance_m).clearance_m);
    const double clearance_m = truth_.nearest(problem_.obstacles, std::max(result_.clearance_m, kNear_m)).clearance_m;
    result_.clearance_m = std::min(result_.clearance_m, clearance_m);
    if (!problem_.mover) return clearance_m < kNear_m;
    mover_.motion.position_m = problem_.mover->at(t_s).position_m;
    const double mover_m = truth_.clearance_m(mover_);
    result_.mover_clearance_m = std::fmin(result_.mover_clearance_m, mover_m);
    return clearance_m < kNear_m || mover_m < kMoverNear_m;
  }

  const Problem& problem_;
  sim::Truth truth_;
  const Model model_;
  std::unique_ptr<TrialController> controller_;
  sim::Plant plant_;
  Eigen::Isometry3d goal_;
  ObstacleMeasurement measurement_;
  sim::Obstacle mover_;
  double t_s_ = 0.0;  ///< since the first cycle that tracks
  ProblemResult result_;
  int64_t now_us_ = 1'000'000;
};

sim::Truth truth_of(const Robot& robot) {
  return sim::Truth(sim::Arm(robot.urdf, robot.base, robot.tip, robot.meshes.package_path, robot.joint_positions));
}

}  // namespace

std::vector<ProblemResult> play(const std::vector<Problem>& problems, const Config& config, int jobs, bool quiet,
                                const std::atomic<bool>& stop) {
  // Loading an arm with meshes takes seconds; the positions of the fingers are mostly the same.
  std::map<JointPositions, sim::Truth> truths;
  for (const Problem& problem : problems)
    if (const auto place = truths.lower_bound(problem.other_positions);
        place == truths.end() || place->first != problem.other_positions)
      truths.emplace_hint(place, problem.other_positions, truth_of(config_for(problem, config).robot));
  std::vector<std::optional<ProblemResult>> results(problems.size());
  Progress progress(problems.size(), quiet);
  run_parallel(problems.size(), jobs, stop, [&](size_t i) {
    results[i] = ProblemTrial(problems[i], config, truths.at(problems[i].other_positions)).run();
    progress.add(results[i]->touched(), results[i]->arrived(kWithin_m));
  });
  std::vector<ProblemResult> finished;
  for (const auto& result : results)
    if (result) finished.push_back(*result);
  return finished;
}

}  // namespace sidestep::campaign
