#include "host/campaign/furniture/pieces.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "host/campaign/furniture/assembly.h"

namespace sidestep::campaign {
namespace {

using Eigen::Vector3d;

constexpr double kBoard_m = 0.02;  // thickness
constexpr double kBar_m = 0.025;
constexpr double kLeg_m = 0.05;

/// A cuboid in the frame of the furniture.
struct Room {
  Vector3d low_m, high_m;

  /// The room around the origin with these edges; the origin is at least margin_m inside each face.
  static Room around_goal(Random& random, const Vector3d& edges_m, double margin_m) {
    Room room;
    for (int axis = 0; axis < 3; ++axis) {
      room.low_m[axis] = -random.uniform(margin_m, edges_m[axis] - margin_m);
      room.high_m[axis] = room.low_m[axis] + edges_m[axis];
    }
    return room;
  }

  /// The part of the room around the goal, 0.6 m wide.
  Room near_goal() const {
    Room near = *this;
    near.low_m.head<2>() = low_m.head<2>().cwiseMax(Eigen::Vector2d(-0.3, -0.3));
    near.high_m.head<2>() = high_m.head<2>().cwiseMin(Eigen::Vector2d(0.3, 0.3));
    return near;
  }
};

/// Puts things on the floor of a room, apart from one another.
class Floor {
 public:
  Floor(Assembly& assembly, const Room& room) : assembly_(assembly), room_(room) {}

  void add_cans(Random& random, int least, int most) {
    const int cans = random.integer(least, most);
    for (int can = 0; can < cans; ++can) {
      const double radius_m = random.uniform(0.025, 0.045);
      const double height_m = std::min(random.uniform(0.08, 0.20), room_.high_m.z() - room_.low_m.z() - 0.01);
      const auto foot_m = draw_place(random, radius_m);
      if (foot_m) assembly_.add_can(*foot_m, radius_m, height_m);
    }
  }

  void add_boxes(Random& random, int least, int most) {
    const int boxes = random.integer(least, most);
    for (int box = 0; box < boxes; ++box) {
      const Vector3d edges_m = random.in_box({0.05, 0.05, 0.05}, {0.15, 0.15, 0.25});
      const auto foot_m = draw_place(random, 0.5 * edges_m.head<2>().norm());
      const Vector3d half_m(0.5 * edges_m.x(), 0.5 * edges_m.y(), 0.0);
      if (foot_m) assembly_.add_box(*foot_m - half_m, *foot_m + half_m + Vector3d(0, 0, edges_m.z()));
    }
  }

 private:
  /// The middle of a free circle on the floor; none if a few draws find none.
  std::optional<Vector3d> draw_place(Random& random, double radius_m) {
    const Vector3d inset_m(radius_m + 0.005, radius_m + 0.005, 0.0);
    for (int draw = 0; draw < 10; ++draw) {
      Vector3d place_m = random.in_box(room_.low_m + inset_m, room_.high_m - inset_m);
      place_m.z() = room_.low_m.z();
      const bool is_free = std::all_of(taken_.begin(), taken_.end(), [&](const Circle& other) {
        return (other.middle_m - place_m).norm() > other.radius_m + radius_m;
      });
      if (!is_free) continue;
      taken_.push_back({place_m, radius_m});
      return place_m;
    }
    return std::nullopt;
  }

  struct Circle {
    Vector3d middle_m;
    double radius_m;
  };

