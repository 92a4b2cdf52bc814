// radivox render: scene file in, pictures and statistics out.
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <iostream>

#include "samples/cli/assets.h"
#include "samples/cli/cache.h"
#include "samples/cli/interrupt.h"
#include "samples/cli/picture.h"
#include "samples/cli/progress.h"
#include "samples/cli/stats.h"
#include "samples/report/budget.h"

namespace radivox::cli {

namespace {

class Stopwatch {
 public:
  /// Milliseconds since the last call or construction.
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    const double ms = std::chrono::duration<double, std::milli>(now - last_).count();
    last_ = now;
    return ms;
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

std::string extensionOf(const std::string& path) { return std::filesystem::path(path).extension().string(); }

/// Everything that can be wrong with the files to write, before the long work.
void checkOutputs(const Options& options, const std::vector<std::string>& aovs) {
  if (options.outputs.empty()) throw Error(ErrorCode::BadInput, "--out is missing; give a .exr or .png file to write");
  bool onlyPng = true;
  std::vector<std::string> all = options.outputs;
  for (const std::string& path : options.outputs) {
    const std::string extension = extensionOf(path);
    if (extension != ".exr" && extension != ".png") {
      throw Error(ErrorCode::BadInput, "--out '" + path + "': unknown kind of file; end the name in .exr or .png");
    }
    onlyPng = onlyPng && extension == ".png";
    image::checkWritable(path);
  }
  if (onlyPng && aovs.size() > 1) {
    throw Error(ErrorCode::BadInput, "--out '" + options.outputs[0] + "': a .png holds one AOV, and --aov names " +
                                         std::to_string(aovs.size()) + "; write .exr, or ask for one");
  }
  if (!options.stats.empty()) {
    if (extensionOf(options.stats) != ".json") {
      throw Error(ErrorCode::BadInput, "--stats '" + options.stats + "': end the name in .json");
    }
    image::checkWritable(options.stats);
    all.push_back(options.stats);
  }
  std::sort(all.begin(), all.end());
  const auto twice = std::adjacent_find(all.begin(), all.end());
  if (twice != all.end()) throw Error(ErrorCode::BadInput, "'" + *twice + "' would be written twice; give different names");
}

void checkSizeFits(const Job& job, const gpu::Capabilities& capabilities) {
  const uint32_t largest = capabilities.maxImageDimension2D;
  if (job.request.width <= largest && job.request.height <= largest) return;
  const uint32_t fits = largest / job.supersample;
  throw Error(ErrorCode::OutOfMemory, "--size " + std::to_string(job.size.width) + "x" + std::to_string(job.size.height) + ": " +
                                          capabilities.deviceName + " has images of at most " + std::to_string(largest) +
                                          " pixels a side; the largest that fits is " + std::to_string(fits) + "x" + std::to_string(fits));
}

void writePictures(const Options& options, const Job& job, gpu::Device& device, graph::Executor& executor, const scene::Scene& scene,
                   const std::vector<image::Layer>& layers) {
  const auto color = std::find_if(layers.begin(), layers.end(), [](const image::Layer& l) { return l.name == "color"; });
  const image::Layer& shown = color != layers.end() ? *color : layers.front();
  for (const std::string& path : options.outputs) {
    if (extensionOf(path) == ".exr") {
      image::writeExr(path, arrangeLayers(layers));
    } else if (shown.name == "color" && job.displayEndpoint) {
      writePreview(path, downloadAov(device, executor, job, *job.displayEndpoint, scene));
    } else {
      writePreview(path, shown);
    }
  }
}

/// The same command with the settings that keep its budget.
Options withinBudget(const Options& options) {
  report::Budget budget;
  if (!options.maxError.empty()) budget.maxError = parsePositive("--max-error", options.maxError);
  if (!options.budgetMs.empty()) budget.milliseconds = parsePositive("--budget-ms", options.budgetMs);
  budget.calibrationSeconds = parsePositive("--calibration-time", options.calibrationTime);
  report::Choice choice = report::chooseSetting(options, budget);
  std::cout << "settings: " << choice.text << std::endl;
  choice.options.maxError.clear();
  choice.options.budgetMs.clear();
  return choice.options;
}

void printWarnings(const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) std::cerr << "radivox: warning: " << warning << "\n";
}

}  // namespace

int runRender(const Options& options) {
  Stopwatch total, phase;
  RunRecord record;
  const std::vector<std::string> aovNames = parseList("--aov", options.aovs);
  checkOutputs(options, aovNames);
  const uint32_t frameCount = parseWhole("--frames", options.frames, 1, 10000);
  if (!options.maxError.empty() || !options.budgetMs.empty()) return runRender(withinBudget(options));
  const bool wantsPng =
      std::any_of(options.outputs.begin(), options.outputs.end(), [](const std::string& path) { return extensionOf(path) == ".png"; });
  std::unique_ptr<gpu::Device> device;  // outlives the job, whose nodes hold pipelines
  Job job;
  prepareJob(options, wantsPng, job);
  stopIfInterrupted();

  const scene::Scene scene = scene::loadScene(options.scene, options.sky);
  const scene::CameraDescription& camera = scene::findCamera(scene, options.camera.empty() ? "0" : options.camera);
  record.camera = camera.name;
  printWarnings(scene.warnings);
  record.phases.loadMs = phase.lap();
  stopIfInterrupted();

  gpu::DeviceOptions deviceOptions;
  deviceOptions.index = parseDevice(options.device);
  deviceOptions.validation = options.validate;
  deviceOptions.pipelineCacheFile = pipelineCacheFile();
  deviceOptions.onMessage = [](const std::string& message) {
    std::string line = message;
    std::replace(line.begin(), line.end(), '\n', ' ');
    std::cerr << "radivox: validation: " + line + "\n";
  };
  device = gpu::Device::create(deviceOptions);
  checkSizeFits(job, device->capabilities());
  scene::GpuScene gpuScene(*device, scene, job.lights);
  gpuScene.setCamera(camera, job.request.width, job.request.height);
  record.notes = gpuScene.notes();
  printWarnings(record.notes);
  const scene::Traits traits = scene::traitsFor(scene, job.lights);
  graph::Plan plan = graph::compile(job.graph, {traits, job.request, device->capabilities(), gpuScene.imports(), gpuScene.counts()});
  stopIfInterrupted();
  graph::Executor executor(*device, job.graph, std::move(plan), traits, job.request, gpuScene.counts());
  gpuScene.importInto(executor);
  record.phases.prepareMs = phase.lap();

  {
    ProgressBar bar;
    for (uint32_t frame = 0; frame < frameCount; ++frame) {
      stopIfInterrupted();
      executor.run([&bar](std::string_view node, double fraction) { bar.show(node, fraction); }, isInterrupted);
      record.frames.push_back(executor.stats());
    }
  }
  stopIfInterrupted();
  record.phases.runMs = phase.lap();

  std::vector<image::Layer> layers;
  for (const Aov& aov : job.aovs) layers.push_back(downloadAov(*device, executor, job, aov, scene));
  record.phases.downloadMs = phase.lap();
  stopIfInterrupted();
  writePictures(options, job, *device, executor, scene, layers);
  record.phases.writeMs = phase.lap();
  record.phases.totalMs = total.lap();
  record.validated = options.validate;
  record.validationMessageCount = device->validationMessageCount();
  if (!options.stats.empty())
    image::writeFileAtomically(options.stats, printStats(options, job, scene, device->capabilities(), executor.plan(), record));
  if (record.validationMessageCount > 0) {
    throw Error(ErrorCode::DeviceFailed, "--validate: " + std::to_string(record.validationMessageCount) +
                                             " validation messages (above); the picture was written, but report this");
  }
  return 0;
}

}  // namespace radivox::cli
