#pragma once

#include <string>
#include <vector>

namespace sidestep::campaign {

/// A kind of scene, and how it differs from the others.
struct Family {
  std::string name;
  std::string stream;      ///< of random numbers: families with the same stream get the same scenes for the same seed
  int most_obstacles;      ///< 0: none, and nothing to hit
  double speed_mps;        ///< the largest of an obstacle; of every one in a dodge
  bool chase = false;      ///< the target moves along the witness's tool path
  bool full_pose = false;  ///< of a chase: the target turns with the witness's tool
  bool erratic = false;    ///< obstacles change their velocity
  bool real = false;       ///< noise, delay and loss on the obstacles, lag in the arm
  bool dodge = false;      ///< hold the tool while all obstacles fly through the arm at once
  bool hold_orientation = false;
};

/// All of them, in the order of the tables.
const std::vector<Family>& families();

/// Throws std::runtime_error when there is no such family.
const Family& family_named(const std::string& name);

/// What `--family` may say: a family's name, `dodge` for all its variants, or `all`. Throws as above.
std::vector<const Family*> families_of(const std::string& word);

}  // namespace sidestep::campaign
