// Suns of an image: texels that no handful of rays finds without noise. Internal to engine/scene.
#pragma once

#include "engine/scene/sky.h"

namespace radivox::scene {

/// Adds to suns, sunShare and notes of `sky`; returns its texels without them.
std::vector<glm::vec3> takeOutSuns(Sky& sky, const std::string& name);

}  // namespace radivox::scene
