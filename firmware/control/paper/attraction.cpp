#include "firmware/control/paper/attraction.h"

#include "firmware/model/kinematics.h"

namespace sidestep {

Vector3 attraction(const PaperGains& gains, const Target& target, const Vector3& tool_position_m,
                   const Vector3& tool_velocity_mps) {
  return gains.k_pos_per_s2 * (target.position_m - tool_position_m) +
         gains.k_vel_per_s * (target.velocity_mps - tool_velocity_mps);
}

Vector3 orientation_rate(const PaperGains& gains, const Target& target, const Matrix3& base_from_tool) {
  const Eigen::AngleAxisd to_goal = orientation_error(target.orientation, base_from_tool);
  return target.angular_velocity_radps + gains.k_ori_per_s * to_goal.angle() * to_goal.axis();
}

}  // namespace sidestep
