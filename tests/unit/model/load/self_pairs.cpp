#include "firmware/model/load/srdf.h"

#include <algorithm>

#include "firmware/control/shield/shield.h"
#include "firmware/model/gjk.h"
#include "firmware/model/load/convex_hull.h"
#include "tests/support/check.h"
#include "tests/support/closed_loop.h"
#include "tests/support/lwa3.h"
#include "tests/support/random.h"
#include "tests/support/scratch.h"

using namespace sidestep;
using test::lwa3;
using test::Random;

namespace {

constexpr double kPeriod_s = 0.01;

using Pairs = std::vector<SelfPair>;

std::vector<std::string> names(const Arm& arm, const Pairs& pairs) {
  std::vector<std::string> found;
  for (const auto& [a, b, clearance_m] : pairs)
    found.push_back(arm.shapes[static_cast<size_t>(a)].link + " " + arm.shapes[static_cast<size_t>(b)].link);
  std::sort(found.begin(), found.end());
  return found;
}

Proximity measure(const Arm& arm, const LinkPoses& poses, const SelfPair& pair) {
  return measure_pair(transformed(poses, arm.shapes[static_cast<size_t>(pair.first)]),
                      transformed(poses, arm.shapes[static_cast<size_t>(pair.second)]));
}

void the_lwa3_has_three_pairs_that_can_meet(void**) {
  const std::vector<std::string> expected = {"base_link forearm_link", "base_link hand_link",
                                             "upper_arm_link hand_link"};
  const std::vector<std::string> found = names(lwa3(), find_self_pairs(lwa3(), 0.02).kept);
  std::string text;
  for (const std::string& name : found) text += name + "; ";
  check(found == expected, "found %s", text.c_str());
}

void the_pairs_are_the_same_on_every_call(void**) {
  const char* const arms[][3] = {{"tests/data/arm6.urdf", "foot", "tip"},
                                 {"tests/data/arm8.urdf", "mount", "flange"},
                                 {"tests/data/arm10.urdf", "l0", "l10"}};
  for (const auto& [file, base, tip] : arms) {
    const Arm arm = load_arm(file, base, tip);
    const Pairs pairs = find_self_pairs(arm, 0.02).kept, again = find_self_pairs(arm, 0.02).kept;
    const auto same = [](const SelfPair& x, const SelfPair& y) {
      return x.first == y.first && x.second == y.second && x.clearance_m == y.clearance_m;
    };
    assert_true(std::equal(pairs.begin(), pairs.end(), again.begin(), again.end(), same));
    for (const auto& [a, b, clearance_m] : pairs) {
      check(a < b && b < static_cast<int>(arm.shapes.size()), "%s: %d and %d", file, a, b);
      assert_int_not_equal(arm.shapes[static_cast<size_t>(a)].body, arm.shapes[static_cast<size_t>(b)].body);
    }
  }
}

/// The share of configurations without contact, other ones than were sampled, that the pairs forbid.
double forbidden_share(const Arm& arm, const SelfPairs& pairs) {
  Random random(7);
  int free = 0, forbidden = 0;
  for (int i = 0; i < 3000; ++i) {
    const LinkPoses poses = forward_kinematics(arm, random.configuration(arm));
    double least_m = 1.0, least_room_m = 1.0;
    for (const SelfPair& pair : pairs.kept) {
      const ConvexSolid a = solid_of(poses, arm.shapes[static_cast<size_t>(pair.first)]);
      const ConvexSolid b = solid_of(poses, arm.shapes[static_cast<size_t>(pair.second)]);
      const double distance_m = gap_between(a, b, a.centre - b.centre).distance_m;
      least_m = std::min(least_m, distance_m);
      least_room_m = std::min(least_room_m, distance_m - pair.clearance_m);
    }
    if (least_m <= 0.0) continue;
    ++free;
    if (least_room_m < 0.0) ++forbidden;
  }
  return forbidden / static_cast<double>(free);
}

void few_free_configurations_are_forbidden_also_where_links_are_near_by_construction(void**) {
  const Arm arm = load_arm("tests/data/arm8.urdf", "mount", "flange");
  for (const double clearance_m : {0.02, 0.2}) {
    const SelfPairs pairs = find_self_pairs(arm, clearance_m);
    for (const SelfPair& pair : pairs.kept)
      check(pair.clearance_m >= 0.0 && pair.clearance_m <= clearance_m, "%g", pair.clearance_m);
    check(forbidden_share(arm, pairs) < 0.03, "%g m: %g", clearance_m, forbidden_share(arm, pairs));
  }
}

/// Of the first and the last link, which are 12 to 18 mm apart in every configuration, as some links of a UR: no
/// threshold would keep them 20 mm apart.
Arm with_links_near_by_construction() {
  std::string links, joints;
  const char* const shapes[7] = {
      "<geometry><sphere radius='0.05'/></geometry>",
      "<origin xyz='0 0 -0.3'/><geometry><sphere radius='0.01'/></geometry>",
      "",
      "",
      "",
      "",
      "<origin xyz='0.003 0 0'/><geometry><sphere radius='0.05'/></geometry>",
  };
  for (int i = 0; i < 7; ++i) {
    const std::string name = "l" + std::to_string(i), shape = shapes[i];
    links += "<link name='" + name + "'>" + (shape.empty() ? "" : "<collision>" + shape + "</collision>") + "</link>";
    if (i == 0) continue;
    joints += "<joint name='j" + std::to_string(i) + "' type='revolute'><parent link='l" + std::to_string(i - 1) +
              "'/><child link='" + name + "'/><axis xyz='0 0 1'/><origin xyz='" + (i == 6 ? "0.115" : "0") +
              " 0 0'/><limit lower='-3' upper='3' velocity='1' effort='1'/></joint>";
  }
  return load_arm(test::scratch_file("near.urdf", "<robot name='near'>" + links + joints + "</robot>"), "l0", "l6");
}

void links_that_no_configuration_keeps_apart_forbid_next_to_nothing(void**) {
  const Arm arm = with_links_near_by_construction();
  const SelfPairs pairs = find_self_pairs(arm, 0.02);
  assert_true(names(arm, pairs.kept) == std::vector<std::string>({"l0 l6", "l1 l6"}));
  check_near(pairs.kept[0].clearance_m, 0.012, 5e-5);
  check(forbidden_share(arm, pairs) < 0.002, "%g", forbidden_share(arm, pairs));
}

/// Of two links with joints between them but no shape: one that always touch, or one that can fold together.
void links_with_no_shape_between_are_kept_apart_if_they_can_be(void**) {
  const auto arm_with = [](const std::string& shape_of_last) {
    std::string links = "<link name='l0'><collision><geometry><box size='0.1 0.1 0.1'/></geometry></collision></link>";
    std::string joints;
    for (int i = 1; i <= 6; ++i) {
      const std::string name = "l" + std::to_string(i);
      links +=
          "<link name='" + name + "'>" + (i == 6 ? "<collision>" + shape_of_last + "</collision>" : "") + "</link>";
      joints += "<joint name='j" + std::to_string(i) + "' type='revolute'><parent link='l" + std::to_string(i - 1) +
                "'/><child link='" + name + "'/><axis xyz='" + (i % 2 ? "0 0 1" : "1 0 0") +
                "'/><limit lower='-3' upper='3' velocity='1' effort='1'/></joint>";
    }
    return load_arm(test::scratch_file("joined.urdf", "<robot name='joined'>" + links + joints + "</robot>"), "l0",
                    "l6");
  };
  const char* const at = "<origin xyz='0 0 %s'/><geometry><cylinder radius='0.02' length='0.1'/></geometry>";
  const auto kept = [&](const char* z_m) {
    std::string shape = at;
    shape.replace(shape.find("%s"), 2, z_m);
    return find_self_pairs(arm_with(shape), 0.02);
  };
  assert_true(kept("0").kept.empty() && kept("0").overlaps.empty());
  const SelfPairs beside = kept("0.13");
  assert_int_equal(beside.kept.size(), 1);
  assert_true(beside.forbidden_share > 0.0 && beside.forbidden_share <= 0.0152);
}

std::shared_ptr<const Polyhedron> box_of(const Vector3& half_m) {
  std::vector<Vector3> corners;
  for (int i = 0; i < 8; ++i)
    corners.push_back(Vector3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1).cwiseProduct(half_m));
  return std::make_shared<Polyhedron>(polyhedron_of(convex_hull(corners)));
}

