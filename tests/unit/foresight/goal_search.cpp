#include "firmware/foresight/goal_search.h"

#include "tests/support/check.h"
#include "tests/support/lwa3.h"

using namespace sidestep;

namespace {

Target point(double x_m) {
  Target target;
  target.position_m.x() = x_m;
  return target;
}

void thirty_searches_in_vain_in_a_row_show_that_the_target_is_out_of_reach(void**) {
  GoalSearch search(test::lwa3());
  search.set_goal(point(1.0));
  for (int i = 0; i < 29; ++i) search.searched(false);
  assert_true(search.finding() == GoalFinding::kNone);
  search.searched(true);
  for (int i = 0; i < 29; ++i) search.searched(false);
  assert_true(search.finding() == GoalFinding::kNone);
  search.searched(false);
  assert_true(search.finding() == GoalFinding::kOutOfReach);
  search.searched(true);
  assert_true(search.finding() == GoalFinding::kNone);
}

void another_goal_is_new_and_the_same_one_is_not(void**) {
  GoalSearch search(test::lwa3());
  assert_true(search.set_goal(point(1.0)));
  for (int i = 0; i < 30; ++i) search.searched(false);
  assert_false(search.set_goal(point(1.004)));
  assert_true(search.finding() == GoalFinding::kOutOfReach);
  assert_true(search.set_goal(point(1.006)));
  assert_true(search.finding() == GoalFinding::kNone);
}

void the_first_goal_is_new_wherever_it_is_also_after_the_last_one_was_forgotten(void**) {
  GoalSearch search(test::lwa3());
  assert_true(search.set_goal(Target{}));
  assert_false(search.set_goal(Target{}));
  search.forget_goal();
  assert_true(search.set_goal(Target{}));
}

void a_blocked_posture_is_blocked_until_it_is_examined_again_or_replaced(void**) {
  GoalSearch search(test::lwa3());
  Target posture;
  posture.posture_rad = test::home_rad();
  search.set_goal(posture);
  search.examined(true);
  assert_true(search.finding() == GoalFinding::kPostureBlocked);
  search.set_goal(posture);
  assert_true(search.finding() == GoalFinding::kPostureBlocked);
  search.examined(false);
  assert_true(search.finding() == GoalFinding::kNone);
  search.examined(true);
  posture.posture_rad[2] += 0.01;
  search.set_goal(posture);
  assert_true(search.finding() == GoalFinding::kNone);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(thirty_searches_in_vain_in_a_row_show_that_the_target_is_out_of_reach),
      cmocka_unit_test(another_goal_is_new_and_the_same_one_is_not),
      cmocka_unit_test(the_first_goal_is_new_wherever_it_is_also_after_the_last_one_was_forgotten),
      cmocka_unit_test(a_blocked_posture_is_blocked_until_it_is_examined_again_or_replaced),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
