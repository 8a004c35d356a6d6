#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "firmware/control/input_gate.h"
#include "firmware/control/validation.h"
#include "firmware/foresight/foresight_thread.h"
#include "firmware/io/config/config.h"
#include "firmware/library/sidestep.h"

namespace sidestep {
namespace {

// The constants of the public header are those of the firmware.
static_assert(Controller::kMostJoints == kMaxJoints && Controller::kMostObstacles == kMaxObstacles);
static_assert(Controller::kMostHeldShapes == kMaxHeldShapes && Controller::kMostAllowed == kMaxAllowed);
static_assert(static_cast<int>(Controller::Shape::kSphere) == static_cast<int>(Shape::kSphere));
static_assert(static_cast<int>(Controller::Shape::kCapsule) == static_cast<int>(Shape::kCapsule));
static_assert(static_cast<int>(Controller::Shape::kBox) == static_cast<int>(Shape::kBox));
static_assert(static_cast<int>(Controller::Shape::kCylinder) == static_cast<int>(Shape::kCylinder));
static_assert(static_cast<int>(Controller::Mode::kWait) == static_cast<int>(Mode::kWait));
static_assert(static_cast<int>(Controller::Mode::kHold) == static_cast<int>(Mode::kHold));
static_assert(static_cast<int>(Controller::Mode::kTrack) == static_cast<int>(Mode::kTrack));
static_assert(static_cast<int>(Controller::Mode::kBrake) == static_cast<int>(Mode::kBrake));
static_assert(static_cast<int>(Controller::Mode::kFault) == static_cast<int>(Mode::kFault));
static_assert(int{Controller::kFaultNone} == static_cast<int>(Fault::kNone));
static_assert(int{Controller::kFaultArmStateLost} == static_cast<int>(Fault::kArmStateLost));
static_assert(int{Controller::kFaultArmStateInconsistent} == static_cast<int>(Fault::kArmStateInconsistent));
static_assert(int{Controller::kFaultNotFinite} == static_cast<int>(Fault::kNotFinite));
static_assert(int{Controller::kLimitingVelocity} == int{kLimitingVelocity});
static_assert(int{Controller::kLimitingAcceleration} == int{kLimitingAcceleration});
static_assert(int{Controller::kLimitingPosition} == int{kLimitingPosition});
static_assert(int{Controller::kLimitingTaskSpeed} == int{kLimitingTaskSpeed});
static_assert(int{Controller::kLimitingShield} == int{kLimitingShield});
static_assert(int{Controller::kLimitingShieldFailed} == int{kLimitingShieldFailed});
static_assert(int{Controller::kLimitingSelf} == int{kLimitingSelf});

Vector3 vector(const Controller::Vector& xyz) {
  return Vector3(xyz[0], xyz[1], xyz[2]);
}
Quaternion quaternion(const Controller::Quaternion& wxyz) {
  return Quaternion(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
}
JointVector vector(const Controller::Joints& values, int joints) {
  return Eigen::Map<const JointVector>(values.data(), joints);
}

Controller::Vector array(const Vector3& xyz) {
  return {xyz.x(), xyz.y(), xyz.z()};
}
Controller::Joints array(const JointVector& values) {
  Controller::Joints joints{};
  std::copy(values.begin(), values.end(), joints.begin());
  return joints;
}

Obstacle obstacle_of(const Controller::Obstacle& from) {
  Obstacle to = reported_obstacle(static_cast<sidestep::Shape>(from.shape), vector(from.position_m),
                                  quaternion(from.orientation), vector(from.size_m));
  to.id = from.id;
  to.velocity_mps = vector(from.velocity_mps);
  to.angular_velocity_radps = vector(from.angular_velocity_radps);
  to.kind = from.is_person ? Kind::kPerson : Kind::kThing;
  return to;
}

Target target_of(const Controller::Target& from) {
  return {0,
          vector(from.position_m),
          vector(from.velocity_mps),
          from.tracks_orientation,
          quaternion(from.orientation),
          vector(from.angular_velocity_radps),
          {}};
}

Controller::Result result_of(const sidestep::Result& from) {
  const Report& report = from.report;
  return {from.commanding,
          array(from.command.position_rad),
          array(from.command.velocity_radps),
          static_cast<Controller::Mode>(report.mode),
          static_cast<int>(report.fault),
          report.limiting,
          report.speed_scale,
          report.message,
          report.target_distance_m,
          report.clearance_m,
          report.nearest_obstacle,
          report.guide != nullptr,
          array(report.tool_position_m),
          array(report.tool_velocity_mps)};
}

Model model_of(const std::string& config_file, const Overrides& overrides, Controller::Foresight foresight) {
  const Config config = load_config(config_file, overrides);
  if (!config.neighbours.listen.empty())
    throw std::runtime_error(config_file +
                             ": neighbours.listen: this process has no channels; pass the neighbours' "
                             "links as obstacles");
  Model model = config.model;
  if (foresight == Controller::Foresight::kOff) model.settings.foresight.enabled = false;
  return model;
}

}  // namespace

struct Controller::Inside {
  Inside(Model the_model, Controller::Foresight foresight)
      : model(std::move(the_model)),
        foresight_thread(model, foresight == Foresight::kWithinStep),
        gate(model.arm, model.settings, InputSource::kCalls) {}