  Assembly& assembly_;
  Room room_;
  std::vector<Circle> taken_;
};

void add_shelf(Random& random, Assembly& assembly) {
  const double width_m = random.uniform(0.5, 1.0), depth_m = random.uniform(0.25, 0.45);
  const int compartments = random.integer(2, 3), of_goal = random.integer(0, compartments - 1);
  std::vector<double> heights_m(static_cast<size_t>(compartments));
  for (double& height_m : heights_m) height_m = random.uniform(0.24, 0.42);
  Room room;
  room.low_m.x() = -random.uniform(0.10, depth_m - 0.05);
  room.low_m.y() = -random.uniform(0.12, width_m - 0.12);
  room.low_m.z() = -random.uniform(0.08, heights_m[static_cast<size_t>(of_goal)] - 0.08);
  for (int i = 0; i < of_goal; ++i) room.low_m.z() -= heights_m[static_cast<size_t>(i)] + kBoard_m;
  const double x0 = room.low_m.x(), x1 = x0 + depth_m, y0 = room.low_m.y(), y1 = y0 + width_m;
  const double bottom_m = room.low_m.z() - kBoard_m;
  for (int i = 0; i < compartments; ++i) {
    const double height_m = heights_m[static_cast<size_t>(i)];
    assembly.add_box({x0, y0, room.low_m.z() - kBoard_m}, {x1, y1, room.low_m.z()});
    room.high_m = {x1, y1, room.low_m.z() + height_m};
    Floor(assembly, i == of_goal ? room.near_goal() : room).add_cans(random, i == of_goal ? 1 : 0, 3);
    room.low_m.z() = room.high_m.z() + kBoard_m;
  }
  const double top_m = room.low_m.z();
  assembly.add_box({x0, y0, top_m - kBoard_m}, {x1, y1, top_m});
  assembly.add_box({x0, y0 - kBoard_m, bottom_m}, {x1, y0, top_m});
  assembly.add_box({x0, y1, bottom_m}, {x1, y1 + kBoard_m, top_m});
  assembly.add_box({x1, y0 - kBoard_m, bottom_m}, {x1 + kBoard_m, y1 + kBoard_m, top_m});
}

void add_open_box(Random& random, Assembly& assembly) {
  const Vector3d edges_m = random.in_box({0.24, 0.24, 0.20}, {0.45, 0.45, 0.45});
  Room room = Room::around_goal(random, edges_m, 0.10);
  room.low_m.z() = -random.uniform(0.03, 0.5 * edges_m.z());
  room.high_m.z() = room.low_m.z() + edges_m.z();
  const Vector3d &low = room.low_m, &high = room.high_m;
  const double x0 = low.x() - kBoard_m, x1 = high.x() + kBoard_m, y0 = low.y() - kBoard_m, y1 = high.y() + kBoard_m;
  assembly.add_box({x0, y0, low.z() - kBoard_m}, {x1, y1, low.z()});
  assembly.add_box({x0, y0, low.z()}, {low.x(), y1, high.z()});
  assembly.add_box({high.x(), y0, low.z()}, {x1, y1, high.z()});
  assembly.add_box({low.x(), y0, low.z()}, {high.x(), low.y(), high.z()});
  assembly.add_box({low.x(), high.y(), low.z()}, {high.x(), y1, high.z()});
  Floor(assembly, room).add_cans(random, 0, 3);
}

/// A bar along one axis through a point.
void add_bar(Assembly& assembly, const Vector3d& from_m, int axis, double length_m) {
  const Vector3d half_m = 0.5 * Vector3d::Constant(kBar_m);
  Vector3d to_m = from_m;
  to_m[axis] += length_m;
  assembly.add_box(from_m - half_m, to_m + half_m);
}

void add_cage(Random& random, Assembly& assembly) {
  const Vector3d edges_m = random.in_box({0.32, 0.32, 0.32}, {0.55, 0.55, 0.55});
  const Room room = Room::around_goal(random, edges_m, 0.08);
  for (int axis = 0; axis < 3; ++axis) {
    const int second = (axis + 1) % 3, third = (axis + 2) % 3;
    for (const double b : {room.low_m[second], room.high_m[second]}) {
      for (const double c : {room.low_m[third], room.high_m[third]}) {
        Vector3d from_m = room.low_m;
        from_m[second] = b, from_m[third] = c;
        add_bar(assembly, from_m, axis, edges_m[axis]);
      }
    }
  }
  for (const bool along_x : {true, false}) {  // one upright bar across each side
    const int across = along_x ? 0 : 1, along = along_x ? 1 : 0;
    for (const double side : {room.low_m[across], room.high_m[across]}) {
      Vector3d from_m = room.low_m;
      from_m[across] = side;
      from_m[along] += random.uniform(0.4, 0.6) * edges_m[along];
      add_bar(assembly, from_m, 2, edges_m.z());
    }
  }
  const Vector3d above_m(room.low_m.x() + random.uniform(0.4, 0.6) * edges_m.x(), room.low_m.y(), room.high_m.z());
  add_bar(assembly, above_m, 1, edges_m.y());
  assembly.add_box(room.low_m - Vector3d(0, 0, kBar_m), {room.high_m.x(), room.high_m.y(), room.low_m.z()});
  Floor(assembly, room).add_cans(random, 0, 3);
}

/// A table top on four legs. Returns the room on it.
Room add_table_top(Random& random, Assembly& assembly, double top_m, double front_m) {
  const double depth_m = random.uniform(0.5, 0.9), width_m = random.uniform(0.8, 1.4), leg_m = random.uniform(0.4, 0.7);
  const double x0 = -front_m, x1 = x0 + depth_m;
  const double y0 = -random.uniform(0.3, 0.7) * width_m, y1 = y0 + width_m;
  const double under_m = top_m - 0.03;
  assembly.add_box({x0, y0, under_m}, {x1, y1, top_m});
  for (const double x : {x0, x1 - kLeg_m})
    for (const double y : {y0, y1 - kLeg_m})
      assembly.add_box({x, y, under_m - leg_m}, {x + kLeg_m, y + kLeg_m, under_m});
  return {{x0, y0, top_m}, {x1, y1, top_m + 0.3}};
}

void add_table(Random& random, Assembly& assembly) {
  const double front_m = random.uniform(0.1, 0.4), above_m = random.uniform(0.05, 0.18);
  const Room room = add_table_top(random, assembly, -above_m, front_m);
  Floor floor(assembly, room.near_goal());
  floor.add_cans(random, 3, 7);
  floor.add_boxes(random, 0, 3);
}

void add_under_table(Random& random, Assembly& assembly) {
  const double front_m = random.uniform(0.10, 0.40);
  const Room top = add_table_top(random, assembly, random.uniform(0.12, 0.28), front_m);
  Room below = top;
  below.low_m.z() = -random.uniform(0.08, 0.20);
  below.high_m.z() = top.low_m.z() - 0.03;
  assembly.add_box({top.low_m.x(), top.low_m.y(), below.low_m.z() - kBoard_m},
                   {top.high_m.x(), top.high_m.y(), below.low_m.z()});
  Floor(assembly, below.near_goal()).add_cans(random, 1, 5);
}

}  // namespace

GoalRegion goal_region(Furniture kind) {
  GoalRegion region{};
  region.nearest_m = 0.35, region.farthest_m = 0.80;
  switch (kind) {
    case Furniture::kShelf:
      region.lowest_m = 0.15, region.highest_m = 0.90, region.most_upward = 1.0, region.least_outward = 0.8;
      break;
    case Furniture::kBox:
      region.lowest_m = 0.05, region.highest_m = 0.50, region.most_upward = -0.8, region.least_outward = -1.0;
      break;
    case Furniture::kCage:
      region.lowest_m = 0.15, region.highest_m = 0.70, region.most_upward = 0.5, region.least_outward = -0.3;
      break;
    case Furniture::kTable:
      region.lowest_m = 0.10, region.highest_m = 0.60, region.most_upward = -0.2, region.least_outward = -1.0;
      break;
    case Furniture::kUnderTable:
    case Furniture::kNone:
      region.lowest_m = 0.10, region.highest_m = 0.45, region.most_upward = 1.0, region.least_outward = 0.8;
  }
  return region;
}

std::vector<sim::Obstacle> draw_furniture(Random& random, Furniture kind, const Vector3d& goal_m) {
  const double yaw_rad = std::atan2(goal_m.y(), goal_m.x()) + random.uniform(-0.4, 0.4);
  Assembly assembly(goal_m, yaw_rad);
  if (kind == Furniture::kShelf) add_shelf(random, assembly);
  if (kind == Furniture::kBox) add_open_box(random, assembly);
  if (kind == Furniture::kCage) add_cage(random, assembly);
  if (kind == Furniture::kTable) add_table(random, assembly);
  if (kind == Furniture::kUnderTable) add_under_table(random, assembly);
  return assembly.solids();
}

}  // namespace sidestep::campaign
