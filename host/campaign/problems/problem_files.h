#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/campaign/judge_arm.h"
#include "host/campaign/sphere_path.h"

namespace sidestep::campaign {

/// A motion planning problem of MotionBenchMaker: a posture to start from and one to end in, among objects at rest.
struct Problem {
  std::string kind;  ///< the folder of the files
  std::string name;  ///< the number in their names
  Joints start_rad, goal_rad;
  JointPositions other_positions;        ///< of joints that the start state names and that are not the arm's
  std::vector<sim::Obstacle> obstacles;  ///< base frame, ids from 0
  std::optional<SpherePath> mover;       ///< of radius kSphereRadius_m; not from the files (problem_mover.h)
};

/// Reads all problems below a folder: every scene<number>.yaml (MoveIt's planning scene with boxes, cylinders and
/// spheres) with the request<number>.yaml beside it (MoveIt's motion plan request, its goal given by joint positions),
/// sorted by kind and name. The world's frame counts as the arm's base. Throws std::runtime_error, one line with the
/// file's name.
std::vector<Problem> read_problems(const std::string& folder, const Arm& arm);

}  // namespace sidestep::campaign
