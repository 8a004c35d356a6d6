#pragma once

#include "host/campaign/runner.h"

namespace sidestep::campaign {

/// The trials of a run that are in its CSV file already, and the tasks that are not.
struct Resumed {
  std::vector<Row> rows;
  std::vector<Task> rest;
};

/// Reads the rows of an interrupted run with these tasks; a last line without end is ignored. Without a file, no row.
/// Throws std::runtime_error, one line, if the file has a row of another law or task, or if the trial of its first row,
/// run again, has another result (CPU times excepted): then arm, configuration or version is another.
Resumed resume(const std::string& file, const std::vector<Task>& tasks, const TestedController& tested);

}  // namespace sidestep::campaign
