#pragma once

#include "host/campaign/lwa3_arm.h"
#include "host/campaign/scene.h"

namespace sidestep::campaign {

/// The scene of a family, a seed and an arm; always the same for the same arguments. Draws scenes until one satisfies
/// the benchmark's rules: the witness stays 0.05 m clear of every sphere, each sphere comes within 0.25 m of the
/// witness, and plain tracking touches a sphere (unless the family has none).
/// Among people there is no witness: plain tracking touches a person (people/people_maker.h, people/way_out.h).
/// Among furniture: furniture/furniture_maker.h. Among boxes there is no witness either: boxes/boxes_maker.h.
/// The arm must outlive the scene. Throws std::runtime_error if no scene is found for the arm.
Scene make_scene(const Family& family, uint64_t seed, const JudgeArm& arm = lwa3_arm());

}  // namespace sidestep::campaign
