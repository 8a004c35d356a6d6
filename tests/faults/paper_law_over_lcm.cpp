// A step of the real controller in lockstep against the NumPy version of the paper's law.

#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>

#include "tests/support/check.h"

namespace {

void a_lockstep_step_agrees_with_numpy_on_random_states(void**) {
  const std::string url = fmt::format("udpm://239.255.76.67:{}?ttl=0", 20000 + getpid() % 20000);
  const std::string command = fmt::format("build/venv/bin/python tests/support/law_over_lcm.py '{}'", url);
  assert_int_equal(std::system(command.c_str()), 0);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {cmocka_unit_test(a_lockstep_step_agrees_with_numpy_on_random_states)};
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
