#include "firmware/io/lcm/link_encoder.h"

#include "firmware/model/link_obstacle.h"

namespace sidestep {

Packet LinkEncoder::encode(const ArmState& arm, const OtherFrames& others, int64_t utime) {
  const LinkPoses poses = forward_kinematics(arm_, arm.position_rad, others);
  encoder_.begin(utime);
  int id = 0;
  const auto add = [&](const BodyShape& shape) {
    Obstacle link = link_obstacle(poses, shape, arm.velocity_radps);
    if (shape.other_joint >= 0)
      link.velocity_mps += other_velocity_at(arm_, poses, shape.other_joint, link.capsule.centre());
    link.id = id++;
    encoder_.add(transformed(world_from_base_, link));
  };
  for (const LinkShape& shape : arm_.shapes)
    if (!shape.below_arm) add(shape);
  if (others.attachments)
    for (const BodyShape& shape : others.attachments->held) add(shape);
  return encoder_.finish();
}

}  // namespace sidestep
