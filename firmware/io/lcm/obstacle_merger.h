#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "firmware/io/config/config.h"
#include "firmware/io/lcm/encoder.h"

namespace sidestep {

/// Joins the obstacles on our own channel and the links of the neighbours into one message in our base frame. Where
/// nobody else is listened to, messages pass as they are.
///
/// The whole is as old as its oldest part: what was heard later is moved back to then. So a neighbour that falls silent
/// is unknown, exactly as obstacles are that are no longer reported.
class ObstacleMerger {
 public:
  explicit ObstacleMerger(const Config& config);
  ~ObstacleMerger();

  struct Whole {
    Packet packet;  ///< an obstacles_t, valid until the next call
    double age_s;   ///< of its oldest part
  };
  /// Takes a message from outside: of our own channel (part 0) or of the k-th neighbour (part k). Nothing comes of one
  /// that is bad, of more obstacles than a message holds, or while a part is missing or too old.
  std::optional<Whole> join(size_t part, const void* bytes, size_t size, double now_s);

  int64_t rejected() const;
  const char* last_reason() const { return reason_; }  ///< static text; "" when nothing was rejected

 private:
  struct Part;
  double oldest_s() const;
  void add(const Part& part, int number, double at_s);

  double limit_s_;
  int64_t utime_ = 0;
  int64_t too_many_ = 0;
  const char* reason_ = "";
  std::vector<std::unique_ptr<Part>> parts_;  ///< none where nobody is listened to
  std::unique_ptr<class ObstacleEncoder> whole_;
};

}  // namespace sidestep
