#include "firmware/control/message_order.h"

#include <algorithm>
#include <cmath>

namespace sidestep {
namespace {

constexpr int kOldInARow = 3;       // a network reorders single messages; three in a row come from a restarted sender
constexpr double kLeadKept = 0.99;  // for each message: a clock that is fast by 1e-4 leads by a hundredth of the period

}  // namespace

double sent_apart_s(int64_t utime, int64_t later_utime, double received_apart_s, double slack_s) {
  const double apart_s = 1e-6 * (static_cast<double>(later_utime) - static_cast<double>(utime));
  return std::min(apart_s, received_apart_s + slack_s);
}

bool MessageOrder::has_restarted(int64_t utime, double now_s, double restart_s) {
  const bool silent = std::abs(now_s - accepted_s_) > restart_s;  // also when the local clock was set back
  if (silent) return utime != utime_;
  const bool is_old = static_cast<double>(utime_) - static_cast<double>(utime) > restart_s * 1e6;
  if (!is_old) return false;
  old_in_a_row_ = old_in_a_row_ > 0 && utime > old_utime_ ? old_in_a_row_ + 1 : 1;
  old_utime_ = utime;
  return old_in_a_row_ == kOldInARow;
}

/// The lead is the sum of the differences between the sender's clock and the receipts, which decays, so that only
/// jitter remains of it. Bounded by slack_s: a clock in another unit, or one that stands still, is soon ignored.
void MessageOrder::follow_clock(int64_t utime, double by_receipt_s, double slack_s) {
  const double by_clock_s = 1e-6 * (static_cast<double>(utime) - static_cast<double>(utime_));
  if (by_clock_s <= 0.0) {  // the sender has restarted
    lead_s_ = 0.0;
    sending_interval_s_ = by_receipt_s;
    return;
  }
  const double lead_s = std::clamp(kLeadKept * lead_s_ + by_clock_s - by_receipt_s, -slack_s, slack_s);
  sending_interval_s_ = std::max(0.0, by_receipt_s + (lead_s - lead_s_));
  lead_s_ = lead_s;
}

bool MessageOrder::accept(int64_t utime, double now_s, double restart_s) {
  if (any_ && utime <= utime_ && !has_restarted(utime, now_s, restart_s)) return false;
  const double by_receipt_s = std::abs(now_s - accepted_s_);
  elapsed_s_ = any_ ? std::max(by_receipt_s, sent_apart_s(utime_, utime, by_receipt_s, restart_s)) : 0.0;
  if (any_) follow_clock(utime, by_receipt_s, restart_s);
  any_ = true;
  old_in_a_row_ = 0;
  utime_ = utime;
  accepted_s_ = now_s;
  return true;
}

}  // namespace sidestep
