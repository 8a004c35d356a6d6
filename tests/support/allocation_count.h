#pragma once

#include <cstdint>

namespace sidestep::test {

/// How often this thread has asked for memory: malloc, calloc, realloc, aligned_alloc and all that ends there (operator
/// new, Eigen). A binary that calls this gets counting versions of them instead of the C library's.
int64_t allocation_count();

}  // namespace sidestep::test
