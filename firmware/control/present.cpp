#include "firmware/control/present.h"

namespace sidestep {

ObstacleView view_obstacles(const Settings& settings, const Latest<ObstacleSet>& obstacles, double now_s) {
  if (!obstacles.message) return {};
  const double age_s = obstacles.age_s(now_s);
  const bool fresh = obstacles.fresh(now_s, settings.ages.obstacles_s);
  return {obstacles.message, age_s, fresh ? 0.0 : age_s * settings.obstacle_speed_bound_mps};
}

Target moved_on(const Target& target, double dt_s) {
  Target later = target;
  later.position_m += target.velocity_mps * dt_s;
  const Vector3 turn = target.angular_velocity_radps * dt_s;
  if (target.tracks_orientation && turn.squaredNorm() > 0.0)
    later.orientation = Quaternion(Eigen::AngleAxisd(turn.norm(), turn.normalized())) * target.orientation;
  return later;
}

Target present(const Latest<Target>& latest, double now_s) {
  return moved_on(*latest.message, latest.age_s(now_s));
}

}  // namespace sidestep
