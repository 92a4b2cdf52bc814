// radivox needs: what leaving out what a scene does not need saves, in time and memory, scene by scene.
#include <algorithm>
#include <cstdio>
#include <iostream>
#include <optional>

#include "engine/error.h"
#include "engine/graph/left_out.h"
#include "samples/cli/cache.h"
#include "samples/cli/interrupt.h"
#include "samples/cli/job.h"
#include "samples/cli/progress.h"

namespace radivox::cli {

namespace {

/// One plan of a scene, run again and again.
class Candidate {
 public:
  Candidate(gpu::Device& device, Job& job, const scene::Scene& scene, const scene::CameraDescription& camera, const scene::Traits& traits)
      : job_(job), scene_(scene), camera_(camera), gpuScene_(device, scene, job.lights) {
    gpuScene_.setCamera(camera, job.request.width, job.request.height);
    const VkDeviceSize before = device.memoryUse().current;
    graph::Plan plan = graph::compile(job.graph, {traits, job.request, device.capabilities(), gpuScene_.imports(), gpuScene_.counts()});
    executor_.emplace(device, job.graph, std::move(plan), traits, job.request, gpuScene_.counts());
    render();  // compiles shaders late; it is not counted
    times_.clear();
    mebibytes_ = static_cast<double>(device.memoryUse().current - before) / 1048576.0;
  }
  /// A whole picture: scene, light and view are new.
  void render() {
    stopIfInterrupted();
    gpuScene_.touchGeometry();
    gpuScene_.setLights(scene_);
    gpuScene_.setCamera(camera_, job_.request.width, job_.request.height);
    gpuScene_.importInto(*executor_);
    executor_->run({}, isInterrupted);
    times_.push_back(executor_->stats().wallMs);
  }
  double milliseconds() const {
    std::vector<double> sorted = times_;
    std::sort(sorted.begin(), sorted.end());
    return sorted[sorted.size() / 2];
  }
  double mebibytes() const { return mebibytes_; }

 private:
  Job& job_;
  const scene::Scene& scene_;
  const scene::CameraDescription& camera_;
  scene::GpuScene gpuScene_;
  std::optional<graph::Executor> executor_;
  std::vector<double> times_;
  double mebibytes_ = 0;
};

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
    Job job, keptJob;  // nodes belong to one plan
    prepareJob(one, false, job);
    one.keepAll = true;
    prepareJob(one, false, keptJob);
    const scene::Scene scene = scene::loadScene(name);
    const scene::CameraDescription& camera = scene::findCamera(scene, one.camera.empty() ? "0" : one.camera);
    const scene::Traits traits = scene::traitsFor(scene, job.lights);
    std::string notNeeded;
    {
      const scene::SceneShapes shapes = scene::describeShapes(scene, job.lights, job.request.width, job.request.height);
      for (const graph::LeftOut& entry :
           graph::listLeftOut(job.graph, {traits, job.request, device->capabilities(), shapes.imports, shapes.counts}, shapes.counts))
        notNeeded += (notNeeded.empty() ? "" : ", ") + entry.what;
    }
    Candidate needed(*device, job, scene, camera, traits);
    Candidate all(*device, keptJob, scene, camera, scene::traitsFor(scene, keptJob.lights));
    // In turn, so that what else the machine does meets both.
    for (uint32_t run = 0; run < runs; ++run) {
      needed.render();
      all.render();
    }
    const auto saved = [](double a, double b) { return b > 0 ? format("%.0f %%", 100.0 * (1.0 - a / b)) : std::string("0 %"); };
    std::cout << "| " << name << " | " << format("%.1f", needed.milliseconds()) << " | " << format("%.1f", all.milliseconds()) << " | "
              << saved(needed.milliseconds(), all.milliseconds()) << " | " << format("%.1f", needed.mebibytes()) << " | "
              << format("%.1f", all.mebibytes()) << " | " << saved(needed.mebibytes(), all.mebibytes()) << " | " << notNeeded << " |"
              << std::endl;
  }
  return 0;
}

}  // namespace radivox::cli
