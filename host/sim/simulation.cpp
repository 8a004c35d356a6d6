#include "host/sim/simulation.h"

#include <algorithm>
#include <functional>

namespace sidestep::sim {
bool Simulation::answered() const {
  return std::all_of(runs.begin(), runs.end(), [](const Run& run) { return run.status().has_value(); });
}

bool Simulation::ready() const {
  return std::all_of(runs.begin(), runs.end(), std::mem_fn(&Run::ready));
}

void Simulation::record() {
  std::vector<const Row*> rows;
  for (Run& run : runs) {
    run.record(runs);
    rows.push_back(&run.row());
  }
  progress_.show_running(rows, scenario().duration_s());
}

std::string Simulation::waits_for() const {
  return std::find_if_not(runs.begin(), runs.end() - 1, std::mem_fn(&Run::ready))->waits_for();
}

}  // namespace sidestep::sim
