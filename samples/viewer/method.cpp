#include "samples/viewer/method.h"

#include <algorithm>
#include <chrono>
#include <cstring>

#include "engine/error.h"
#include "modules/clustered_voxel/gather_pixels/gather_pixels.h"
#include "samples/cli/picture.h"
#ifdef RADIVOX_WITH_VDB
#include "modules/vdb/dump.h"
#else
#include "samples/cli/missing.h"
#endif

namespace radivox::viewer {

namespace {

/// "node.param=value" → its parts.
struct Setting {
  std::string name, owner, param, value;
  explicit Setting(const std::string& text) {
    const size_t equals = text.find('='), dot = text.find('.');
    name = text.substr(0, equals);
    owner = text.substr(0, dot);
    param = name.substr(std::min(dot + 1, name.size()));
    value = equals == std::string::npos ? "" : text.substr(equals + 1);
  }
};

const params::Param* findParam(const params::Table& table, const std::string& name) {
  const auto found = std::find_if(table.all().begin(), table.all().end(), [&](const params::Param& p) { return p.name == name; });
  return found == table.all().end() ? nullptr : &*found;
}

/// Sets the parameters that trade time for quality to the cheapest value worth trying, unless they are cheaper already.
void cheapen(params::Table& table, const std::string& owner, std::set<std::string>& fixed) {
  for (const params::Param& param : table.all()) {
    if (param.sweep.empty()) continue;
    const double first = std::stod(param.sweep.front()), last = std::stod(param.sweep.back()), now = std::stod(param.get());
    const bool cheaper = first < last ? now < first : now > first;
    fixed.insert(owner + "." + param.name);
    if (!cheaper) table.set(owner, param.name, param.sweep.front());
  }
}

/// The same light sources: a plan made for one holds for the other.
bool isSamePlan(const scene::Traits& a, const scene::Traits& b) {
  return a.directionalLightCount == b.directionalLightCount && a.pointLightCount == b.pointLightCount &&
         a.spotLightCount == b.spotLightCount && a.sky == b.sky && a.skyImage == b.skyImage && a.emittersByRays == b.emittersByRays;
}

}  // namespace

Method::Method(gpu::Device& device, const scene::Scene& scene, const View& view, const std::vector<std::string>& modules, Quality quality)
    : device_(device), quality_(quality), job_(std::make_unique<cli::Job>()), view_(view) {
  cli::Options options;
  options.scene = view.scene;
  options.graph = view.graph;
  options.modules = modules;
  options.sets = view.settings;
  options.bounces = view.bounces;
  options.size = std::to_string(view.width) + "x" + std::to_string(view.height);
  cli::prepareJob(options, true, *job_);
  if (quality == Quality::Full) {
    for (const auto& [name, endpoint] : job_->graph.aovs()) {
      if (name != "color" && name != "display") options.aovs += "," + name;
    }
    job_ = std::make_unique<cli::Job>();
    cli::prepareJob(options, true, *job_);
  } else {
    for (const graph::Graph::Entry& entry : job_->graph.nodes()) cheapen(entry.node->params(), entry.name, fixed_);
    cheapen(job_->lightParams, "lights", fixed_);
  }
  // Lights are moved while the picture is looked at, and then no ray of a pixel is traced again.
  job_->lights.fixed = false;
  for (const graph::Graph::Entry& entry : job_->graph.nodes()) {
    const std::string keep = entry.name + ".keep";
    const bool isSaid =
        std::any_of(view.settings.begin(), view.settings.end(), [&](const std::string& text) { return Setting(text).name == keep; });
    if (entry.node->type() == clustered_voxel::GatherPixels::kType && !isSaid) job_->graph.set(keep, "true");
  }
  planKey_ = planKey(view);
  gpuScene_ = std::make_unique<scene::GpuScene>(device, scene, job_->lights);
  compile(scene);
}

void Method::compile(const scene::Scene& scene) {
  gpuScene_->setCamera(view_.camera, view_.width, view_.height);
  traits_ = scene::traitsFor(scene, job_->lights);
  const scene::Request& request = job_->request;
  const auto makePlan = [&] {
    return graph::compile(job_->graph, {.traits = traits_,
                                        .request = request,
                                        .capabilities = device_.capabilities(),
                                        .imports = gpuScene_->imports(),
                                        .knownCounts = gpuScene_->counts(),
                                        .keepsAll = true});  // overlays look at what nodes hand on
  };
  graph::Plan plan = makePlan();
  // Where clusters are, which only overlays ask: of clusters that the picture has made.
  bool asks = false;
  for (const graph::Graph::Entry& entry : job_->graph.nodes()) {
    if (entry.node->type() != "clustered_voxel.members" || plan.findPort(entry.name, "clusters") == nullptr) continue;
    if (plan.findPort(entry.name, "places") != nullptr && plan.findPort(entry.name, "places")->resource != graph::kNoResource) continue;
    job_->graph.output(entry.name + ".places");
    asks = true;
  }
  if (asks) plan = makePlan();
  executor_ = std::make_unique<graph::Executor>(device_, job_->graph, std::move(plan), traits_, request, gpuScene_->counts());
  gpuScene_->importInto(*executor_);
}

std::string Method::planKey(const View& view) const {
  std::string key = view.scene + "\n" + view.graph + "\n" + view.bounces;
  for (const std::string& text : view.settings) {
    const Setting setting(text);
    if (fixed_.count(setting.name) != 0) continue;
    graph::Node* node = job_->graph.find(setting.owner);
    const params::Param* param = nullptr;
    if (node != nullptr) param = findParam(node->params(), setting.param);
    if (node != nullptr && param != nullptr && param->invalidates != params::Invalidates::Plan) continue;
    key += "\n" + text;
  }
  return key;
}

void Method::applySettings(const View& view) {
  for (const std::string& text : view.settings) {
    const Setting setting(text);
    if (fixed_.count(setting.name) == 0 && setting.owner != "lights") job_->graph.set(setting.name, setting.value);
  }
}

bool Method::update(const scene::Scene& scene, const View& view) {
  if (planKey(view) != planKey_) return false;
  const bool relit = !(view.lighting == view_.lighting);
  if (relit && !isSamePlan(traits_, scene::traitsFor(scene, job_->lights))) return false;
  if (view.settings != view_.settings || relit) lit_ = false;
  if (view.settings != view_.settings) applySettings(view);
  if (relit) {
    gpuScene_->setLights(scene);
    for (const auto& [name, value] : gpuScene_->counts()) executor_->setCount(name, value);
  }
  if (!(view.camera == view_.camera) || view.width != view_.width || view.height != view_.height) {
    gpuScene_->setCamera(view.camera, view.width, view.height);
    executor_->setCount("width", view.width);
    executor_->setCount("height", view.height);
    job_->size = {view.width, view.height};
  }
  gpuScene_->importInto(*executor_);
  view_ = view;
  return true;
}

void Method::run(const graph::Progress& progress, const std::function<bool()>& cancelled) {
  const bool wasLit = lit_;
  const auto start = std::chrono::steady_clock::now();
  executor_->run(progress, cancelled);
  lit_ = true;
  if (wasLit) lastFrameMs_ = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

Pixels Method::display() {
  gpu::Image* image = job_->displayEndpoint ? executor_->findImage(job_->displayEndpoint->endpoint) : nullptr;
  Pixels pixels;
  if (image != nullptr && image->info().format == VK_FORMAT_R8G8B8A8_UNORM) {
    pixels.width = image->info().width;
    pixels.height = image->info().height;
    const std::vector<std::byte> bytes = gpu::download(device_, *image);
    pixels.rgba.resize(bytes.size());
    std::memcpy(pixels.rgba.data(), bytes.data(), bytes.size());
    return pixels;
  }
  // A graph that tone-maps nothing: as `radivox render` writes its pictures.
  const scene::Scene nowhere;
  const image::Layer layer = cli::downloadAov(device_, *executor_, *job_, job_->aovs.front(), nowhere);
  return encodePixels(cli::displayReferred(layer));
}

float Method::exposure() {
  const gpu::Buffer* exposure = ports().buffer("frame.tone_map", "exposure");
  if (exposure == nullptr) return 1.f;
  return gpu::downloadAs<float>(device_, *exposure, 1).front();
}

bool Method::isFilmic() const {
  graph::Node* node = ports().node("frame.tone_map");
  if (node == nullptr) return false;
  const params::Param* param = findParam(node->params(), "operator");
  return param != nullptr && param->get() == "filmic";
}

image::Layer Method::aov(const std::string& name, const scene::Scene& scene) {
  for (const cli::Aov& aov : job_->aovs) {
    if (aov.name == name) return cli::downloadAov(device_, *executor_, *job_, aov, scene);
  }
  throw Error(ErrorCode::BadInput, "AOV " + name + " is not kept by this picture; wait for the full one, or choose another graph");
}

std::string Method::dumpVoxels(const std::string& path, const scene::Scene& scene) {
#ifdef RADIVOX_WITH_VDB
  vdb::DumpRequest request;
  request.file = path;
  request.scene = scene.name;
  request.origin = scene.origin;
  std::string names;
  for (const std::string& line : vdb::dumpFrame(device_, job_->graph, *executor_, traits_, request).leftOut)
    names += (names.empty() ? "" : ", ") + line.substr(0, line.find(':'));
  return names.empty() ? "" : "without " + names + ", which this picture did not need; `radivox vdb` writes them";
#else
  throw Error(ErrorCode::Unsupported, path + ": this build writes no voxels of " + scene.name + "; " + cli::kGetVdb);
#endif
}

std::vector<std::string> Method::aovNames() const {
  std::vector<std::string> names;
  for (const cli::Aov& aov : job_->aovs) {
    if (!aov.endpoint.empty() && executor_->findImage(aov.endpoint) != nullptr) names.push_back(aov.name);
  }
  return names;
}

GraphReport Method::report() const {
  return {executor_->stats(), job_->graphName, device_.capabilities().deviceName, gpuScene_->notes(),
          executor_->plan().printText(executor_->counts())};
}

}  // namespace radivox::viewer
