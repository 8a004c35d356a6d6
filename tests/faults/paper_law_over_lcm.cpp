// A step of the real controller in lockstep against the NumPy version of the paper's law.

#include <fmt/format.h>

#include <cstdlib>

#include "tests/support/check.h"
#include "tests/support/lcm_peer.h"

namespace {

void a_lockstep_step_agrees_with_numpy_on_random_states(void**) {
  const std::string command =
      fmt::format("build/venv/bin/python tests/support/law_over_lcm.py '{}'", sidestep::test::private_lcm_url());
  assert_int_equal(std::system(command.c_str()), 0);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {cmocka_unit_test(a_lockstep_step_agrees_with_numpy_on_random_states)};
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
