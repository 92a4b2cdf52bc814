// What the session hands out: one finished picture and what there is to say about it. Host memory only, so that any thread may hold it.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/graph/executor.h"
#include "engine/image/compare.h"
#include "samples/viewer/view.h"

namespace radivox::viewer {

/// RGBA, sRGB-encoded, rows from the top.
struct Pixels {
  uint32_t width = 0, height = 0;
  std::vector<uint8_t> rgba;
};

/// Of display-referred linear values, 1 or 3 channels; what is no number is black.
Pixels encodePixels(const image::Image& image);

/// The voxel face under the mouse, and what its rays found.
struct PointedFace {
  uint32_t id = 0;
  glm::uvec3 voxel{0};
  uint32_t direction = 0;  ///< 0 … 5: +x −x +y −y +z −z
  float area = 0;          ///< m²
  glm::vec3 position{0.f}, normal{0.f}, albedo{0.f};
  uint32_t cluster = 0;
  std::optional<glm::vec3> direct, indirect;  ///< E, W/m²
  uint32_t rayCount = 0;
  std::map<uint32_t, uint32_t> clusters;  ///< rays by cluster
  std::map<uint32_t, uint32_t> faces;     ///< rays that keep their face
  uint32_t misses = 0;                    ///< rays that left the scene
  uint32_t absorbed = 0;                  ///< rays that ended on the back of a one-sided surface
  struct Ray {
    glm::vec3 end{0.f};      ///< metres; a miss: where it leaves the voxels
    uint32_t hit = ~0u;      ///< face; ~0: none
    uint32_t cluster = ~0u;  ///< of that face
  };
  std::vector<Ray> rays;  ///< those counted; where the graph traces them in a way of its own, one to the middle of each cluster
};

/// What ran, for the graph panel.
struct GraphReport {
  graph::FrameStats stats;
  std::string graph, device;
  std::vector<std::string> notes;  ///< what had to be lowered to fit
  std::string plan;                ///< as `radivox graph` prints it
};

struct Picture {
  std::shared_ptr<const Pixels> pixels;
  View view;             ///< that it shows
  bool preview = false;  ///< cheap settings: a better one follows
  float exposure = 1.f;  ///< radiance → display
  bool filmic = false;   ///< the tone map's operator
  double milliseconds = 0;
  std::shared_ptr<const GraphReport> report;
  std::shared_ptr<const PointedFace> pointed;
  std::shared_ptr<const image::Comparison> error;  ///< of Overlay::Error
  std::string remark;                              ///< why the overlay shows nothing; empty: it does
};

}  // namespace radivox::viewer
