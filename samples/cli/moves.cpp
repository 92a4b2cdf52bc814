// radivox moves: what a picture costs after part of the scene has moved, beside one from scratch, and whether both have the same bits.
#include <algorithm>
#include <array>
#include <cstdio>
#include <iostream>
#include <map>
#include <numeric>
#include <optional>

#include "engine/error.h"
#include "engine/graph/executor.h"
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
    gpuScene_.setCamera(camera, job.request.width, job.request.height);
    const scene::Traits traits = scene::traitsFor(scene, job.lights);
    graph::Plan plan = graph::compile(job.graph, {traits, job.request, device.capabilities(), gpuScene_.imports(), gpuScene_.counts()});
    executor_.emplace(device, job.graph, std::move(plan), traits, job.request, gpuScene_.counts());
  }
  Timing render(const scene::Scene& scene) {
    stopIfInterrupted();
    gpuScene_.setGeometry(scene);
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
  const std::string visibility = findVisibility(freshJob).name;
  keeping.sets.push_back(visibility + ".keep=true");
  prepareJob(keeping, false, keptJob);
  const scene::Scene scene = scene::loadScene(options.scene, options.sky);
  const scene::CameraDescription& camera = scene::findCamera(scene, options.camera.empty() ? "0" : options.camera);
  const scene::Traits traits = scene.traits();
  const std::vector<Piece> pieces = findPieces(scene);
  const glm::vec3 extent = traits.boundsMax - traits.boundsMin;
  // A fiftieth of the longest side, some voxels, along it.
  const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
  const float by = 0.02f * extent[axis];

  Renderer kept(*device, keptJob, scene, camera), fresh(*device, freshJob, scene, camera);
  kept.render(scene);  // compiles shaders late; it is not counted
  fresh.render(scene);
  std::cout << "| moved | voxels changed | rays traced | visibility, s | all, s | from scratch: visibility, s | all, s | same bits |\n"
               "|---|---|---|---|---|---|---|---|\n";
  bool same = true;
  std::vector<Timing> after;
  std::vector<std::string> columns;
  Timing scratch;
  for (const double share : shares) {
    size_t moved = 0;
    const scene::Scene there = moveShare(scene, pieces, share, axis, by, moved);
    after.push_back(kept.render(there));
    scratch = fresh.render(there);
    const bool equal = kept.picture(there) == fresh.picture(there);
    same = same && equal;
    const auto figure = [&](const char* name) {
      const auto found = after.back().figures.find(visibility + name);
      return found != after.back().figures.end() ? found->second : 0.0;
    };
    const auto seconds = [&](const Timing& timing) { return timing.nodes.contains(visibility) ? timing.nodes.at(visibility) : 0.0; };
    const double part = static_cast<double>(moved) / static_cast<double>(std::max<size_t>(scene.triangleCount(), 1));
    char column[32];
    std::snprintf(column, sizeof column, "%.1f %%", 100.0 * part);
    columns.emplace_back(column);
    char line[256];
    std::snprintf(line, sizeof line, "| %s | %.1f %% | %.1f %% | %.2f | %.2f | %.2f | %.2f | %s |", column,
                  100.0 * figure(".changed_voxels") / std::max(1.0, after.back().voxels),
                  100.0 * figure(".traced_rays") / std::max(1.0, figure(".rays")), seconds(after.back()), after.back().seconds,
                  seconds(scratch), scratch.seconds, equal ? "yes" : "no");
    std::cout << line << std::endl;
    kept.render(scene);  // back, for the next
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
