#include "firmware/foresight/foresight_thread.h"

#include "firmware/base/realtime.h"

namespace sidestep {
namespace {

constexpr double kUpdateEvery_s = 0.01;

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
  while (!end_) {
    sleep_until(monotonic_s() + kUpdateEvery_s);
    const double now_s = snapshots_.latest().now_s;
    if (now_s != updated_for_s_) update();
    updated_for_s_ = now_s;
  }
}

}  // namespace sidestep
