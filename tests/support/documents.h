#pragma once

#include <string>
#include <vector>

#include "tests/support/check.h"
#include "tests/support/process.h"

namespace sidestep::test {

/// Checks what README.md and docs/results.md say about these scenarios against runs of this version. The runs are in
/// lockstep and take all CPUs; with a lower priority they do not starve the tests in real time beside them. At 15,
/// other processes of a busy machine would starve them.
inline void check_documents(const std::vector<std::string>& scenarios) {
  std::vector<std::string> command = {"/usr/bin/nice",      "-n",     "5", "build/venv/bin/python",
                                      "host/tools/docs.py", "--check"};
  for (const std::string& name : scenarios) command.insert(command.end(), {"--scenario", name});
  Process python(command);
  const int code = python.wait(patient_s(550.0));
  check(code == 0, "%s", python.output().c_str());
}

}  // namespace sidestep::test
