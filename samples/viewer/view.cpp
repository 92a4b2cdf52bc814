#include "samples/viewer/view.h"

namespace radivox::viewer {

const std::vector<std::string>& overlayNames() {
  static const std::vector<std::string> names = {
      "picture", "voxels", "clusters", "cluster_normals", "irradiance_direct", "irradiance_indirect", "visible_clusters", "error"};
  return names;
}

namespace {

bool isSameLight(const scene::PunctualLight& a, const scene::PunctualLight& b) {
  return a.type == b.type && a.position == b.position && a.direction == b.direction && a.intensity == b.intensity && a.range == b.range &&
         a.innerConeAngle == b.innerConeAngle && a.outerConeAngle == b.outerConeAngle;
}

}  // namespace

bool operator==(const Lighting& a, const Lighting& b) {
  if (a.lights.size() != b.lights.size() || a.sky != b.sky) return false;
  for (size_t i = 0; i < a.lights.size(); ++i) {
    if (!isSameLight(a.lights[i], b.lights[i])) return false;
  }
  return true;
}

bool operator==(const scene::CameraDescription& a, const scene::CameraDescription& b) {
  return a.position == b.position && a.orientation == b.orientation && a.orthographic == b.orthographic && a.yfov == b.yfov &&
         a.ymag == b.ymag && a.znear == b.znear && a.zfar == b.zfar;
}

bool wantsSameLight(const View& a, const View& b) {
  return a.scene == b.scene && a.graph == b.graph && a.settings == b.settings && a.bounces == b.bounces && a.lighting == b.lighting;
}

}  // namespace radivox::viewer
