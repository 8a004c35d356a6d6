#include "tests/support/allocation_count.h"

#include <cerrno>
#include <cstddef>

namespace {
thread_local int64_t count = 0;
}

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
// Declared as in sanitizer/allocator_interface.h, which not every compiler has.
extern "C" int __sanitizer_install_malloc_and_free_hooks(void (*on_malloc)(const volatile void*, size_t),
                                                         void (*on_free)(const volatile void*));

namespace {
const int kHooked = __sanitizer_install_malloc_and_free_hooks([](const volatile void*, size_t) { ++count; },
                                                              [](const volatile void*) {});
}
#else
// The internal names of the GNU C library's allocator.
extern "C" {
void* __libc_malloc(size_t size);
void* __libc_calloc(size_t count, size_t size);
void* __libc_realloc(void* old, size_t size);
void* __libc_memalign(size_t alignment, size_t size);
}

extern "C" {
void* malloc(size_t size) {
  ++count;
  return __libc_malloc(size);
}
void* calloc(size_t elements, size_t size) {
  ++count;
  return __libc_calloc(elements, size);
}
void* realloc(void* old, size_t size) {
  ++count;
  return __libc_realloc(old, size);
}
void* memalign(size_t alignment, size_t size) {
  ++count;
  return __libc_memalign(alignment, size);
}
void* aligned_alloc(size_t alignment, size_t size) {
  ++count;
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** result, size_t alignment, size_t size) {
  ++count;
  *result = __libc_memalign(alignment, size);
  return *result ? 0 : ENOMEM;
}
}
#endif

namespace sidestep::test {

int64_t allocation_count() {
  return count;
}

}  // namespace sidestep::test
