#include "host/campaign/table.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>

#include "host/campaign/runner.h"
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
    check(std::isnan(read_back[i].metrics.witness_path_rad) == std::isnan(rows[i].metrics.witness_path_rad), "row %zu",
          i);
  }
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
      cmocka_unit_test(merged_shards_give_the_table_of_the_whole_run),
      cmocka_unit_test(a_duplicate_trial_is_rejected_by_name),
      cmocka_unit_test(statistics_of_a_known_sample),
      cmocka_unit_test(links_that_touch_each_other_are_a_contact),
      cmocka_unit_test(threads_and_shards_do_not_change_the_results),
      cmocka_unit_test(a_stopped_run_starts_no_trial),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
