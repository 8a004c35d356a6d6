#include "firmware/foresight/foresight.h"

namespace sidestep {
namespace {

// Tuned on the witnessed campaign, as the cost below which a forecast is good.
constexpr int kAssessEvery_calls = 5;
constexpr double kWorthAChange_s = 0.5;  // of cost; smaller differences are no reason to change the guide
constexpr double kGoodCost_s = 4.0;
constexpr int kSearchesUntilWaiting = 50;

/// Whether a better guide need not be searched.
bool is_good(const Forecast& forecast) {
  return forecast.arrives && !forecast.collides && forecast.cost_s < kGoodCost_s;
}

}  // namespace

void Foresight::reset() {
  adopt(Guide{}, Forecast{});
  candidate_ = Guide{};
  planner_.reset();
  calls_ = 0;
}

void Foresight::adopt(const Guide& guide, const Forecast& forecast) {
  guide_ = guide;
  expected_ = forecast;
  unsuccessful_searches_ = 0;
}

void Foresight::assess(const Snapshot& now) {
  expected_ = rollout_.run(now, guide_);
  if (guide_.knots > 0) {
    const Forecast direct = rollout_.run(now, Guide{});
    if (direct.cost_s < expected_.cost_s - kWorthAChange_s || (!expected_.arrives && direct.cost_s <= expected_.cost_s))
      adopt(Guide{}, direct);
  }
  if (is_good(expected_)) {
    unsuccessful_searches_ = 0;
    candidate_ = Guide{};
    if (guide_.knots == 0) guide_.foresight_status = ForesightStatus::kDirect;
  }
}

void Foresight::search(const Snapshot& now) {
  if (candidate_.knots > 0) {
    // Both rollouts start from the same snapshot: whether a coarse rollout just touches an obstacle may differ from one
    // snapshot to the next.
    expected_ = rollout_.run(now, guide_);
    const Forecast forecast = rollout_.run(now, candidate_);
    if (forecast.cost_s < expected_.cost_s - kWorthAChange_s) adopt(candidate_, forecast);
    candidate_ = Guide{};
    return;
  }
  candidate_ = planner_.plan_to_target(now);
  if (candidate_.knots > 0) return;
  if (expected_.collides) candidate_ = planner_.plan_retreat(now);
  if (++unsuccessful_searches_ > kSearchesUntilWaiting && guide_.knots == 0 && !expected_.arrives)
    guide_.foresight_status = ForesightStatus::kWaiting;
}

const Guide& Foresight::update(const Snapshot& now) {
  if (!now.tracking)
    reset();
  else if (calls_++ % kAssessEvery_calls == 0)
    assess(now);
  else if (!is_good(expected_))
    search(now);
  return guide_;
}

}  // namespace sidestep
