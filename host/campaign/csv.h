#pragma once

#include <string>
#include <vector>

#include "host/campaign/family.h"
#include "host/campaign/outcome.h"

namespace sidestep::campaign {

/// One trial: which scene, who steered, what came of it.
struct Row {
  const Family* family = nullptr;
  std::string law;
  uint64_t seed = 0;
  Outcome outcome;
};

/// Numbers are written so that reading gives the same bits back. Both throw std::runtime_error, one line with the file.
void write_csv(const std::string& file, const std::vector<Row>& rows);
std::vector<Row> read_csv(const std::string& file);

/// By law, family in the order of the tables, and seed. Throws std::runtime_error when a trial stands twice.
void sort_rows(std::vector<Row>& rows);

}  // namespace sidestep::campaign
