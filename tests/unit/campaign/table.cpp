#include "host/campaign/table.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>

#include "host/campaign/resume.h"
#include "host/campaign/statistics.h"
#include "tests/support/check.h"
#include "tests/support/scratch.h"

using namespace sidestep::campaign;
using sidestep::test::scratch_folder;

namespace {

/// Trials with random metrics that need all digits.
std::vector<Row> some_rows() {
  std::mt19937 engine(1);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  std::vector<Row> rows;
  for (const char* law : {"sidestep", "paper"}) {
    for (const Family& family : families()) {
      for (uint64_t seed = 0; seed < 30; ++seed) {
        Row row{&family, law, 1'000'000 + seed, {}};
        row.metrics.clearance_m = any(engine);
        row.metrics.final_error_m = 0.02 * std::abs(any(engine));
        row.metrics.arrival_s = 5.0 + any(engine);
        row.metrics.witness_arrival_s = 1.0 / 3.0;
        row.metrics.path_rad = std::exp(any(engine));
        row.metrics.witness_path_rad = seed % 7 == 0 ? TrialMetrics::kNone : 0.1;
        row.metrics.jerk_radps3 = 1e300 * any(engine);
        row.metrics.cpu_mean_s = 1e-6 * any(engine);
        if (family.has_people()) row.metrics.rest_clearance_m = any(engine);
        if (family.has_furniture()) row.metrics.final_turn_rad = any(engine);
        if (family.posture) row.metrics.final_posture_rad = any(engine);
        if (family.has_people()) row.metrics.seen_way_out = seed % 2 == 0 ? 1.0 : 0.0;
        rows.push_back(row);
      }
    }
  }
  return rows;
}

std::string all_tables(std::vector<Row> rows) {
  sort_rows(rows);
  return tables(rows, true) + smoothness_table(rows);
}

void a_csv_file_preserves_every_bit(void**) {
  const std::string file = scratch_folder() + "/trials.csv";
  const std::vector<Row> rows = some_rows();
  write_csv(file, rows);
  const std::vector<Row> read_back = read_csv(file);
  check(read_back.size() == rows.size(), "%zu rows", read_back.size());
  for (size_t i = 0; i < rows.size(); ++i) {
    check(read_back[i].family == rows[i].family && read_back[i].law == rows[i].law && read_back[i].seed == rows[i].seed,
          "row %zu", i);
    check(std::memcmp(&read_back[i].metrics.clearance_m, &rows[i].metrics.clearance_m, sizeof(double)) == 0, "row %zu",
          i);
    check(read_back[i].metrics.jerk_radps3 == rows[i].metrics.jerk_radps3, "row %zu", i);
    check(same_result(read_back[i], rows[i]), "row %zu", i);
    check(std::isnan(read_back[i].metrics.witness_path_rad) == std::isnan(rows[i].metrics.witness_path_rad), "row %zu",
          i);
  }
}

void only_files_with_people_furniture_or_postures_have_their_columns(void**) {
  const std::string file = scratch_folder() + "/columns.csv";
  const auto has_columns = [&](const char* family, const char* column) {
    write_csv(file, {{&family_named(family), "paper", 5, {}}});
    const std::vector<Row> read_back = read_csv(file);
    check(read_back.size() == 1 && read_back[0].family == &family_named(family), "%s", family);
    return sidestep::test::text_of(file).find(column) != std::string::npos;
  };
  for (const char* column : {"way_out", "goal_clearance_m"}) assert_false(has_columns("moving", column));
  assert_true(has_columns("walk-by@camera", "way_out"));
  assert_false(has_columns("walk-by@camera", "goal_clearance_m"));
  assert_true(has_columns("shelf", "goal_clearance_m"));
  assert_false(has_columns("shelf", "way_out"));
  assert_true(has_columns("boxes@posture", "final_posture_rad"));
  assert_false(has_columns("boxes", "final_posture_rad"));
}

void rows_of_a_killed_writer_are_read_without_its_unfinished_line(void**) {
  const std::string file = scratch_folder() + "/killed.csv";
  write_csv(file, some_rows());
  const std::string whole = sidestep::test::text_of(file);
  const std::string cut = sidestep::test::scratch_file("cut.csv", whole.substr(0, whole.size() - 20));
  const std::vector<Row> rows = read_interrupted_csv(cut);
  check(rows.size() == some_rows().size() - 1 && same_result(rows.back(), some_rows()[rows.size() - 1]), "%zu rows",
        rows.size());
  check(read_interrupted_csv(sidestep::test::scratch_file("head.csv", "family,la")).empty(), "a header in part");
  check(sidestep::test::one_line_with(
            sidestep::test::message_of([] { read_interrupted_csv(sidestep::test::scratch_file("no.csv", "a,b\n")); }),
            {"no.csv"}),
        "another file");
}

void a_run_goes_on_where_it_was_interrupted(void**) {
  std::vector<Task> tasks;
  for (uint64_t k = 0; k < 6; ++k) tasks.push_back({&family_named("moving"), scene_seed(3, k)});
  const std::atomic<bool> stop{false};
  const TestedController plain{"plain", nullptr};
  const std::vector<Row> whole = run(tasks, plain, 1, true, stop);
  const std::string file = scratch_folder() + "/resume.csv";
  write_csv(file, {whole[4], whole[1]});
  const Resumed resumed = resume(file, tasks, plain);
  check(resumed.rows.size() == 2 && resumed.rest.size() == 4, "%zu rows, %zu tasks", resumed.rows.size(),
        resumed.rest.size());
  for (const size_t i : {0u, 1u, 2u, 3u}) check(resumed.rest[i].seed == tasks[i + (i > 0) + (i > 2)].seed, "%zu", i);
  check(resume(scratch_folder() + "/none.csv", tasks, plain).rest.size() == tasks.size(), "no file yet");
}

void a_file_of_another_run_is_not_resumed(void**) {
  const std::vector<Task> tasks{{&family_named("moving"), 5}};
  const std::atomic<bool> stop{false};
  const TestedController plain{"plain", nullptr};
  const std::string file = scratch_folder() + "/other.csv";
  const auto refusal = [&](const Row& row) {
    write_csv(file, {row});
    return sidestep::test::message_of([&] { resume(file, tasks, plain); });
  };
  const Row row = run(tasks, plain, 1, true, stop).front();
  check(refusal(row).empty(), "%s", refusal(row).c_str());
  Row law = row, seed = row, result = row;
  law.law = "paper";
  seed.seed = 6;
  result.metrics.path_rad += 1e-12;
  for (const Row& other : {law, seed, result})
    check(sidestep::test::one_line_with(refusal(other), {"other.csv", "moving"}), "%s", refusal(other).c_str());
}

void merged_shards_give_the_table_of_the_whole_run(void**) {
  const std::vector<Row> rows = some_rows();
  std::vector<Row> merged;
  for (const size_t shard : {2u, 0u, 1u}) {
    std::vector<Row> part;
    for (size_t i = shard; i < rows.size(); i += 3) part.push_back(rows[i]);
    const std::string file = scratch_folder() + "/shard.csv";
    write_csv(file, part);
    const std::vector<Row> read = read_csv(file);
    merged.insert(merged.end(), read.begin(), read.end());
  }
  check(all_tables(merged) == all_tables(rows), "\n%s\n%s", all_tables(merged).c_str(), all_tables(rows).c_str());
}

void a_duplicate_trial_is_rejected_by_name(void**) {
  std::vector<Row> rows = some_rows();
  rows.push_back(rows[40]);
  const std::string message = sidestep::test::message_of([&] { sort_rows(rows); });
  check(sidestep::test::one_line_with(message, {"fast", "1000010", "sidestep"}), "%s", message.c_str());
}

Row trial(double clearance_m, double final_error_m, double arrival_s) {
  Row row{&family_named("moving"), "paper", 0, {}};
  row.metrics.clearance_m = clearance_m;
  row.metrics.final_error_m = final_error_m;
  row.metrics.arrival_s = arrival_s;
  row.metrics.witness_arrival_s = 2.0;
  return row;
}

void statistics_of_a_known_sample(void**) {
  const Sample sample{trial(0.02, 0.001, 3.0), trial(-0.01, 0.002, 2.0), trial(0.0, 0.009, 5.0),
                      trial(0.03, 0.010, TrialMetrics::kNone)};
  check_near(percent(sample, touched), 25.0, 0.0);
  check_near(percent(sample, arrived), 75.0, 0.0);
  check_near(percent(sample, succeeded), 50.0, 0.0);
  check_near(least(sample, &TrialMetrics::clearance_m), -0.01, 0.0);
  check_near(mean(successes(sample), &TrialMetrics::arrival_s), 4.0, 0.0);
  check_near(ratio(sample, &TrialMetrics::arrival_s, &TrialMetrics::witness_arrival_s), 2.0, 0.0);
  check_near(largest(sample, &TrialMetrics::arrival_s), 5.0, 0.0);
  check(std::isnan(largest(sample, &TrialMetrics::error_rms_m)), "no trial has it");
}

void confidence_intervals_are_wilsons(void**) {
  const auto check_interval = [](double successes, double trials, double lower, double upper) {
    const Interval interval = wilson_interval(successes, trials);
    check_near(interval.lower, lower, 0.005);
    check_near(interval.upper, upper, 0.005);
  };
  check_interval(0, 10, 0.0, 27.75);  // published values of the score interval
  check_interval(10, 10, 72.25, 100.0);
  check_interval(5, 10, 23.66, 76.34);
  check_interval(81, 263, 25.53, 36.62);  // Newcombe (1998), Statistics in Medicine 17, table I
  check_interval(15, 148, 6.24, 16.05);
  check_interval(0, 20, 0.0, 16.11);
  check_interval(1, 29, 0.61, 17.18);
}

void the_table_prints_shares_with_their_interval(void**) {
  const std::string text = tables({trial(0.02, 0.001, 3.0), trial(-0.01, 0.002, 2.0)}, false);
  check(text.find("50.0 (9.5-90.5)") != std::string::npos, "%s", text.c_str());
}

Row among_people(double clearance_m, double rest_clearance_m, double way_out, double seen_way_out) {
  Row row{&family_named("walk-by"), "sidestep", 0, {}};
  row.metrics.clearance_m = clearance_m;
  row.metrics.rest_clearance_m = rest_clearance_m;
  row.metrics.way_out = way_out;
  row.metrics.seen_way_out = seen_way_out;
  return row;
}

void contacts_with_persons_are_classified(void**) {
  const Row none = among_people(0.02, -0.1, 1, TrialMetrics::kNone), avoidable = among_people(-0.02, 0.3, 1, 0),
            late = among_people(-0.05, -0.1, 1, 1), hopeless = among_people(-0.11, -0.1, 0, 0);
  const Sample sample{none, avoidable, late, hopeless};
  check_near(percent(sample, touched), 75.0, 0.0);
  check_near(percent(sample, touched_avoidably), 50.0, 0.0);
  check_near(percent(sample, touched_avoidably_when_seen), 25.0, 0.0);
  check_near(percent(sample, touched_at_rest), 75.0, 0.0);
  assert_true(touched_deeper_than_at_rest(avoidable) && touched_deeper_than_at_rest(hopeless));
  assert_false(touched_deeper_than_at_rest(none) || touched_deeper_than_at_rest(late));
}

void a_goal_among_furniture_is_reached_in_position_and_orientation(void**) {
  Row turned = trial(0.02, 0.001, 3.0), there = turned;
  turned.metrics.final_turn_rad = 0.06;
  there.metrics.final_turn_rad = 0.04;
  assert_true(arrived(there));
  assert_false(arrived(turned) || succeeded(turned));
}

void a_posture_is_reached_when_every_joint_is_there(void**) {
  Row away = trial(0.02, 0.001, 3.0), there = trial(0.02, 0.02, 3.0);
  away.family = there.family = &family_named("boxes@posture");
  away.metrics.final_posture_rad = 0.011;
  there.metrics.final_posture_rad = 0.009;
  assert_true(arrived(there));
  assert_false(arrived(away));
}

void all_is_without_furniture_and_boxes(void**) {
  for (const Family* family : families_of("all")) assert_false(family->has_furniture() || family->boxes);
  check(families_of("boxes").size() == 1 && !families_of("boxes").front()->posture, "boxes");
  check(families_of("boxes@posture").front()->posture, "boxes@posture");
}

void links_that_touch_each_other_are_a_contact(void**) {
  Row near = trial(0.02, 0.001, 3.0), folded = near;
  near.metrics.self_clearance_m = 0.001;
  folded.metrics.self_clearance_m = 0.0;
  assert_true(succeeded(near) && !touched(near));
  assert_true(touched(folded) && touched_itself(folded) && !succeeded(folded));
}

bool same_except_cpu_time(const Row& a, const Row& b) {
  const TrialMetrics &x = a.metrics, &y = b.metrics;
  return a.family == b.family && a.seed == b.seed && x.clearance_m == y.clearance_m &&
         x.final_error_m == y.final_error_m && x.path_rad == y.path_rad && x.jerk_radps3 == y.jerk_radps3;
}

void threads_and_shards_do_not_change_the_results(void**) {
  std::vector<Task> tasks, odd, even;
  for (const char* family : {"moving", "erratic", "dodge@2"})
    for (uint64_t k = 0; k < 8; ++k) {
      tasks.push_back({&family_named(family), scene_seed(3, k)});
      (k % 2 == 0 ? even : odd).push_back(tasks.back());
    }
  const std::atomic<bool> stop{false};
  const TestedController plain{"plain", nullptr};
  const std::vector<Row> one = run(tasks, plain, 1, true, stop), three = run(tasks, plain, 3, true, stop);
  check(one.size() == tasks.size(), "%zu rows", one.size());
  check(std::equal(one.begin(), one.end(), three.begin(), three.end(), same_except_cpu_time), "three threads");

  std::vector<Row> merged = run(odd, plain, 1, true, stop), whole = one;
  const std::vector<Row> rest = run(even, plain, 2, true, stop);
  merged.insert(merged.end(), rest.begin(), rest.end());
  sort_rows(merged);
  sort_rows(whole);
  check(std::equal(whole.begin(), whole.end(), merged.begin(), merged.end(), same_except_cpu_time), "two shards");
}

void a_stopped_run_starts_no_trial(void**) {
  const std::atomic<bool> stop{true};
  const std::vector<Task> tasks(1'000, Task{&family_named("moving"), 1});
  check(run(tasks, {"plain", nullptr}, 2, true, stop).empty(), "a trial was started");
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(a_csv_file_preserves_every_bit),
      cmocka_unit_test(only_files_with_people_furniture_or_postures_have_their_columns),
      cmocka_unit_test(rows_of_a_killed_writer_are_read_without_its_unfinished_line),
      cmocka_unit_test(merged_shards_give_the_table_of_the_whole_run),
      cmocka_unit_test(a_duplicate_trial_is_rejected_by_name),
      cmocka_unit_test(a_run_goes_on_where_it_was_interrupted),
      cmocka_unit_test(a_file_of_another_run_is_not_resumed),
      cmocka_unit_test(statistics_of_a_known_sample),
      cmocka_unit_test(confidence_intervals_are_wilsons),
      cmocka_unit_test(the_table_prints_shares_with_their_interval),
      cmocka_unit_test(contacts_with_persons_are_classified),
      cmocka_unit_test(a_goal_among_furniture_is_reached_in_position_and_orientation),
      cmocka_unit_test(a_posture_is_reached_when_every_joint_is_there),
      cmocka_unit_test(all_is_without_furniture_and_boxes),
      cmocka_unit_test(links_that_touch_each_other_are_a_contact),
      cmocka_unit_test(threads_and_shards_do_not_change_the_results),
      cmocka_unit_test(a_stopped_run_starts_no_trial),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
