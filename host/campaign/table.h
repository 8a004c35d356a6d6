#pragma once

#include "host/campaign/csv.h"

namespace sidestep::campaign {

/// The benchmark's tables from sorted rows, one line per law and family. Without CPU times the same trials always give
/// the same text.
std::string tables(const std::vector<Row>& rows, bool with_cpu);

/// The smoothness of the commands, one line per law and family.
std::string smoothness_table(const std::vector<Row>& rows);

}  // namespace sidestep::campaign
