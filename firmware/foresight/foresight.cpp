#include "firmware/foresight/foresight.h"

namespace sidestep {
namespace {

constexpr int kJudgeEvery = 5;     // calls
constexpr double kBetter_s = 0.5;  // by which a change has to pay
constexpr int kInVain = 50;        // calls of search until the outlook is to wait

/// Whether it is worth looking for something better.
bool is_fine(const Forecast& forecast) {
  return forecast.arrives && !forecast.collides && forecast.cost_s < 4.0;
}

}  // namespace

bool foresees(const Settings& settings) {
  return settings.foresight.enabled && settings.law == Law::kSidestep;
}

void Foresight::take(const Guide& guide, const Forecast& forecast) {
  guide_ = guide;
  expected_ = forecast;
  searching_ = 0;
}

void Foresight::judge(const Snapshot& now) {
  expected_ = rollout_.run(now, guide_);
  if (guide_.knots > 0) {
    const Forecast direct = rollout_.run(now, Guide{});
    if (direct.cost_s < expected_.cost_s - kBetter_s || (!expected_.arrives && direct.cost_s <= expected_.cost_s))
      take(Guide{}, direct);
  }
  if (is_fine(expected_)) {
    searching_ = 0;
    candidate_ = Guide{};
    if (guide_.knots == 0) guide_.foresight_status = ForesightStatus::kDirect;
  }
}

void Foresight::search(const Snapshot& now) {
  if (candidate_.knots > 0) {
    // Both from now: a coarse future that only grazes an obstacle may change its mind from one cycle to the next.
    expected_ = rollout_.run(now, guide_);
    const Forecast forecast = rollout_.run(now, candidate_);
    if (forecast.cost_s < expected_.cost_s - kBetter_s) take(candidate_, forecast);
    candidate_ = Guide{};
    return;
  }
  candidate_ = planner_.to_target(now);
  if (candidate_.knots > 0) return;
  if (expected_.collides) candidate_ = planner_.to_safety(now);
  if (++searching_ > kInVain && guide_.knots == 0 && !expected_.arrives)
    guide_.foresight_status = ForesightStatus::kWaiting;
}

const Guide& Foresight::update(const Snapshot& now) {
  if (!now.tracking) {
    take(Guide{}, Forecast{});
    candidate_ = Guide{};
    planner_.start_over();
    calls_ = 0;
    return guide_;
  }
  if (calls_++ % kJudgeEvery == 0)
    judge(now);
  else if (!is_fine(expected_))
    search(now);
  return guide_;
}

}  // namespace sidestep
