#pragma once

#include "host/campaign/csv.h"

namespace sidestep::campaign {

/// All trials of one law in one family, by seed.
using Sample = std::vector<Row>;

/// Sorted rows, cut where law or family changes.
std::vector<Sample> samples(const std::vector<Row>& rows);

bool touched(const Row& row);
/// The tool is at the target at the end: within 10 mm; back within 5 mm after a dodge.
bool arrived(const Row& row);
bool succeeded(const Row& row);

Sample successes(const Sample& sample);

double percent(const Sample& sample, bool (*holds)(const Row&));

/// Over the trials that have the value; NaN if none has.
double mean(const Sample& sample, double Outcome::*value);
double largest(const Sample& sample, double Outcome::*value);
double least(const Sample& sample, double Outcome::*value);

/// Mean of value / reference over the trials that succeeded.
double ratio(const Sample& sample, double Outcome::*value, double Outcome::*reference);

}  // namespace sidestep::campaign
