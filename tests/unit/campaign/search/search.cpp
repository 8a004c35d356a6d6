#include "host/campaign/search/search.h"

#include "firmware/io/config/config.h"
#include "host/campaign/search/finding_file.h"
#include "host/campaign/search/search_report.h"
#include "tests/support/capsule_truth.h"
#include "tests/support/check.h"
#include "tests/support/command_check.h"
#include "tests/support/scratch.h"

using namespace sidestep::campaign;
using sidestep::Model;
using sidestep::test::message_of;
using sidestep::test::one_line_with;
using sidestep::test::replaced;
using sidestep::test::scratch_file;

namespace {

constexpr bool kShield = true;

Model model(bool shield) {
  Model loaded = sidestep::load_config("firmware/config/lwa3.yaml", {}).model;
  loaded.settings.foresight.enabled = false;
  loaded.settings.shield.enabled = shield;
  return loaded;
}

SearchResult search_with(const Model& tested, SearchFamily family, const SearchPlan& plan, int jobs = 1) {
  const std::atomic<bool> stop{false};
  return search({family, 2, 0.5, tested.arm.limits}, tested, plan, jobs, true, stop);
}

/// A search in which the arm, without its shield, is touched in many scenes.
const SearchResult& unshielded() {
  static const SearchResult result = search_with(model(!kShield), SearchFamily::kRest, {1, 12});
  return result;
}

void a_controller_without_shield_touches_obstacles_that_a_witness_avoids(void**) {
  for (const SearchFamily family : {SearchFamily::kRest, SearchFamily::kTrack}) {
    const SearchResult result = search_with(model(!kShield), family, {1, 12});
    check(result.runs == 12, "%d runs", result.runs);
    check(result.contacts >= 6 && !result.findings.empty(), "%d contacts, %zu findings", result.contacts,
          result.findings.size());
    check(result.least_clearance_m < 0.0, "%g m", result.least_clearance_m);
    for (const Finding& finding : result.findings)
      check(finding.scene.family == family && finding.closest.clearance_m < 0.0, "%g m", finding.closest.clearance_m);
  }
}

void the_shield_avoids_these_contacts(void**) {
  const Model shielded = model(kShield);
  for (const Finding& finding : unshielded().findings) {
    const auto controller = make_controller(&shielded, lwa3_arm(), shielded.arm.limits);
    check(run_search_trial(finding.scene, *controller).clearance_m > 0.0, "run %d", finding.run);
  }
}

/// With FCL's distances on the URDF and the check that commands of the controller must pass.
void every_witness_keeps_limits_and_clearance(void**) {
  const Limits limits = model(kShield).arm.limits;
  sidestep::test::CapsuleTruth truth;
  for (const Finding& finding : unshielded().findings) {
    const WitnessPath& path = finding.witness;
    sidestep::test::CommandCheck check_of(limits, 0.01);
    check_near(path.at(0.0), finding.scene.start_rad, 0.0);
    check_of.begin(path.at(0.0), Joints::Zero(7));
    check_of.allow_position_correction();
    for (double t_s = 0.01; t_s <= finding.scene.duration_s(); t_s += 0.01) {
      const Joints rate_radps = (path.at(t_s) - path.at(t_s - 0.01)) / 0.01;
      check_of.feed(path.at(t_s), rate_radps);
      const double clearance_m = truth.clearance_m(finding.scene, path.at(t_s), t_s);
      check(clearance_m >= 0.01 - 1e-6 && clearance_m >= finding.witness_clearance_m - 1e-6, "%g m at %g s",
            clearance_m, t_s);
      check(lwa3_arm().self_clearance(lwa3_arm().pose(path.at(t_s))) >= 0.02, "self-collision at %g s", t_s);
    }
    check(check_of.violation().empty(), "%s", check_of.violation().c_str());
  }
}

void a_witness_keeps_its_clearance_between_the_coarse_checks_of_the_draws_too(void**) {
  const Limits limits = model(kShield).arm.limits;
  int found = 0;
  for (uint64_t seed = 0; seed < 20; ++seed) {
    for (const Finding& finding : unshielded().findings) {
      Random random("test", seed);
      const auto witness = find_witness(random, finding.scene, limits, 100);
      if (!witness) continue;
      ++found;
      const double least_m = path_clearance_m(finding.scene, *witness, 0.002);
      check(least_m >= 0.01, "%g m", least_m);
    }
  }
  check(found > 40, "only %d witnesses", found);
}

void a_path_that_proves_nothing_is_recognised(void**) {
  const Finding& finding = unshielded().findings.front();
  const Limits limits = model(kShield).arm.limits;
  check(proven_clearance_m(finding.scene, finding.witness, limits) >= 0.01, "the witness is a proof");
  const auto refuted = [&](const char* what, const WitnessPath& path) {
    check(proven_clearance_m(finding.scene, path, limits) < 0.0, "%s", what);
  };
  WitnessPath path = finding.witness;
  path.segments[0].duration_s *= 0.8;
  refuted("too fast", path);
  path = finding.witness;
  path.start_rad[0] += 1e-3;
  refuted("begins elsewhere", path);
  path = finding.witness;
  path.segments[0].knot_rad[1] = 1.98;
  path.segments[0].duration_s += 10.0;
  refuted("beyond a joint limit", path);
  path = finding.witness;
  path.segments.push_back(path.segments.back());
  refuted("two segments at once", path);
  path = finding.witness;
  path.segments.clear();
  refuted("the arm stays", path);
}

void the_result_depends_on_neither_threads_nor_shards(void**) {
  const Model tested = model(kShield);
  const int runs = kChainRuns + 10;
  const SearchResult whole = search_with(tested, SearchFamily::kRest, {3, runs}, 2);
  SearchResult parts = search_with(tested, SearchFamily::kRest, {3, runs, 1, 2});
  const SearchResult second = search_with(tested, SearchFamily::kRest, {3, runs, 2, 2});
  check(parts.runs == kChainRuns && second.runs == 10 && whole.runs == runs, "%d + %d", parts.runs, second.runs);
  check(whole.contacts == parts.contacts + second.contacts, "%d contacts", whole.contacts);
  check(whole.least_clearance_m == std::min(parts.least_clearance_m, second.least_clearance_m), "%.17g m",
        whole.least_clearance_m);
}

void mutations_bring_the_obstacles_nearer(void**) {
  const Model tested = model(kShield);
  const SearchResult pool = search_with(tested, SearchFamily::kRest, {4, 8});
  const SearchResult chain = search_with(tested, SearchFamily::kRest, {4, kChainRuns});
  check(chain.least_clearance_m < pool.least_clearance_m, "%g m and %g m", chain.least_clearance_m,
        pool.least_clearance_m);
}

void a_search_that_is_stopped_keeps_what_it_has(void**) {
  const Model tested = model(kShield);
  const std::atomic<bool> stop{true};
  const SearchResult result = search({SearchFamily::kRest, 1, 0.5, tested.arm.limits}, tested, {1, 100}, 1, true, stop);
  check(result.runs == 0 && result.findings.empty(), "%d runs", result.runs);
}

void a_finding_in_a_file_runs_as_it_did_in_the_search(void**) {
  const Model tested = model(!kShield);
  for (const Finding& finding : unshielded().findings) {
    const ProvenScene read =
        load_proven_scene(scratch_file("scene.yaml", to_yaml(finding.scene, finding.witness) + "\n"));
    const auto controller = make_controller(&tested, lwa3_arm(), tested.arm.limits);
    const ClosestApproach closest = run_search_trial(read.scene, *controller);
    check(closest.clearance_m == finding.closest.clearance_m && closest.t_s == finding.closest.t_s, "%.17g m",
          closest.clearance_m);
    check(proven_clearance_m(read.scene, read.witness, tested.arm.limits) == finding.witness_clearance_m, "%.17g m",
          finding.witness_clearance_m);
  }
}

void damaged_files_are_refused_with_one_line(void**) {
  const Finding& finding = unshielded().findings.front();
  const std::string whole = to_yaml(finding.scene, finding.witness);
  const std::string damaged[] = {"",
                                 "{}",
                                 whole.substr(0, whole.size() / 2),
                                 replaced(whole, "family: rest", "family: sleep"),
                                 replaced(whole, "start_rad: [", "start_rad: [0, "),
                                 replaced(whole, "velocity_mps: [", "velocity_mps: [nan, "),
                                 replaced(whole, "crossing_s: ", "crossing_s: -"),
                                 replaced(whole, "radius_m: ", "radius: "),
                                 replaced(whole, "obstacles: [", "obstacle: [")};
  for (const std::string& text : damaged) {
    const std::string message = message_of([&] { load_proven_scene(scratch_file("bad.yaml", text)); });
    check(one_line_with(message, {"bad.yaml"}), "%s: %s", text.substr(0, 100).c_str(), message.c_str());
  }
}

void the_report_has_the_counts_and_every_scene(void**) {
  const SearchResult& result = unshielded();
  const std::string report = search_report({SearchFamily::kRest, 2, 0.5, {}}, "sidestep", result);
  check(report.find("rest") != std::string::npos && report.find(" 12 ") != std::string::npos, "%s", report.c_str());
  for (const Finding& finding : result.findings)
    check(report.find(to_yaml(finding.scene, finding.witness)) != std::string::npos, "run %d", finding.run);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(a_controller_without_shield_touches_obstacles_that_a_witness_avoids),
      cmocka_unit_test(the_shield_avoids_these_contacts),
      cmocka_unit_test(every_witness_keeps_limits_and_clearance),
      cmocka_unit_test(a_witness_keeps_its_clearance_between_the_coarse_checks_of_the_draws_too),
      cmocka_unit_test(a_path_that_proves_nothing_is_recognised),
      cmocka_unit_test(the_result_depends_on_neither_threads_nor_shards),
      cmocka_unit_test(mutations_bring_the_obstacles_nearer),
      cmocka_unit_test(a_search_that_is_stopped_keeps_what_it_has),
      cmocka_unit_test(a_finding_in_a_file_runs_as_it_did_in_the_search),
      cmocka_unit_test(damaged_files_are_refused_with_one_line),
      cmocka_unit_test(the_report_has_the_counts_and_every_scene),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
