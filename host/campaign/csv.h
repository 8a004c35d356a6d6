#pragma once

#include <string>
#include <vector>

#include "host/campaign/family.h"
#include "host/campaign/metrics.h"

namespace sidestep::campaign {

/// One trial: the scene (family and seed), the law that controlled the arm, and the result.
struct Row {
  const Family* family = nullptr;
  std::string law;
  uint64_t seed = 0;
  TrialMetrics metrics;
};

/// Written numbers are read back as the same bits. Both functions throw std::runtime_error, one line with the file.
void write_csv(const std::string& file, const std::vector<Row>& rows);
std::vector<Row> read_csv(const std::string& file);

/// Sorts by law, family (in the order of the tables) and seed. Throws std::runtime_error if a trial occurs twice.
void sort_rows(std::vector<Row>& rows);

}  // namespace sidestep::campaign
