// Cameras: projection, lookup, the default view.
#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_inverse.hpp>

#include "engine/error.h"
#include "engine/params/params.h"
#include "engine/scene/geometry.h"

namespace radivox::scene {

glm::quat orientationFrom(const glm::dvec3& forward, const glm::dvec3& up) {
  const glm::dvec3 z = -glm::normalize(forward);
  glm::dvec3 x = glm::cross(up, z);
  if (!(glm::dot(x, x) > 1e-20 * glm::dot(up, up))) {  // up is along the view: any other axis will do
    x = glm::cross(std::abs(z.x) < 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 0, 1), z);
  }
  x = glm::normalize(x);
  return glm::normalize(glm::quat(glm::quat_cast(glm::dmat3(x, glm::cross(z, x), z))));
}

CameraDescription makeDefaultCamera(const Scene& scene) {
  const Traits traits = scene.traits();
  const glm::dvec3 centre = (glm::dvec3(traits.boundsMin) + glm::dvec3(traits.boundsMax)) * 0.5;
  double radius = glm::length(glm::dvec3(traits.boundsMax) - glm::dvec3(traits.boundsMin)) * 0.5;
  if (!(radius > 0)) radius = 1;
  const glm::dvec3 towardsEye = glm::normalize(glm::dvec3(1.0, 0.7, 1.2));
  CameraDescription camera;
  camera.name = "default";
  camera.yfov = 0.8f;
  camera.position = glm::vec3(centre + towardsEye * (radius / std::sin(0.4) * 1.02));
  camera.orientation = orientationFrom(-towardsEye, glm::dvec3(0, 1, 0));
  camera.znear = static_cast<float>(radius * 2e-3);
  camera.zfar = static_cast<float>(radius * 10);
  return camera;
}

const CameraDescription& findCamera(const Scene& scene, const std::string& nameOrIndex) {
  for (const auto& camera : scene.cameras) {
    if (camera.name == nameOrIndex) return camera;
  }
  if (!nameOrIndex.empty() && nameOrIndex.size() < 9 && nameOrIndex.find_first_not_of("0123456789") == std::string::npos) {
    const size_t index = std::stoul(nameOrIndex);
    if (index < scene.cameras.size()) return scene.cameras[index];
  }
  std::string list;
  std::vector<std::string> names;
  for (size_t i = 0; i < scene.cameras.size(); ++i) {
    list += (i > 0 ? ", " : "") + std::to_string(i) + " \"" + scene.cameras[i].name + "\"";
    names.push_back(scene.cameras[i].name);
  }
  const std::string nearest = params::nearestName(nameOrIndex, names);
  throw Error(ErrorCode::BadInput, scene.name + ": no camera \"" + nameOrIndex + "\"; there are: " + list +
                                       (nearest.empty() ? "" : ". Did you mean \"" + nearest + "\"?"));
}

shared::Camera makeCamera(const CameraDescription& camera, uint32_t width, uint32_t height) {
  const double aspect = static_cast<double>(width) / static_cast<double>(height);
  const glm::dmat3 axes = glm::mat3_cast(glm::normalize(glm::dquat(camera.orientation)));  // columns: right, up, backward
  const glm::dvec3 position(camera.position);
  glm::dmat4 view = glm::dmat4(glm::transpose(axes));
  view[3] = glm::dvec4(-(glm::transpose(axes) * position), 1.0);
  glm::dmat4 viewInverse = glm::dmat4(axes);
  viewInverse[3] = glm::dvec4(position, 1.0);

  // Vulkan's clip space has y down, hence the minus. Depth is reversed: 1 at the near plane, 0 at the far one.
  glm::dmat4 projection(0.0);
  double halfHeight = 0;
  const double znear = camera.znear;
  if (camera.orthographic) {
    halfHeight = camera.ymag;
    const double range = camera.zfar - znear;
    projection[0][0] = 1.0 / (halfHeight * aspect);
    projection[1][1] = -1.0 / halfHeight;
    projection[2][2] = 1.0 / range;
    projection[3][2] = camera.zfar / range;
    projection[3][3] = 1.0;
  } else {
    halfHeight = std::tan(0.5 * static_cast<double>(camera.yfov));
    projection[0][0] = 1.0 / (halfHeight * aspect);
    projection[1][1] = -1.0 / halfHeight;
    projection[2][3] = -1.0;
    projection[3][2] = znear;
  }
  shared::Camera out{};
  out.viewProjection = glm::mat4(projection * view);
  out.inverseViewProjection = glm::mat4(viewInverse * glm::inverse(projection));
  out.position = camera.position;
  out.orthographic = camera.orthographic ? 1u : 0u;
  out.forward = glm::vec3(-axes[2]);
  out.pixelAngle = static_cast<float>(2.0 * halfHeight / height);
  out.width = width;
  out.height = height;
  return out;
}

}  // namespace radivox::scene
