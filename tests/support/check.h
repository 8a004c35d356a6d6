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
// Macros of cmocka that would rewrite members of other classes.
#undef fail
#undef skip

// A failing check leaves its test by longjmp: destructors do not run. An exception that escapes a test ends the binary.

/// Fails unless the condition holds; says why in printf's words.
#define check(condition, ...)          \
  do {                                 \
    if (!(condition)) {                \
      print_error("%s: ", #condition); \
      print_error(__VA_ARGS__);        \
      print_error("\n");               \
      _fail(__FILE__, __LINE__);       \
    }                                  \
  } while (false)

/// Two numbers, or all elements of two Eigen matrices, agree within the tolerance. (cmocka compares doubles as floats.)
#define check_near(actual, expected, tolerance) check_near_because(actual, expected, tolerance, "no more to say")

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

/// What a function throws, as text; empty when it throws nothing.
template <typename Function>
std::string message_of(Function&& function) {
  try {
    function();
  } catch (const std::exception& error) {
    return *error.what() ? error.what() : "(an exception without words)";
  }
  return {};
}

/// A text that is one line and holds all of the parts.
inline bool one_line_with(const std::string& text, std::initializer_list<std::string> parts) {
  if (text.empty() || text.find('\n') != std::string::npos) return false;
  for (const std::string& part : parts)
    if (text.find(part) == std::string::npos) return false;
  return true;
}

}  // namespace sidestep::test
