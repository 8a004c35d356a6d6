#include "firmware/io/lcm/lcm_url.h"

#include <cstdlib>

#include "tests/support/check.h"

using namespace sidestep;
using test::message_of;
using test::one_line_with;

namespace {

void group_port_and_buffer_are_read(void**) {
  const struct {
    const char* url;
    MulticastGroup group;
  } cases[] = {
      {"udpm://239.255.76.67:7667?ttl=0", {0xefff4c43, 7667, 0}},
      {"udpm://", {0xefff4c43, 7667, 0}},
      {"udpm://?ttl=1", {0xefff4c43, 7667, 0}},
      {"udpm://224.0.0.1:1", {0xe0000001, 1, 0}},
      {"udpm://239.1.2.3:65535?recv_buf_size=2097152&ttl=1", {0xef010203, 65535, 2097152}},
      {"udpm://239.1.2.3:0x10?ttl=0,recv_buf_size=010", {0xef010203, 16, 8}},  // as liblcm reads numbers
  };
  for (const auto& [url, group] : cases) {
    const MulticastGroup read = multicast_group_of(url);
    check(read.address == group.address, "%s: %x", url, read.address);
    check(read.port == group.port, "%s: %d", url, read.port);
    check(read.receive_buffer_bytes == group.receive_buffer_bytes, "%s: %d", url, read.receive_buffer_bytes);
  }
}

void every_other_url_is_refused_with_one_line(void**) {
  const struct {
    const char* url;
    const char* word;
  } cases[] = {
      {"memq://", "udpm://"},
      {"tcpq://127.0.0.1:7700", "udpm://"},
      {"file://log", "udpm://"},
      {"udpm", "udpm://"},
      {"udpm:/239.1.2.3:1", "udpm://"},
      {"udpm://:7667", "''"},
      {"udpm://239.1.2:7667", "'239.1.2'"},
      {"udpm://127.0.0.1:7667", "'127.0.0.1'"},
      {"udpm://239.1.2.3", "port"},
      {"udpm://239.1.2.3:", "port"},
      {"udpm://239.1.2.3:0", "port"},
      {"udpm://239.1.2.3:65536", "port"},
      {"udpm://239.1.2.3:1x", "port"},
      {"udpm://239.1.2.3:99999999999999999999", "port"},
      {"udpm://239.1.2.3:1?ttl", "ttl"},
      {"udpm://239.1.2.3:1?ttl=256", "ttl"},
      {"udpm://239.1.2.3:1?recv_buf_size=-1", "recv_buf_size"},
      {"udpm://239.1.2.3:1?recv_buf_size=2147483647", "recv_buf_size"},
      {"udpm://239.1.2.3:1?colour=red", "'colour'"},
      {"udpm://239.1.2.3:1?ttl=0&&ttl=1", "''"},
  };
  for (const auto& [url, word] : cases) {
    const std::string message = message_of([url = url] { multicast_group_of(url); });
    check(one_line_with(message, {word}), "%s: '%s'", url, message.c_str());
  }
}

void the_environment_counts_where_no_url_is_given(void**) {
  setenv("LCM_DEFAULT_URL", "udpm://239.1.2.3:4", 1);
  assert_string_equal(lcm_url_or_default("").c_str(), "udpm://239.1.2.3:4");
  assert_string_equal(lcm_url_or_default("udpm://239.5.6.7:8").c_str(), "udpm://239.5.6.7:8");
  for (const bool empty : {true, false}) {
    empty ? setenv("LCM_DEFAULT_URL", "", 1) : unsetenv("LCM_DEFAULT_URL");
    assert_string_equal(lcm_url_or_default("").c_str(), "udpm://239.255.76.67:7667?ttl=0");
  }
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(group_port_and_buffer_are_read),
      cmocka_unit_test(every_other_url_is_refused_with_one_line),
      cmocka_unit_test(the_environment_counts_where_no_url_is_given),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
