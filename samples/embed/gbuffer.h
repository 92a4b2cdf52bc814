// The host's own renderer: its vertices, its pipeline, its images. It would be here without Radivox, too.
#pragma once

#include <array>
#include <glm/glm.hpp>

#include "host.h"

// As view.glsl has them.
struct HostVertex {
  glm::vec3 position, normal, albedo, emission;
};
struct HostView {
  glm::mat4 viewProjection, inverseViewProjection;  ///< reversed z, infinite far plane
  glm::vec3 eye, forward;
  glm::uvec2 size;
};

class HostGBuffer {
 public:
  /// Images are also used as storage images: that is how Radivox reads them.
  HostGBuffer(Host& host, const std::vector<HostVertex>& vertices);  ///< triangle list
  ~HostGBuffer();
  HostGBuffer(const HostGBuffer&) = delete;
  HostGBuffer& operator=(const HostGBuffer&) = delete;

  /// Leaves the images in COLOR_ATTACHMENT_OPTIMAL. The GPU must be done with earlier frames: there is one view.
  void draw(VkCommandBuffer commands, const HostView& view) const;

  enum { Position, Normal, Albedo, Emission, Triangle, Count };
  std::array<HostImage, Count> images;

 private:
  Host& host_;
  HostImage depth_;
  HostBuffer vertices_, view_;
  uint32_t vertexCount_;
  VkPipelineLayout layout_ = VK_NULL_HANDLE;
  VkPipeline pipeline_ = VK_NULL_HANDLE;
};
