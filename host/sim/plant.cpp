#include "host/sim/plant.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sidestep::sim {
namespace {

constexpr int64_t kNever = std::numeric_limits<int64_t>::max();
constexpr size_t kMaxPending = 256;  // beyond it a command replaces the newest pending one: bounds the memory

struct Joint {
  double q_rad;
  double qd_radps;
};

// Closed form of qd' = clamp((demand - qd) / lag, -limit, limit) over dt: full acceleration while the error is large,
// then an exponential.
Joint servo(Joint joint, double demand_radps, double lag_s, double limit_radps2, double dt_s) {
  const double error_radps = demand_radps - joint.qd_radps;
  const double saturated_s = std::clamp(std::abs(error_radps) / limit_radps2 - lag_s, 0.0, dt_s);
  const double acceleration_radps2 = std::copysign(limit_radps2, error_radps);
  joint.q_rad += (joint.qd_radps + acceleration_radps2 * saturated_s / 2.0) * saturated_s;
  joint.qd_radps += acceleration_radps2 * saturated_s;
  const double rest_s = dt_s - saturated_s;
  if (rest_s <= 0.0) return joint;
  const double rest_radps = demand_radps - joint.qd_radps;
  const double decay = lag_s > 0.0 ? std::exp(-rest_s / lag_s) : 0.0;
  joint.q_rad += demand_radps * rest_s - rest_radps * lag_s * (1.0 - decay);
  joint.qd_radps = demand_radps - rest_radps * decay;
  return joint;
}

}  // namespace

Plant::Plant(const PlantSpec& spec, const JointVector& start_rad)
    : spec_(spec),
      stop_us_(kNever),
      q_rad_(start_rad),
      qd_radps_(JointVector::Zero(start_rad.size())),
      demand_radps_(qd_radps_),
      last_command_radps_(qd_radps_) {
  if (spec_.kind == PlantSpec::Kind::kServo) latency_us_ = std::llround(spec_.latency_s * 1e6);
}

bool Plant::command(const Eigen::Ref<const Eigen::VectorXd>& qd_radps) {
  if (qd_radps.size() != q_rad_.size() || !qd_radps.allFinite() ||
      qd_radps.cwiseAbs().maxCoeff() > kImplausible_radps) {
    ++refused_;
    return false;
  }
  last_command_radps_ = qd_radps;
  if (pending_.size() == kMaxPending) pending_.pop_back();
  pending_.push_back({now_us_ + latency_us_, last_command_radps_});
  apply_due();
  return true;
}

void Plant::advance(int64_t dt_us) {
  const int64_t end_us = now_us_ + dt_us;
  while (now_us_ < end_us) {
    const int64_t due_us = pending_.empty() ? kNever : pending_.front().due_us;
    const int64_t next_us = std::min({end_us, due_us, stop_us_});
    integrate(static_cast<double>(next_us - now_us_) / 1e6);
    now_us_ = next_us;
    apply_due();
  }
}

void Plant::apply_due() {
  while (!pending_.empty() && pending_.front().due_us <= now_us_) {
    demand_radps_ = pending_.front().qd_radps;
    stop_us_ = pending_.front().due_us + kWatchdog_us;
    pending_.pop_front();
  }
  if (stop_us_ <= now_us_) {
    demand_radps_.setZero();
    stop_us_ = kNever;
  }
  if (spec_.kind == PlantSpec::Kind::kIdeal) qd_radps_ = demand_radps_;
}

void Plant::integrate(double dt_s) {
  if (spec_.kind == PlantSpec::Kind::kIdeal) {
    q_rad_ += qd_radps_ * dt_s;
    return;
  }
  for (Eigen::Index i = 0; i < q_rad_.size(); ++i) {
    const double limit_radps = spec_.velocity_limit_radps[i];
    const double demand_radps = std::clamp(demand_radps_[i], -limit_radps, limit_radps);
    const Joint joint =
        servo({q_rad_[i], qd_radps_[i]}, demand_radps, spec_.lag_s, spec_.acceleration_limit_radps2[i], dt_s);
    q_rad_[i] = joint.q_rad;
    qd_radps_[i] = joint.qd_radps;
  }
}

}  // namespace sidestep::sim
