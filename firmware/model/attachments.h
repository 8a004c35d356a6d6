#pragma once

#include <algorithm>

#include "firmware/base/bounded_list.h"
#include "firmware/model/arm.h"
#include "firmware/model/obstacle.h"

namespace sidestep {

constexpr int kMaxAllowed = 64;  ///< obstacles in Attachments::allowed

/// What the tool holds and what it may touch, as the newest message told. It counts until the next one.
struct Attachments {
  int64_t utime = 0;
  BoundedList<Obstacle, kMaxHeldShapes> shapes;  ///< tool frame; velocities do not count
  BoundedList<int32_t, kMaxAllowed> allowed;     ///< ids of obstacles that the tool and what it holds may touch
  BoundedList<BodyShape, kMaxHeldShapes> held;   ///< the shapes on the last body of the arm

  /// Whether a held shape has this id. A sensor may go on seeing it as an obstacle.
  bool holds(int32_t id) const {
    return std::any_of(shapes.begin(), shapes.end(), [id](const Obstacle& shape) { return shape.id == id; });
  }
  bool is_empty() const { return shapes.size() == 0 && allowed.size() == 0; }
  bool allows(int32_t id) const { return std::find(allowed.begin(), allowed.end(), id) != allowed.end(); }
};

/// Fills Attachments::held from Attachments::shapes.
void place_held_shapes(const Arm& arm, Attachments& attachments);

/// Whether both attach and allow the same; their utime does not count.
bool are_same(const Attachments& a, const Attachments& b);

/// What the tool holds keeps this distance from the links of all bodies but the last two.
constexpr double kHeldClearance_m = 0.01;

/// Calls use(pair) for each held shape and each link shape that it must keep clear of, numbered as by shape_at().
template <typename Use>
void for_each_held_pair(const Arm& arm, const Attachments& attachments, const Use& use) {
  const int links = static_cast<int>(arm.shapes.size());
  for (int held = 0; held < attachments.held.size(); ++held)
    for (int link = 0; link < links; ++link)
      if (arm.shapes[static_cast<size_t>(link)].body < arm.joints - 1)
        use(SelfPair{link, links + held, kHeldClearance_m});
}

}  // namespace sidestep
