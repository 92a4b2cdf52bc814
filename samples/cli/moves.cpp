// radivox moves: what a picture costs after the camera, a light, or part of the scene has moved, beside one from scratch, and whether both have the
// same bits.
#include <algorithm>
#include <array>
#include <cstdio>
#include <iostream>
#include <map>
#include <numeric>
#include <optional>

#include "engine/error.h"
#include "engine/graph/executor.h"
#include "modules/clustered_voxel/gather_pixels/gather_pixels.h"
#include "samples/cli/cache.h"
#include "samples/cli/interrupt.h"
#include "samples/cli/job.h"
#include "samples/cli/picture.h"
#include "samples/cli/progress.h"

namespace radivox::cli {

namespace {

/// Triangles that share vertices, as lists of their vertices.
struct Piece {
  std::vector<uint32_t> vertices;
  size_t triangles = 0;
  glm::vec3 least{1e30f}, greatest{-1e30f};
  glm::vec3 middle() const { return 0.5f * (least + greatest); }
};

std::vector<Piece> findPieces(const scene::Scene& scene) {
  std::vector<uint32_t> parent(scene.vertices.size());
  std::iota(parent.begin(), parent.end(), 0u);
  const auto rootOf = [&](uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  // Corners in the same place count as shared: seams of texture coordinates hold no mesh apart.
  std::map<std::array<float, 3>, uint32_t> places;
  for (uint32_t i = 0; i < scene.vertices.size(); ++i) {
    const glm::vec3& p = scene.vertices[i].position;
    const auto [at, isNew] = places.try_emplace({p.x, p.y, p.z}, i);
    if (!isNew) parent[rootOf(i)] = rootOf(at->second);
  }
  for (size_t t = 0; t < scene.triangleCount(); ++t) {
    for (size_t k = 1; k < 3; ++k) parent[rootOf(scene.indices[3 * t + k])] = rootOf(scene.indices[3 * t]);
  }
  std::map<uint32_t, Piece> byRoot;
  for (uint32_t i = 0; i < scene.vertices.size(); ++i) {
    Piece& piece = byRoot[rootOf(i)];
    piece.vertices.push_back(i);
    piece.least = glm::min(piece.least, scene.vertices[i].position);
    piece.greatest = glm::max(piece.greatest, scene.vertices[i].position);
  }
  for (size_t t = 0; t < scene.triangleCount(); ++t) ++byRoot[rootOf(scene.indices[3 * t])].triangles;
  std::vector<Piece> pieces;
  for (auto& [root, piece] : byRoot) pieces.push_back(std::move(piece));
  return pieces;
}

/// Moves the pieces nearest to the middle of the scene, until they have `share` of the triangles: what moves lies together, as things do. Each must stay
/// within the bounds, or the grid would be another; where too few can, less moves.
scene::Scene moveShare(const scene::Scene& scene, const std::vector<Piece>& pieces, double share, int axis, float by, size_t& moved) {
  const scene::Traits traits = scene.traits();
  const auto wanted = static_cast<size_t>(share * static_cast<double>(scene.triangleCount()));
  std::vector<const Piece*> movable;
  for (const Piece& piece : pieces) {
    if (piece.triangles > 0 && piece.least[axis] > traits.boundsMin[axis] && piece.greatest[axis] + by < traits.boundsMax[axis])
      movable.push_back(&piece);
  }
  moved = 0;
  scene::Scene result = scene;
  if (movable.empty()) return result;
  const glm::vec3 heart = 0.5f * (traits.boundsMin + traits.boundsMax);
  std::sort(movable.begin(), movable.end(), [&](const Piece* a, const Piece* b) {
    const float x = glm::distance(a->middle(), heart), y = glm::distance(b->middle(), heart);
    return x != y ? x < y : a->vertices.front() < b->vertices.front();
  });
  for (const Piece* piece : movable) {
    if (moved >= wanted) break;
    // One that is far too large is passed over for smaller ones.
    if (moved + piece->triangles > wanted + wanted / 5 + 64) continue;
    for (const uint32_t vertex : piece->vertices) result.vertices[vertex].position[axis] += by;
    moved += piece->triangles;
  }
  return result;
}

/// Every directional light turned by 5 degrees about the vertical, every other one `by` along `axis`.
scene::Scene moveLights(scene::Scene scene, int axis, float by) {
  for (scene::PunctualLight& light : scene.lights) {
    if (light.type == shared::kLightDirectional) {
      light.direction = glm::angleAxis(glm::radians(5.f), glm::vec3(0, 1, 0)) * light.direction;
    } else {
      light.position[axis] += by;
    }
  }
  return scene;
}

struct Timing {
  double seconds = 0;
  std::map<std::string, double> nodes;
  std::map<std::string, double> figures;
  double voxels = 0;
};

class Renderer {
 public:
  Renderer(gpu::Device& device, Job& job, const scene::Scene& scene, const scene::CameraDescription& camera)
      : device_(device), job_(job), gpuScene_(device, scene, job.lights) {
    setCamera(camera);
    const scene::Traits traits = scene::traitsFor(scene, job.lights);
    graph::Plan plan = graph::compile(job.graph, {traits, job.request, device.capabilities(), gpuScene_.imports(), gpuScene_.counts()});
    executor_.emplace(device, job.graph, std::move(plan), traits, job.request, gpuScene_.counts());
  }
  void setCamera(const scene::CameraDescription& camera) { gpuScene_.setCamera(camera, job_.request.width, job_.request.height); }
  void setLights(const scene::Scene& scene) { gpuScene_.setLights(scene); }
  void setGeometry(const scene::Scene& scene) { gpuScene_.setGeometry(scene); }
  Timing render() {
    stopIfInterrupted();
    gpuScene_.importInto(*executor_);
    executor_->run({}, isInterrupted);
    Timing timing;
    timing.seconds = executor_->stats().wallMs * 1e-3;
    for (const graph::NodeStats& node : executor_->stats().nodes) {
      if (node.ranLastFrame) timing.nodes[node.name] = node.gpuMs * 1e-3;
      for (const auto& [name, value] : node.figures) timing.figures[node.name + "." + name] = value;
    }
    const graph::Counts& counts = executor_->counts();
    if (const auto found = counts.find("voxels"); found != counts.end()) timing.voxels = static_cast<double>(found->second);
    return timing;
  }
  std::vector<float> picture(const scene::Scene& scene) {
    return downloadAov(device_, *executor_, job_, job_.aovs.front(), scene).image.data;
  }

 private:
  gpu::Device& device_;
  Job& job_;
  scene::GpuScene gpuScene_;
  std::optional<graph::Executor> executor_;
};

std::string formatSeconds(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3f", value);
  return text;
}

std::string formatPercent(double share) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f %%", 100.0 * share);
  return text;
}

}  // namespace

int runMoves(const Options& options, const std::string& sharesText) {
  std::vector<double> shares;
  for (size_t at = 0; at <= sharesText.size();) {
    const size_t end = std::min(sharesText.find(',', at), sharesText.size());
    shares.push_back(static_cast<double>(parseWhole("--shares", sharesText.substr(at, end - at), 0, 100)) / 100.0);
    at = end + 1;
  }
  gpu::DeviceOptions deviceOptions;
  deviceOptions.index = parseDevice(options.device);
  deviceOptions.pipelineCacheFile = pipelineCacheFile();
  const auto device = gpu::Device::create(deviceOptions);
  Job keptJob, freshJob;  // nodes belong to one plan
  prepareJob(options, false, freshJob);
  Options keeping = options;
  // Whose rays are kept.
  const std::string faces = findVisibility(freshJob).name;
  std::string pixels;
  for (const graph::Graph::Entry& entry : freshJob.graph.nodes())
    if (entry.node->type() == clustered_voxel::GatherPixels::kType) pixels = entry.name;
  keeping.sets.push_back(faces + ".keep=true");
  if (!pixels.empty()) keeping.sets.push_back(pixels + ".keep=true");
  prepareJob(keeping, false, keptJob);
  keptJob.lights.fixed = freshJob.lights.fixed = false;
  const scene::Scene scene = scene::loadScene(options.scene, options.sky);
  const scene::CameraDescription& camera = scene::findCamera(scene, options.camera.empty() ? "0" : options.camera);
  const scene::Traits traits = scene.traits();
  const std::vector<Piece> pieces = findPieces(scene);
  const glm::vec3 extent = traits.boundsMax - traits.boundsMin;
  // A fiftieth of the longest side, some voxels, along it.
  const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
  const float by = 0.02f * extent[axis];

  Renderer kept(*device, keptJob, scene, camera), fresh(*device, freshJob, scene, camera);
  kept.render();  // compiles shaders late; it is not counted
  fresh.render();
  std::cout << "| moved | voxels changed | faces' rays traced | pixels' rays traced | s | from scratch, s | same bits |\n"
               "|---|---|---|---|---|---|---|\n";
  bool same = true;
  std::vector<Timing> after;
  std::vector<std::string> columns;
  Timing scratch;
  /// A picture of both, each having been told what it must know; from scratch everything runs.
  const auto compare = [&](const std::string& column, const scene::Scene& there) {
    after.push_back(kept.render());
    fresh.setGeometry(there);
    scratch = fresh.render();
    const bool equal = kept.picture(there) == fresh.picture(there);
    same = same && equal;
    columns.push_back(column);
    const auto figure = [&](const std::string& node, const char* name) {
      const auto found = after.back().nodes.contains(node) ? after.back().figures.find(node + name) : after.back().figures.end();
      return found != after.back().figures.end() ? found->second : 0.0;
    };
    const auto percent = [](double part, double whole) { return formatPercent(part / std::max(1.0, whole)); };
    std::cout << "| " << column << " | " << percent(figure(faces, ".changed_voxels"), after.back().voxels) << " | "
              << percent(figure(faces, ".traced_rays"), figure(faces, ".rays")) << " | "
              << (pixels.empty() ? "none" : percent(figure(pixels, ".traced_rays"), figure(pixels, ".rays"))) << " | "
              << formatSeconds(after.back().seconds) << " | " << formatSeconds(scratch.seconds) << " | " << (equal ? "yes" : "no") << " |"
              << std::endl;
  };
  const scene::Scene turned = moveLights(scene, axis, by);
  if (!scene.lights.empty()) {
    kept.setLights(turned);
    compare("lights", turned);
    kept.setLights(scene);
    kept.render();  // back, for the next
  }
  scene::CameraDescription beside = camera;
  beside.position[axis] += 0.1f * by;
  kept.setCamera(beside);
  fresh.setCamera(beside);
  compare("camera", scene);
  kept.setCamera(camera);
  fresh.setCamera(camera);
  kept.render();
  for (const double share : shares) {
    size_t moved = 0;
    const scene::Scene there = moveShare(scene, pieces, share, axis, by, moved);
    kept.setGeometry(there);
    compare(formatPercent(static_cast<double>(moved) / static_cast<double>(std::max<size_t>(scene.triangleCount(), 1))), there);
    kept.setGeometry(scene);
    kept.render();
  }
  std::cout << "\n| node, s | from scratch |";
  for (const std::string& column : columns) std::cout << " " << column << " |";
  std::cout << "\n|---|---|";
  for (size_t i = 0; i < columns.size(); ++i) std::cout << "---|";
  std::cout << "\n";
  for (const auto& [name, all] : scratch.nodes) {
    if (all < 0.002 * scratch.seconds) continue;
    std::cout << "| " << name << " | " << formatSeconds(all) << " |";
    for (const Timing& timing : after)
      std::cout << " " << (timing.nodes.contains(name) ? formatSeconds(timing.nodes.at(name)) : "0") << " |";
    std::cout << "\n";
  }
  if (!same) throw Error(ErrorCode::DeviceFailed, "a picture after a move differs from one from scratch");
  return 0;
}

}  // namespace radivox::cli
