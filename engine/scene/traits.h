// What a scene, a camera and a request contain: nodes read these while declaring, to leave out what is not needed.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <set>
#include <string>

#include "shaders/shared/scene.h"

namespace radivox::scene {

/// Above this share of the surface a few sample points no longer stand for what emits.
constexpr double kMaxSampledEmissiveShare = 0.1;

/// What a scene or a request may lack, so that nodes leave it out (engine/graph/left_out.h lists it with reasons and costs).
enum class Feature : uint32_t {
  AlphaMasks,
  SingleSides,
  Textures,
  PunctualLights,
  Emitters,
  Bounces,      ///< indirect light: nothing bounces, or direct light alone is asked for
  Matrix,       ///< light between clusters, beyond the first bounce
  Readers,      ///< nodes and pictures that nobody asked for
  OtherLights,  ///< more lights than one, and of other kinds
  DarkViews,    ///< shadow maps where no face is, and lights that end before the nearest
  Sky,
  Count
};
constexpr uint32_t kKeepAll = ~0u;
constexpr uint32_t kManyLights = ~0u;

struct Traits {
  uint64_t triangleCount = 0;
  uint64_t vertexCount = 0;
  uint32_t materialCount = 0;
  uint32_t textureCount = 0;
  uint32_t directionalLightCount = 0;
  uint32_t pointLightCount = 0;
  uint32_t spotLightCount = 0;
  uint32_t unreachingLightCount = 0;  ///< of these: whose range ends before the bounds (known where LightOptions::fixed)
  uint32_t shadowViewCount = 0;       ///< likewise, and how many of them no face is in
  uint32_t darkViewCount = 0;
  uint32_t wholeShadowSide = 1, wholeShadowLayers = 1;  ///< what shadow maps would be with those
  uint32_t emissiveTriangleCount = 0;
  bool alphaMasked = false;  ///< some material has alphaMode MASK
  bool singleSided = false;  ///< some material is not double-sided
  bool sky = false;          ///< constant sky radiance above 0, or an image
  bool skyImage = false;
  glm::dvec3 origin{0.0};    ///< Scene::origin: world coordinates = origin + what nodes see; for files that others place
  glm::vec3 boundsMin{0.f};  ///< metres, relative to the scene origin (Scene::origin)
  glm::vec3 boundsMax{0.f};
  double surfaceArea = 0.0;   ///< m², one side of each triangle
  double emissiveArea = 0.0;  ///< m², likewise of the emissive ones
  double shortestEdge = 0.0;  ///< m, of the triangles that have an area; 0: there are none
  /// Emitters light through rays that fetch their B_e, not through samples with shadow maps: more than kMaxSampledEmissiveShare of the
  /// surface emits, or no samples are wanted (traitsFor in gpu_scene.h knows the latter).
  bool emittersByRays = false;

  bool reflects = true;  ///< some material has an albedo above 0
  /// Bits of Feature: what is kept though it is not needed (`--keep-all`). The picture is the same.
  uint32_t kept = 0;

  bool keeps(Feature feature) const { return ((kept >> static_cast<uint32_t>(feature)) & 1u) != 0; }
  bool hasAlphaMasks() const { return alphaMasked || keeps(Feature::AlphaMasks); }
  bool hasSingleSides() const { return singleSided || keeps(Feature::SingleSides); }
  bool hasTextures() const { return textureCount > 0 || keeps(Feature::Textures); }
  /// The kind of the one light that there is, shared::kLight…; kManyLights where there may be more, or emitters.
  uint32_t soleLight() const {
    if (directionalLightCount + pointLightCount + spotLightCount != 1 || emissiveTriangleCount > 0 || keeps(Feature::OtherLights))
      return kManyLights;
    return directionalLightCount > 0 ? shared::kLightDirectional : pointLightCount > 0 ? shared::kLightPoint : shared::kLightSpot;
  }
  bool hasPunctualLights() const { return punctualLightCount() > 0 || keeps(Feature::PunctualLights); }
  bool hasSky() const { return sky || keeps(Feature::Sky); }
  bool hasEmitters() const { return emissiveTriangleCount > 0 || keeps(Feature::Emitters); }
  /// Emission reaches clusters by rays; where nothing emits but is kept, so does nothing.
  bool hasEmissionByRays() const { return emittersByRays || (emissiveTriangleCount == 0 && keeps(Feature::Emitters)); }
  /// Why no light goes from surface to surface; null where it does.
  const char* whyNothingBounces() const {
    if (!lit()) return unreachingLightCount > 0 ? "no light reaches a face" : "no light in the scene";
    if (!reflects) return "every surface is black";
    if (triangleCount > 0 && (boundsMin.x == boundsMax.x || boundsMin.y == boundsMax.y || boundsMin.z == boundsMax.z))
      return "all surfaces lie in one plane";
    return nullptr;
  }

  /// Those that reach a face.
  uint32_t punctualLightCount() const {
    return directionalLightCount + pointLightCount + spotLightCount - (keeps(Feature::DarkViews) ? 0 : unreachingLightCount);
  }
  bool lit() const { return punctualLightCount() + emissiveTriangleCount > 0 || sky; }
};

constexpr uint32_t kAllBounces = 0xffffffffu;

struct Request {
  uint32_t width = 960;
  uint32_t height = 540;
  uint32_t bounces = kAllBounces;  ///< indirect bounces; 0: direct light only
  std::set<std::string> aovs{"color"};
  bool wantsIndirect() const { return bounces > 0; }
};

}  // namespace radivox::scene
