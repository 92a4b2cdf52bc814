#include "engine/stability/bench.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <new>
#include <tuple>

namespace radivox::stability {

namespace {

/// "gbuffer.position.w" → endpoint and channel; −1: all.
std::pair<std::string, int> splitChannel(std::string endpoint) {
  const size_t length = endpoint.size();
  if (length > 2 && endpoint[length - 2] == '.') {
    const size_t channel = std::string("xyzw").find(endpoint[length - 1]);
    endpoint.resize(length - 2);
    return {endpoint, static_cast<int>(channel)};
  }
  return {endpoint, -1};
}

std::string endpointOf(const graph::Graph& graph, const std::string& aov) {
  const auto found = graph.aovs().find(aov);
  if (found == graph.aovs().end()) throw Error(ErrorCode::BadInput, "this method has no AOV " + aov + "; name it in the graph's aovs");
  return splitChannel(found->second).first;
}

}  // namespace

const char* printVerdict(Verdict verdict) {
  switch (verdict) {
    case Verdict::Pass:
      return "pass";
    case Verdict::Degraded:
      return "degraded";
    case Verdict::Refused:
      return "refused";
    case Verdict::Shown:
      return "shown";
    case Verdict::Skipped:
      return "skipped";
    case Verdict::Fail:
      return "fail";
  }
  return "";
}

void Row::judge(double expectedValue, double resultValue, double toleranceValue, double scale) {
  expected = expectedValue;
  result = resultValue;
  tolerance = toleranceValue;
  error = std::abs(resultValue - expectedValue) / (scale > 0 ? scale : 1.0);
}

Render::Render(gpu::Device& device, scene::Scene scene, graph::Graph graph, const RenderOptions& options,
               const std::function<bool()>& cancelled)
    : device_(device), scene_(std::move(scene)), graph_(std::move(graph)) {
  for (const auto& [name, value] : options.settings) {
    if (graph_.find(name.substr(0, name.find('.'))) != nullptr) graph_.set(name, value);
  }
  scene::Request request;
  request.width = options.width;
  request.height = options.height;
  request.bounces = options.bounces;
  request.aovs = {options.aovs.begin(), options.aovs.end()};
  graph_.clearOutputs();
  std::vector<std::string> outputs = options.outputs;
  for (const std::string& aov : options.aovs) outputs.push_back(endpointOf(graph_, aov));
  // What a surface is, for surfaceValues; where, for describeWorst.
  for (const char* aov : {"depth", "position"}) {
    if (graph_.aovs().count(aov) != 0) outputs.push_back(endpointOf(graph_, aov));
  }
  std::sort(outputs.begin(), outputs.end());
  outputs.erase(std::unique(outputs.begin(), outputs.end()), outputs.end());
  for (const std::string& output : outputs) graph_.output(output);

  const scene::Traits traits = scene::traitsFor(scene_, options.lights);
  gpuScene_ = std::make_unique<scene::GpuScene>(device, scene_, options.lights);
  gpuScene_->setCamera(scene_.cameras.front(), options.width, options.height);
  graph::Plan plan = graph::compile(graph_, {traits, request, device.capabilities(), gpuScene_->imports(), gpuScene_->counts()});
  executor_ = std::make_unique<graph::Executor>(device, graph_, std::move(plan), traits, request, gpuScene_->counts());
  gpuScene_->importInto(*executor_);
  executor_->run({}, cancelled);
}

image::Image Render::aov(const std::string& name) {
  const auto [endpoint, channel] = splitChannel(graph_.aovs().at(name));
  gpu::Image* from = executor_->findImage(endpoint);
  if (from == nullptr) throw Error(ErrorCode::BadInput, "AOV " + name + " was left out of this plan");
  const auto bytes = gpu::download(device_, *from);
  image::Image out{from->info().width, from->info().height, 4, {}};
  out.data.resize(size_t{out.width} * out.height * 4);
  if (bytes.size() != out.data.size() * sizeof(float)) throw Error(ErrorCode::Unsupported, "AOV " + name + " is no RGBA32F image");
  std::memcpy(out.data.data(), bytes.data(), bytes.size());
  if (channel >= 0) {
    for (size_t i = 0; i < out.data.size(); i += 4) {
      const float value = out.data[i + static_cast<size_t>(channel)];
      std::fill_n(out.data.begin() + static_cast<std::ptrdiff_t>(i), 4, value);
    }
  }
  return out;
}

std::vector<float> Render::surfaceValues(const std::string& name) {
  const image::Image picture = aov(name);
  image::Image depth;
  if (graph_.aovs().count("depth") != 0) depth = aov("depth");
  std::vector<float> values;
  for (size_t i = 0; i < picture.data.size(); i += 4) {
    if (!depth.data.empty() && depth.data[i] == 0.f) continue;
    values.insert(values.end(), picture.data.begin() + static_cast<std::ptrdiff_t>(i),
                  picture.data.begin() + static_cast<std::ptrdiff_t>(i) + 3);
  }
  return values;
}

std::string Render::describeWorst(const std::string& name, double expected) {
  const image::Image picture = aov(name);
  return describeWorst(
      name, image::Image{picture.width, picture.height, 4, std::vector<float>(picture.data.size(), static_cast<float>(expected))});
}

std::string Render::describeWorst(const std::string& name, const image::Image& expected) {
  const image::Image picture = aov(name);
  uint32_t worstX = 0, worstY = 0;
  double worst = -1;
  for (uint32_t y = 0; y < picture.height; ++y) {
    for (uint32_t x = 0; x < picture.width; ++x) {
      for (uint32_t c = 0; c < 3; ++c) {
        const double off = std::abs(double{picture.at(x, y, c)} - double{expected.at(x, y, c)});
        if (off <= worst) continue;
        worst = off;
        worstX = x;
        worstY = y;
      }
    }
  }
  char values[96];
  std::snprintf(values, sizeof values, "%.4g for %.4g", double{picture.at(worstX, worstY, 0)}, double{expected.at(worstX, worstY, 0)});
  std::string text = "worst at pixel (" + std::to_string(worstX) + ", " + std::to_string(worstY) + "): " + values;
  if (graph_.aovs().count("position") == 0) return text;
  const image::Image position = aov("position");
  char place[96];
  std::snprintf(place, sizeof place, ", at (%.4g, %.4g, %.4g) m", double{position.at(worstX, worstY, 0)},
                double{position.at(worstX, worstY, 1)}, double{position.at(worstX, worstY, 2)});
  return text + place;
}

uint64_t Render::count(const std::string& name) const {
  const auto found = executor_->counts().find(name);
  return found == executor_->counts().end() ? 0 : found->second;
}

std::optional<double> Render::figure(const std::string& node, const std::string& name) const {
  for (const graph::NodeStats& stats : executor_->stats().nodes) {
    if (stats.name == node && stats.figures.contains(name)) return stats.figures.at(name);
  }
  return std::nullopt;
}

std::optional<std::pair<double, double>> Render::solverFigures() const {
  for (const graph::NodeStats& stats : executor_->stats().nodes) {
    if (stats.figures.contains("iterations") && stats.figures.contains("residual"))
      return std::pair(stats.figures.at("iterations"), stats.figures.at("residual"));
  }
  return std::nullopt;
}

Bench::Bench(gpu::Device& device, std::string method, MakeGraph makeGraph, std::function<bool()> cancelled)
    : device_(device), method_(std::move(method)), makeGraph_(std::move(makeGraph)), cancelled_(std::move(cancelled)) {
  const graph::Graph graph = makeGraph_(method_);
  for (const auto& entry : graph.nodes()) noisy_ |= entry.node->type() == "reference.path_trace";
}

bool Bench::hasGraph(const std::string& name) const {
  try {
    makeGraph_(name);
    return true;
  } catch (const Error&) {
    return false;
  }
}

std::unique_ptr<Render> Bench::render(scene::Scene scene, const RenderOptions& options) {
  auto render =
      std::make_unique<Render>(device_, std::move(scene), makeGraph_(options.graph.empty() ? method_ : options.graph), options, cancelled_);
  if (const auto figures = render->solverFigures()) std::tie(iterations_, residual_) = *figures;
  for (const std::string& aov : options.aovs) {
    for (const float value : render->aov(aov).data) badValues_ += std::isfinite(value) ? 0 : 1;
  }
  return render;
}

Row runCase(const Case& which, Bench& bench) {
  Row row;
  const auto start = std::chrono::steady_clock::now();
  const uint32_t messagesBefore = bench.validationMessages();
  std::string failure;
  try {
    which.run(bench, row);
  } catch (const Error& error) {
    const std::string text = error.what();
    if (text == "interrupted") throw;
    row.note = text;
    if (which.mayRefuse && error.code() != ErrorCode::DeviceFailed && text.find('\n') == std::string::npos)
      row.verdict = Verdict::Refused;
    else
      failure = "error: " + text;
  } catch (const std::bad_alloc&) {
    failure = "out of memory on the host";
  }
  row.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  row.iterations = bench.lastIterations();
  row.residual = bench.lastResidual();
  if (bench.badValueCount() > 0) failure = std::to_string(bench.badValueCount()) + " values that are not finite";
  if (bench.validationMessages() > messagesBefore) failure = "validation messages";
  if (!failure.empty()) {
    // What shows another's divergence may diverge; nothing else may.
    row.verdict = row.shown ? Verdict::Shown : Verdict::Fail;
    row.note = failure;
  } else if (row.verdict != Verdict::Refused) {
    // Not a comparison that NaN passes.
    row.verdict = row.shown                                 ? Verdict::Shown
                  : row.error <= row.tolerance              ? Verdict::Pass
                  : row.bound > 0 && row.error <= row.bound ? Verdict::Degraded
                                                            : Verdict::Fail;
  }
  return row;
}

double meanOf(const std::vector<float>& values) {
  double sum = 0;
  for (const float value : values) sum += double{value};
  return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
}

double rmsFrom(const std::vector<float>& values, double expected) {
  double sum = 0;
  for (const float value : values) sum += (double{value} - expected) * (double{value} - expected);
  return values.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(values.size()));
}

double largestFrom(const std::vector<float>& values, double expected) {
  double largest = 0;
  for (const float value : values) {
    const double off = std::abs(double{value} - expected);
    if (!(off <= largest)) largest = off;  // keeps NaN
  }
  return largest;
}

double relativeRmse(const std::vector<float>& reference, const std::vector<float>& test) {
  if (reference.size() != test.size()) return std::numeric_limits<double>::infinity();
  double sum = 0;
  for (size_t i = 0; i < reference.size(); ++i) sum += (double{test[i]} - double{reference[i]}) * (double{test[i]} - double{reference[i]});
  const double mean = meanOf(reference);
  const double rms = reference.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(reference.size()));
  return rms > 0 ? rms / mean : 0.0;
}

}  // namespace radivox::stability
