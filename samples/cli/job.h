// What `render` and `graph` share: the graph with its presets and settings, the request, and the AOVs as endpoints of that graph.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/graph/graph.h"
#include "engine/scene/gpu_scene.h"
#include "samples/cli/options.h"

namespace radivox::cli {

/// One layer of the picture.
struct Aov {
  std::string name;      ///< "depth"
  std::string endpoint;  ///< "gbuffer.position"; empty: black by definition (indirect light of 0 bounces)
  int channel = -1;      ///< one channel of the image; −1: its colour channels
};

struct Job {
  plugin::Registry registry;
  graph::Graph graph;
  std::string graphName;
  std::vector<std::string> presetNames;
  scene::Request request;
  Size size;  ///< of the picture; request.width and .height are `supersample` times as large
  uint32_t supersample = 1;
  scene::LightOptions lights;
  std::vector<Aov> aovs;               ///< as asked for
  std::optional<Aov> albedo;           ///< weights of irradiance where pixels are means of several samples
  std::optional<Aov> displayEndpoint;  ///< tone-mapped picture of `color`, where it is wanted and the graph has it
  params::Table lightParams;           ///< of `lights`; `--set lights.param=value`

  Job() = default;
  Job(const Job&) = delete;  // lightParams points into it
  Job& operator=(const Job&) = delete;
};

/// Where neither --graph nor a preset names a graph: pictures get the one that gathers by pixels; what looks at voxel faces, and walks
/// past them, the one that gathers by faces.
inline constexpr const char* kPictureGraph = "clustered_voxel_pixels";
inline constexpr const char* kFaceGraph = "clustered_voxel";
/// What pictures start from where neither --graph nor --preset is given; its graph is kPictureGraph.
inline constexpr const char* kDefaultPreset = "default";

/// E, not radiance: means over samples are weighed by albedo.
bool isIrradiance(const std::string& aov);

/// Fills `job`; the graph's outputs are those that the AOVs need, and with `wantsDisplay` the tone-mapped picture. Throws BadInput.
void prepareJob(const Options& options, bool wantsDisplay, Job& job, const char* fallbackGraph = kPictureGraph);

/// The node that casts rays from voxel faces; throws BadInput where the graph has none.
const graph::Graph::Entry& findVisibility(const Job& job);

params::Table lightTable(scene::LightOptions& lights);

/// Linked-in modules and those of --module.
void fillRegistry(const Options& options, plugin::Registry& registry);

}  // namespace radivox::cli
