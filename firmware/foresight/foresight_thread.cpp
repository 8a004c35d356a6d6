#include "firmware/foresight/foresight_thread.h"

#include <algorithm>

#include "firmware/base/load_limit.h"
#include "firmware/base/realtime.h"

namespace sidestep {
namespace {

constexpr double kUpdateEvery_s = 0.01;

// Of one core: the loop and the receiver need a few percent more. The burst is a few updates on a slow core.
constexpr double kShare = 0.2;
constexpr double kBurst_s = 0.03;

}  // namespace

ForesightThread::ForesightThread(const Model& model, bool lockstep)
    : model_(model), enabled_(model.settings.foresight.enabled) {
  if (!enabled_) return;
  foresight_ = std::make_unique<Foresight>(model);
  if (!lockstep) thread_ = std::thread([this] { run(); });
}

ForesightThread::~ForesightThread() {
  end_ = true;
  if (thread_.joinable()) thread_.join();
}

const Guide* ForesightThread::latest() {
  return enabled_ ? &guides_.latest() : nullptr;
}

void ForesightThread::submit(const Inputs& inputs, const State& state, double now_s) {
  if (!enabled_) return;
  take_snapshot(model_, inputs, state, now_s, snapshots_.draft());
  snapshots_.publish();
  if (!thread_.joinable()) update();
}

void ForesightThread::update() {
  const Snapshot& snapshot = snapshots_.latest();
  guides_.draft() = foresight_->update(snapshot);
  guides_.publish();
}

void ForesightThread::run() {
  use_normal_scheduler();
  LoadLimit limit(kShare, kBurst_s, monotonic_s());
  while (!end_) {
    const double now_s = monotonic_s();
    sleep_until(std::max(now_s + kUpdateEvery_s, limit.next_start_s(now_s, thread_cpu_s())));
    const double cycle_s = snapshots_.latest().now_s;
    if (cycle_s != updated_for_s_) update();
    updated_for_s_ = cycle_s;
  }
}

}  // namespace sidestep
