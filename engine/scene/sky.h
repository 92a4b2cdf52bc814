// An image-based sky: equirectangular radiance, and what is derived from it once. Orientation: shaders/shared/sky.h.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/image/image.h"
#include "engine/scene/scene.h"

namespace radivox::scene {

constexpr uint32_t kMostSkyWidth = 4096;  ///< texels; wider images are halved

/// Immutable: scenes that differ in their lights share it.
struct Sky {
  uint32_t width = 0, height = 0;
  std::vector<glm::vec3> texels;  ///< W/(m² sr), rows from +y; the whole image, suns included
  float turn = 0.f;               ///< radians about +y
  /// What no handful of rays finds without noise, as directional lights. The renderer has these beside bins and cells; the path tracer
  /// has the texels alone.
  std::vector<PunctualLight> suns;
  std::vector<glm::vec3> bins, cells;  ///< means over solid angle without the suns (shaders/shared/sky.h)
  double sunShare = 0;                 ///< of the image's flux that the suns carry
  std::vector<std::string> notes;      ///< what was done to the image, one line each

  /// Through the middle of texel space: u, v in [0, 1].
  glm::dvec3 direction(double u, double v) const;
  /// Column and row of the texel in that unit direction.
  glm::uvec2 texelAt(const glm::vec3& direction) const;
  glm::vec3 radiance(const glm::vec3& direction) const;      ///< of that texel
  glm::vec3 interpolated(const glm::vec3& direction) const;  ///< bilinear, as the picture's background is
  /// sr, of a texel in this row.
  double solidAngle(uint32_t row) const;
};

enum class Suns { TakeOut, Keep };

/// Suns are what is brighter than both 16 times the mean of the rest and all but 0.02 sr of the image (a disc of 4.6°), where one connected
/// patch of it carries at least 1 % of the image's flux: at most four such patches, brightest first. Their texels are cut to that limit, and the flux
/// above it becomes a directional light each, from where it came from on average. `turn` in degrees. Throws BadInput naming `name` for an image
/// that is not twice as wide as high, and for texels that are not finite or below 0.
std::shared_ptr<const Sky> makeSky(const image::Image& image, const std::string& name, double scale = 1, double turn = 0,
                                   Suns suns = Suns::TakeOut);

/// FILE.exr|.hdr or builtin:clear, with ?scale=X&turn=DEGREES&sun=keep. Throws BadInput naming file, place and mend.
std::shared_ptr<const Sky> loadSky(const std::string& sky);

}  // namespace radivox::scene
