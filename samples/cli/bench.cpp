// radivox bench: how fast voxel rays are, beside Embree's closest hits of the same rays, and how often both meet the same surface.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "engine/error.h"
#include "engine/image/image.h"
#include "modules/clustered_voxel/visibility/ray_bench.h"
#include "samples/cli/cache.h"
#include "samples/cli/interrupt.h"
#include "samples/cli/job.h"
#include "samples/cli/progress.h"
#ifdef RADIVOX_WITH_REFERENCE
#include "modules/reference/closest_hits.h"
#endif

namespace radivox::cli {

namespace {

using clustered_voxel::RayBench;
using Cast = RayBench::Cast;
using nlohmann::ordered_json;

constexpr Cast kCasts[] = {Cast::Traversal, Cast::Planes, Cast::Walk};

struct Agreement {
  double hitOrMiss = 0;                 ///< share of rays that hit in both or in neither
  double median = 0, p90 = 0, p99 = 0;  ///< |difference of distances| where both hit, voxels
  double withinVoxel = 0;               ///< share of those
};

struct CastResult {
  std::string name, meaning;
  double mrays = 0;
  std::string embreeWay;  ///< the fastest; empty: not measured
  double embreeMrays = 0;
  std::vector<std::pair<std::string, double>> ways;
  Agreement agreement;
};

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

std::string paramOf(graph::Node& node, std::string_view name) {
  for (const params::Param& param : node.params().all()) {
    if (param.name == name) return param.get();
  }
  return {};
}

RayBench::Settings settingsOf(graph::Node& visibility, uint64_t rays, const scene::Traits& traits) {
  RayBench::Settings settings;
  settings.raysPerFace = static_cast<uint32_t>(std::stoul(paramOf(visibility, "rays")));
  settings.rays = rays;
  settings.triangles = std::stof(paramOf(visibility, "triangles"));
  const std::string skip = paramOf(visibility, "skip");
  settings.skip = skip == "none" ? 0 : (skip == "bricks" ? 1 : 2);
  settings.alphaMasked = traits.alphaMasked;
  return settings;
}

std::string nameOf(Cast cast) { return cast == Cast::Traversal ? "traversal" : (cast == Cast::Planes ? "planes" : "walk"); }

std::string meaningOf(Cast cast, const RayBench::Settings& settings) {
  char text[96];
  switch (cast) {
    case Cast::Traversal:
      std::snprintf(text, sizeof text, "to the first occupied voxel, from %.1f voxels off the surface", shared::kBenchLift);
      return text;
    case Cast::Planes:
      return "to the first plane, from the surface";
    case Cast::Walk:
      std::snprintf(text, sizeof text, "as visibility: triangles up to %g voxels, then planes", settings.triangles);
      return text;
  }
  return {};
}

#ifdef RADIVOX_WITH_REFERENCE

Agreement compare(const std::vector<float>& voxels, const std::vector<float>& truth, float h) {
  Agreement agreement;
  std::vector<double> errors;
  uint64_t same = 0, within = 0;
  for (size_t i = 0; i < voxels.size(); ++i) {
    const bool hits = voxels[i] >= 0.f, truly = truth[i] >= 0.f;
    same += hits == truly ? 1 : 0;
    if (!hits || !truly) continue;
    errors.push_back(std::abs(double{voxels[i]} - double{truth[i]} / h));
    within += errors.back() <= 1.0 ? 1 : 0;
  }
  agreement.hitOrMiss = static_cast<double>(same) / static_cast<double>(std::max<size_t>(voxels.size(), 1));
  if (errors.empty()) return agreement;
  std::sort(errors.begin(), errors.end());
  const auto quantile = [&](double q) { return errors[static_cast<size_t>(q * static_cast<double>(errors.size() - 1))]; };
  agreement.median = quantile(0.5);
  agreement.p90 = quantile(0.9);
  agreement.p99 = quantile(0.99);
  agreement.withinVoxel = static_cast<double>(within) / static_cast<double>(errors.size());
  return agreement;
}

/// Embree on the rays of one kind of cast.
class Yardstick {
 public:
  Yardstick(const reference::ClosestHits& embree, const RayBench& bench, Cast cast, uint32_t threads)
      : embree_(embree), threads_(threads), ways_(embree.ways()), seconds_(ways_.size()) {
    const shared::Grid& grid = bench.grid();
    for (const shared::BenchRay& ray : bench.rays(cast)) rays_.push_back({grid.origin + ray.origin * grid.h, ray.direction});
    distances_.resize(rays_.size());
  }
  void run() {
    for (size_t i = 0; i < ways_.size(); ++i) {
      stopIfInterrupted();
      seconds_[i].push_back(embree_.trace(rays_, distances_, ways_[i], threads_));
    }
  }
  const std::vector<float>& distances() const { return distances_; }
  void tell(CastResult& result) const {
    for (size_t i = 0; i < ways_.size(); ++i) {
      const double mrays = static_cast<double>(rays_.size()) / median(seconds_[i]) * 1e-6;
      result.ways.emplace_back(reference::ClosestHits::name(ways_[i]), mrays);
      if (mrays <= result.embreeMrays) continue;
      result.embreeMrays = mrays;
      result.embreeWay = reference::ClosestHits::name(ways_[i]);
    }
  }

