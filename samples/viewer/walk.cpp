#include "samples/viewer/walk.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

namespace radivox::viewer {

Walk::Walk(const scene::CameraDescription& camera, float metresPerSecond) : speed(metresPerSecond) { jump(camera); }

void Walk::jump(const scene::CameraDescription& camera) {
  camera_ = camera;
  const glm::vec3 forward = camera.orientation * glm::vec3(0, 0, -1);
  pitch_ = std::asin(std::clamp(forward.y, -1.f, 1.f));
  // Straight up or down the view's own up says where it would look.
  const glm::vec3 level = std::abs(forward.y) < 0.9999f ? forward : camera.orientation * glm::vec3(0, forward.y > 0 ? -1.f : 1.f, 0);
  yaw_ = std::atan2(-level.x, -level.z);
}

void Walk::orient() {
  camera_.orientation = glm::normalize(glm::angleAxis(yaw_, glm::vec3(0, 1, 0)) * glm::angleAxis(pitch_, glm::vec3(1, 0, 0)));
}

void Walk::move(const glm::vec3& along, float seconds) {
  const glm::vec3 right = camera_.orientation * glm::vec3(1, 0, 0), forward = camera_.orientation * glm::vec3(0, 0, -1);
  camera_.position += (along.x * right + along.y * glm::vec3(0, 1, 0) + along.z * forward) * (speed * seconds);
}

void Walk::turn(float right, float up) {
  constexpr float kMostPitch = 0.5f * glm::pi<float>() - 1e-3f;
  yaw_ = std::remainder(yaw_ - right, 2.f * glm::pi<float>());
  pitch_ = std::clamp(pitch_ + up, -kMostPitch, kMostPitch);
  orient();
}

float walkingSpeed(const scene::Scene& scene) {
  const scene::Traits traits = scene.traits();
  const float size = glm::length(traits.boundsMax - traits.boundsMin);
  return size > 0.f ? size / 10.f : 1.f;
}

scene::CameraDescription mixCameras(const scene::CameraDescription& a, const scene::CameraDescription& b, float t) {
  scene::CameraDescription camera = a;
  camera.position = glm::mix(a.position, b.position, t);
  camera.orientation = glm::normalize(glm::slerp(a.orientation, b.orientation, t));
  camera.yfov = glm::mix(a.yfov, b.yfov, t);
  camera.ymag = glm::mix(a.ymag, b.ymag, t);
  camera.znear = glm::mix(a.znear, b.znear, t);
  camera.zfar = glm::mix(a.zfar, b.zfar, t);
  return camera;
}

}  // namespace radivox::viewer
