#include "host/campaign/lwa3_arm.h"

#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

#include "tests/support/check.h"
#include "tests/support/random.h"

using namespace sidestep::campaign;
using sidestep::Matrix3;
using sidestep::Vector3;
using sidestep::test::Random;

namespace {

constexpr int kJoints = 7;

Joints random_joints(Random& random) {
  return random.joints(kJoints, -M_PI, M_PI);
}

/// Craig's transform from one row (alpha, d) of the table with a = 0.
Eigen::Matrix4d craig(double alpha_rad, double d_m, double q_rad) {
  const double c = std::cos(q_rad), s = std::sin(q_rad), ca = std::cos(alpha_rad), sa = std::sin(alpha_rad);
  Eigen::Matrix4d t;
  t << c, -s, 0, 0,                    //
      s * ca, c * ca, -sa, -d_m * sa,  //
      s * sa, c * sa, ca, d_m * ca,    //
      0, 0, 0, 1;
  return t;
}

void home_pose_is_that_of_the_paper(void**) {
  Joints q_rad = Joints::Zero(kJoints);
  q_rad[1] = M_PI / 2;
  q_rad[3] = -M_PI / 2;
  const ArmPose home = lwa3_arm().pose(q_rad);
  check_near(home.tool(), Vector3(-0.328, 0, 0.9137), 1e-12);
  check_near(home.tool_rotation, Matrix3::Identity(), 1e-12);
}

void frames_match_the_dh_table(void**) {
  const double quarter = M_PI / 2;
  const double alpha_rad[] = {0, quarter, -quarter, quarter, -quarter, quarter, -quarter};
  const double d_m[] = {0.3, 0, 0.328, 0, 0.2765, 0, 0};
  Random random(1);
  for (int trial = 0; trial < 500; ++trial) {
    const Joints q_rad = random_joints(random);
    const ArmPose arm = lwa3_arm().pose(q_rad);
    Eigen::Matrix4d t = Eigen::Matrix4d::Identity();
    for (int i = 0; i < kJoints; ++i) {
      t = t * craig(alpha_rad[i], d_m[i], q_rad[i]);
      check_near(arm.axes[static_cast<size_t>(i)], Vector3(t.block<3, 1>(0, 2)), 1e-12);
      if (i == 0) check_near(arm.corners[1], Vector3(t.block<3, 1>(0, 3)), 1e-12);
      if (i == 3) check_near(arm.corners[2], Vector3(t.block<3, 1>(0, 3)), 1e-12);
      if (i == 5) check_near(arm.corners[3], Vector3(t.block<3, 1>(0, 3)), 1e-12);
    }
    check_near(arm.tool(), Vector3((t * Eigen::Vector4d(0, 0, 0.3372, 1)).head<3>()), 1e-12);
    check_near(arm.tool_rotation, Matrix3(t.block<3, 3>(0, 0)), 1e-12);
  }
}

void jacobian_is_the_derivative_of_the_tool_position(void**) {
  Random random(2);
  for (int trial = 0; trial < 200; ++trial) {
    const Joints q_rad = random_joints(random);
    const Joints step_rad = 1e-6 * random_joints(random);
    const Vector3 difference_m = lwa3_arm().pose(q_rad + step_rad).tool() - lwa3_arm().pose(q_rad - step_rad).tool();
    check_near(tool_jacobian(lwa3_arm().pose(q_rad)) * (2.0 * step_rad), difference_m, 1e-13);
  }
}

/// The arm's capsules and the sphere as FCL objects.
struct Objects {
  std::vector<fcl::CollisionObjectd> links;
  fcl::CollisionObjectd sphere;
};

Objects objects(const ArmPose& arm, const Vector3& center_m, double radius_m) {
  Objects result{{}, {std::make_shared<fcl::Sphered>(radius_m), Matrix3::Identity(), center_m}};
  for (size_t i = 0; i < 4; ++i) {
    const Vector3 along = arm.corners[i + 1] - arm.corners[i];
    const Matrix3 rotation = Eigen::Quaterniond::FromTwoVectors(Vector3::UnitZ(), along).toRotationMatrix();
    result.links.emplace_back(std::make_shared<fcl::Capsuled>(kLinkRadius_m, along.norm()), rotation,
                              Vector3(0.5 * (arm.corners[i] + arm.corners[i + 1])));
  }
  return result;
}

double fcl_clearance(const Objects& objects) {
  double least_m = 1e9;
  for (const auto& link : objects.links) {
    fcl::DistanceResultd result;
    least_m = std::min(least_m, fcl::distance(&link, &objects.sphere, fcl::DistanceRequestd(true), result));
  }
  return least_m;
}

bool fcl_touches(const Objects& objects) {
  for (const auto& link : objects.links) {
    fcl::CollisionResultd result;
    if (fcl::collide(&link, &objects.sphere, fcl::CollisionRequestd(), result) > 0) return true;
  }
  return false;
}

void clearance_matches_fcl(void**) {
  Random random(3);
  int apart = 0, overlapping = 0;
  for (int trial = 0; trial < 5000; ++trial) {
    const ArmPose arm = lwa3_arm().pose(random_joints(random));
    const Vector3 center_m = random.inside(-0.4, 0.4) + Vector3(0, 0, 0.4);
    const double radius_m = random.uniform(0.01, 0.3);
    const double clearance_m = lwa3_arm().clearance(arm, center_m, radius_m);
    const Objects all = objects(arm, center_m, radius_m);
    check(fcl_touches(all) == (clearance_m < 0.0), "trial %d: %g", trial, clearance_m);
    if (clearance_m > 0.0) check_near_because(clearance_m, fcl_clearance(all), 1e-6, "trial %d", trial);
    ++(clearance_m > 0.0 ? apart : overlapping);
  }
  check(apart > 1000 && overlapping > 1000, "%d apart, %d overlapping", apart, overlapping);
}

void self_clearance_matches_fcl(void**) {
  Random random(5);
  int apart = 0, overlapping = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    Joints q_rad = random_joints(random);
    if (trial % 2 == 0) q_rad[3] = random.uniform(1.7, 2.2), q_rad[4] *= 0.1, q_rad[5] = random.uniform(1.7, 2.2);
    const ArmPose arm = lwa3_arm().pose(q_rad);
    const double clearance_m = lwa3_arm().self_clearance(arm);
    const Objects all = objects(arm, Vector3::Zero(), 0.1);
    double least_m = 1e9;
    for (const auto& [a, b] : {std::pair{0, 2}, {0, 3}, {1, 3}}) {
      fcl::DistanceResultd result;
      const auto &first = all.links[static_cast<size_t>(a)], &second = all.links[static_cast<size_t>(b)];
      least_m = std::min(least_m, fcl::distance(&first, &second, fcl::DistanceRequestd(true), result));
    }
    check((least_m <= 0.0) == (clearance_m <= 0.0), "trial %d: %g and %g", trial, clearance_m, least_m);
    if (clearance_m > 0.0) check_near_because(clearance_m, least_m, 1e-6, "trial %d", trial);
    ++(clearance_m > 0.0 ? apart : overlapping);
  }
  check(apart > 100 && overlapping > 100, "%d apart, %d overlapping", apart, overlapping);
}

/// Also for a sphere that overlaps the arm.
void a_larger_radius_reduces_the_clearance_by_the_same_length(void**) {
  Random random(4);
  for (int trial = 0; trial < 1000; ++trial) {
    const ArmPose arm = lwa3_arm().pose(random_joints(random));
    const Vector3 center_m = random.inside(-0.5, 0.5);
    check_near(lwa3_arm().clearance(arm, center_m, 0.3), lwa3_arm().clearance(arm, center_m, 0.05) - 0.25, 1e-12);
  }
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(home_pose_is_that_of_the_paper),
      cmocka_unit_test(frames_match_the_dh_table),
      cmocka_unit_test(jacobian_is_the_derivative_of_the_tool_position),
      cmocka_unit_test(clearance_matches_fcl),
      cmocka_unit_test(self_clearance_matches_fcl),
      cmocka_unit_test(a_larger_radius_reduces_the_clearance_by_the_same_length),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
