#include "firmware/io/lcm/network_inputs.h"

#include "firmware/control/input_gate.h"
#include "firmware/control/validation.h"
#include "firmware/io/lcm/message_decoder.h"
#include "firmware/io/lcm/obstacle_merger.h"

namespace sidestep {

struct NetworkInputs::Parts {
  MessageDecoder decoder;
  InputGate gate;
  std::unique_ptr<ObstacleMerger> merger;  ///< null without neighbours
};

namespace {

/// With neighbours the merger estimates motion, before it moves the parts to one time.
Settings settings_of_gate(Settings settings, const Neighbours& neighbours) {
  settings.estimates_motion &= neighbours.listen.empty();
  return settings;
}

}  // namespace

NetworkInputs::NetworkInputs(const Settings& settings, const Arm& arm, const Dialect& dialect,
                             const Neighbours& neighbours, bool lockstep)
    : parts_(new Parts{
          {dialect, arm},
          {arm, settings_of_gate(settings, neighbours), lockstep ? InputSource::kLockstep : InputSource::kNetwork},
          nullptr}) {
  if (neighbours.listen.empty()) return;
  parts_->merger = std::make_unique<ObstacleMerger>(neighbours.listen.size(), neighbours.world_from_base.inverse(),
                                                    settings.timeouts.obstacles_s, settings.estimates_motion);
}

NetworkInputs::~NetworkInputs() = default;

bool NetworkInputs::reject(const char* reason) {
  ++rejected_;
  reason_ = reason;
  return false;
}

template <typename Message>
bool NetworkInputs::receive_value(Packet packet, double now_s, Received<Message>& received) {
  if (const char* wrong = parts_->decoder.decode(packet, received.message)) return reject(wrong);
  return accept(packet, now_s, received);
}

/// A decoded message into the gate.
template <typename Message>
bool NetworkInputs::accept(Packet packet, double now_s, Received<Message>& received) {
  const Verdict verdict = parts_->gate.accept(received.message, now_s);
  if (verdict.rejected) return reject(verdict.rejected);
  if (verdict.accepted) received.store(packet, now_s);
  return verdict.accepted;
}

bool NetworkInputs::receive(Packet packet, double now_s, Received<ArmState>& received) {
  return receive_value(packet, now_s, received);
}

bool NetworkInputs::receive(Packet packet, double now_s, Received<Target>& received) {
  return receive_value(packet, now_s, received);
}

bool NetworkInputs::receive_joint_target(Packet packet, double now_s, Received<Target>& received) {
  if (const char* wrong = parts_->decoder.decode_joint_target(packet, received.message)) return reject(wrong);
  return accept(packet, now_s, received);
}

bool NetworkInputs::receive(Packet packet, double now_s, Received<OtherJoints>& received) {
  return receive_value(packet, now_s, received);
}

bool NetworkInputs::receive(Packet packet, double now_s, Received<Control>& received) {
  return receive_value(packet, now_s, received);
}

bool NetworkInputs::receive(Packet packet, double now_s, Received<Attachments>& received) {
  return receive_value(packet, now_s, received);
}

bool NetworkInputs::receive_obstacles(size_t part, Packet packet, double now_s, Received<ObstacleSet>& received) {
  ObstacleMerger* merger = parts_->merger.get();
  ObstacleSet& set = merger ? merger->draft(part) : received.message;
  int64_t utime = 0;
  double age_s = 0.0;
  if (const char* wrong = parts_->decoder.decode(packet, set, utime)) return reject(wrong);
  if (merger) {
    if (!sanitize(set)) return reject("obstacles with impossible values");
    if (!merger->accept(part, utime, now_s)) return false;
    const auto merged = merger->merge(now_s, received.message);
    if (merger->too_many()) return reject("more obstacles than a set holds");
    if (!merged) return false;
    utime = merged->utime;
    age_s = merged->age_s;
  }
  const Verdict verdict = parts_->gate.accept(received.message, utime, now_s - age_s);
  if (verdict.rejected) return reject(verdict.rejected);
  if (verdict.accepted) received.store(merger ? Packet{} : packet, now_s - age_s);
  return verdict.accepted;
}

}  // namespace sidestep
