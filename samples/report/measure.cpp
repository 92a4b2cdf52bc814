#include "samples/report/measure.h"

#include <algorithm>
#include <chrono>
#include <glm/gtc/quaternion.hpp>
#include <set>

#include "engine/error.h"
#include "samples/cli/picture.h"

namespace radivox::report {

namespace {

constexpr double kMillisecondsForRepeats = 3000;
constexpr uint32_t kMostRepeats = 5;
constexpr double kLongRunMs = 4000;
/// How far the camera turns between two frames: a slow pan.
constexpr float kDegreesAFrame = 0.5f;

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const size_t n = values.size();
  return n == 0 ? 0 : n % 2 == 1 ? values[n / 2] : 0.5 * (values[n / 2 - 1] + values[n / 2]);
}

enum Event { kScene, kLight, kFrame, kEventCount };

/// What the nodes took, one entry a repeat.
struct Times {
  std::vector<double> wall[kEventCount];
  std::vector<double> overhead;
  std::map<std::string, std::vector<double>> nodes[kEventCount];
};

class Timer {
 public:
  explicit Timer(const graph::Plan& plan) {
    for (const graph::PlannedStep& step : plan.steps) {
      if (step.hostPaced) hostPaced_.insert(plan.nodeNames[step.node]);
    }
  }

  /// The scene's times hold what the driver compiled: only nodes that did not run again are told by them.
  void scenesAreCold() { cold_ = true; }

  void note(Event event, const graph::FrameStats& frame) {
    double sum = 0;
    for (const graph::NodeStats& node : frame.nodes) {
      const double ms = node.ranLastFrame ? timeOf(node) : 0.0;
      times_.nodes[event][node.name].push_back(ms);
      sum += ms;
    }
    times_.wall[event].push_back(frame.wallMs);
    if (event == kFrame) times_.overhead.push_back(std::max(frame.wallMs - sum, 0.0));
  }

  void fill(const graph::FrameStats& last, Cost& cost) const {
    cost.repeats = static_cast<uint32_t>(times_.wall[kFrame].size());
    cost.wallSceneMs = median(times_.wall[kScene]);
    cost.wallLightMs = median(times_.wall[kLight]);
    cost.wallFrameMs = median(times_.wall[kFrame]);
    cost.overheadMs = median(times_.overhead);
    for (const graph::NodeStats& node : last.nodes) {
      const auto took = [&](Event event) { return median(times_.nodes[event].at(node.name)); };
      NodeCost part{node.name, node.type, 0, 0, 0};
      part.frameMs = took(kFrame);
      part.lightMs = more(took(kLight), part.frameMs);
      const double before = part.frameMs + part.lightMs;
      part.sceneMs = cold_ && before > 0 ? 0.0 : more(took(kScene), before);
      cost.frameMs += part.frameMs;
      cost.lightMs += part.lightMs;
      cost.sceneMs += part.sceneMs;
      cost.nodes.push_back(std::move(part));
    }
  }

 private:
  /// A node that does the same work takes about the same time: less than half as much again is noise.
  static double more(double ms, double before) { return ms > 1.5 * before ? ms - before : 0.0; }
  /// Host-paced nodes work between their submissions too; of the others the clock sees only the recording.
  double timeOf(const graph::NodeStats& node) const {
    return hostPaced_.count(node.name) != 0 || node.gpuMs <= 0.0 ? node.wallMs : node.gpuMs;
  }
  std::set<std::string> hostPaced_;
  Times times_;
  bool cold_ = false;
};

void describe(const graph::FrameStats& last, Cost& cost) {
  for (const graph::ResourceStats& r : last.resources) cost.memory.push_back({r.name, r.meaning, r.bytes, r.scratch});
  cost.deviceBytes = last.memory.current;
  cost.counts = last.counts;
  for (const graph::CulledNode& node : last.culled) cost.culled[node.name] = node.reason;
  for (const graph::NodeStats& node : last.nodes) {
    for (const auto& [name, value] : node.figures) cost.figures[node.name + "." + name] = value;
  }
}

image::Image black(const image::Image& like) { return {like.width, like.height, like.channels, std::vector<float>(like.data.size())}; }

}  // namespace

