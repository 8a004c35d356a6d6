// The library headers that most files include, compiled once for the whole build (gcc only, see the Makefile). Each
// file still includes what it uses: the sanitizer, arm64 and fuzz builds and clang-tidy read the files without this
// one.
#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>
