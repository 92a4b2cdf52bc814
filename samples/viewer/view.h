// What the viewer is to show: a plain value. Panels, keys and scripts write it, the session makes pictures of it.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/scene/scene.h"

namespace radivox::viewer {

enum class Overlay : uint32_t {
  Picture,             ///< tone-mapped radiance, or View::aov
  Voxels,              ///< the voxels as cubes, in the albedo of their faces
  Clusters,            ///< a colour per cluster
  ClusterNormals,      ///< mean normal of each cluster as a colour
  DirectIrradiance,    ///< E_dir per voxel face, exposed as the picture is
  IndirectIrradiance,  ///< E_indirect per voxel face, where it was gathered
  VisibleClusters,     ///< what the face under the mouse sees, and its rays
  Error,               ///< how far the picture is from a stored one
};
/// "picture", "voxels", … in the order of the enum.
const std::vector<std::string>& overlayNames();

/// What lights a scene and can be changed without loading it again.
struct Lighting {
  std::vector<scene::PunctualLight> lights;
  glm::vec3 sky{0.f};
};
bool operator==(const Lighting& a, const Lighting& b);

bool operator==(const scene::CameraDescription& a, const scene::CameraDescription& b);

struct View {
  std::string scene;                  ///< as on the command line
  std::string graph;                  ///< name or file
  std::vector<std::string> settings;  ///< "node.param=value": every parameter, "lights." too
  std::string bounces = "all";        ///< as --bounces
  std::optional<Lighting> lighting;   ///< nothing: the scene's own
  scene::CameraDescription camera;    ///< relative to the scene's origin
  /// Instead of `camera`: the scene's own of that name or index; none of that name: its first.
  std::optional<std::string> namedCamera;
  uint32_t width = 640, height = 360;  ///< of the picture
  Overlay overlay = Overlay::Picture;
  std::string aov;      ///< of Overlay::Picture: another AOV of the graph; empty: as a screen shows it
  bool blocks = false;  ///< overlays on voxels cast as cubes instead of on surfaces; Overlay::Voxels always is
  /// Nothing but overlays changes: no node runs. Overlays of blocks follow `camera` all the same.
  bool frozen = false;
  /// The camera or a light is on its way: where a full picture takes long, a preview will do.
  bool moving = false;
  std::optional<glm::uvec2> pointer;  ///< pixel under the mouse
  std::string reference;              ///< .exr to compare with, for Overlay::Error
};

/// Both want the same work of the graph: only cameras, sizes and overlays may differ.
bool wantsSameLight(const View& a, const View& b);

}  // namespace radivox::viewer
