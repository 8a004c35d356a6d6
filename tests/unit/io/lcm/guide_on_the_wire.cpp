// How controller_status_t encodes a guide.
#include <sidestep/controller_status_t.hpp>

#include "firmware/io/lcm/encoder.h"
#include "firmware/model/kinematics.h"
#include "tests/support/check.h"
#include "tests/support/lwa3.h"

using namespace sidestep;

namespace {

constexpr int kPoints = 8;

controller_status_t decoded_status(const Report& report) {
  Encoder encoder(test::lwa3(), kSidestepDialect);
  const Packet packet = encoder.encode(report, CycleRecord{});
  controller_status_t status;
  assert_int_equal(status.decode(packet.bytes, 0, static_cast<int>(packet.size)), packet.size);
  return status;
}

Guide guide_from_home() {
  Guide guide;
  guide.foresight_status = ForesightStatus::kGuided;
  guide.add(10.0, test::home_rad());
  guide.add(12.0, test::home_rad() + JointVector::Constant(test::lwa3().joints, 0.3));
  return guide;
}

void the_tool_path_leads_from_the_guides_current_point_to_its_end(void**) {
  const Guide guide = guide_from_home();
  Report report;
  report.foresight_status = guide.foresight_status;
  report.guide_horizon_s = 1.5;
  report.guide = &guide;
  const controller_status_t status = decoded_status(report);
  assert_int_equal(status.foresight, controller_status_t::GUIDED);
  for (int i = 0; i < kPoints; ++i) {
    const LinkPoses poses =
        forward_kinematics(test::lwa3(), point_of(guide, 10.5 + 1.5 * i / (kPoints - 1)).position_rad);
    check_near(Eigen::Map<const Vector3>(status.guide_tool[i]).eval(), poses.tool_position, 1e-12);
  }
}

void without_a_guide_the_tool_path_is_zero(void**) {
  const controller_status_t status = decoded_status(Report{});
  for (const auto& point : status.guide_tool)
    for (const double coordinate : point) check_near(coordinate, 0.0, 0.0);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(the_tool_path_leads_from_the_guides_current_point_to_its_end),
      cmocka_unit_test(without_a_guide_the_tool_path_is_zero),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
