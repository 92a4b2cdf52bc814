// glTF 2.0 → Scene and back. Read through tinygltf, after checks of our own: it takes wrong types as missing, follows ranges and file names
// unchecked, and keeps no place for its errors.
#pragma once

#include "engine/scene/scene.h"

namespace radivox::scene {

/// Node hierarchy, instancing (flattened), indexed or not, all component types and modes triangles/strip/fan, sparse accessors, base colour
/// factor and texture with sampler and texcoord set, KHR_texture_transform, alpha mask, double-sided, emissive +
/// KHR_materials_emissive_strength, KHR_lights_punctual, KHR_mesh_quantization, cameras; morph targets at their default weights, skins at
/// rest; vertex colours as materials (gltf_mesh.cpp); KHR_draco_mesh_compression and EXT_meshopt_compression where built with them.
/// Missing normals are computed (flat), missing images leave their texture white. Throws BadInput in one line naming the file, the JSON
/// place ("meshes[3].primitives[0].attributes.POSITION") and the mend. What is skipped lands in Scene::warnings.
Scene importGltf(const std::string& path);

/// Writes positions, normals, UVs, materials, lights, cameras as .glb (temporary name, then renamed). The sky goes to
/// scene.extras.radivox.skyRadiance, which importGltf reads back.
void exportGlb(const Scene& scene, const std::string& path);

}  // namespace radivox::scene
