#include "firmware/foresight/person_retreat.h"

#include <memory>

#include "firmware/foresight/foresight.h"
#include "firmware/model/prediction.h"
#include "tests/support/check.h"
#include "tests/support/closed_loop.h"
#include "tests/support/lwa3.h"

using namespace sidestep;
using test::lwa3;

namespace {

const Model& model() {
  static const Model model = test::lwa3_model("sidestep");
  return model;
}

Vector3 tool_m() {
  return forward_kinematics(lwa3(), test::home_rad()).tool_position;
}

/// The arm at rest at home, where its target is.
std::unique_ptr<Snapshot> at_target() {
  auto snapshot = std::make_unique<Snapshot>();
  snapshot->moves = snapshot->tracking = true;
  snapshot->now_s = 12.5;
  snapshot->arm.position_rad = test::home_rad();
  snapshot->arm.velocity_radps = JointVector::Zero(7);
  snapshot->target.position_m = tool_m();
  return snapshot;
}

/// A hand beside the tool, at so much from its place.
void add_hand(Snapshot& snapshot, const Vector3& beside_m, Kind kind = Kind::kPerson) {
  Obstacle hand = sphere_obstacle(tool_m() + beside_m, 0.05);
  hand.kind = kind;
  hand.id = snapshot.nearby.count;
  snapshot.nearby.obstacles[static_cast<size_t>(snapshot.nearby.count++)] = hand;
}

std::unique_ptr<Snapshot> between_two(Kind kind = Kind::kPerson) {
  auto snapshot = at_target();
  add_hand(*snapshot, {0.0, 0.3, 0.0}, kind);
  add_hand(*snapshot, {0.0, -0.3, 0.0}, kind);
  return snapshot;
}

double clearance_m(const JointVector& q_rad, const NearbyObstacles& nearby) {
  return clearance_after(lwa3(), forward_kinematics(lwa3(), q_rad), nearby.obstacles.data(), nearby.count, 0.0, 10.0);
}

/// Whether it retreats after so many calls.
bool retreats(PersonRetreat& retreat, const Snapshot& now, int calls = 20) {
  bool result = false;
  for (int i = 0; i < calls; ++i) result = retreat.update(now);
  return result;
}

void an_arm_between_two_persons_retreats_to_where_it_is_clear_of_both(void**) {
  const auto now = between_two();
  const auto retreat = std::make_unique<PersonRetreat>(model());
  assert_false(retreat->update(*now));  // one report may be wrong
  assert_true(retreats(*retreat, *now, 40));
  const Guide& guide = retreat->guide();
  assert_true(guide.foresight_status == ForesightStatus::kWaiting);
  const JointVector& end_rad = guide.position_rad[static_cast<size_t>(guide.knots) - 1];
  assert_true(clearance_m(end_rad, now->nearby) > clearance_m(now->arm.position_rad, now->nearby) + 0.1);
}

void an_arm_beside_a_slow_person_leaves_it_to_the_separation(void**) {
  const auto now = at_target();
  add_hand(*now, {0.0, 0.3, 0.0});
  assert_false(retreats(*std::make_unique<PersonRetreat>(model()), *now));
}

void an_arm_beside_a_person_who_gestures_retreats(void**) {
  const auto now = at_target();
  add_hand(*now, {0.0, 0.3, 0.0});
  now->nearby.obstacles[0].velocity_mps = {0.0, 0.0, 2.0};
  assert_true(retreats(*std::make_unique<PersonRetreat>(model()), *now));
}

void an_arm_between_two_things_does_not_retreat(void**) {
  assert_false(retreats(*std::make_unique<PersonRetreat>(model()), *between_two(Kind::kThing)));
}

void a_retreat_ends_a_second_after_the_persons_have_left(void**) {
  const auto retreat = std::make_unique<PersonRetreat>(model());
  assert_true(retreats(*retreat, *between_two()));
  const auto alone = at_target();
  assert_true(retreats(*retreat, *alone, 99));
  assert_false(retreat->update(*alone));
}

void a_retreat_ends_when_the_target_changes(void**) {
  const auto retreat = std::make_unique<PersonRetreat>(model());
  const auto now = between_two();
  assert_true(retreats(*retreat, *now));
  now->target.position_m.z() += 0.06;
  assert_false(retreat->update(*now));
}

void foresight_leads_the_arm_out_from_between_two_persons(void**) {
  const auto foresight = std::make_unique<Foresight>(model());
  const auto now = between_two();
  for (int i = 0; i < 20; ++i) foresight->update(*now);
  const Guide& guide = foresight->update(*now);
  assert_int_equal(guide.knots, 2);
  assert_true(guide.foresight_status == ForesightStatus::kWaiting);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(an_arm_between_two_persons_retreats_to_where_it_is_clear_of_both),
      cmocka_unit_test(an_arm_beside_a_slow_person_leaves_it_to_the_separation),
      cmocka_unit_test(an_arm_beside_a_person_who_gestures_retreats),
      cmocka_unit_test(an_arm_between_two_things_does_not_retreat),
      cmocka_unit_test(a_retreat_ends_a_second_after_the_persons_have_left),
      cmocka_unit_test(a_retreat_ends_when_the_target_changes),
      cmocka_unit_test(foresight_leads_the_arm_out_from_between_two_persons),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
