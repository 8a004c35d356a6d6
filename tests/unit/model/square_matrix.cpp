#include "firmware/model/square_matrix.h"

#include "tests/support/check.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::Random;

namespace {

template <int n>
SquareMatrix<n> random_matrix(Random& random) {
  SquareMatrix<n> matrix;
  for (double& entry : matrix.reshaped()) entry = random.uniform(-1.0, 1.0);
  return matrix;
}

/// A symmetric matrix with eigenvalues of at least 0.1.
template <int n>
SquareMatrix<n> random_positive(Random& random) {
  const SquareMatrix<n> root = random_matrix<n>(random);
  return root * root.transpose() + 0.1 * SquareMatrix<n>::Identity();
}

template <int n>
void check_decompositions(int seed) {
  Random random(seed);
  const SquareMatrix<n> one = SquareMatrix<n>::Identity();
  for (int i = 0; i < 1000; ++i) {
    const SquareMatrix<n> matrix = random_positive<n>(random);
    assert_true((matrix * inverse(matrix) - one).norm() < 1e-11);
    const SquareMatrix<n> root = cholesky_root(matrix);
    assert_true((root * root.transpose() - matrix).norm() < 1e-12);
    assert_true(root.isLowerTriangular(0.0));

    // The matrix less its least eigenvalue is singular; a little less of it is positive definite, a little more not.
    const double least = least_eigenvalue(matrix);
    assert_true(least > 0.0999999);
    assert_true(is_positive_definite<n>(matrix - (least - 1e-9) * one));
    assert_false(is_positive_definite<n>(matrix - (least + 1e-9) * one));
  }
}

void matrices_of_three_rows_are_decomposed(void**) {
  check_decompositions<3>(1);
}

void matrices_of_six_rows_are_decomposed(void**) {
  check_decompositions<6>(2);
}

void ldlt_solves_both_sizes(void**) {
  Random random(3);
  for (int i = 0; i < 1000; ++i) {
    const Matrix3 three = random_positive<3>(random);
    const Vector3 b = random.inside(-1.0, 1.0);
    assert_true((three * solve_ldlt(three, b) - b).norm() < 1e-12);
    const TaskMatrix six = random_positive<6>(random);
    const TaskVector c = random_matrix<6>(random).col(0);
    assert_true((six * solve_ldlt(six, c) - c).norm() < 1e-12);
  }
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(matrices_of_three_rows_are_decomposed),
      cmocka_unit_test(matrices_of_six_rows_are_decomposed),
      cmocka_unit_test(ldlt_solves_both_sizes),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