 private:
  const reference::ClosestHits& embree_;
  uint32_t threads_;
  std::vector<reference::ClosestHits::Way> ways_;
  std::vector<reference::ClosestHits::Ray> rays_;
  std::vector<float> distances_;
  std::vector<std::vector<double>> seconds_;
};

#endif

std::vector<CastResult> measure(RayBench& bench, [[maybe_unused]] const scene::Scene& scene, const RayBench::Settings& settings,
                                uint32_t runs, [[maybe_unused]] uint32_t threads) {
  std::vector<CastResult> results;
  std::vector<std::vector<double>> seconds(std::size(kCasts));
  for (const Cast cast : kCasts) {
    results.push_back({.name = nameOf(cast), .meaning = meaningOf(cast, settings)});
    bench.run(cast);  // compiles shaders late; it is not counted
  }
#ifdef RADIVOX_WITH_REFERENCE
  const reference::ClosestHits embree(scene);
  Yardstick lifted(embree, bench, Cast::Traversal, threads), surface(embree, bench, Cast::Planes, threads);
  lifted.run();
  surface.run();
  for (size_t i = 0; i < std::size(kCasts); ++i) {
    bench.run(kCasts[i]);
    const std::vector<float>& truth = (kCasts[i] == Cast::Traversal ? lifted : surface).distances();
    results[i].agreement = compare(bench.times(), truth, bench.grid().h);
  }
#endif
  // In turn, so that what else the machine does meets all.
  ProgressBar bar;
  for (uint32_t run = 0; run < runs; ++run) {
    bar.show("bench", static_cast<double>(run) / runs);
    for (size_t i = 0; i < std::size(kCasts); ++i) {
      stopIfInterrupted();
      seconds[i].push_back(bench.run(kCasts[i]));
    }
#ifdef RADIVOX_WITH_REFERENCE
    lifted.run();
    surface.run();
#endif
  }
  for (size_t i = 0; i < std::size(kCasts); ++i) {
    results[i].mrays = static_cast<double>(bench.rayCount()) / median(seconds[i]) * 1e-6;
#ifdef RADIVOX_WITH_REFERENCE
    (kCasts[i] == Cast::Traversal ? lifted : surface).tell(results[i]);
#endif
  }
  return results;
}

void print(const std::vector<CastResult>& results) {
  std::cout
      << "\n| voxel rays | Mrays/s | Embree Mrays/s | ratio | hit or miss agree | distance off by voxels: median, 90 %, 99 % | within 1 |\n"
         "|---|---|---|---|---|---|---|\n";
  for (const CastResult& r : results) {
    char text[256];
    std::cout << "| " << r.name << ": " << r.meaning;
    if (r.embreeWay.empty()) {
      std::snprintf(text, sizeof text, " | %.2f | – | – | – | – | – |\n", r.mrays);
    } else {
      std::snprintf(text, sizeof text, " | %.2f | %.2f (%s) | %.2f | %.2f %% | %.3f, %.3f, %.3f | %.1f %% |\n", r.mrays, r.embreeMrays,
                    r.embreeWay.c_str(), r.mrays / r.embreeMrays, 100.0 * r.agreement.hitOrMiss, r.agreement.median, r.agreement.p90,
                    r.agreement.p99, 100.0 * r.agreement.withinVoxel);
    }
    std::cout << text;
  }
}

ordered_json toJson(const std::vector<CastResult>& results) {
  ordered_json casts = ordered_json::object();
  for (const CastResult& r : results) {
    ordered_json& cast = casts[r.name] = {{"meaning", r.meaning}, {"mrays_per_second", r.mrays}};
    if (r.embreeWay.empty()) continue;
    cast["embree_mrays_per_second"] = r.embreeMrays;
    cast["embree_way"] = r.embreeWay;
    for (const auto& [way, mrays] : r.ways) cast["embree_ways"][way] = mrays;
    cast["ratio"] = r.mrays / r.embreeMrays;
    cast["agreement"] = {{"hit_or_miss", r.agreement.hitOrMiss},
                         {"distance_error_voxels", {{"median", r.agreement.median}, {"p90", r.agreement.p90}, {"p99", r.agreement.p99}}},
                         {"within_one_voxel", r.agreement.withinVoxel}};
  }
  return casts;
}

}  // namespace

int runBench(const Options& options, const BenchOptions& benchOptions) {
  const uint32_t runs = parseWhole("--runs", benchOptions.runs, 1, 1000);
  const uint32_t rays = parseWhole("--rays", benchOptions.rays, 1, 4000000);
  const uint32_t threads = parseWhole("--threads", benchOptions.threads, 0, 1024);
  if (options.outputs.size() > 1) throw Error(ErrorCode::BadInput, "--out: give one .json file");
  for (const std::string& path : options.outputs) {
    if (std::filesystem::path(path).extension() != ".json") throw Error(ErrorCode::BadInput, "--out '" + path + "': end the name in .json");
    image::checkWritable(path);
  }
  gpu::DeviceOptions deviceOptions;
  deviceOptions.index = parseDevice(options.device);
  deviceOptions.pipelineCacheFile = pipelineCacheFile();
  std::unique_ptr<gpu::Device> device;  // outlives the job, whose nodes hold pipelines
  Job job;
  prepareJob(options, false, job);
  const graph::Graph::Entry& visibility = findVisibility(job);
  const scene::Scene scene = scene::loadScene(options.scene);
  device = gpu::Device::create(deviceOptions);
  job.graph.clearOutputs();
  job.graph.output(visibility.name + ".row_start");
  scene::GpuScene gpuScene(*device, scene, job.lights);
  gpuScene.setCamera(scene.cameras[0], job.request.width, job.request.height);
  const scene::Traits traits = scene::traitsFor(scene, job.lights);
  graph::Plan plan = graph::compile(job.graph, {traits, job.request, device->capabilities(), gpuScene.imports(), gpuScene.counts()});
  graph::Executor executor(*device, job.graph, std::move(plan), traits, job.request, gpuScene.counts());
  gpuScene.importInto(executor);
  {
    ProgressBar bar;
    executor.run([&bar](std::string_view node, double fraction) { bar.show(node, fraction); }, isInterrupted);
  }
  stopIfInterrupted();
  const auto faces = executor.counts().find("faces");
  if (faces == executor.counts().end() || faces->second == 0)
    throw Error(ErrorCode::BadInput, "'" + options.scene + "' has no surface to cast rays from; give a scene with triangles");

  const RayBench::Settings settings = settingsOf(*visibility.node, rays, traits);
  RayBench bench(*device, executor, visibility.name, settings);
  const shared::Grid& grid = bench.grid();
  const std::string name = device->capabilities().deviceName;
  const uint32_t embreeThreads = threads != 0 ? threads : std::thread::hardware_concurrency();
  std::cout << "device     " << name << "\n"
            << "scene      " << options.scene << ": " << scene.triangleCount() << " triangles, " << grid.size.x << " x " << grid.size.y
            << " x " << grid.size.z << " voxels of " << grid.h << " m, " << executor.counts().at("voxels") << " occupied, " << faces->second
            << " faces\n"
            << "rays       " << bench.rayCount() << ", as visibility casts them from voxel faces; medians of " << runs << " runs\n";
#ifdef RADIVOX_WITH_REFERENCE
  std::cout << "Embree     " << embreeThreads << " threads, the fastest of its ways\n";
#else
  std::cout << "Embree     not built in (RADIVOX_REFERENCE=OFF)\n";
#endif
  const std::vector<CastResult> results = measure(bench, scene, settings, runs, threads);
  print(results);
  if (options.outputs.empty()) return 0;
  const ordered_json json = {{"radivox", RADIVOX_VERSION},
                             {"device", name},
                             {"scene", options.scene},
                             {"triangles", scene.triangleCount()},
                             {"grid", {grid.size.x, grid.size.y, grid.size.z}},
                             {"voxel_edge", grid.h},
                             {"counts", executor.counts()},
                             {"rays", bench.rayCount()},
                             {"runs", runs},
                             {"embree_threads", embreeThreads},
                             {"skip", bench.usesClearance() ? "clearance" : (settings.skip == 0 ? "none" : "bricks")},
                             {"casts", toJson(results)}};
  image::writeFileAtomically(options.outputs[0], json.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n");
  return 0;
}

}  // namespace radivox::cli
