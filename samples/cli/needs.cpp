// radivox needs: what leaving out what a scene does not need saves, in time and memory, scene by scene.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <iostream>

#include "engine/error.h"
#include "engine/graph/left_out.h"
#include "samples/cli/cache.h"
#include "samples/cli/interrupt.h"
#include "samples/cli/job.h"
#include "samples/cli/progress.h"

namespace radivox::cli {

namespace {

struct Cost {
  double milliseconds = 0;  ///< median of whole pictures: scene, light and view new
  double mebibytes = 0;     ///< allocated for the plan
};

Cost measure(gpu::Device& device, Job& job, const scene::Scene& scene, const scene::CameraDescription& camera, const scene::Traits& traits,
             uint32_t runs) {
  const VkDeviceSize before = device.memoryUse().current;
  scene::GpuScene gpuScene(device, scene, job.lights);
  gpuScene.setCamera(camera, job.request.width, job.request.height);
  const VkDeviceSize sceneBytes = device.memoryUse().current - before;
  graph::Plan plan = graph::compile(job.graph, {traits, job.request, device.capabilities(), gpuScene.imports(), gpuScene.counts()});
  graph::Executor executor(device, job.graph, std::move(plan), traits, job.request, gpuScene.counts());
  std::vector<double> times;
  // The first picture compiles shaders late; it is not counted.
  for (uint32_t run = 0; run <= runs; ++run) {
    stopIfInterrupted();
    gpuScene.touchGeometry();
    gpuScene.setLights(scene);
    gpuScene.setCamera(camera, job.request.width, job.request.height);
    gpuScene.importInto(executor);
    executor.run({}, isInterrupted);
    if (run > 0) times.push_back(executor.stats().wallMs);
  }
  std::sort(times.begin(), times.end());
  return {times[times.size() / 2], static_cast<double>(device.memoryUse().current - before - sceneBytes) / 1048576.0};
}

std::string format(const char* pattern, double value) {
  char text[64];
  std::snprintf(text, sizeof text, pattern, value);
  return text;
}

}  // namespace

int runNeeds(const Options& options, const std::vector<std::string>& scenes, const std::string& runsText) {
  const uint32_t runs = parseWhole("--runs", runsText, 1, 1000);
  gpu::DeviceOptions deviceOptions;
  deviceOptions.index = parseDevice(options.device);
  deviceOptions.pipelineCacheFile = pipelineCacheFile();
  const auto device = gpu::Device::create(deviceOptions);
  std::cout << "| scene | ms as needed | ms with all kept | time saved | MiB as needed | MiB with all kept | memory saved | not needed |\n"
               "|---|---|---|---|---|---|---|---|\n";
  for (const std::string& name : scenes) {
    Options one = options;
    one.scene = name;
    Job job;
    prepareJob(one, false, job);
    const scene::Scene scene = scene::loadScene(name);
    const scene::CameraDescription& camera = scene::findCamera(scene, one.camera.empty() ? "0" : one.camera);
    scene::Traits traits = scene::traitsFor(scene, job.lights);
    std::string notNeeded;
    {
      const scene::SceneShapes shapes = scene::describeShapes(scene, job.lights, job.request.width, job.request.height);
      for (const graph::LeftOut& entry :
           graph::listLeftOut(job.graph, {traits, job.request, device->capabilities(), shapes.imports, shapes.counts}, shapes.counts))
        notNeeded += (notNeeded.empty() ? "" : ", ") + entry.what;
    }
    const Cost needed = measure(*device, job, scene, camera, traits, runs);
    traits.kept = scene::kKeepAll;
    const Cost all = measure(*device, job, scene, camera, traits, runs);
    const auto saved = [](double a, double b) { return b > 0 ? format("%.0f %%", 100.0 * (1.0 - a / b)) : std::string("0 %"); };
    std::cout << "| " << name << " | " << format("%.1f", needed.milliseconds) << " | " << format("%.1f", all.milliseconds) << " | "
              << saved(needed.milliseconds, all.milliseconds) << " | " << format("%.1f", needed.mebibytes) << " | "
              << format("%.1f", all.mebibytes) << " | " << saved(needed.mebibytes, all.mebibytes) << " | " << notNeeded << " |"
              << std::endl;
  }
  return 0;
}

}  // namespace radivox::cli
