// What a stability case works with: renders of the method under test, with every picture and figure of them at hand.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/graph/executor.h"
#include "engine/image/image.h"
#include "engine/scene/gpu_scene.h"
#include "engine/stability/case.h"

namespace radivox::stability {

struct RenderOptions {
  std::string graph;  ///< empty: the method under test
  std::vector<std::pair<std::string, std::string>>
      settings;  ///< "voxelize.resolution" = "32"; those of nodes that the graph lacks are passed over
  std::vector<std::string> aovs{"irradiance_indirect"};
  std::vector<std::string> outputs;  ///< further endpoints to keep, "gather.irradiance"
  uint32_t width = 48, height = 32;
  uint32_t bounces = scene::kAllBounces;
  /// Small maps: cases run on CPUs.
  scene::LightOptions lights{.shadowResolution = 512, .pointShadowResolution = 128, .emitterSamples = 16, .emitterShadowResolution = 64};
};

/// One scene rendered once.
class Render {
 public:
  Render(gpu::Device& device, scene::Scene scene, graph::Graph graph, const RenderOptions& options, const std::function<bool()>& cancelled);

  /// RGBA of an AOV, or of one channel as that channel four times.
  image::Image aov(const std::string& name);
  /// Values of its first three channels where there is a surface (all pixels if it knows no depth).
  std::vector<float> surfaceValues(const std::string& name);
  /// "pixel (3, 4), at (0.1, 2, 0.5) m": where `aov` is farthest from `expected`.
  std::string describeWorst(const std::string& aov, double expected);
  std::string describeWorst(const std::string& aov, const image::Image& expected);
  template <class T>
  std::vector<T> buffer(const std::string& nodePort, size_t count) {
    const gpu::Buffer* found = executor_->findBuffer(nodePort);
    if (found == nullptr) throw Error(ErrorCode::BadInput, "no buffer " + nodePort + " in this plan");
    return gpu::downloadAs<T>(device_, *found, count);
  }
  uint64_t count(const std::string& name) const;
  /// Of Node's reportStat; nothing if the node or the figure is not there.
  std::optional<double> figure(const std::string& node, const std::string& name) const;
  /// Iterations and residual of the first node that reports both.
  std::optional<std::pair<double, double>> solverFigures() const;
  const scene::Scene& scene() const { return scene_; }
  const graph::Executor& executor() const { return *executor_; }

 private:
  gpu::Device& device_;
  scene::Scene scene_;
  graph::Graph graph_;
  std::unique_ptr<scene::GpuScene> gpuScene_;
  std::unique_ptr<graph::Executor> executor_;
};

class Bench {
 public:
  using MakeGraph = std::function<graph::Graph(const std::string& name)>;
  Bench(gpu::Device& device, std::string method, MakeGraph makeGraph, std::function<bool()> cancelled);

  const std::string& method() const { return method_; }
  gpu::Device& device() { return device_; }
  /// The method draws samples: what it finds is noisy, and cases allow for that.
  bool isNoisy() const { return noisy_; }
  /// `exact` for methods without noise, else what `noisy` allows.
  double tolerance(double exact, double noisy = 0.05) const { return noisy_ ? std::max(exact, noisy) : exact; }
  std::unique_ptr<Render> render(scene::Scene scene, const RenderOptions& options = {});
  bool hasGraph(const std::string& name) const;

  // Of all renders of this case:
  double lastIterations() const { return iterations_; }
  double lastResidual() const { return residual_; }
  /// Values that are not finite, in every AOV that was rendered.
  uint64_t badValueCount() const { return badValues_; }
  uint32_t validationMessages() const { return device_.validationMessageCount(); }

 private:
  gpu::Device& device_;
  std::string method_;
  MakeGraph makeGraph_;
  std::function<bool()> cancelled_;
  bool noisy_ = false;
  double iterations_ = -1, residual_ = -1;
  uint64_t badValues_ = 0;
};

/// Runs one case: its row with verdict, time and iterations. Errors that a case allows are `Refused`, all others `Fail`; nothing is thrown
/// but an interruption.
Row runCase(const Case& which, Bench& bench);

// Statistics that cases judge by.
double meanOf(const std::vector<float>& values);
/// √mean((value − expected)²)
double rmsFrom(const std::vector<float>& values, double expected);
double largestFrom(const std::vector<float>& values, double expected);
/// RMSE of test against reference over the mean of the reference; pictures of one size.
double relativeRmse(const std::vector<float>& reference, const std::vector<float>& test);

}  // namespace radivox::stability
