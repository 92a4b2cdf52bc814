// Steps of setUpLights: emitters, views, tiles. Internal to engine/scene.
#pragma once

#include "engine/scene/gpu_scene.h"

namespace radivox::scene {

/// Emissive triangles with their mean emission and cumulative power.
std::vector<shared::EmissiveTriangle> listEmitters(const Scene& scene);
/// `count` points on them, stratified by power.
std::vector<shared::Light> sampleEmitters(const Scene& scene, const std::vector<shared::EmissiveTriangle>& emitters, uint32_t count);

/// Texels a side of each kind of view.
struct ViewResolutions {
  uint32_t directional, spot, point, emitter;
};
/// The light's views, appended; sets firstShadowView and shadowViewCount.
void appendViews(const Scene& scene, const Traits& traits, const ViewResolutions& resolutions, uint32_t lightIndex, shared::Light& light,
                 std::vector<shared::ShadowView>& views);
uint32_t viewCountOf(const shared::Light& light);
uint32_t viewResolutionOf(const shared::Light& light, const ViewResolutions& resolutions, uint32_t view);

/// Places square tiles on layers of one size: rows of tiles, largest first. Returns the number of layers; sets layer, offsetX, offsetY.
uint32_t packTiles(std::vector<shared::ShadowView>& views, uint32_t side);
/// A side that holds the largest tile and few layers, a power of two unless a tile asks for more.
uint32_t chooseLayerSide(const std::vector<shared::ShadowView>& views, uint32_t maxSide);

/// Does the light's range end before the scene's bounds?
bool endsBefore(const Traits& traits, const shared::Light& light);
/// Which views no triangle is in, or whose light ends before the nearest: what they would hold is nothing, or nothing that is looked up.
std::vector<bool> findDarkViews(const Scene& scene, const Traits& traits, const std::vector<shared::Light>& lights,
                                const std::vector<shared::ShadowView>& views);

/// A square view along `forward`; `tangent` of half its angle. `up` is square to `forward`.
shared::ShadowView makePerspectiveView(const glm::dvec3& position, const glm::dvec3& forward, const glm::dvec3& up, double tangent,
                                       double znear, uint32_t resolution);
shared::ShadowView makeParallelView(const Scene& scene, const glm::dvec3& direction, uint32_t resolution);

}  // namespace radivox::scene