  /// The newest accepted value of a kind, and a draft for the next one.
  template <typename Message>
  struct Newest {
    std::unique_ptr<Message> message = std::make_unique<Message>(), draft = std::make_unique<Message>();
    double received_s = 0.0;
    int64_t count = 0;

    void take_draft(double now_s) {
      std::swap(message, draft);
      received_s = now_s;
      ++count;
    }
    Latest<Message> latest() const { return {count > 0 ? message.get() : nullptr, received_s, count}; }
  };

  Model model;
  ForesightThread foresight_thread;
  InputGate gate;
  State state;
  Newest<sidestep::ArmState> arm;
  Newest<sidestep::Target> target;
  Newest<ObstacleSet> obstacles;
  Newest<sidestep::Control> control;
  Newest<Attachments> attachments;
  bool stopping = false;
};

Controller::Controller(const std::string& config_file, Foresight foresight)
    : inside_(std::make_unique<Inside>(model_of(config_file, {}, foresight), foresight)) {}

Controller::Controller(const std::string& urdf, const std::string& base, const std::string& tip, Foresight foresight)
    : inside_(std::make_unique<Inside>(model_of("", {"", urdf, base, tip}, foresight), foresight)) {}

Controller::~Controller() = default;

int Controller::joints() const {
  return inside_->model.arm.joints;
}

double Controller::period_s() const {
  return inside_->model.settings.period_s();
}

bool Controller::set_target(const Target& target, double now_s) {
  auto& newest = inside_->target;
  *newest.draft = target_of(target);
  if (!inside_->gate.accept(*newest.draft, now_s)) return false;
  newest.take_draft(now_s);
  return true;
}

bool Controller::set_joint_target(const Joints& position_rad, double now_s) {
  auto& newest = inside_->target;
  *newest.draft = sidestep::Target{};
  newest.draft->posture_rad = vector(position_rad, joints());
  if (!inside_->gate.accept(*newest.draft, now_s)) return false;
  newest.take_draft(now_s);
  return true;
}

bool Controller::set_obstacles(const Obstacle* obstacles, int count, double now_s) {
  if (count < 0 || count > kMostObstacles) return false;
  auto& newest = inside_->obstacles;
  ObstacleSet& set = *newest.draft;
  set.count = count;
  set.remembered = 0;
  for (int i = 0; i < count; ++i) set.obstacles[static_cast<size_t>(i)] = obstacle_of(obstacles[i]);
  if (!inside_->gate.accept(set, std::llround(now_s * 1e6), now_s)) return false;
  newest.take_draft(now_s);
  return true;
}

bool Controller::set_attachments(const Obstacle* shapes, int count, const int* allowed, int allowed_count,
                                 double now_s) {
  if (count < 0 || count > kMostHeldShapes || allowed_count < 0 || allowed_count > kMostAllowed) return false;
  auto& newest = inside_->attachments;
  Attachments& attachments = *newest.draft;
  attachments.shapes.clear();
  attachments.allowed.clear();
  for (int i = 0; i < count; ++i) attachments.shapes.add(obstacle_of(shapes[i]));
  for (int i = 0; i < allowed_count; ++i) attachments.allowed.add(allowed[i]);
  if (!inside_->gate.accept(attachments, now_s)) return false;
  newest.take_draft(now_s);
  return true;
}

bool Controller::set_control(const Control& control, double now_s) {
  auto& newest = inside_->control;
  *newest.draft = {0, control.paused ? ControlCommand::kPause : ControlCommand::kResume, control.speed_scale};
  if (!inside_->gate.accept(*newest.draft, now_s)) return false;
  newest.take_draft(now_s);
  return true;
}

Controller::Result Controller::step(const ArmState& arm, double now_s) {
  sidestep::ArmState& state = *inside_->arm.draft;
  state.utime = std::llround(now_s * 1e6);
  state.position_rad = vector(arm.position_rad, joints());
  state.velocity_radps = vector(arm.velocity_radps, joints());
  if (inside_->gate.accept(state, now_s)) inside_->arm.take_draft(now_s);
  return step(now_s);
}

Controller::Result Controller::step(double now_s) {
  Inside& in = *inside_;
  Inputs inputs{in.arm.latest(), in.target.latest(), in.obstacles.latest(), 0, in.stopping};
  inputs.control = in.control.latest();
  inputs.attachments = in.attachments.latest();
  inputs.guide = in.foresight_thread.latest();
  const sidestep::Result result = sidestep::step(in.model, in.state, inputs, now_s);
  in.state = result.next;
  in.foresight_thread.submit(inputs, in.state, now_s);
  return result_of(result);
}

void Controller::stop() {
  inside_->stopping = true;
}

}  // namespace sidestep
