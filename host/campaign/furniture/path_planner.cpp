#include "host/campaign/furniture/path_planner.h"

#include <ompl/base/ScopedState.h>
#include <ompl/base/samplers/UniformValidStateSampler.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/datastructures/NearestNeighborsLinear.h>
#include <ompl/geometric/PathSimplifier.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/Console.h>

namespace sidestep::campaign {
namespace {

namespace ob = ompl::base;
namespace og = ompl::geometric;

constexpr double kExtension_rad = 0.75;  // of a tree
constexpr int kShorteningRounds = 4;

// OMPL seeds its random numbers in the order in which the objects of the process are made: here each has its own seed.
class SeededSampler : public ob::RealVectorStateSampler {
 public:
  SeededSampler(const ob::StateSpace* space, uint32_t seed) : RealVectorStateSampler(space) { rng_.setLocalSeed(seed); }
};

class SeededSimplifier : public og::PathSimplifier {
 public:
  SeededSimplifier(const ob::SpaceInformationPtr& space, uint32_t seed) : PathSimplifier(space) {
    rng_.setLocalSeed(seed);
  }
};

class Planning {
 public:
  explicit Planning(const PlanningProblem& problem)
      : problem_(problem),
        joints_(static_cast<unsigned>(problem.start_rad.size())),
        space_(std::make_shared<ob::RealVectorStateSpace>(joints_)),
        information_(std::make_shared<ob::SpaceInformation>(space_)) {
    ob::RealVectorBounds bounds(joints_);
    for (unsigned i = 0; i < joints_; ++i) {
      bounds.setLow(i, problem.range.lower_rad[i]);
      bounds.setHigh(i, problem.range.upper_rad[i]);
    }
    space_->setBounds(bounds);
    space_->setStateSamplerAllocator(
        [seed = problem.seed](const ob::StateSpace* space) { return std::make_shared<SeededSampler>(space, seed); });
    information_->setStateValidityChecker([this](const ob::State* state) {
      ++checks_;
      return problem_.is_valid(joints_of(state));
    });
    information_->setStateValidityCheckingResolution(kPlannedStep_rad / space_->getMaximumExtent());
    information_->setup();
  }

  std::vector<Joints> run() {
    const auto definition = std::make_shared<ob::ProblemDefinition>(information_);
    definition->setStartAndGoalStates(state_of(problem_.start_rad), state_of(problem_.goal_rad));
    og::RRTConnect planner(information_);
    planner.setProblemDefinition(definition);
    planner.setRange(kExtension_rad);
    planner.setNearestNeighbors<ompl::NearestNeighborsLinear>();  // the default one draws random numbers
    planner.setup();
    const ob::PlannerTerminationCondition at_end([this] { return checks_ >= problem_.most_checks; });
    if (planner.solve(at_end) != ob::PlannerStatus::EXACT_SOLUTION) return {};
    og::PathGeometric path = *definition->getSolutionPath()->as<og::PathGeometric>();
    SeededSimplifier simplifier(information_, problem_.seed);
    for (int round = 0; round < kShorteningRounds; ++round) {
      simplifier.reduceVertices(path);
      simplifier.shortcutPath(path);
    }
    simplifier.reduceVertices(path);
    std::vector<Joints> postures_rad;
    for (const ob::State* state : path.getStates()) postures_rad.push_back(joints_of(state));
    return postures_rad;
  }

 private:
  Joints joints_of(const ob::State* state) const {
    const double* values = state->as<ob::RealVectorStateSpace::StateType>()->values;
    return Eigen::Map<const Eigen::VectorXd>(values, static_cast<int>(joints_));
  }

  ob::ScopedState<> state_of(const Joints& q_rad) const {
    ob::ScopedState<> state(space_);
    for (unsigned i = 0; i < joints_; ++i) state[i] = q_rad[i];
    return state;
  }

  const PlanningProblem& problem_;
  unsigned joints_;
  std::shared_ptr<ob::RealVectorStateSpace> space_;
  ob::SpaceInformationPtr information_;
  int checks_ = 0;
};

}  // namespace

std::vector<Joints> plan_path(const PlanningProblem& problem) {
  ompl::msg::noOutputHandler();
  return Planning(problem).run();
}

}  // namespace sidestep::campaign
