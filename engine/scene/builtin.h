// Scenes made by code: what the tests, the samples and the first run need without any file.
#pragma once

#include <map>

#include "engine/scene/scene.h"

namespace radivox::scene {

struct BuiltinInfo {
  std::string name;
  std::string help;
  std::vector<std::string> parameters;  ///< "triangles=20000" with defaults
};
std::vector<BuiltinInfo> builtinScenes();

/// atrium (a two-storey arcaded court of our own, with curtains; triangles=N), cornell, cornell_point, furnace (albedo=, closed box, every
/// wall emits L_e = (1 - albedo)/pi, so that B = 1 everywhere), two_rooms (one lit, a door between), thin_wall (one two-triangle sheet; one
/// side lit by the sun), box (unit cube inward), plane, sphere, ramp, staircase, empty. Throws BadInput with the nearest name.
Scene makeBuiltin(const std::string& name, const std::map<std::string, std::string>& parameters = {});

}  // namespace radivox::scene
