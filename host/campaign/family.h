#pragma once

#include <string>
#include <vector>

namespace sidestep::campaign {

/// What the persons of a scene do.
enum class People { kNone, kWalkBy, kReachIn, kGesture, kTwo };

/// What stands around the goal of a scene.
enum class Furniture { kNone, kShelf, kBox, kCage, kTable, kUnderTable };

/// A kind of scene.
struct Family {
  std::string name;
  std::string stream;      ///< random number stream: families of one stream have the same scenes for the same seed
  int most_obstacles;      ///< 0: scenes without obstacles
  double speed_mps;        ///< largest speed of an obstacle; in a dodge the speed of every obstacle
  bool chase = false;      ///< the target moves along the witness's tool path
  bool full_pose = false;  ///< with chase: the target also has the orientation of the witness's tool
  bool erratic = false;    ///< obstacles change their velocity
  bool real = false;       ///< noise, delay and loss in the obstacle measurements, lag in the arm
  bool dodge = false;      ///< the task is to hold the tool while all obstacles fly through the arm at once
  bool hold_orientation = false;           ///< with dodge: the task includes the tool's orientation
  People people = People::kNone;           ///< not kNone: the obstacles are the capsules of one person or two
  bool camera = false;                     ///< with people: a camera sees them, late, with noise and loss
  Furniture furniture = Furniture::kNone;  ///< not kNone: boxes and cylinders at rest, reported exactly
  bool mover = false;                      ///< with furniture: a sphere flies past while the arm works
  bool boxes = false;    ///< the obstacles are boxes that move to and fro; the trial ends when the goal is reached
  bool posture = false;  ///< with boxes: the goal is a posture, not a position of the tool

  bool has_people() const { return people != People::kNone; }
  bool has_furniture() const { return furniture != Furniture::kNone; }
};

/// All families, in the order of the tables.
const std::vector<Family>& families();

/// Throws std::runtime_error if there is no such family.
const Family& family_named(const std::string& name);

/// The families that a value of `--family` selects: a family's name, `dodge`, `people` or `furniture` for all of
/// theirs, or `all` for all but those of furniture, whose witnesses cost up to a minute a scene (arms of meshes, the
/// cage), and of boxes, which are meant for longer arms. Throws like family_named().
std::vector<const Family*> families_of(const std::string& word);

}  // namespace sidestep::campaign
