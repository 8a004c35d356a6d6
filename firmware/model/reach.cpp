#include "firmware/model/reach.h"

#include <algorithm>
#include <cmath>

namespace sidestep {

bool is_beyond_reach(const Arm& arm, const Vector3& point_m) {
  double length_m = arm.last_body_from_tool.translation().norm();
  for (int i = 1; i <= arm.joints; ++i) {
    if (i > 1) length_m += arm.joint_placement[i].translation().norm();
    if (arm.prismatic[i - 1])
      length_m += std::max(std::abs(arm.limits.lower_rad[i - 1]), std::abs(arm.limits.upper_rad[i - 1]));
  }
  return (point_m - arm.joint_placement[1].translation()).norm() > length_m;
}

}  // namespace sidestep