/// The pieces alone forbid what they exceed their mesh.
void clearances_forbid_less_where_pieces_stand_for_meshes(void**) {
  Arm arm = load_arm("tests/data/arm8.urdf", "mount", "flange");
  const SelfPairs exact = find_self_pairs(arm, 0.02);
  const auto box = std::find_if(arm.shapes.begin(), arm.shapes.end(),
                                [](const LinkShape& s) { return !s.is_capsule && s.solid.kind == CoreKind::kBox; });
  assert_true(box != arm.shapes.end());
  box->polyhedron = box_of(box->solid.half_m);
  box->solid.polyhedron = box->polyhedron.get();
  box->solid.kind = CoreKind::kPolyhedron;
  const SelfPairs pieces = find_self_pairs(arm, 0.02);
  check(exact.forbidden_share > 0.012 && exact.forbidden_share <= 0.015, "%g", exact.forbidden_share);
  check(pieces.forbidden_share > 0.005 && pieces.forbidden_share <= 0.012, "%g", pieces.forbidden_share);
}

/// One shape counts as a piece of a mesh and keeps its form, so that the rule alone makes the difference.
void the_least_clearance_of_a_pair_forbids_little_where_pieces_stand_for_meshes(void**) {
  Arm arm = load_arm("tests/data/arm10.urdf", "l0", "l10");
  const SelfPairs exact = find_self_pairs(arm, 0.02);
  arm.shapes.front().polyhedron = box_of(Vector3::Ones());
  const SelfPairs pieces = find_self_pairs(arm, 0.02);
  check(exact.worst_share > 0.005 && pieces.worst_share <= 0.0052, "%g, %g", exact.worst_share, pieces.worst_share);
  for (const SelfPair& pair : pieces.kept) check(pair.clearance_m >= 0.0002, "%g", pair.clearance_m);
}

