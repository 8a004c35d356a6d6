#pragma once

#include "host/campaign/csv.h"

namespace sidestep::campaign {

/// All trials of one law in one family, by seed.
using Sample = std::vector<Row>;

/// Splits sorted rows where law or family changes.
std::vector<Sample> samples(const std::vector<Row>& rows);

/// The arm touched an obstacle or itself.
bool touched(const Row& row);
/// Links of the arm touched each other.
bool touched_itself(const Row& row);
/// The tool is at the target at the end: within 10 mm, after a dodge within 5 mm; among furniture also within 0.05 rad
/// where the goal has an orientation. If the goal is a posture: every joint is within 0.01 rad.
bool arrived(const Row& row);
/// The arm arrived without contact.
bool succeeded(const Row& row);

Sample successes(const Sample& sample);

/// Among people: the arm touched a person although a motion without contact exists, from the start or still from the
/// arm's state when the approach could first be seen.
bool touched_avoidably(const Row& row);
bool touched_avoidably_when_seen(const Row& row);
/// Among people: the arm touched a person, and deeper than an arm that stays at the start would have, by 1 mm or more.
bool touched_deeper_than_at_rest(const Row& row);
/// An arm that stays at the start is touched.
bool touched_at_rest(const Row& row);

/// Among furniture: the arm touched the mover.
bool touched_mover(const Row& row);

/// Share of the trials that satisfy a condition, %.
double percent(const Sample& sample, bool (*holds)(const Row&));

/// Bounds of a share, %.
struct Interval {
  double lower, upper;
};

/// The 95 % confidence interval of the share of trials that satisfy a condition (Wilson's score interval).
Interval confidence(const Sample& sample, bool (*holds)(const Row&));
Interval wilson_interval(double successes, double trials);

/// Over the trials whose value is not NaN; NaN if there are none.
double mean(const Sample& sample, double TrialMetrics::*value);
double largest(const Sample& sample, double TrialMetrics::*value);
double least(const Sample& sample, double TrialMetrics::*value);

/// Mean of value / reference over the successful trials.
double ratio(const Sample& sample, double TrialMetrics::*value, double TrialMetrics::*reference);

}  // namespace sidestep::campaign
