#include <eiquadprog/eiquadprog-rt.hpp>

#include "tests/support/check.h"

// eiquadprog 1.3.2 (host/setup/python.txt) has a sign error: given the inverse root of the Hessian, its solver starts
// from the negated minimum. firmware/control/shield/shield_qp.cpp negates the gradient for this reason. When this test
// fails after an update of eiquadprog, remove that negation.

namespace {

using Vector2 = Eigen::Vector2d;
using Solver = eiquadprog::solvers::RtEiquadprog<2, 0, 1>;

/// The minimum of 1/2 x'x + gradient'x, which is -gradient, as the solver reports it. The only constraint is inactive.
Vector2 solve(const Vector2& gradient, bool is_inverse_provided) {
  Solver solver;
  solver.m_J = Eigen::Matrix2d::Identity();
  solver.is_inverse_provided_ = is_inverse_provided;
  const Eigen::Matrix<double, 1, 2> condition = Eigen::Matrix<double, 1, 2>::Zero();
  const Eigen::Matrix<double, 1, 1> offset = Eigen::Matrix<double, 1, 1>::Ones();
  Vector2 x = Vector2::Zero();
  const auto status = solver.solve_quadprog(Eigen::Matrix2d::Identity(), gradient, Eigen::Matrix<double, 0, 2>(),
                                            Eigen::Matrix<double, 0, 1>(), condition, offset, x);
  assert_int_equal(status, eiquadprog::solvers::RT_EIQUADPROG_OPTIMAL);
  return x;
}

void without_a_given_inverse_the_solver_returns_the_minimum(void**) {
  const Vector2 gradient(1.0, -2.0), minimum = -gradient;
  check_near(solve(gradient, false), minimum, 1e-12);
}

void with_a_given_inverse_eiquadprog_1_3_2_returns_the_negated_minimum(void**) {
  const Vector2 gradient(1.0, -2.0), negated_minimum(1.0, -2.0);
  check_near_because(solve(gradient, true), negated_minimum, 1e-12,
                     "this eiquadprog is not 1.3.2 or behaves differently: firmware/control/shield/shield_qp.cpp must "
                     "no longer pass the negated gradient");
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(without_a_given_inverse_the_solver_returns_the_minimum),
      cmocka_unit_test(with_a_given_inverse_eiquadprog_1_3_2_returns_the_negated_minimum),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
