#include "firmware/control/types/guide.h"

#include <algorithm>

namespace sidestep {

void Guide::add(double at_s, const JointVector& q_rad, const JointVector& qd_radps) {
  time_s[knots] = at_s;
  position_rad[knots] = q_rad;
  velocity_radps[knots++] = qd_radps;
}

GuidePoint point_of(const Guide& guide, double now_s) {
  int next = 0;
  while (next < guide.knots && guide.time_s[next] <= now_s) ++next;
  const int last = std::max(0, next - 1);
  const JointVector& from_rad = guide.position_rad[last];
  if (next == 0 || next == guide.knots) return {from_rad, JointVector::Zero(from_rad.size())};

  const double duration_s = guide.time_s[next] - guide.time_s[last];
  const double u = (now_s - guide.time_s[last]) / duration_s;
  const JointVector displacement_rad = guide.position_rad[next] - from_rad;
  const JointVector &from_radps = guide.velocity_radps[last], &to_radps = guide.velocity_radps[next];
  GuidePoint point{from_rad + displacement_rad * (u * u * (3.0 - 2.0 * u)),
                   displacement_rad * (6.0 * u * (1.0 - u) / duration_s)};
  point.position_rad += (duration_s * u * (1.0 - u)) * ((1.0 - u) * from_radps - u * to_radps);
  point.velocity_radps += (1.0 - u) * (1.0 - 3.0 * u) * from_radps + u * (3.0 * u - 2.0) * to_radps;
  return point;
}

}  // namespace sidestep
