#include "modules/reference/closest_hits.h"

#include <embree3/rtcore.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <limits>

#include "modules/reference/embree_scene.h"
#include "modules/reference/rendering_state.h"

namespace radivox::reference {

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr size_t kStream = 256;  ///< rays

float distanceOf(float tFar) { return tFar < kInfinity ? tFar : -1.f; }

RTCRayHit makeQuery(const ClosestHits::Ray& ray) {
  RTCRayHit query{};
  query.ray.org_x = ray.origin.x;
  query.ray.org_y = ray.origin.y;
  query.ray.org_z = ray.origin.z;
  query.ray.dir_x = ray.direction.x;
  query.ray.dir_y = ray.direction.y;
  query.ray.dir_z = ray.direction.z;
  query.ray.tfar = kInfinity;
  query.ray.mask = 0xffffffffu;
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  return query;
}

void traceSingle(RTCScene scene, const ClosestHits::Ray* rays, float* distances, size_t count) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  for (size_t i = 0; i < count; ++i) {
    RTCRayHit query = makeQuery(rays[i]);
    rtcIntersect1(scene, &context, &query);
    distances[i] = distanceOf(query.ray.tfar);
  }
}

void traceStream(RTCScene scene, const ClosestHits::Ray* rays, float* distances, size_t count) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  RTCRayHit queries[kStream];
  for (size_t first = 0; first < count; first += kStream) {
    const size_t n = std::min(kStream, count - first);
    for (size_t i = 0; i < n; ++i) queries[i] = makeQuery(rays[first + i]);
    rtcIntersect1M(scene, &context, queries, static_cast<unsigned>(n), sizeof(RTCRayHit));
    for (size_t i = 0; i < n; ++i) distances[first + i] = distanceOf(queries[i].ray.tfar);
  }
}

template <class Packet, size_t kWidth, class Intersect>
void tracePackets(const ClosestHits::Ray* rays, float* distances, size_t count, const Intersect& intersect) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  alignas(64) int valid[kWidth];
  Packet packet{};
  for (size_t first = 0; first < count; first += kWidth) {
    for (size_t i = 0; i < kWidth; ++i) {
      const ClosestHits::Ray& ray = rays[std::min(first + i, count - 1)];
      valid[i] = first + i < count ? -1 : 0;
      packet.ray.org_x[i] = ray.origin.x;
      packet.ray.org_y[i] = ray.origin.y;
      packet.ray.org_z[i] = ray.origin.z;
      packet.ray.dir_x[i] = ray.direction.x;
      packet.ray.dir_y[i] = ray.direction.y;
      packet.ray.dir_z[i] = ray.direction.z;
      packet.ray.tfar[i] = kInfinity;
      packet.ray.mask[i] = 0xffffffffu;
      packet.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
    }
    intersect(valid, &context, &packet);
    for (size_t i = 0; i < std::min(kWidth, count - first); ++i) distances[first + i] = distanceOf(packet.ray.tfar[i]);
  }
}

}  // namespace

struct ClosestHits::Impl {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  ~Impl() {
    if (scene != nullptr) rtcReleaseScene(scene);
    if (device != nullptr) rtcReleaseDevice(device);
  }
  void trace(const Ray* rays, float* distances, size_t count, Way way) const {
    switch (way) {
      case Way::Single:
        return traceSingle(scene, rays, distances, count);
      case Way::Packet4:
        return tracePackets<RTCRayHit4, 4>(
            rays, distances, count, [this](auto* valid, auto* context, auto* packet) { rtcIntersect4(valid, scene, context, packet); });
      case Way::Packet8:
        return tracePackets<RTCRayHit8, 8>(
            rays, distances, count, [this](auto* valid, auto* context, auto* packet) { rtcIntersect8(valid, scene, context, packet); });
      case Way::Packet16:
        return tracePackets<RTCRayHit16, 16>(
            rays, distances, count, [this](auto* valid, auto* context, auto* packet) { rtcIntersect16(valid, scene, context, packet); });
      case Way::Stream:
        return traceStream(scene, rays, distances, count);
    }
  }
};

std::string_view ClosestHits::name(Way way) {
  switch (way) {
    case Way::Single:
      return "single";
    case Way::Packet4:
      return "packet4";
    case Way::Packet8:
      return "packet8";
    case Way::Packet16:
      return "packet16";
    case Way::Stream:
      return "stream";
  }
  return {};
}

ClosestHits::ClosestHits(const scene::Scene& scene) : impl_(std::make_unique<Impl>()) {
  impl_->device = makeEmbreeDevice();
  impl_->scene = rtcNewScene(impl_->device);
  rtcSetSceneBuildQuality(impl_->scene, RTC_BUILD_QUALITY_HIGH);
  const RTCGeometry geometry = rtcNewGeometry(impl_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_HIGH);
  shareTriangles(geometry, scene.vertices, scene.indices);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(impl_->scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(impl_->scene);
  expectBuilt(impl_->device, scene.triangleCount());
}

ClosestHits::~ClosestHits() = default;

std::vector<ClosestHits::Way> ClosestHits::ways() const {
  const auto has = [this](RTCDeviceProperty property) { return rtcGetDeviceProperty(impl_->device, property) != 0; };
  std::vector<Way> found = {Way::Single};
  if (has(RTC_DEVICE_PROPERTY_NATIVE_RAY4_SUPPORTED)) found.push_back(Way::Packet4);
  if (has(RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED)) found.push_back(Way::Packet8);
  if (has(RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED)) found.push_back(Way::Packet16);
  if (has(RTC_DEVICE_PROPERTY_RAY_STREAM_SUPPORTED)) found.push_back(Way::Stream);
  return found;
}

double ClosestHits::trace(std::span<const Ray> rays, std::span<float> distances, Way way, uint32_t threads) const {
  tbb::task_arena arena(arenaSize(threads));
  arena.initialize();
  const auto start = std::chrono::steady_clock::now();
  arena.execute([&] {
    tbb::parallel_for(tbb::blocked_range<size_t>(0, rays.size(), 16 * kStream), [&](const tbb::blocked_range<size_t>& range) {
      impl_->trace(rays.data() + range.begin(), distances.data() + range.begin(), range.size(), way);
    });
  });
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace radivox::reference
