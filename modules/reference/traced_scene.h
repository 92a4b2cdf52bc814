// The scene as rays meet it: Embree's hierarchy, surfaces at hits, lights to sample. Internal to modules/reference.
//
// Textures are read as shaders/shared/texture.glsl reads them (bilinear in linear light, wrap modes), always at level 0: the renderer's
// coarser levels stand for the mean over a pixel, and here the samples of the pixel make that mean.
#pragma once

#include <embree3/rtcore.h>

#include <array>

#include "engine/scene/sky.h"
#include "modules/reference/path_tracer.h"
#include "modules/reference/sky_distribution.h"

namespace radivox::reference {

/// A point that light arrives at.
struct Surface {
  glm::vec3 position{0.f};
  glm::vec3 geometric{0.f};  ///< unit, on the side that the ray came from
  glm::vec3 shading{0.f};    ///< unit, on the same side; light counts only above both
  glm::vec3 albedo{0.f};
  glm::vec3 emission{0.f};  ///< L_e towards the ray's origin
  uint32_t triangle = 0;
  float clearance = 0.f;  ///< m; rays start this far off the surface
};

struct EmitterPoint {
  glm::vec3 position{0.f};
  glm::vec3 normal{0.f};    ///< unit, front
  glm::vec3 emission{0.f};  ///< 0 where an alpha mask leaves a hole
  double areaDensity = 0;   ///< probability of the point per m²
  float clearance = 0.f;
};

struct Punctual {
  uint32_t type = 0;
  glm::vec3 position{0.f}, direction{0.f}, intensity{0.f};
  float range = 0.f, cosInner = 0.f, cosOuter = 0.f;
};

/// What every hit needs of its triangle, side by side: vertices by way of indices would be two trips to memory, one after the other, and
/// a fifth of all time.
struct TriangleRecord {
  std::array<glm::vec3, 3> positions, normals;
  uint32_t material;
  float clearance;
};

struct PathTracer::Impl {
  Impl(const scene::Scene& scene, Sides sides);
  ~Impl();
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  /// The nearest surface in (tNear, tFar); `direction` is unit.
  bool findSurface(const glm::vec3& origin, const glm::vec3& direction, float tNear, float tFar, Surface& surface) const;
  /// Does anything stand between `from` and `to`? Both are clear of their own surfaces (clearanceOf).
  bool isBlocked(const glm::vec3& from, const glm::vec3& to) const;
  bool isBlockedAlong(const glm::vec3& from, const glm::vec3& direction) const;

  /// A point on an emissive triangle, chosen by power and then evenly over its area.
  EmitterPoint sampleEmitters(double u, double v, double choice) const;
  /// sampleEmitters' density per m² on this triangle.
  double emitterDensity(uint32_t triangle) const { return emitterDensities.empty() ? 0.0 : emitterDensities[triangle]; }

  /// Unshadowed irradiance of light i on a surface with this shading normal (shaders/shared/light.glsl).
  glm::vec3 punctualIrradiance(size_t i, const glm::vec3& p, const glm::vec3& n) const;

  bool hasEmitters() const { return !emitters.empty(); }
  bool isThere(uint32_t triangle, const glm::vec2& barycentric) const;  ///< not cut away by an alpha mask
  glm::vec3 emissionAt(uint32_t triangle, const glm::vec2& barycentric) const;

  std::vector<shared::Vertex> vertices;
  std::vector<uint32_t> indices, triangleMaterials;
  std::vector<TriangleRecord> triangles;
  std::vector<shared::Material> materials;
  std::vector<scene::TextureImage> textures;
  std::vector<Punctual> lights;
  std::vector<double> lightShares;  ///< cumulative, for choosing among many; the last is 1
  glm::vec3 sky{0.f};               ///< the constant part
  /// Its texels, suns and all; even over each for light, bilinear behind the scene. Null: none.
  std::shared_ptr<const scene::Sky> skyImage;
  SkyDistribution skyDistribution;
  float largestCoordinate = 0.f;
  bool obeysSides = false;  ///< back faces of single-sided materials are not there, and some are single-sided

  struct Emitter {
    uint32_t triangle;
    double share;       ///< of all power
    double cumulative;  ///< up to and with this one
  };
  std::vector<Emitter> emitters;        ///< those with power
  std::vector<float> emitterDensities;  ///< a triangle; empty without emitters
  bool hasUnsampledEmitters = false;    ///< some emit so little in the mean that only the paths' own directions look for them
  double buildSeconds = 0;
  uint64_t fingerprint = 0;

 private:
  void listTriangles();
  void listLights(const scene::Scene& scene);
  void buildHierarchy();
  void attach(const std::vector<uint32_t>& geometryIndices, bool filtered);

  RTCDevice device_ = nullptr;
  RTCScene scene_ = nullptr;
  /// Geometry 0 is taken as it is; geometry 1 asks a filter at each hit (masks, sides). Each knows the triangles it holds.
  std::vector<uint32_t> plainIndices_, filteredIndices_;
  std::vector<uint32_t> plainTriangles_, filteredTriangles_;
  bool isSplit_ = false;  ///< false: one geometry, of all triangles in their order

  uint32_t triangleOf(uint32_t geometry, uint32_t primitive) const;
  static void filterSeen(const RTCFilterFunctionNArguments* arguments);
  static void filterShadow(const RTCFilterFunctionNArguments* arguments);
  bool filterKeeps(const RTCFilterFunctionNArguments* arguments, bool shadow) const;
};

/// How far rays start off a surface whose corners have coordinates up to `largest`: past the rounding of its points and of the
/// intersection, so that neither its own nor a coplanar triangle is met again.
inline float clearanceOf(float largest) { return 2e-6f * largest + 1e-12f; }

inline float luminance(const glm::vec3& c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; }

}  // namespace radivox::reference
