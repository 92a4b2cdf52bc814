#include "modules/reference/traced_scene.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "engine/scene/texture.h"
#include "modules/reference/embree_scene.h"

namespace radivox::reference {

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
/// Above this, spatial splits cost more time to build than most pictures take to trace.
constexpr size_t kMostTrianglesForSplits = 4000000;

glm::vec2 interpolateUv(const std::vector<shared::Vertex>& vertices, const uint32_t* corners, const glm::vec2& b,
                        glm::vec2 shared::Vertex::*member) {
  return (1.f - b.x - b.y) * (vertices[corners[0]].*member) + b.x * (vertices[corners[1]].*member) + b.y * (vertices[corners[2]].*member);
}

float largestOf(const glm::vec3& p) {
  const glm::vec3 a = glm::abs(p);
  return std::max(a.x, std::max(a.y, a.z));
}

RTCRay makeRay(const glm::vec3& origin, const glm::vec3& direction, float tNear, float tFar) {
  RTCRay ray{};
  ray.org_x = origin.x;
  ray.org_y = origin.y;
  ray.org_z = origin.z;
  ray.dir_x = direction.x;
  ray.dir_y = direction.y;
  ray.dir_z = direction.z;
  ray.tnear = tNear;
  ray.tfar = tFar;
  ray.mask = 0xffffffffu;
  return ray;
}

}  // namespace

PathTracer::Impl::~Impl() {
  if (scene_ != nullptr) rtcReleaseScene(scene_);
  if (device_ != nullptr) rtcReleaseDevice(device_);
}

void PathTracer::Impl::listTriangles() {
  triangles.reserve(triangleMaterials.size());
  for (size_t t = 0; t < triangleMaterials.size(); ++t) {
    TriangleRecord record;
    float largest = 0.f;
    for (size_t k = 0; k < 3; ++k) {
      const shared::Vertex& vertex = vertices[indices[3 * t + k]];
      record.positions[k] = vertex.position;
      record.normals[k] = vertex.normal;
      largest = std::max(largest, largestOf(vertex.position));
    }
    record.material = triangleMaterials[t];
    record.clearance = clearanceOf(largest);
    triangles.push_back(record);
    largestCoordinate = std::max(largestCoordinate, largest);
  }
}

void PathTracer::Impl::attach(const std::vector<uint32_t>& geometryIndices, bool filtered) {
  const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
  shareTriangles(geometry, vertices, geometryIndices);
  if (filtered) {
    rtcSetGeometryUserData(geometry, this);
    rtcSetGeometryIntersectFilterFunction(geometry, filterSeen);
    rtcSetGeometryOccludedFilterFunction(geometry, filterShadow);
  }
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(scene_, geometry, filtered ? 1 : 0);
  rtcReleaseGeometry(geometry);
}

