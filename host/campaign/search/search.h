#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

#include "firmware/control/types/model.h"
#include "host/campaign/search/search_scene_maker.h"
#include "host/campaign/search/search_trial.h"
#include "host/campaign/search/witness_path.h"

namespace sidestep::campaign {

/// A scene in which the arm was touched, and a witness: a path by which it could have evaded.
struct Finding {
  uint64_t chain = 0;  ///< seed of the chain of runs
  int run = 0;         ///< in the chain, from 1
  SearchScene scene;
  ClosestApproach closest;
  WitnessPath witness;
  double witness_clearance_m = 0.0;
};

/// The results of one chain or of a whole search.
struct SearchResult {
  int runs = 0, contacts = 0;
  double least_clearance_m = sim::kNothingNear;
  std::vector<Finding> findings;
};

/// Runs of one chain: the scene with the least clearance of a pool of random ones is mutated, and each mutation with
/// less clearance is kept, until there is a contact or no progress; then the next pool is drawn. Chains are independent
/// of each other, so that they can run in parallel.
constexpr int kChainRuns = 60;

/// The chains of a search: those with the indices shard - 1, shard - 1 + shards, ... of as many as `runs` runs need.
struct SearchPlan {
  uint64_t seed;
  int runs;
  int shard = 1, shards = 1;
};

/// Number of runs of a plan.
int runs_of(const SearchPlan& plan);

/// Runs all chains of a plan on `jobs` threads; the result does not depend on their number. When `stop` becomes true
/// the current runs are finished. Progress is printed on stderr unless quiet. The model's arm must be the LWA3. Throws
/// like run_search_trial().
SearchResult search(const SearchSpace& space, const Model& model, const SearchPlan& plan, int jobs, bool quiet,
                    const std::atomic<bool>& stop);

}  // namespace sidestep::campaign
