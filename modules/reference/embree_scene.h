// What building a hierarchy over a scene's triangles asks of Embree, whoever traces it.
#pragma once

#include <embree3/rtcore.h>

#include <cstdint>
#include <vector>

#include "shaders/shared/scene.h"

namespace radivox::reference {

/// Throws Unsupported where Embree does not start.
RTCDevice makeEmbreeDevice();
/// Embree reads the vectors in place: they outlive the geometry, unchanged.
void shareTriangles(RTCGeometry geometry, const std::vector<shared::Vertex>& vertices, const std::vector<uint32_t>& indices);
/// After rtcCommitScene: throws OutOfMemory or DeviceFailed if it went wrong.
void expectBuilt(RTCDevice device, size_t triangleCount);

}  // namespace radivox::reference
