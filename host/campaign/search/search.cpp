#include "host/campaign/search/search.h"

#include <algorithm>

#include "host/campaign/parallel.h"
#include "host/campaign/progress.h"
#include "host/campaign/runner.h"

namespace sidestep::campaign {
namespace {

constexpr int kPool = 8;
constexpr int kMostFailures = 20;  // mutations in a row without less clearance
constexpr int kWitnessDraws = 20'000;

struct Candidate {
  SearchScene scene;
  ClosestApproach closest;
};

class Chain {
 public:
  Chain(const SearchSpace& space, const Model& model, uint64_t seed, int runs, Progress& progress,
        const std::atomic<bool>& stop)
      : space_(space),
        model_(model),
        seed_(seed),
        runs_(runs),
        progress_(progress),
        stop_(stop),
        random_(std::string("search ") + name_of(space.family), seed) {}

  SearchResult result() {
    while (!done()) climb(worst_of_pool());
    return result_;
  }

 private:
  bool done() const { return result_.runs >= runs_ || stop_; }

  Candidate worst_of_pool() {
    Candidate worst;
    for (int i = 0; i < kPool && !done() && worst.closest.clearance_m >= 0.0; ++i) {
      Candidate candidate = run(draw_search_scene(random_, space_));
      if (candidate.closest.clearance_m < worst.closest.clearance_m) worst = std::move(candidate);
    }
    return worst;
  }

  void climb(Candidate worst) {
    for (int failures = 0; failures < kMostFailures && !done() && worst.closest.clearance_m >= 0.0; ++failures) {
      Candidate candidate = run(mutated(random_, space_, worst.scene));
      if (candidate.closest.clearance_m >= worst.closest.clearance_m) continue;
      worst = std::move(candidate);
      failures = -1;
    }
  }

  Candidate run(const SearchScene& scene) {
    const std::unique_ptr<TrialController> controller = make_controller(&model_, lwa3_arm(), space_.limits);
    const ClosestApproach closest = run_search_trial(scene, *controller);
    ++result_.runs;
    result_.least_clearance_m = std::min(result_.least_clearance_m, closest.clearance_m);
    progress_.add(closest.clearance_m < 0.0, closest.clearance_m >= 0.0);
    if (closest.clearance_m < 0.0) record_contact(scene, closest);
    return {scene, closest};
  }

  void record_contact(const SearchScene& scene, const ClosestApproach& closest) {
    ++result_.contacts;
    Random random("witness", seed_ * 1'000 + static_cast<uint64_t>(result_.runs));
    const auto witness = find_witness(random, scene, space_.limits, kWitnessDraws);
    if (!witness) return;
    result_.findings.push_back(
        {seed_, result_.runs, scene, closest, *witness, proven_clearance_m(scene, *witness, space_.limits)});
  }

  const SearchSpace& space_;
  const Model& model_;
  uint64_t seed_;
  int runs_;
  Progress& progress_;
  const std::atomic<bool>& stop_;
  Random random_;
  SearchResult result_;
};

struct ChainPlan {
  uint64_t seed;
  int runs;
};

std::vector<ChainPlan> chains_of(const SearchPlan& plan) {
  std::vector<ChainPlan> chains;
  const int count = (plan.runs + kChainRuns - 1) / kChainRuns;
  for (int k = plan.shard - 1; k < count; k += plan.shards)
    chains.push_back(
        {scene_seed(plan.seed, static_cast<uint64_t>(k)), std::min(kChainRuns, plan.runs - k * kChainRuns)});
  return chains;
}

void add(SearchResult& sum, const SearchResult& result) {
  sum.runs += result.runs;
  sum.contacts += result.contacts;
  sum.least_clearance_m = std::min(sum.least_clearance_m, result.least_clearance_m);
  sum.findings.insert(sum.findings.end(), result.findings.begin(), result.findings.end());
}

}  // namespace

int runs_of(const SearchPlan& plan) {
  int runs = 0;
  for (const ChainPlan& chain : chains_of(plan)) runs += chain.runs;
  return runs;
}

SearchResult search(const SearchSpace& space, const Model& model, const SearchPlan& plan, int jobs, bool quiet,
                    const std::atomic<bool>& stop) {
  const std::vector<ChainPlan> chains = chains_of(plan);
  std::vector<SearchResult> results(chains.size());
  Progress progress(static_cast<size_t>(runs_of(plan)), quiet);
  run_parallel(chains.size(), jobs, stop, [&](size_t i) {
    results[i] = Chain(space, model, chains[i].seed, chains[i].runs, progress, stop).result();
  });
  SearchResult sum;
  for (const SearchResult& result : results) add(sum, result);
  return sum;
}

}  // namespace sidestep::campaign
