#pragma once

#include "host/campaign/csv.h"

namespace sidestep::campaign {

/// The benchmark's tables, one line per law and family, from sorted rows. Without the CPU times all of it follows from
/// the scenes alone.
std::string tables(const std::vector<Row>& rows, bool with_cpu);

/// How smooth the commands were.
std::string smoothness_table(const std::vector<Row>& rows);

}  // namespace sidestep::campaign
