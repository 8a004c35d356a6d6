#include "host/campaign/people/behaviour.h"

#include <algorithm>

#include "tests/support/check.h"

using namespace sidestep;
using namespace sidestep::campaign;

namespace {

constexpr double kFrame_s = 1.0 / 60.0;  // of the clips from which the measured figures come
constexpr int kPersons = 60;

/// Speeds and accelerations of the middles of body parts by finite differences, over all frames of a clip.
struct Figures {
  std::vector<double> speed_mps, acceleration_mps2;

  void add(const CapsulePath& path, double from_s, double to_s) {
    const auto middle_m = [&](double t_s) { return path.at(t_s).capsule.centre(); };
    for (double t_s = from_s + kFrame_s; t_s < to_s - kFrame_s; t_s += kFrame_s) {
      const Vector3 before_m = middle_m(t_s - kFrame_s), now_m = middle_m(t_s), after_m = middle_m(t_s + kFrame_s);
      speed_mps.push_back((after_m - before_m).norm() / (2.0 * kFrame_s));
      acceleration_mps2.push_back((after_m - 2.0 * now_m + before_m).norm() / (kFrame_s * kFrame_s));
    }
  }
};

double quantile(std::vector<double> values, double share) {
  const auto place = values.begin() + static_cast<long>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

void check_within(const char* what, double value, double least, double most) {
  check(value >= least && value <= most, "%s: %g, not in %g .. %g", what, value, least, most);
}

void walkers_move_as_measured(void**) {
  Figures hands, forearms, heads, trunks;
  Random random("walkers", 1);
  for (int person = 0; person < kPersons; ++person) {
    const Anatomy anatomy = draw_anatomy(random);
    const double speed_mps = random.uniform(1.05, 1.45);
    const auto body = record(anatomy, walking(random, anatomy, Vector3::Zero(), 0.7, speed_mps, 5.0).at, 5.0);
    for (const BodyPart part : {kHandLeft, kHandRight}) hands.add(body[part], 0.1, 4.9);
    for (const BodyPart part : {kForearmLeft, kForearmRight}) forearms.add(body[part], 0.1, 4.9);
    heads.add(body[kHead], 0.1, 4.9);
    trunks.add(body[kTorso], 0.1, 4.9);
  }
  check_within("hands, median speed", quantile(hands.speed_mps, 0.5), 1.1, 1.5);
  check_within("hands, 95 % of speed", quantile(hands.speed_mps, 0.95), 2.5, 3.1);
  check_within("hands, 95 % of acceleration", quantile(hands.acceleration_mps2, 0.95), 8.5, 11.5);
  check_within("forearms, 95 % of speed", quantile(forearms.speed_mps, 0.95), 1.9, 2.3);
  for (const Figures& slow : {heads, trunks}) {
    check_within("head, trunk: median speed", quantile(slow.speed_mps, 0.5), 1.1, 1.5);
    check_within("head, trunk: 95 % of speed", quantile(slow.speed_mps, 0.95), 1.1, 1.6);
    check_within("head, trunk: 95 % of acceleration", quantile(slow.acceleration_mps2, 0.95), 3.0, 6.0);
  }
}

void gestures_are_as_quick_as_measured_with_the_body_at_rest(void**) {
  Random random("gestures", 1);
  for (int person = 0; person < kPersons; ++person) {
    const Anatomy anatomy = draw_anatomy(random);
    const size_t side = static_cast<size_t>(person % 2);
    const Vector3 in_front_m = shoulder_m(anatomy, side) + 0.75 * anatomy.reach_m() * Vector3(0.9, 0.2, -0.1);
    const Behaviour behaviour = gesturing(random, anatomy, Vector3::Zero(), 1.0, side, in_front_m, 2.0);
    const auto body = record(anatomy, behaviour.at, 8.0);
    Figures hand, rest;
    hand.add(body[kHandLeft + side], 0.0, 8.0);
    for (const BodyPart part : {kTorso, kHead, kShoulders, kThighLeft}) rest.add(body[part], 0.0, 8.0);
    check_within("largest speed of the hand", quantile(hand.speed_mps, 1.0), 3.0, 6.0);
    check_within("largest acceleration of the hand", quantile(hand.acceleration_mps2, 1.0), 25.0, 70.0);
    check_near(quantile(rest.speed_mps, 1.0), 0.0, 1e-9);
  }
}

void a_reaching_hand_gets_to_its_point_in_time_and_comes_back(void**) {
  Random random("reaching", 1);
  for (int person = 0; person < kPersons; ++person) {
    const Anatomy anatomy = draw_anatomy(random);
    const size_t side = static_cast<size_t>(person % 2);
    const Vector3 point_m(random.uniform(0.6, 1.1) * anatomy.reach_m(), shoulder_m(anatomy, side).y(),
                          anatomy.shoulder_height_m() - 0.2);
    const Behaviour behaviour = reaching(random, anatomy, {1, 2, -0.7}, 0.0, side, point_m, 3.0);
    const auto body = record(anatomy, behaviour.at, 9.0);
    const CapsulePath& hand = body[kHandLeft + side];
    check_near(hand.at(3.0).capsule.centre(), Vector3(point_m + Vector3(1, 2, -0.7)), 0.03);
    check_near(hand.at(9.0).capsule.centre(), hand.at(0.0).capsule.centre(), 1e-6);
    Figures speeds;
    speeds.add(hand, 0.0, 9.0);
    check_within("largest speed of the hand", quantile(speeds.speed_mps, 1.0), 0.6, 2.6);
  }
}

void limbs_keep_their_lengths_and_hang_together(void**) {
  Random random("limbs", 1);
  for (int person = 0; person < kPersons; ++person) {
    const Anatomy anatomy = draw_anatomy(random);
    const Vector3 point_m = shoulder_m(anatomy, 0) + 0.8 * anatomy.reach_m() * Vector3(0.8, 0.0, -0.6);
    const Behaviour behaviour = gesturing(random, anatomy, Vector3::Zero(), 0.4, 0, point_m, 2.0);
    for (double t_s = 0.0; t_s < behaviour.end_s; t_s += 0.05) {
      const auto body = capsules_of(anatomy, behaviour.at(t_s));
      for (size_t side : {0u, 1u}) {
        const Capsule &upper = body[kUpperArmLeft + side], &lower = body[kForearmLeft + side];
        check_near((upper.end - upper.start).norm(), anatomy.upper_arm_m(), 1e-6);
        check_near((lower.end - lower.start).norm(), anatomy.forearm_m(), 1e-6);
        check_near(upper.end, lower.start, 1e-12);
        check(upper.radius_m >= 0.045 && upper.radius_m <= 0.050, "%g m", upper.radius_m);
        check_near(
            upper.start,
            Vector3(body[kShoulders].start + (side == 0 ? 0.0 : 1.0) * (body[kShoulders].end - body[kShoulders].start)),
            1e-9);
      }
    }
  }
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(walkers_move_as_measured),
      cmocka_unit_test(gestures_are_as_quick_as_measured_with_the_body_at_rest),
      cmocka_unit_test(a_reaching_hand_gets_to_its_point_in_time_and_comes_back),
      cmocka_unit_test(limbs_keep_their_lengths_and_hang_together),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