void the_pair_that_forbids_most_is_named(void**) {
  const SelfPairs pairs = find_self_pairs(load_arm("tests/data/arm8.urdf", "mount", "flange"), 0.2);
  assert_true(pairs.forbidden_share > 0.0 && pairs.worst_share > 0.0 && pairs.worst_share <= pairs.forbidden_share);
  assert_true(pairs.worst >= 0 && pairs.worst < static_cast<int>(pairs.kept.size()));
}

void the_clearance_of_pairs_that_are_mostly_far_apart_is_the_whole_one(void**) {
  for (const SelfPair& pair : find_self_pairs(lwa3(), 0.02).kept) check_near(pair.clearance_m, 0.02, 0.0);
}

void links_of_a_long_chain_keep_more_than_those_of_a_short_one(void**) {
  const auto least_m = [](const char* file, const char* base, const char* tip) {
    double clearance_m = 1.0;
    for (const SelfPair& pair : find_self_pairs(load_arm(file, base, tip), 0.02).kept)
      clearance_m = std::min(clearance_m, pair.clearance_m);
    return clearance_m;
  };
  check_near(least_m("tests/data/ten_joints.urdf", "base", "tool"), 0.004, 0.0);
  check_near(least_m("tests/data/arm6.urdf", "foot", "tip"), 0.001, 0.0);
}

void ignored_links_form_no_pair(void**) {
  const Pairs pairs = find_self_pairs(lwa3(), 0.02, {{"hand_link", "base_link"}, {"no_link", "base_link"}}).kept;
  const std::vector<std::string> expected = {"base_link forearm_link", "upper_arm_link hand_link"};
  assert_true(names(lwa3(), pairs) == expected);
}

void an_srdf_disables_collisions(void**) {
  const std::string file = test::scratch_file("arm.srdf", R"(<?xml version="1.0"?><robot name="x">
    <!-- <disable_collisions link1="c" link2="d"/> -->
    <disable_collisions link1="a" link2="b" reason="Adjacent"/><disable_collisions
      link2='e' link1='f'/></robot>)");
  assert_true(disabled_collisions(file) == std::vector<LinkPair>({{"a", "b"}, {"f", "e"}}));
  assert_string_equal(srdf_beside(test::scratch_folder() + "/arm.urdf").c_str(), file.c_str());
  assert_string_equal(srdf_beside(test::scratch_folder() + "/other.urdf").c_str(), "");
  const std::string bad = test::scratch_file("bad.srdf", "<robot><disable_collisions link1='a'/></robot>");
  assert_true(test::one_line_with(test::message_of([&] { disabled_collisions(bad); }), {bad, "link2"}));
}

