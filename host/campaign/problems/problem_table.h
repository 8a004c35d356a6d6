#pragma once

#include "host/campaign/problems/problem_trial.h"

namespace sidestep::campaign {

/// A line for each kind of problem and one for all, and below what planners for static scenes report. At least one
/// result.
std::string problem_table(const std::vector<ProblemResult>& results);

/// A row for each result. Throws std::runtime_error, one line, if the file cannot be written.
void write_problem_csv(const std::string& file, const std::vector<ProblemResult>& results);

}  // namespace sidestep::campaign
