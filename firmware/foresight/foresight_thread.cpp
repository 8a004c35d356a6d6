#include "firmware/foresight/foresight_thread.h"

#include "firmware/base/realtime.h"

namespace sidestep {
namespace {

constexpr double kThinkEvery_s = 0.01;

}  // namespace

ForesightThread::ForesightThread(const Model& model, bool lockstep) : model_(model), on_(foresees(model.settings)) {
  if (!on_) return;
  foresight_ = std::make_unique<Foresight>(model);
  if (!lockstep) thinking_ = std::thread([this] { attend(); });
}

ForesightThread::~ForesightThread() {
  end_ = true;
  if (thinking_.joinable()) thinking_.join();
}

const Guide* ForesightThread::latest() {
  return on_ ? &guides_.latest() : nullptr;
}

void ForesightThread::tell(const Inputs& inputs, const State& state, double now_s) {
  if (!on_) return;
  take_snapshot(model_, inputs, state, now_s, snapshots_.draft());
  snapshots_.post();
  if (!thinking_.joinable()) think();
}

void ForesightThread::think() {
  const Snapshot& snapshot = snapshots_.latest();
  guides_.draft() = foresight_->update(snapshot);
  guides_.post();
}

void ForesightThread::attend() {
  while (!end_) {
    sleep_until(monotonic_s() + kThinkEvery_s);
    const double now_s = snapshots_.latest().now_s;
    if (now_s != thought_of_s_) think();
    thought_of_s_ = now_s;
  }
}

}  // namespace sidestep
