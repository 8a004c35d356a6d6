#include <algorithm>
#include <array>
#include <cmath>

#include "host/sim/arm.h"
#include "tests/support/check.h"
#include "tests/support/command_check.h"
#include "tests/support/lcm_peer.h"
#include "tests/support/live_scene.h"
#include "tests/support/lwa3.h"
#include "tests/support/process.h"
#include "tests/support/scratch.h"

using namespace sidestep;
using test::LcmPeer;
using test::private_lcm_url;
using test::Process;
using test::replaced;

namespace {

constexpr int64_t kPeriod_us = 10000;
constexpr double kPeriod_s = 0.01;

/// The LWA3's configuration on channels with a suffix, at a place in the world.
std::string config_file(const std::string& suffix, double x_m, double yaw_rad, const std::string& listen) {
  std::string text = test::text_of("firmware/config/lwa3.yaml");
  for (const char* name : {"TARGET", "OBSTACLES", "ARM_STATE", "ARM_COMMAND", "CONTROLLER_STATUS", "LOOP_TIMING"})
    text = replaced(text, std::string(": ") + name, std::string(": ") + name + suffix);
  text = replaced(text, "# publish: LINKS_1 ", "publish: LINKS" + suffix + " ");
  text = replaced(text, "listen: []", "listen: [" + listen + "]");
  text = replaced(text, "base_position_m: [0, 0, 0]", "base_position_m: [" + std::to_string(x_m) + ", 0, 0]");
  text = replaced(text, "base_rpy_rad: [0, 0, 0]", "base_rpy_rad: [0, 0, " + std::to_string(yaw_rad) + "]");
  return test::scratch_file("arm" + suffix + ".yaml", text);
}

/// An ideal arm with a controller of its own, on the arm's clock.
class Side {
 public:
  Side(const std::string& suffix, double x_m, double yaw_rad, const std::string& listen)
      : suffix_(suffix),
        controller_({"build/controller", "--config", config_file(suffix, x_m, yaw_rad, listen), "--lockstep",
                     "--lcm-url", private_lcm_url()}),
        peer_(suffix),
        commands_(test::lwa3().limits, kPeriod_s),
        body_("urdf/lwa3.urdf", "base_link", "tool"),
        q_rad_(test::home_rad()),
        qd_radps_(JointVector::Zero(7)) {
    world_from_base_ = Eigen::Translation3d(x_m, 0, 0) * Eigen::AngleAxisd(yaw_rad, Vector3::UnitZ());
    commands_.begin(q_rad_, qd_radps_);
    body_.place(q_rad_);
  }

  /// One cycle: the world, the arm, the answer. Returns whether there was one.
  bool cycle(int64_t utime, const Vector3& target_m, const Vector3& target_mps) {
    const Eigen::Isometry3d base_from_world = world_from_base_.inverse();
    const size_t before = peer_.statuses.size();
    target_m_ = target_m;
    peer_.send("TARGET" + suffix_,
               test::target_message(utime, base_from_world * target_m, base_from_world.linear() * target_mps));
    peer_.send("OBSTACLES" + suffix_, test::obstacles_message(utime, {}));
    peer_.send("ARM_STATE" + suffix_, test::arm_state_message(utime, q_rad_, qd_radps_));
    if (!peer_.await([&] { return peer_.statuses.size() > before; }, 1.0)) return false;
    const joint_command_t& command = peer_.commands.back();
    q_rad_ = Eigen::Map<const Eigen::VectorXd>(command.joint_position.data(), 7);
    qd_radps_ = Eigen::Map<const Eigen::VectorXd>(command.joint_velocity.data(), 7);
    commands_.feed(q_rad_, qd_radps_);
    body_.place(q_rad_);
    return true;
  }

  int8_t mode() const { return peer_.statuses.empty() ? int8_t{-1} : peer_.statuses.back().mode; }
  double error_m() const { return (world_from_base_ * body_.base_from_tool().translation() - target_m_).norm(); }

  /// Surface to surface by FCL, m; pairs farther apart than 0.5 m do not matter.
  double clearance_m(const Side& other) const {
    double least_m = 0.5;
    for (const sim::ArmPart& mine : body_.parts()) {
      for (const sim::ArmPart& its : other.body_.parts()) {
        const Eigen::Isometry3d here = world_from_base_ * mine.base_from_part,
                                there = other.world_from_base_ * its.base_from_part;
        const double bound_m = (here.translation() - there.translation()).norm() - sim::bounding_radius_m(mine.solid) -
                               sim::bounding_radius_m(its.solid);
        if (bound_m < least_m) least_m = std::min(least_m, sim::signed_distance_m(mine.solid, here, its.solid, there));
      }
    }
    return least_m;
  }

  const std::string& complaint() const { return commands_.complaint(); }
  const Process& controller() const { return controller_; }

