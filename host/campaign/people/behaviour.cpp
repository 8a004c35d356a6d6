#include "host/campaign/people/behaviour.h"

#include <algorithm>
#include <cmath>

#include "host/campaign/people/point_moves.h"
#include "host/campaign/segment.h"

namespace sidestep::campaign {
namespace {

/// Angles of shoulder and elbow oscillate once a stride; the elbow bends as the arm swings forward.
Vector3 swinging_hand_m(const Anatomy& anatomy, size_t side, double swing_rad, double swing) {
  const double shoulder_rad = 0.04 + swing_rad * swing, elbow_rad = 0.35 + 1.1 * swing_rad * swing;
  const double upper_m = anatomy.upper_arm_m(), lower_m = anatomy.reach_m() - upper_m;
  const double out_m = sign_of(side) * 0.08 * anatomy.reach_m();
  return {upper_m * std::sin(shoulder_rad) + lower_m * std::sin(shoulder_rad + elbow_rad), out_m,
          -upper_m * std::cos(shoulder_rad) - lower_m * std::cos(shoulder_rad + elbow_rad)};
}

}  // namespace

Anatomy draw_anatomy(Random& random) {
  const double stature_m = std::clamp(1.72 + 0.09 * random.normal(), 1.52, 1.95);
  return {stature_m, random.uniform(0.045, 0.050)};
}

Behaviour walking(Random& random, const Anatomy& anatomy, const Vector3& floor_m, double heading_rad, double speed_mps,
                  double end_s) {
  // A stride of about 0.8 statures at a usual speed; both stride and cadence grow with the square root of the speed.
  const double stride_m = 0.80 * anatomy.stature_m * std::sqrt(speed_mps / 1.3);
  const double turn_radps = 2.0 * M_PI * speed_mps / stride_m;
  const double phase_rad = random.uniform(-M_PI, M_PI), swing_rad = random.uniform(0.20, 0.36);
  const double rise_m = random.uniform(0.045, 0.065), sway_m = random.uniform(0.015, 0.030);
  const double hip_rad = std::asin(0.25 * stride_m / (anatomy.thigh_m() + anatomy.shank_m()));
  const Posture stand = standing(anatomy, floor_m, heading_rad);
  const Vector3 forward(std::cos(heading_rad), std::sin(heading_rad), 0.0);
  const Vector3 left(-forward.y(), forward.x(), 0.0);
  const auto posture = [=](double t_s) {
    Posture now = stand;
    const double phase = phase_rad + turn_radps * t_s;
    now.floor_m += speed_mps * t_s * forward + sway_m * std::sin(phase) * left;
    now.rise_m = -rise_m * (1.0 - std::cos(2.0 * phase)) / 2.0;
    now.lean_rad = 0.05;
    for (size_t side : {0u, 1u}) {
      const double swing = sign_of(side) * std::sin(phase);  // of the leg; the arm of this side swings against it
      now.hand_m[side] = swinging_hand_m(anatomy, side, swing_rad, -swing);
      now.hip_rad[side] = 0.05 + hip_rad * swing;
      now.knee_rad[side] = 0.1 + 0.4 * (1.0 + sign_of(side) * std::cos(phase)) / 2.0;
    }
    return now;
  };
  return {posture, end_s};
}

Behaviour reaching(Random& random, const Anatomy& anatomy, const Vector3& floor_m, double heading_rad, size_t side,
                   const Vector3& point_m, double reach_s) {
  const Vector3 hanging_m = hanging_hand_m(anatomy, side), reached_m = point_m - shoulder_m(anatomy, side);
  const double peak_mps = random.uniform(0.8, 2.0), stay_s = random.uniform(0.2, 1.0);
  const double way_s = PointMoves::kPeakSpeed * (reached_m - hanging_m).norm() / peak_mps;
  const double back_s = way_s * random.uniform(0.8, 1.3);
  const double lack_m = std::max(0.0, reached_m.norm() - 0.9 * anatomy.reach_m());
  const double lean_rad = std::min(0.7, lack_m / (anatomy.shoulder_height_m() - anatomy.hip_height_m()));
  PointMoves hand(hanging_m), lean(Vector3::Zero());
  for (PointMoves* moves : {&hand, &lean}) {
    const bool is_hand = moves == &hand;
    moves->wait(std::max(0.0, reach_s - way_s));
    moves->move_to(is_hand ? reached_m : Vector3(lean_rad, 0, 0), way_s);
    moves->wait(stay_s);
    moves->move_to(is_hand ? hanging_m : Vector3(0, 0, 0), back_s);
  }
  const Posture stand = standing(anatomy, floor_m, heading_rad);
  const auto posture = [=](double t_s) {
    Posture now = stand;
    now.hand_m[side] = hand.at(t_s);
    now.lean_rad = lean.at(t_s).x();
    return now;
  };
  return {posture, hand.end_s()};
}

namespace {

/// A straight stroke of a hand that ends at a given point.
struct Stroke {
  Vector3 from_m, to_m;
  double duration_s;
};

/// Draws largest speed and acceleration in the measured ranges of quick gestures, and a start that the arm reaches.
Stroke draw_stroke(Random& random, const Anatomy& anatomy, const Vector3& hanging_m, const Vector3& to_m) {
  constexpr double kRatio = PointMoves::kPeakAcceleration / (PointMoves::kPeakSpeed * PointMoves::kPeakSpeed);
  Stroke stroke{to_m, to_m, 0.3};
  for (int draw = 0; draw < 10'000; ++draw) {
    const double speed_mps = random.uniform(3.2, 5.2), acceleration_mps2 = random.uniform(30.0, 64.0);
    const double length_m = kRatio * speed_mps * speed_mps / acceleration_mps2;
    stroke.from_m = to_m - length_m * random.direction();
    stroke.duration_s = PointMoves::kPeakSpeed * length_m / speed_mps;
    // No way of the hand leads past the shoulder so near that the arm could not follow.
    const double nearest_m = std::min(distance_to_segment(stroke.from_m, to_m, Vector3::Zero()),
                                      distance_to_segment(hanging_m, stroke.from_m, Vector3::Zero()));
    const bool reached = stroke.from_m.norm() < 0.95 * anatomy.reach_m() && nearest_m > 0.33 * anatomy.reach_m();
    if (reached && stroke.from_m.x() > -0.05) return stroke;
  }
  stroke.from_m = to_m;  // none was found: the hand stays at its point
  return stroke;
}

PointMoves strokes(Random& random, const Vector3& hanging_m, const Stroke& stroke, double strike_s) {
  constexpr double kRaise_s = 0.9;
  PointMoves hand(hanging_m);
  hand.wait(std::max(0.0, strike_s - stroke.duration_s - kRaise_s));
  hand.move_to(stroke.from_m, kRaise_s);
  const int count = random.integer(2, 6);
  for (int k = 0; k < count; ++k) {
    hand.move_to(k % 2 == 0 ? stroke.to_m : stroke.from_m, stroke.duration_s);
    if (random.uniform(0.0, 1.0) < 0.5) hand.wait(random.uniform(0.0, 0.5));
  }
  hand.move_to(hanging_m, kRaise_s);
  return hand;
}

}  // namespace

Behaviour gesturing(Random& random, const Anatomy& anatomy, const Vector3& floor_m, double heading_rad, size_t side,
                    const Vector3& point_m, double strike_s) {
  const size_t other = 1 - side;
  const Vector3 to_m = point_m - shoulder_m(anatomy, side);
  const Vector3 hanging_m = hanging_hand_m(anatomy, side), other_hanging_m = hanging_hand_m(anatomy, other);
  const PointMoves first = strokes(random, hanging_m, draw_stroke(random, anatomy, hanging_m, to_m), strike_s);
  PointMoves second(other_hanging_m);
  if (random.uniform(0.0, 1.0) < 0.5) {
    const Vector3 mirrored_m(to_m.x(), -to_m.y(), to_m.z());
    second = strokes(random, other_hanging_m, draw_stroke(random, anatomy, other_hanging_m, mirrored_m),
                     strike_s + random.uniform(0.0, 0.6));
  }
  const Posture stand = standing(anatomy, floor_m, heading_rad);
  const auto posture = [=](double t_s) {
    Posture now = stand;
    now.hand_m[side] = first.at(t_s);
    now.hand_m[other] = second.at(t_s);
    return now;
  };
  return {posture, std::max(first.end_s(), second.end_s())};
}

}  // namespace sidestep::campaign
