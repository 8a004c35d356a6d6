#include "firmware/base/hash.h"

#include <cstring>

#include "tests/support/check.h"

using sidestep::fnv1a;

namespace {

/// Test vectors published with the FNV reference code.
void published_hashes_are_reproduced(void**) {
  const struct {
    const char* text;
    uint64_t hash;
  } known[] = {{"", 0xcbf29ce484222325u}, {"a", 0xaf63dc4c8601ec8cu}, {"foobar", 0x85944171f73967e8u}};
  for (const auto& [text, hash] : known) check(fnv1a(text, std::strlen(text)) == hash, "'%s'", text);
}

void the_hash_of_two_ranges_is_that_of_their_concatenation(void**) {
  assert_true(fnv1a("bar", 3, fnv1a("foo", 3)) == fnv1a("foobar", 6));
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(published_hashes_are_reproduced),
      cmocka_unit_test(the_hash_of_two_ranges_is_that_of_their_concatenation),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
