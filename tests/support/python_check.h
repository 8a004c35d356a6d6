#pragma once

#include <string>

#include "tests/support/check.h"
#include "tests/support/process.h"

namespace sidestep::test {

/// Fails unless check `name` of tests/support/`script` ends with 0 within limit_s.
inline void require_python_check(const std::string& script, const char* name, double limit_s = 60.0) {
  Process python({"build/venv/bin/python", "tests/support/" + script, name});
  const int code = python.wait(patient_s(limit_s));
  check(code == 0, "%s: %s", name, python.output().c_str());
}

}  // namespace sidestep::test
