#pragma once

#include <cstdint>

namespace sidestep::test {

/// Number of memory allocations of this thread: malloc, calloc, realloc, aligned_alloc and everything that calls them
/// (operator new, Eigen). A binary that links this function gets counting versions of them instead of the C library's.
int64_t allocation_count();

}  // namespace sidestep::test
