#include "modules/reference/embree_scene.h"

#include <cstddef>
#include <string>

#include "engine/error.h"

namespace radivox::reference {

RTCDevice makeEmbreeDevice() {
  const RTCDevice device = rtcNewDevice(nullptr);
  if (device == nullptr) throw Error(ErrorCode::Unsupported, "Embree does not start on this processor");
  return device;
}

void shareTriangles(RTCGeometry geometry, const std::vector<shared::Vertex>& vertices, const std::vector<uint32_t>& indices) {
  // Vertex is longer than the 16 bytes that Embree loads at once, so the last one may be shared too.
  static_assert(sizeof(shared::Vertex) >= 16 && offsetof(shared::Vertex, position) == 0);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, vertices.data(), 0, sizeof(shared::Vertex),
                             vertices.size());
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, indices.data(), 0, 3 * sizeof(uint32_t),
                             indices.size() / 3);
}

void expectBuilt(RTCDevice device, size_t triangleCount) {
  const RTCError error = rtcGetDeviceError(device);
  if (error == RTC_ERROR_OUT_OF_MEMORY) {
    throw Error(ErrorCode::OutOfMemory,
                "out of memory for the ray hierarchy of " + std::to_string(triangleCount) + " triangles; choose a smaller scene");
  }
  if (error != RTC_ERROR_NONE) throw Error(ErrorCode::DeviceFailed, "Embree error " + std::to_string(error) + " while building");
}

}  // namespace radivox::reference
