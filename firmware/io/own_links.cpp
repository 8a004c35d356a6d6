#include "firmware/io/own_links.h"

#include "firmware/model/link_obstacle.h"

namespace sidestep {

Packet OwnLinks::encode(const ArmState& arm, int64_t utime) {
  const Posture posture = forward(config_.model.arm, arm.position_rad);
  encoder_.begin(utime);
  int id = 0;
  for (const LinkShape& shape : config_.model.arm.shapes) {
    if (shape.below_arm) continue;  // the neighbour may stand on it, too
    Obstacle link = transformed(config_.neighbours.world_from_base, link_obstacle(posture, shape, arm.velocity_radps));
    link.id = id++;
    encoder_.add(link);
  }
  return encoder_.finish();
}

}  // namespace sidestep
