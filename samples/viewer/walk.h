// A camera that walks: keys move it along where it looks, the mouse turns it, it stays upright.
#pragma once

#include "engine/scene/scene.h"

namespace radivox::viewer {

class Walk {
 public:
  /// Starts at `camera`, whose lens it keeps. A roll is lost with the first turn.
  explicit Walk(const scene::CameraDescription& camera = {}, float metresPerSecond = 2.f);

  const scene::CameraDescription& camera() const { return camera_; }
  float speed = 2.f;  ///< m/s

  /// right, up, forward in [−1, 1] each. Up is the world's y.
  void move(const glm::vec3& along, float seconds);
  /// Radians; up is limited to straight up and down.
  void turn(float right, float up);
  void jump(const scene::CameraDescription& camera);

 private:
  void orient();
  scene::CameraDescription camera_;
  float yaw_ = 0, pitch_ = 0;
};

/// A pace at which a scene is crossed in about ten seconds.
float walkingSpeed(const scene::Scene& scene);

/// Between two poses: positions along the line, orientations along the great circle.
scene::CameraDescription mixCameras(const scene::CameraDescription& a, const scene::CameraDescription& b, float t);

}  // namespace radivox::viewer