void judgePictures(const Bench& bench, image::Image color, image::Image indirect, Row& row) {
  const auto one = [&](const cli::LayerTruth& truth, float exposure, image::Image& picture, const char* name, bool hdr) {
    Judgement judgement = judge(truth, exposure, picture, hdr);
    const std::string path = bench.pictures + "/" + row.key + "." + name;
    image::writePng(path + ".png", image::scaled(picture, exposure));
    image::writePng(path + "_error.png", image::paintHeat(judgement.flip));
    return judgement.figures;
  };
  row.full = one(bench.truth.full, bench.truth.exposureFull, color, "color", true);
  row.indirect = one(bench.truth.indirect, bench.truth.exposureIndirect, indirect, "indirect", false);
}

void measure(const Bench& bench, cli::Job& job, Row& row) {
  using std::chrono::steady_clock;
  scene::GpuScene gpuScene(bench.device, bench.scene, job.lights);
  const uint32_t width = job.request.width, height = job.request.height;
  gpuScene.setCamera(bench.camera, width, height);
  const scene::Traits traits = scene::traitsFor(bench.scene, job.lights);
  const auto start = steady_clock::now();
  graph::Plan plan = graph::compile(job.graph, {traits, job.request, bench.device.capabilities(), gpuScene.imports(), gpuScene.counts()});
  graph::Executor executor(bench.device, job.graph, std::move(plan), traits, job.request, gpuScene.counts());
  row.cost.prepareMs = std::chrono::duration<double, std::milli>(steady_clock::now() - start).count();
  Timer timer(executor.plan());
  const auto run = [&] {
    gpuScene.importInto(executor);
    executor.run(bench.progress, bench.cancelled);
    return executor.stats();
  };
  graph::FrameStats all = run();
  row.cost.firstRunMs = all.wallMs;

  std::map<std::string, image::Image> pictures;
  scene::CameraDescription moved = bench.camera;
  uint32_t repeats = 1;
  for (uint32_t i = 0; i < repeats; ++i) {
    // The first run of all compiles late in some drivers. Where that is little of it, it counts, and the longest settings take half the time.
    if (i > 0 || all.wallMs < kLongRunMs) {
      gpuScene.touchGeometry();
      all = run();
    } else {
      timer.scenesAreCold();
    }
    timer.note(kScene, all);
    gpuScene.setLights(bench.scene);
    const graph::FrameStats lit = run();
    timer.note(kLight, lit);
    if (i == 0) {
      for (const cli::Aov& aov : job.aovs) {
        pictures[aov.name] = cli::downloadAov(bench.device, executor, job, aov, bench.scene).image;
      }
    }
    // Never where it was before: a lazy node would have its work done.
    const float degrees = kDegreesAFrame * static_cast<float>((i + 2) / 2) * (i % 2 == 0 ? 1.f : -1.f);
    moved.orientation = glm::angleAxis(glm::radians(degrees), glm::vec3(0.f, 1.f, 0.f)) * bench.camera.orientation;
    gpuScene.setCamera(moved, width, height);
    timer.note(kFrame, run());
    if (i == 0) repeats = std::clamp(static_cast<uint32_t>(kMillisecondsForRepeats / std::max(all.wallMs, 1.0)) | 1u, 1u, kMostRepeats);
  }
  const graph::FrameStats last = executor.stats();
  timer.fill(last, row.cost);
  describe(last, row.cost);
  image::Image& color = pictures["color"];
  // A method that gives none has no indirect light.
  image::Image indirect =
      pictures.count("irradiance_indirect") != 0 ? std::move(pictures["irradiance_indirect"]) : black(bench.truth.full.truth.mean);
  judgePictures(bench, std::move(color), std::move(indirect), row);
}

}  // namespace radivox::report