 private:
  std::string suffix_;
  Process controller_;
  LcmPeer peer_;
  test::CommandCheck commands_;
  sim::Arm body_;
  Eigen::Isometry3d world_from_base_;
  JointVector q_rad_, qd_radps_;
  Vector3 target_m_ = Vector3::Zero();
};

/// What came of two arms face to face, 1 m apart, whose targets cross the middle against each other.
struct Meeting {
  double least_m = 1.0;
  std::array<std::vector<double>, 2> errors_m;
};

Meeting meet(bool listening, double period_s, double duration_s) {
  Side left("_L", -0.5, M_PI, listening ? "LINKS_R" : ""), right("_R", 0.5, 0, listening ? "LINKS_L" : "");
  const std::array<Side*, 2> sides{&left, &right};
  Meeting meeting;
  const double rate_radps = 2 * M_PI / period_s;
  double t_s = 0.0;
  for (int64_t utime = kPeriod_us; t_s < duration_s; utime += kPeriod_us) {
    const Vector3 place_m(0.05, 0.35 * std::cos(rate_radps * t_s), 0.75);
    const Vector3 velocity_mps(0, -0.35 * rate_radps * std::sin(rate_radps * t_s), 0);
    int tracking = 0;
    for (size_t i = 0; i < 2; ++i) {
      const double mirror = i == 0 ? 1.0 : -1.0;
      const Vector3 across(mirror, mirror, 1);
      const bool answered = sides[i]->cycle(utime, across.cwiseProduct(place_m), across.cwiseProduct(velocity_mps));
      check(answered || t_s == 0.0, "%s", sides[i]->controller().output().c_str());
      tracking += sides[i]->mode() == controller_status_t::TRACK;
    }
    check(utime < 1000 * kPeriod_us || t_s > 0.0, "never tracked: %s", left.controller().output().c_str());
    if (t_s == 0.0 && tracking < 2) continue;
    check(tracking == 2, "modes %d and %d after %g s", left.mode(), right.mode(), t_s);
    t_s += kPeriod_s;
    meeting.least_m = std::min(meeting.least_m, left.clearance_m(right));
    for (size_t i = 0; i < 2; ++i) meeting.errors_m[i].push_back(sides[i]->error_m());
  }
  for (const Side* side : sides) check(side->complaint().empty(), "%s", side->complaint().c_str());
  return meeting;
}

double quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<size_t>(share * static_cast<double>(values.size() - 1))];
}

void two_controllers_share_a_workspace_without_contact(void**) {
  for (const double period_s : {2.5, 6.0}) {
    const Meeting meeting = meet(true, period_s, 24.0);
    print_message("least clearance between the arms, by FCL: %.1f mm\n", 1e3 * meeting.least_m);
    check(meeting.least_m > 0.0, "%g m", meeting.least_m);
    for (const auto& errors_m : meeting.errors_m) {
      const double half_m = quantile(errors_m, 0.5), most_m = quantile(errors_m, 0.9);
      print_message("distance to the target: half of the time below %.1f mm, 90 %% of it below %.0f mm\n", 1e3 * half_m,
                    1e3 * most_m);
      check(half_m < 0.05, "%g m", half_m);
    }
  }
}

/// The scene is worth the name.
void two_that_do_not_listen_collide(void**) {
  const Meeting meeting = meet(false, 6.0, 6.0);
  check(meeting.least_m < 0.0, "%g m", meeting.least_m);
}

/// In real time; the neighbour is a ball far away.
void a_neighbour_that_is_not_heard_stops_the_arm(void**) {
  const std::string config = config_file("", 0, 0, "LINKS_R");
  Process controller({"build/controller", "--config", config, "--lcm-url", private_lcm_url()});
  test::LiveArm arm(test::lwa3().limits, test::home_rad());
  arm.target_m = Vector3(0.1, 0.45, 0.7);
  int64_t links_utime = 0;
  const auto run = [&](double duration_s, bool neighbour_speaks) {
    for (double t_s = 0.0; t_s < duration_s; t_s += 0.02) {
      const obstacle_t ball = test::sphere(0, Vector3(3, 3, 3), 0.1, Vector3::Zero());
      if (neighbour_speaks) arm.peer.send("LINKS_R", test::obstacles_message(++links_utime, {ball}));
      arm.run(0.02);
    }
    return arm.status().mode;
  };
  arm.peer.await([&] { return !arm.peer.statuses.empty(); }, 10.0);
  check(run(1.0, false) == controller_status_t::WAIT, "%s", arm.status().message.c_str());
  check(run(1.0, true) == controller_status_t::TRACK, "%s", arm.status().message.c_str());
  check(run(0.2, false) == controller_status_t::BRAKE, "%s", arm.status().message.c_str());
  run(0.5, false);
  check_near(arm.speed_radps(), 0.0, 0);
  check(run(0.5, true) == controller_status_t::TRACK, "%s", arm.status().message.c_str());
  test::check_stream(arm);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test_teardown(two_controllers_share_a_workspace_without_contact, test::kill_processes),
      cmocka_unit_test_teardown(a_neighbour_that_is_not_heard_stops_the_arm, test::kill_processes),
      cmocka_unit_test_teardown(two_that_do_not_listen_collide, test::kill_processes),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