/// The nominal velocity that closes the nearest pair as fast as the joints can move.
JointVector folding_nominal(const Arm& arm, const LinkPoses& poses, const Pairs& pairs, double& least_m) {
  JointVector nominal_radps = JointVector::Zero(arm.joints);
  least_m = 1e9;
  for (const auto& pair : pairs) {
    const Proximity now = measure(arm, poses, pair);
    if (now.distance_m >= least_m) continue;
    least_m = now.distance_m;
    const int first = arm.shapes[static_cast<size_t>(pair.first)].body;
    const int second = arm.shapes[static_cast<size_t>(pair.second)].body;
    const JointVector opening =
        (point_jacobian(poses, first, now.on_arm) - point_jacobian(poses, second, now.on_obstacle)).transpose() *
        now.normal;
    nominal_radps = -opening * (2.0 / std::max(1e-6, opening.cwiseAbs().maxCoeff()));
  }
  return nominal_radps;
}

void a_nominal_velocity_that_folds_the_arm_onto_itself_leads_to_no_contact(void**) {
  const Model model = test::lwa3_model("sidestep");
  const auto nothing = std::make_unique<ObstacleSet>();
  const ObstacleView view{nothing.get(), 0.0, 0.0};
  Random random(1);
  int met = 0;
  for (int trial = 0; trial < 60; ++trial) {
    JointVector q_rad = random.configuration(model.arm, 0.95), last_radps = JointVector::Zero(7);
    double least_m = 0.0, nearest_m = 1.0;
    folding_nominal(model.arm, forward_kinematics(model.arm, q_rad), model.self_pairs, least_m);
    if (least_m < 0.05) continue;
    for (int cycle = 0; cycle < 300; ++cycle) {
      const LinkPoses poses = forward_kinematics(model.arm, q_rad);
      const JointVector nominal_radps = folding_nominal(model.arm, poses, model.self_pairs, least_m);
      check(least_m >= 0.0, "trial %d, cycle %d: %g m", trial, cycle, least_m);
      nearest_m = std::min(nearest_m, least_m);
      const Clearance clearance = measure_clearance(model.arm, poses, view, {0.0, 0.0});
      const ShieldInput around{model.arm,  poses,     q_rad, q_rad,
                               last_radps, clearance, view,  model.self_pairs,
                               last_radps, 0.01,      1.0,   model.settings.shield.tool_weight};
      last_radps = shield(model.settings.shield, around, sustainable_range(model.arm.limits, q_rad, q_rad, kPeriod_s),
                          velocity_range(model.arm.limits, q_rad, q_rad, last_radps, kPeriod_s),
                          tool_jacobian(poses, 3), nominal_radps)
                       .velocity_radps;
      q_rad += kPeriod_s * last_radps;
    }
    if (nearest_m < 0.03) ++met;
  }
  check(met >= 5, "only %d came near", met);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(the_lwa3_has_three_pairs_that_can_meet),
      cmocka_unit_test(the_pairs_are_the_same_on_every_call),
      cmocka_unit_test(few_free_configurations_are_forbidden_also_where_links_are_near_by_construction),
      cmocka_unit_test(links_that_no_configuration_keeps_apart_forbid_next_to_nothing),
      cmocka_unit_test(the_clearance_of_pairs_that_are_mostly_far_apart_is_the_whole_one),
      cmocka_unit_test(links_with_no_shape_between_are_kept_apart_if_they_can_be),
      cmocka_unit_test(clearances_forbid_less_where_pieces_stand_for_meshes),
      cmocka_unit_test(the_least_clearance_of_a_pair_forbids_little_where_pieces_stand_for_meshes),
      cmocka_unit_test(the_pair_that_forbids_most_is_named),
      cmocka_unit_test(links_of_a_long_chain_keep_more_than_those_of_a_short_one),
      cmocka_unit_test(ignored_links_form_no_pair),
      cmocka_unit_test(an_srdf_disables_collisions),
      cmocka_unit_test(a_nominal_velocity_that_folds_the_arm_onto_itself_leads_to_no_contact),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
