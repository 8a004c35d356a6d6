#include "host/campaign/family.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

namespace sidestep::campaign {
namespace {

Family basic(const std::string& name, int most_obstacles, double speed_mps) {
  return {name, name, most_obstacles, speed_mps};
}

std::vector<Family> make_families() {
  std::vector<Family> all{basic("moving", 6, 0.3),    basic("fast", 6, 0.6),  basic("crowd", 20, 0.3),
                          basic("clutter", 15, 0.02), basic("chase", 6, 0.3), basic("erratic", 6, 0.4),
                          basic("real", 6, 0.3)};
  all[4].chase = true;
  all[5].erratic = true;
  all[6].real = true;
  all[6].stream = "moving";
  const auto add_full_pose = [&all](const std::string& name, const std::string& stream, int most_obstacles) {
    Family family{name, stream, most_obstacles, 0.3};
    family.chase = family.full_pose = true;
    all.push_back(family);
  };
  add_full_pose("follow6d", "follow6d", 0);
  add_full_pose("chase6d", "chase", 6);
  const auto add_dodge = [&all](const char* kind, int spheres, double speed_mps, bool hold_orientation) {
    Family family{fmt::format("{}@{}", kind, speed_mps), "dodge", spheres, speed_mps};
    family.dodge = true;
    family.hold_orientation = hold_orientation;
    all.push_back(family);
  };
  for (double speed_mps : {0.1, 0.25, 0.5, 1.0, 2.0}) add_dodge("dodge", 1, speed_mps, false);
  for (double speed_mps : {0.5, 1.0}) add_dodge("dodge3", 3, speed_mps, false);
  for (double speed_mps : {0.1, 0.25, 0.5, 1.0, 2.0}) add_dodge("dodge6d", 1, speed_mps, true);
  const auto add_people = [&all](const std::string& stream, People people) {
    for (const bool camera : {false, true}) {
      Family family{camera ? stream + "@camera" : stream, stream, 0, 0.0};
      family.people = people;
      family.camera = camera;
      all.push_back(family);
    }
  };
  add_people("walk-by", People::kWalkBy);
  add_people("reach-in", People::kReachIn);
  add_people("gesture", People::kGesture);
  add_people("two-people", People::kTwo);
  const auto add_furniture = [&all](const std::string& stream, Furniture furniture) {
    for (const bool mover : {false, true}) {
      Family family{mover ? stream + "@mover" : stream, stream, 0, mover ? 0.5 : 0.0};
      family.furniture = furniture;
      family.mover = mover;
      all.push_back(family);
    }
  };
  add_furniture("shelf", Furniture::kShelf);
  add_furniture("box", Furniture::kBox);
  add_furniture("cage", Furniture::kCage);
  add_furniture("table", Furniture::kTable);
  add_furniture("under-table", Furniture::kUnderTable);
  for (const bool posture : {false, true}) {
    Family family{posture ? "boxes@posture" : "boxes", "boxes", 5, 0.3};
    family.boxes = true;
    family.posture = posture;
    all.push_back(family);
  }
  return all;
}

}  // namespace

const std::vector<Family>& families() {
  static const std::vector<Family> all = make_families();
  return all;
}

std::vector<const Family*> families_of(const std::string& word) {
  std::vector<const Family*> chosen;
  std::string known = "all, dodge, people, furniture";
  for (const Family& family : families()) {
    if (word == family.name || (word == "all" && !family.has_furniture() && !family.boxes) ||
        (word == "dodge" && family.dodge) || (word == "people" && family.has_people()) ||
        (word == "furniture" && family.has_furniture()))
      chosen.push_back(&family);
    known += ", " + family.name;
  }
  if (chosen.empty()) throw std::runtime_error(fmt::format("no family '{}'; the families are {}", word, known));
  return chosen;
}

const Family& family_named(const std::string& name) {
  const auto found =
      std::find_if(families().begin(), families().end(), [&](const Family& family) { return family.name == name; });
  if (found == families().end()) throw std::runtime_error(fmt::format("no family '{}'", name));
  return *found;
}

}  // namespace sidestep::campaign
