#pragma once

#include <cmath>
#include <csetjmp>
#include <cstdarg>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <string>

extern "C" {
#include <cmocka.h>
}
// Macros of cmocka that would replace members of other classes.
#undef fail
#undef skip

// A failing check leaves its test by longjmp: destructors do not run. An exception that escapes a test ends the binary.

/// Fails the test unless the condition holds; the further arguments are printf's and explain the failure.
#define check(condition, ...)          \
  do {                                 \
    if (!(condition)) {                \
      print_error("%s: ", #condition); \
      print_error(__VA_ARGS__);        \
      print_error("\n");               \
      _fail(__FILE__, __LINE__);       \
    }                                  \
  } while (false)

/// Fails the test unless two numbers, or all elements of two Eigen matrices, agree within the tolerance. (cmocka
/// compares doubles as floats.)
#define check_near(actual, expected, tolerance) check_near_because(actual, expected, tolerance, "no further details")

#define check_near_because(actual, expected, tolerance, ...)                                       \
  do {                                                                                             \
    const double gap_ = sidestep::test::gap(actual, expected);                                     \
    if (!(gap_ <= (tolerance))) {                                                                  \
      print_error("%s and %s differ by %g, more than %s\n", #actual, #expected, gap_, #tolerance); \
      print_error(__VA_ARGS__);                                                                    \
      print_error("\n");                                                                           \
      _fail(__FILE__, __LINE__);                                                                   \
    }                                                                                              \
  } while (false)

namespace sidestep::test {

inline double gap(double actual, double expected) {
  return actual == expected ? 0.0 : std::abs(actual - expected);
}

template <typename A, typename B, typename = typename A::Scalar>
double gap(const A& actual, const B& expected) {
  if (actual.rows() != expected.rows() || actual.cols() != expected.cols()) return std::nan("");
  double largest = 0.0;
  for (int row = 0; row < actual.rows(); ++row) {
    for (int column = 0; column < actual.cols(); ++column) {
      const double one = gap(double{actual(row, column)}, double{expected(row, column)});
      if (!(one <= largest)) largest = one;
      if (std::isnan(one)) return one;
    }
  }
  return largest;
}

/// The message of the exception that a function throws; empty if it throws none.
template <typename Function>
std::string message_of(Function&& function) {
  try {
    function();
  } catch (const std::exception& error) {
    return *error.what() ? error.what() : "(an exception without a message)";
  }
  return {};
}

/// Whether the text is one line and contains all of the parts.
inline bool one_line_with(const std::string& text, std::initializer_list<std::string> parts) {
  if (text.empty() || text.find('\n') != std::string::npos) return false;
  for (const std::string& part : parts)
    if (text.find(part) == std::string::npos) return false;
  return true;
}

}  // namespace sidestep::test
