// The structure that the base link of an arm is fixed to: a pedestal, a torso, a table.

#include <algorithm>

#include "firmware/model/gjk.h"
#include "firmware/model/load/self_pairs.h"
#include "host/sim/truth.h"
#include "tests/support/check.h"
#include "tests/support/closed_loop.h"
#include "tests/support/lwa3.h"
#include "tests/support/random.h"
#include "tests/support/scratch.h"

using namespace sidestep;
using test::Random;

namespace {

const Vector3 kPlate_m(0.7, 0.6, 0.04), kPlatePlace_m(-0.8, 0.0, 0.35);

/// The LWA3 on a torso half a metre below its base and rotated by a right angle, with a plate and another arm.
std::string on_a_torso() {
  const std::string torso = R"(
  <link name="torso"><collision><geometry><box size="0.3 0.2 0.2"/></geometry></collision></link>
  <joint name="mount" type="fixed"><origin xyz="0 0 0.5" rpy="0 0 1.5707963267948966"/>
    <parent link="torso"/><child link="base_link"/></joint>
  <link name="plate"><collision><geometry><box size="0.6 0.7 0.04"/></geometry></collision></link>
  <joint name="bracket" type="fixed"><origin xyz="0 -0.8 0.85"/><parent link="torso"/><child link="plate"/></joint>
  <link name="other_arm"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>
  <joint name="other" type="continuous"><origin xyz="0 1 0"/><parent link="torso"/><child link="other_arm"/></joint>
</robot>)";
  return test::scratch_file("torso.urdf", test::replaced(test::text_of("urdf/lwa3.urdf"), "</robot>", torso));
}

std::vector<LinkShape> shapes_of(const Arm& arm, const std::string& link) {
  std::vector<LinkShape> found;
  std::copy_if(arm.shapes.begin(), arm.shapes.end(), std::back_inserter(found),
               [&](const LinkShape& shape) { return shape.link == link; });
  return found;
}

void a_torso_and_the_links_fixed_to_it_have_shapes_but_its_other_arm_has_none(void**) {
  const Arm arm = load_arm(on_a_torso(), "base_link", "tool");
  for (const char* link : {"torso", "plate"}) {
    const auto shapes = shapes_of(arm, link);
    assert_false(shapes.empty());
    for (const LinkShape& shape : shapes) assert_true(shape.body == 0 && shape.below_arm);
  }
  assert_true(shapes_of(arm, "other_arm").empty());
  for (const LinkShape& shape : shapes_of(arm, "base_link")) assert_false(shape.below_arm);
  assert_int_equal(arm.shapes.size() - shapes_of(arm, "torso").size() - shapes_of(arm, "plate").size(),
                   test::lwa3().shapes.size());
}

/// The shapes are in the frame of the base link.
void a_plate_is_exact(void**) {
  const auto shapes = shapes_of(load_arm(on_a_torso(), "base_link", "tool"), "plate");
  assert_int_equal(shapes.size(), 1);
  const auto distance_m = [&](const Vector3& point) {
    return gap_between(shapes[0].solid, ConvexSolid::of(Capsule{point, point, 0.0}), Vector3::UnitZ()).distance_m;
  };
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const Vector3 inside = random.inside(-0.5, 0.5);
    check(distance_m(kPlatePlace_m + inside.cwiseProduct(kPlate_m)) < 1e-9, "a point of the plate is not covered");
  }
  check_near(distance_m(kPlatePlace_m + Vector3(0, 0, 0.02 + 0.003)), 0.003, 1e-9);
}

void a_pedestal_forms_pairs_with_the_links_of_the_arm_alone(void**) {
  const Arm arm = load_arm("tests/data/arm8.urdf", "mount", "flange");
  assert_int_equal(shapes_of(arm, "pedestal").size(), 1);
  bool far = false;
  for (const auto& [a, b, clearance_m] : find_self_pairs(arm, 0.02).kept) {
    const LinkShape &one = arm.shapes[static_cast<size_t>(a)], &other = arm.shapes[static_cast<size_t>(b)];
    if (one.link != "pedestal" && other.link != "pedestal") continue;
    check(one.body != other.body, "%s and %s", one.link.c_str(), other.link.c_str());
    far = far || std::max(one.body, other.body) > 3;
  }
  assert_true(far);
}

/// From home to a target under the plate, for 6 s; the least distance of the plate to the arm by FCL, m.
double reach_under_the_plate(const Model& model) {
  test::ClosedLoop loop(model, test::home_rad());
  sim::Truth truth(sim::Arm("urdf/lwa3.urdf", "base_link", "tool"));
  sim::Obstacle plate;
  plate.solid = {sim::Shape::kBox, kPlate_m};
  plate.motion.position_m = kPlatePlace_m;
  loop.target.position_m = Vector3(-0.6, 0.0, 0.2);
  loop.sends_target = true;
  double least_m = 1.0;
  for (int i = 0; i < 600; ++i) {
    loop.cycle();
    truth.place(loop.arm.position_rad);
    least_m = std::min(least_m, truth.clearance_m(plate));
  }
  test::check_stream(loop);
  return least_m;
}

void the_arm_keeps_clear_of_the_plate(void**) {
  Model model = test::lwa3_model("sidestep");
  const double without_m = reach_under_the_plate(model);
  check(without_m < 0.0, "without its shapes the arm does not touch the plate: %g m", without_m);
  const JointLimits limits = model.arm.limits;
  model.arm = load_arm(on_a_torso(), "base_link", "tool");
  model.arm.limits = limits;
  model.self_pairs = find_self_pairs(model.arm, model.settings.shield.self_clearance_m).kept;
  const double least_m = reach_under_the_plate(model);
  print_message("least distance to the plate, by FCL: %.1f mm\n", 1e3 * least_m);
  check(least_m > 0.01, "%g m", least_m);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(a_torso_and_the_links_fixed_to_it_have_shapes_but_its_other_arm_has_none),
      cmocka_unit_test(a_plate_is_exact),
      cmocka_unit_test(a_pedestal_forms_pairs_with_the_links_of_the_arm_alone),
      cmocka_unit_test(the_arm_keeps_clear_of_the_plate),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