void PathTracer::Impl::buildHierarchy() {
  const auto start = std::chrono::steady_clock::now();
  device_ = makeEmbreeDevice();
  scene_ = rtcNewScene(device_);
  rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(scene_, indices.size() / 3 <= kMostTrianglesForSplits ? RTC_BUILD_QUALITY_HIGH : RTC_BUILD_QUALITY_MEDIUM);

  const auto isFiltered = [&](size_t t) {
    const uint32_t flags = materials[triangleMaterials[t]].flags;
    return (flags & shared::kMaterialAlphaMask) != 0u || (obeysSides && (flags & shared::kMaterialDoubleSided) == 0u);
  };
  const size_t triangleCount = indices.size() / 3;
  for (size_t t = 0; t < triangleCount && !isSplit_; ++t) isSplit_ = isFiltered(t);
  if (isSplit_) {
    for (size_t t = 0; t < triangleCount; ++t) {
      const bool filtered = isFiltered(t);
      const auto corners = indices.begin() + static_cast<std::ptrdiff_t>(3 * t);
      auto& to = filtered ? filteredIndices_ : plainIndices_;
      to.insert(to.end(), corners, corners + 3);
      (filtered ? filteredTriangles_ : plainTriangles_).push_back(static_cast<uint32_t>(t));
    }
    if (!plainIndices_.empty()) attach(plainIndices_, false);
    attach(filteredIndices_, true);
  } else if (triangleCount > 0) {
    attach(indices, false);
  }
  // On one thread: which of two coplanar triangles is met first depends on the hierarchy, and that on how its building was shared out.
  tbb::task_arena(1).execute([&] { rtcCommitScene(scene_); });
  expectBuilt(device_, triangleCount);
  buildSeconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

uint32_t PathTracer::Impl::triangleOf(uint32_t geometry, uint32_t primitive) const {
  if (!isSplit_) return primitive;
  return geometry == 0 ? plainTriangles_[primitive] : filteredTriangles_[primitive];
}

bool PathTracer::Impl::isThere(uint32_t triangle, const glm::vec2& barycentric) const {
  const shared::Material& material = materials[triangleMaterials[triangle]];
  if ((material.flags & shared::kMaterialAlphaMask) == 0u) return true;
  float alpha = material.alpha;
  if (material.baseTexture != shared::kNoTexture) {
    const glm::vec2 uv = interpolateUv(vertices, &indices[size_t{3} * triangle], barycentric, &shared::Vertex::uvBase);
    alpha *= scene::sampleTexture(textures[material.baseTexture], uv).a;
  }
  return alpha >= material.alphaCutoff;
}

glm::vec3 PathTracer::Impl::emissionAt(uint32_t triangle, const glm::vec2& barycentric) const {
  const shared::Material& material = materials[triangleMaterials[triangle]];
  if ((material.flags & shared::kMaterialEmissive) == 0u) return glm::vec3(0.f);
  if (material.emissiveTexture == shared::kNoTexture) return material.emission;
  const glm::vec2 uv = interpolateUv(vertices, &indices[size_t{3} * triangle], barycentric, &shared::Vertex::uvEmissive);
  return material.emission * glm::vec3(scene::sampleTexture(textures[material.emissiveTexture], uv));
}

/// Is the hit a surface? Seen surfaces turn their front to the ray's origin; surfaces that cast shadows turn it to the light, which lies
/// ahead (as in frame.shadow_map).
bool PathTracer::Impl::filterKeeps(const RTCFilterFunctionNArguments* arguments, bool shadow) const {
  const unsigned n = arguments->N;
  const uint32_t triangle = triangleOf(1, RTCHitN_primID(arguments->hit, n, 0));
  if (!isThere(triangle, {RTCHitN_u(arguments->hit, n, 0), RTCHitN_v(arguments->hit, n, 0)})) return false;
  if (!obeysSides || (materials[triangleMaterials[triangle]].flags & shared::kMaterialDoubleSided) != 0u) return true;
  const uint32_t* corners = &indices[size_t{3} * triangle];
  const glm::vec3 p0 = vertices[corners[0]].position;
  const glm::vec3 normal = glm::cross(vertices[corners[1]].position - p0, vertices[corners[2]].position - p0);
  const glm::vec3 direction(RTCRayN_dir_x(arguments->ray, n, 0), RTCRayN_dir_y(arguments->ray, n, 0), RTCRayN_dir_z(arguments->ray, n, 0));
  const float facing = glm::dot(normal, direction);
  return shadow ? facing >= 0.f : facing < 0.f;
}

void PathTracer::Impl::filterSeen(const RTCFilterFunctionNArguments* arguments) {
  if (!static_cast<const Impl*>(arguments->geometryUserPtr)->filterKeeps(arguments, false)) arguments->valid[0] = 0;
}

void PathTracer::Impl::filterShadow(const RTCFilterFunctionNArguments* arguments) {
  if (!static_cast<const Impl*>(arguments->geometryUserPtr)->filterKeeps(arguments, true)) arguments->valid[0] = 0;
}

bool PathTracer::Impl::findSurface(const glm::vec3& origin, const glm::vec3& direction, float tNear, float tFar, Surface& surface) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit query{};
  query.ray = makeRay(origin, direction, tNear, tFar);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(scene_, &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;

  const uint32_t triangle = triangleOf(query.hit.geomID, query.hit.primID);
  const TriangleRecord& record = triangles[triangle];
  const glm::vec2 b(query.hit.u, query.hit.v);
  const float b0 = 1.f - b.x - b.y;
  const auto& [p0, p1, p2] = record.positions;
  surface.triangle = triangle;
  surface.position = b0 * p0 + b.x * p1 + b.y * p2;  // on the plane, however far the ray came
  surface.clearance = record.clearance;
  glm::vec3 geometric = glm::normalize(glm::cross(p1 - p0, p2 - p0));
  const bool front = glm::dot(geometric, direction) < 0.f;
  if (!front) geometric = -geometric;
  surface.geometric = geometric;
  const glm::vec3 normal = b0 * record.normals[0] + b.x * record.normals[1] + b.y * record.normals[2];
  const float length2 = glm::dot(normal, normal);
  surface.shading = length2 > 1e-12f ? normal / std::sqrt(length2) : geometric;
  if (glm::dot(surface.shading, geometric) < 0.f) surface.shading = -surface.shading;

  const shared::Material& material = materials[record.material];
  surface.albedo = material.albedo;
  if (material.baseTexture != shared::kNoTexture) {
    const glm::vec2 uv = interpolateUv(vertices, &indices[size_t{3} * triangle], b, &shared::Vertex::uvBase);
    surface.albedo = glm::min(surface.albedo * glm::vec3(scene::sampleTexture(textures[material.baseTexture], uv)), glm::vec3(0.999f));
  }
  surface.emission = front ? emissionAt(triangle, b) : glm::vec3(0.f);
  return true;
}

bool PathTracer::Impl::isBlocked(const glm::vec3& from, const glm::vec3& to) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRay ray = makeRay(from, to - from, 0.f, 1.f);
  rtcOccluded1(scene_, &context, &ray);
  return ray.tfar < 0.f;
}

bool PathTracer::Impl::isBlockedAlong(const glm::vec3& from, const glm::vec3& direction) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRay ray = makeRay(from, direction, 0.f, kInfinity);
  rtcOccluded1(scene_, &context, &ray);
  return ray.tfar < 0.f;
}

}  // namespace radivox::reference
