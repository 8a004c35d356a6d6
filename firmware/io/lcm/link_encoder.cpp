#include "firmware/io/lcm/link_encoder.h"

#include "firmware/model/link_obstacle.h"

namespace sidestep {

Packet LinkEncoder::encode(const ArmState& arm, int64_t utime) {
  const LinkPoses poses = forward_kinematics(config_.model.arm, arm.position_rad);
  encoder_.begin(utime);
  int id = 0;
  for (const LinkShape& shape : config_.model.arm.shapes) {
    if (shape.below_arm) continue;  // the neighbour may stand on it, too
    Obstacle link = transformed(config_.neighbours.world_from_base, link_obstacle(poses, shape, arm.velocity_radps));
    link.id = id++;
    encoder_.add(link);
  }
  return encoder_.finish();
}

}  // namespace sidestep
