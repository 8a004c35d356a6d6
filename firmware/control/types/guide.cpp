#include "firmware/control/types/guide.h"

#include <algorithm>

namespace sidestep {

GuidePoint point_of(const Guide& guide, double now_s) {
  int next = 0;
  while (next < guide.knots && guide.time_s[next] <= now_s) ++next;
  const JointVector& last = guide.position_rad[std::max(0, next - 1)];
  if (next == 0 || next == guide.knots) return {last, JointVector::Zero(last.size())};

  const double duration_s = guide.time_s[next] - guide.time_s[next - 1];
  const double u = (now_s - guide.time_s[next - 1]) / duration_s;
  const JointVector displacement_rad = guide.position_rad[next] - last;
  return {last + displacement_rad * (u * u * (3.0 - 2.0 * u)), displacement_rad * (6.0 * u * (1.0 - u) / duration_s)};
}

}  // namespace sidestep
