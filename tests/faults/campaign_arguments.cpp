#include <sys/wait.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <thread>

#include "host/campaign/csv.h"
#include "tests/support/check.h"
#include "tests/support/process.h"
#include "tests/support/scratch.h"

using namespace sidestep::campaign;
using sidestep::test::kill_processes;
using sidestep::test::message_of;
using sidestep::test::one_line_with;
using sidestep::test::Process;
using sidestep::test::replaced;
using sidestep::test::scratch_file;
using sidestep::test::scratch_folder;
using sidestep::test::text_of;

namespace {

struct Answer {
  int code;
  std::string out, err;
};

Answer campaign(const std::string& arguments) {
  const std::string out = scratch_folder() + "/out", err = scratch_folder() + "/err";
  const int status = std::system(("build/campaign " + arguments + " >" + out + " 2>" + err).c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, text_of(out), text_of(err)};
}

/// Arguments of a program that runs beside the test.
std::vector<std::string> beside(const std::string& arguments) {
  std::vector<std::string> words{"build/campaign"};
  std::istringstream stream(arguments);
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

constexpr double kLimit_s = 120.0;  // also for a busy machine

template <typename Condition>
void wait_for(const char* what, const Condition& condition) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(kLimit_s);
  while (!condition()) {
    check(std::chrono::steady_clock::now() < end, "%s: not after %g s", what, kLimit_s);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

/// Number of rows in the file of a run; 0 before there is one.
size_t rows_in(const std::string& file) {
  return std::filesystem::exists(file) ? read_interrupted_csv(file).size() : 0;
}

void bad_arguments_end_with_code_2(void**) {
  for (const char* arguments : {"--family slow",
                                "--count 0",
                                "--count -3",
                                "--count x",
                                "--seed -1",
                                "--law none",
                                "--shard 0/4",
                                "--shard 5/4",
                                "--shard 1/4x",
                                "--shard one",
                                "--shard 1/",
                                "--jobs 0",
                                "--config nowhere.yaml",
                                "--csv /nowhere/at/all.csv --count 1",
                                "--resume --count 1",
                                "--replay walk-by:1",
                                "--replay moving",
                                "--replay slow:1",
                                "--replay moving:1 --output /nowhere/at/all.yaml",
                                "--search slow",
                                "--search rest --obstacles 6",
                                "--search rest --fastest nan",
                                "--search rest --law plain",
                                "--search rest --config firmware/config/panda.yaml",
                                "--search rest --count 1 --csv /nowhere/at/all.csv",
                                "--search rest --count 1 --no-velocities",
                                "--problems nowhere --no-velocities",
                                "--search rest --count 1 --ahead 0.1",
                                "--family moving --ahead -0.1",
                                "--family moving --ahead nan",
                                "--family moving --decoys 1",
                                "--family boxes --decoys 1",
                                "--family boxes@posture --law paper",
                                "--family boxes@posture --law plain",
                                "--search rest --count 1 --decoys 1",
                                "--scene nowhere.yaml",
                                "--scene firmware/config/lwa3.yaml",
                                "--family moving --count 1 --law plain --mover",
                                "--search rest --count 1 --resume",
                                "--problems tests/data/problems --resume",
                                "--nonsense",
                                "merge",
                                "merge /nowhere/at/all.csv",
                                "merge ."}) {
    const Answer answer = campaign(arguments);
    check(answer.code == 2, "%s: code %d", arguments, answer.code);
    check(answer.out.empty() && !answer.err.empty(), "%s: out '%s', err '%s'", arguments, answer.out.c_str(),
          answer.err.c_str());
  }
}

void options_without_effect_are_refused_before_anything_is_written(void**) {
  const std::string file = scratch_file("kept.csv", "findings of many hours\n");
  const std::string rows = scratch_folder() + "/rows.csv";
  campaign("--family moving --count 1 --law plain --quiet --csv " + rows);
  const struct {
    std::string arguments, option;
  } cases[] = {
      {"--search rest --count 1 --csv " + file + " --resume", "--resume"},
      {"--search rest --count 1 --csv " + file + " --decoys 3", "--decoys"},
      {"--problems tests/data/problems --config firmware/config/panda.yaml --csv " + file + " --resume", "--resume"},
      {"merge --csv " + file + " --no-velocities " + rows, "--no-velocities"},
      {"merge --csv " + file + " --resume " + rows, "--resume"},
  };
  for (const auto& one : cases) {
    const Answer answer = campaign(one.arguments);
    check(answer.code == 2 && answer.out.empty(), "%s: code %d", one.arguments.c_str(), answer.code);
    check(one_line_with(answer.err.substr(0, answer.err.size() - 1), {one.option + ": has no effect here"}), "%s: %s",
          one.arguments.c_str(), answer.err.c_str());
    check(text_of(file) == "findings of many hours\n", "%s: the file was changed", one.arguments.c_str());
  }
}

void a_valid_run_ends_with_code_0(void**) {
  const std::string file = scratch_folder() + "/good.csv";
  const Answer run = campaign("--family moving --count 3 --law plain --quiet --csv " + file);
  check(run.code == 0 && run.err.empty(), "code %d: %s", run.code, run.err.c_str());
  const Answer merged = campaign("merge " + file);
  check(merged.code == 0 && merged.out == run.out, "%s\n%s", merged.out.c_str(), run.out.c_str());
}

void shards_merge_to_the_table_of_one_run(void**) {
  const std::string run = "--family erratic --count 7 --law plain --quiet --no-cpu --smoothness",
                    dir = scratch_folder();
  const Answer whole = campaign(run + " --jobs 3");
  campaign(run + " --jobs 1 --shard 1/2 --csv " + dir + "/1.csv");
  campaign(run + " --jobs 2 --shard 2/2 --csv " + dir + "/2.csv");
  const Answer merged = campaign("merge --no-cpu --smoothness " + dir + "/2.csv " + dir + "/1.csv");
  check(merged.code == 0 && merged.out == whole.out, "%s\n%s", merged.out.c_str(), whole.out.c_str());
}

void merging_a_scene_twice_is_refused(void**) {
  const std::string file = scratch_folder() + "/twin.csv";
  campaign("--family moving --count 2 --law plain --quiet --csv " + file);
  const Answer merged = campaign("merge " + file + " " + file);
  check(merged.code == 2 && merged.out.empty(), "code %d", merged.code);
}

void an_interrupted_run_keeps_its_finished_rows(void**) {
  const std::string file = scratch_folder() + "/cut.csv";
  Process run(beside("--family moving --count 100000 --law plain --quiet --csv " + file));
  wait_for("a row", [&] { return rows_in(file) > 0; });
  run.signal(SIGINT);
  check(run.wait(kLimit_s) == 130, "code %d", run.wait(0.0));
  check(run.output().find("interrupted after") != std::string::npos, "%s", run.output().c_str());
  const std::vector<Row> rows = read_csv(file);
  check(!rows.empty() && rows.size() < 100'000, "%zu rows", rows.size());
}

void a_killed_run_is_resumed_and_gives_the_table_of_a_whole_one(void**) {
  const std::string file = scratch_folder() + "/killed.csv";
  const std::string run = "--family moving --count 300 --law plain --quiet --no-cpu --jobs 1";
  const Answer whole = campaign(run);
  Process killed(beside(run + " --csv " + file));
  wait_for("rows", [&] { return rows_in(file) >= 5; });
  killed.signal(SIGKILL);
  check(killed.wait(kLimit_s) == 128 + SIGKILL, "the run ended before it was killed");
  check(rows_in(file) < 300, "%zu rows", rows_in(file));
  const Answer resumed = campaign(run + " --resume --csv " + file);
  check(resumed.code == 0 && resumed.out == whole.out, "%s\n%s", resumed.out.c_str(), resumed.err.c_str());
  const Answer merged = campaign("merge --no-cpu " + file);
  check(merged.out == whole.out, "%s", merged.out.c_str());
}

/// The disk is full, as it were: files may have 2 kB.
void a_resumed_run_that_cannot_write_keeps_the_rows(void**) {
  const std::string file = scratch_folder() + "/full.csv", run = "--family moving --law plain --quiet --jobs 1 --csv ";
  campaign(run + file + " --count 20");
  const std::string before = text_of(file);
  check(before.size() > 4096, "%zu bytes", before.size());
  const std::string resume = "build/campaign " + run + file + " --count 30 --resume >/dev/null 2>&1";
  check(std::system(("ulimit -f 4; " + resume).c_str()) != 0, "the limit has no effect");
  check(text_of(file) == before, "%zu bytes are left of %zu", text_of(file).size(), before.size());
  check(std::system(resume.c_str()) == 0 && rows_in(file) == 30, "%zu rows", rows_in(file));
}

void a_run_with_other_arguments_is_not_resumed(void**) {
  const std::string file = scratch_folder() + "/first.csv", run = " --count 2 --quiet --csv " + file;
  campaign("--family moving --law plain" + run);
  const std::string before = text_of(file);
  for (const char* other : {"--family moving --law sidestep", "--family fast --law plain",
                            "--family moving --law plain --seed 2", "--family moving --law plain --count 1 --jobs 1",
                            "--family moving --law plain --config firmware/config/panda.yaml"}) {
    const Answer answer = campaign(other + std::string(" --resume") +
                                   (std::string(other).find("--count") != std::string::npos ? " --csv " + file : run));
    check(answer.code == 2 && answer.out.empty(), "%s: code %d", other, answer.code);
    check(one_line_with(answer.err.substr(0, answer.err.find('\n')), {"first.csv"}), "%s", answer.err.c_str());
    check(text_of(file) == before, "%s: the file was changed", other);
  }
}

void a_finding_of_a_search_runs_again_from_its_line(void**) {
  const std::string csv = scratch_folder() + "/findings.csv";
  const Answer search = campaign("--search track --law paper --obstacles 1 --count 2 --quiet --csv " + csv);
  check(search.code == 0 && search.err.empty(), "code %d: %s", search.code, search.err.c_str());
  const size_t begin = search.out.find("\n{");
  check(begin != std::string::npos, "no finding: %s", search.out.c_str());
  const std::string scene = search.out.substr(begin + 1, search.out.find('\n', begin + 1) - begin - 1);
  check(text_of(csv).find('"' + scene + '"') != std::string::npos, "the file lacks the scene");
  const Answer again = campaign("--law paper --scene " + scratch_file("scene.yaml", scene));
  check(again.code == 0 && search.out.find(again.out) != std::string::npos, "%s", again.out.c_str());
}

void an_interrupted_search_prints_its_table(void**) {
  const std::string file = scratch_folder() + "/search.csv";
  Process search(beside("--search rest --count 1000000 --quiet --csv " + file));
  wait_for("the search", [&] { return std::filesystem::exists(file); });
  search.signal(SIGINT);
  check(search.wait(kLimit_s) == 130, "code %d", search.wait(0.0));
  for (const char* part : {"interrupted after", "rest     sidestep"})
    check(search.output().find(part) != std::string::npos, "%s", search.output().c_str());
}

/// A folder with copies of a problem, and the options that play them.
std::string problems(int copies) {
  const std::filesystem::path folder = scratch_folder() + "/problems/copies";
  std::filesystem::create_directories(folder);
  for (int k = 1; k <= copies; ++k)
    for (const char* kind : {"scene", "request"})
      std::filesystem::copy_file(std::string("tests/data/problems/under-table/") + kind + "0001.yaml",
                                 folder / (kind + std::to_string(1000 + k) + ".yaml"),
                                 std::filesystem::copy_options::overwrite_existing);
  return "--problems " + folder.string() + " --config firmware/config/panda.yaml --jobs 1";
}

void problems_are_not_played_if_the_results_cannot_be_written(void**) {
  const Answer answer = campaign(problems(1) + " --mover --quiet --csv /nowhere/at/all.csv");
  check(answer.code == 2 && answer.out.empty(), "code %d: %s", answer.code, answer.out.c_str());
  check(one_line_with(answer.err.substr(0, answer.err.size() - 1), {"/nowhere/at/all.csv"}), "%s", answer.err.c_str());
}

void interrupted_problems_are_printed_and_written(void**) {
  const std::string file = scratch_folder() + "/problems.csv";
  Process play(beside(problems(50) + " --csv " + file));
  wait_for("a tenth", [&] { return play.output().find("5/50") != std::string::npos; });
  play.signal(SIGINT);
  check(play.wait(kLimit_s) == 130, "code %d", play.wait(0.0));
  for (const char* part : {"interrupted after", "of 50 problems", "copies  ", "All, with 95 % confidence"})
    check(play.output().find(part) != std::string::npos, "'%s': %s", part, play.output().c_str());
  const std::string rows = text_of(file);
  const auto lines = std::count(rows.begin(), rows.end(), '\n');
  check(lines > 5 && lines < 50 && rows.find("\ncopies,1005,") != std::string::npos, "%s", rows.c_str());
}

void problems_that_are_interrupted_while_movers_are_searched_end_with_code_130(void**) {
  const std::string file = scratch_folder() + "/movers.csv";
  Process play(beside(problems(50) + " --mover --quiet --csv " + file));
  wait_for("the search", [&] { return std::filesystem::exists(file); });
  play.signal(SIGINT);
  check(play.wait(kLimit_s) == 130, "code %d: %s", play.wait(0.0), play.output().c_str());
  check(one_line_with(play.output().substr(0, play.output().size() - 1), {"interrupted", "of 50 problems"}), "%s",
        play.output().c_str());
}

void a_second_signal_ends_a_run_at_once(void**) {
  const std::string file = scratch_folder() + "/twice.csv";
  Process run(beside("--family two-people --count 2 --jobs 1 --quiet --csv " + file));
  wait_for("the run", [&] { return std::filesystem::exists(file); });
  run.signal(SIGTERM);
  std::this_thread::sleep_for(std::chrono::milliseconds(400));
  run.signal(SIGTERM);
  check(run.wait(kLimit_s) == 128 + SIGTERM, "code %d: %s", run.wait(0.0), run.output().c_str());
}

/// As `timeout` sends it, to the program and to its group.
void a_signal_that_is_sent_twice_at_once_counts_once(void**) {
  const std::string file = scratch_folder() + "/group.csv";
  Process run(beside("--family two-people --count 1000 --jobs 1 --quiet --csv " + file));
  wait_for("the run", [&] { return std::filesystem::exists(file); });
  run.signal(SIGTERM);
  run.signal(SIGTERM);
  check(run.wait(kLimit_s) == 130, "code %d: %s", run.wait(0.0), run.output().c_str());
}

void hostile_files_are_refused_with_one_line(void**) {
  const std::string file = scratch_folder() + "/whole.csv";
  write_csv(file, {{&family_named("moving"), "paper", 5, {}}});
  const std::string whole = text_of(file);
  const std::string row = whole.substr(whole.find('\n') + 1);
  const std::string broken[] = {"",
                                "\n\n",
                                std::string(100'000, '\0'),
                                std::string(1'000'000, 'x'),
                                replaced(whole, "family", "Family"),
                                replaced(whole, "moving,", "slow,"),
                                replaced(whole, ",5,", ",-5,"),
                                replaced(whole, ",5,", ",5.5,"),
                                replaced(whole, ",5,", ",99999999999999999999,"),
                                replaced(whole, ",5,", ","),
                                replaced(whole, ",5,", ",5,0,"),
                                replaced(whole, ",5,", ",5,x"),
                                replaced(whole, ",5,", ",5,1e999,"),
                                whole.substr(0, whole.size() / 2),
                                whole.substr(0, whole.size() - row.size() / 2),
                                whole.substr(0, whole.size() - 1),
                                whole + "\n"};
  for (const std::string& text : broken) {
    const std::string bad = scratch_file("bad.csv", text);
    const std::string message = message_of([&] { read_csv(bad); });
    check(one_line_with(message, {"bad.csv"}), "%s: %s", text.substr(0, 200).c_str(), message.c_str());
    check(message.size() < 1'000, "%zu characters", message.size());
  }
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(bad_arguments_end_with_code_2),
      cmocka_unit_test(options_without_effect_are_refused_before_anything_is_written),
      cmocka_unit_test(a_valid_run_ends_with_code_0),
      cmocka_unit_test(shards_merge_to_the_table_of_one_run),
      cmocka_unit_test(merging_a_scene_twice_is_refused),
      cmocka_unit_test_teardown(an_interrupted_run_keeps_its_finished_rows, kill_processes),
      cmocka_unit_test_teardown(a_killed_run_is_resumed_and_gives_the_table_of_a_whole_one, kill_processes),
      cmocka_unit_test(a_resumed_run_that_cannot_write_keeps_the_rows),
      cmocka_unit_test(a_run_with_other_arguments_is_not_resumed),
      cmocka_unit_test(a_finding_of_a_search_runs_again_from_its_line),
      cmocka_unit_test_teardown(an_interrupted_search_prints_its_table, kill_processes),
      cmocka_unit_test(problems_are_not_played_if_the_results_cannot_be_written),
      cmocka_unit_test_teardown(interrupted_problems_are_printed_and_written, kill_processes),
      cmocka_unit_test_teardown(problems_that_are_interrupted_while_movers_are_searched_end_with_code_130,
                                kill_processes),
      cmocka_unit_test_teardown(a_second_signal_ends_a_run_at_once, kill_processes),
      cmocka_unit_test_teardown(a_signal_that_is_sent_twice_at_once_counts_once, kill_processes),
      cmocka_unit_test(hostile_files_are_refused_with_one_line),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
