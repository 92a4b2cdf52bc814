#include "samples/viewer/lamps.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/quaternion.hpp>

namespace radivox::viewer {

namespace {

constexpr float kTurnPerReach = 0.5f;  // rad

void moveLamp(const Lamp& lamp, double seconds, scene::PunctualLight& light) {
  const double turns = seconds / std::max(static_cast<double>(lamp.period), 1e-3);
  const auto angle = static_cast<float>((turns - std::floor(turns)) * 2.0 * glm::pi<double>());
  const bool directional = light.type == shared::kLightDirectional;
  switch (lamp.motion) {
    case Motion::Still:
      break;
    case Motion::Circle:
      if (directional) {
        light.direction = glm::angleAxis(angle, glm::vec3(0, 1, 0)) * light.direction;
      } else {
        light.position += lamp.reach * glm::vec3(std::cos(angle) - 1.f, 0.f, std::sin(angle));
      }
      break;
    case Motion::Swing:
      if (directional) {
        glm::vec3 axis = glm::cross(light.direction, glm::vec3(0, 1, 0));
        axis = glm::dot(axis, axis) > 1e-6f ? glm::normalize(axis) : glm::vec3(1, 0, 0);
        light.direction = glm::angleAxis(kTurnPerReach * lamp.reach * std::sin(angle), axis) * light.direction;
      } else {
        light.position.x += lamp.reach * std::sin(angle);
      }
      break;
    case Motion::Pulse:
      light.intensity *= 1.f + std::sin(angle);
      break;
  }
}

}  // namespace

const std::vector<std::string>& motionNames() {
  static const std::vector<std::string> names = {"still", "circle", "swing", "pulse"};
  return names;
}

Lamps Lamps::of(const scene::Scene& scene) {
  Lamps lamps;
  for (const scene::PunctualLight& light : scene.lights) lamps.lamps.push_back({light});
  lamps.sky = scene.skyRadiance;
  return lamps;
}

bool Lamps::isMoving() const {
  return std::any_of(lamps.begin(), lamps.end(), [](const Lamp& lamp) { return lamp.on && lamp.motion != Motion::Still; });
}

Lighting Lamps::at(double seconds) const {
  Lighting lighting;
  lighting.sky = sky;
  for (const Lamp& lamp : lamps) {
    scene::PunctualLight light = lamp.light;
    moveLamp(lamp, seconds, light);
    if (!lamp.on) light.intensity = glm::vec3(0.f);
    lighting.lights.push_back(light);
  }
  return lighting;
}

}  // namespace radivox::viewer
