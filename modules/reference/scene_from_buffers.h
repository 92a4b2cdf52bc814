// The scene, as nodes see it in device buffers, back in host memory: so that the path tracer runs in any graph, without the host's Scene.
#pragma once

#include "engine/graph/node.h"
#include "engine/scene/scene.h"

namespace radivox::reference {

/// All but the texels: textures have their sizes and modes. Reads scene.*; only from stepDone.
scene::Scene readScene(graph::RecordContext& context);
/// view.camera as a description; `width` and `height` are those of the picture.
scene::CameraDescription readCamera(graph::RecordContext& context, uint32_t& width, uint32_t& height);
scene::CameraDescription describeCamera(const shared::Camera& camera);

}  // namespace radivox::reference
