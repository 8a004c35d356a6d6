#include "firmware/io/lcm/dialect.h"

namespace sidestep {
namespace {

const Dialect* const kDialects[] = {&kSidestepDialect, &kIiwaDialect};

}  // namespace

std::vector<std::string> dialect_names() {
  std::vector<std::string> names;
  for (const Dialect* dialect : kDialects) names.emplace_back(dialect->name);
  return names;
}

const Dialect& dialect_named(const std::string& name) {
  for (const Dialect* dialect : kDialects)
    if (name == dialect->name) return *dialect;
  return kSidestepDialect;
}

}  // namespace sidestep
