// Lights as a person edits them: the scene's own ones, moved, turned, coloured, and on their way.
#pragma once

#include "samples/viewer/view.h"

namespace radivox::viewer {

enum class Motion : uint32_t {
  Still,
  Circle,  ///< positions go round a vertical axis beside them; directions turn about the vertical
  Swing,   ///< positions to and fro along x; directions up and down
  Pulse,   ///< intensity between 0 and twice its own
};
const std::vector<std::string>& motionNames();

struct Lamp {
  scene::PunctualLight light;  ///< at rest
  bool on = true;
  Motion motion = Motion::Still;
  float period = 4.f;  ///< s
  float reach = 1.f;   ///< m; directions: multiplied by 0.5 rad
};

struct Lamps {
  std::vector<Lamp> lamps;
  glm::vec3 sky{0.f};

  static Lamps of(const scene::Scene& scene);
  bool isMoving() const;
  /// At a time, in seconds. A lamp that is off has no intensity: the plan stays.
  Lighting at(double seconds) const;
};

}  // namespace radivox::viewer
