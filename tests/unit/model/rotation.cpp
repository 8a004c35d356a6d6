#include "firmware/model/rotation.h"

#include <cmath>

#include "tests/support/check.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::Random;

namespace {

void turns_z_to_any_axis(void**) {
  Random random(1);
  for (int i = 0; i < 100000; ++i) {
    // Every other axis is close to -z, where the rotation is ill-conditioned.
    Vector3 axis = random.inside(-2.0, 2.0);
    if (i % 2) axis = Vector3(axis.x() * std::pow(10.0, -random.uniform(0.0, 18.0)), 0.0, -1.0);
    const Quaternion rotation = rotation_from_z(axis);
    assert_true(std::abs(rotation.norm() - 1.0) < 1e-12);
    assert_true((rotation * Vector3::UnitZ() - axis.normalized()).norm() < 1e-12);
  }
}

void agrees_with_eigen_bit_for_bit_but_near_minus_z(void**) {
  Random random(2);
  for (int i = 0; i < 10000; ++i) {
    const Vector3 axis = random.inside(-2.0, 2.0);
    if (axis.z() < -0.998 * axis.norm()) continue;
    const Quaternion expected = Quaternion::FromTwoVectors(Vector3::UnitZ(), axis);
    assert_true(rotation_from_z(axis).coeffs() == expected.coeffs());
  }
  for (const Vector3& axis : {Vector3(0, 0, 1), Vector3(0, 0, -1), Vector3(1, 0, 0), Vector3(0, -3, 0)})
    assert_true(rotation_from_z(axis).coeffs() == Quaternion::FromTwoVectors(Vector3::UnitZ(), axis).coeffs());
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(turns_z_to_any_axis),
      cmocka_unit_test(agrees_with_eigen_bit_for_bit_but_near_minus_z),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
