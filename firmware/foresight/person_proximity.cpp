#include "firmware/foresight/person_proximity.h"

#include <algorithm>
#include <cmath>

#include "firmware/base/bounded_list.h"
#include "firmware/model/nearest_points.h"

namespace sidestep {
namespace {

constexpr double kDecay_m = 0.2;
constexpr int kPointsPerLine = 4;

using Persons = BoundedList<Capsule, kMaxNearbyObstacles>;

Persons persons_among(const Obstacle* obstacles, int count) {
  Persons persons;
  for (int i = 0; i < count; ++i)
    if (obstacles[i].kind == Kind::kPerson) persons.add(obstacles[i].capsule);
  return persons;
}

double proximity_of(const Vector3& point, const Persons& persons) {
  double least_m = HUGE_VAL;
  for (const Capsule& person : persons)
    least_m = std::min(least_m, (nearest_on_segment(person.start, person.end, point) - point).norm() - person.radius_m);
  return std::exp(-std::max(0.0, least_m) / kDecay_m);
}

}  // namespace

double person_proximity(const LinkPoses& poses, const Obstacle* obstacles, int count) {
  const Persons persons = persons_among(obstacles, count);
  if (persons.size() == 0) return 0.0;
  double sum_m = 0.0, length_m = 0.0;
  for (int body = 1; body <= poses.joints; ++body) {
    const auto index = static_cast<size_t>(body);
    const Vector3& start = poses.origin[index];
    const Vector3& end = body < poses.joints ? poses.origin[index + 1] : poses.tool_position;
    const Vector3 part = (end - start) / kPointsPerLine;
    for (int i = 1; i <= kPointsPerLine; ++i) sum_m += part.norm() * proximity_of(start + i * part, persons);
    length_m += (end - start).norm();
  }
  return length_m > 0.0 ? sum_m / length_m : 0.0;
}

}  // namespace sidestep
