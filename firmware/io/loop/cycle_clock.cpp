#include "firmware/io/loop/cycle_clock.h"

#include <fmt/format.h>

#include "firmware/base/realtime.h"

namespace sidestep {
namespace {

constexpr const char* kStageNames[kStages] = {"  monitor", "  clearance", "  law", "  shield", "  gate"};

std::string row(const char* name, const Histogram& histogram) {
  if (histogram.count() == 0) return "";
  return fmt::format("\n{:18}{:10.1f}{:10.1f}{:10.1f}{:10.1f}", name, histogram.quantile_s(0.5) * 1e6,
                     histogram.quantile_s(0.99) * 1e6, histogram.quantile_s(0.999) * 1e6, histogram.worst_s() * 1e6);
}

}  // namespace

std::string table(const LoopTiming& timing) {
  std::string text = fmt::format("{:18}{:>10}{:>10}{:>10}{:>10}", "us", "p50", "p99", "p99.9", "worst");
  text += row("wake-up latency", timing.wake_latency) + row("CPU time, cycle", timing.cycle);
  for (size_t stage = 0; stage < kStages; ++stage) text += row(kStageNames[stage], timing.stages[stage]);
  return text;
}

void CycleClock::start() {
  start_s_ = passed_s_ = thread_cpu_s();
}

void CycleClock::passed(Stage stage) {
  const double now_s = thread_cpu_s();
  timing_.stages[static_cast<size_t>(stage)].add(now_s - passed_s_);
  passed_s_ = now_s;
}

double CycleClock::stop() {
  const double cycle_s = thread_cpu_s() - start_s_;
  timing_.cycle.add(cycle_s);
  return cycle_s;
}

}  // namespace sidestep
