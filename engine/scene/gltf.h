// glTF 2.0 → Scene and back. Read with a JSON parser and our own checks rather than a glTF library: those stop at the first oddity without
// saying where, or read past it. The tests hold the writer to an independent reader.
#pragma once

#include "engine/scene/scene.h"

namespace radivox::scene {

/// Node hierarchy, instancing (flattened), indexed or not, all component types and modes triangles/strip/fan, base colour factor and
/// texture with sampler and texcoord set, KHR_texture_transform, alpha mask, double-sided, emissive + KHR_materials_emissive_strength,
/// KHR_lights_punctual, KHR_mesh_quantization, cameras. Missing normals are computed (flat). Throws BadInput in one line naming the file,
/// the JSON place ("meshes[3].primitives[0].attributes.POSITION") and the mend. What is skipped lands in Scene::warnings.
Scene importGltf(const std::string& path);

/// Writes positions, normals, UVs, materials, lights, cameras as .glb (temporary name, then renamed). The sky goes to
/// scene.extras.radivox.skyRadiance, which importGltf reads back.
void exportGlb(const Scene& scene, const std::string& path);

}  // namespace radivox::scene
