// A graph, a scene and a device put together, and planned anew where a change asks for it.
#include "bindings/c/handles.h"
#include "engine/image/image.h"

namespace radivox::c {

namespace {

/// Counts up with every parameter that changes the plan.
uint64_t planVersionOf(const graph::Graph& graph) {
  uint64_t version = 0;
  for (const graph::Graph::Entry& entry : graph.nodes()) version += entry.node->params().planVersion();
  return version;
}

/// Whether nodes would declare the same for both: a light more may bring in a node that was left out.
bool isSamePlanFor(const scene::Traits& a, const scene::Traits& b) {
  return a.directionalLightCount == b.directionalLightCount && a.pointLightCount == b.pointLightCount &&
         a.spotLightCount == b.spotLightCount && a.emissiveTriangleCount == b.emissiveTriangleCount && a.sky == b.sky &&
         a.skyImage == b.skyImage && a.emittersByRays == b.emittersByRays && a.boundsMin == b.boundsMin && a.boundsMax == b.boundsMax;
}

graph::Shape shapeOf(const RadivoxImport& import) {
  if (import.format == VK_FORMAT_UNDEFINED) return graph::Shape::buffer(1, import.bufferBytes);
  return graph::Shape::image(import.format, graph::Extent::of("width"), graph::Extent::of("height"));
}

void checkSize(uint32_t width, uint32_t height) {
  if (width == 0 || height == 0) throw Error(ErrorCode::BadInput, "a picture of no pixels; give a width and a height above 0");
}

}  // namespace

Renderer::Renderer(const RadivoxRendererInfo& info)
    : device_(require(info.device, "info->device").device),
      scene_(require(info.scene, "info->scene").scene),
      graph_(require(info.graph, "info->graph").state) {
  checkSize(info.width, info.height);
  if (graph_->hasRenderer) throw Error(ErrorCode::BadInput, "the graph has a renderer already; make another graph of the same JSON");
  if (graph_->device != nullptr && graph_->device != device_) {
    throw Error(ErrorCode::BadInput, "the graph's nodes hold pipelines of another device; make another graph of the same JSON");
  }
  request_.width = info.width;
  request_.height = info.height;
  request_.bounces = info.bounces;
  for (uint32_t i = 0; i < info.importCount; ++i) {
    const RadivoxImport& import = (&require(info.imports, "info->imports"))[i];
    const std::string name = requireText(import.name, "info->imports[i].name");
    Imported imported;
    imported.shape = {name, shapeOf(import)};
    if (!imports_.emplace(name, std::move(imported)).second) throw Error(ErrorCode::BadInput, "the import " + name + " is given twice");
  }
  if (!scene_->cameras.empty()) camera_ = scene_->cameras.front();
  gpuScene_ = std::make_unique<scene::GpuScene>(*device_, *scene_);
  gpuScene_->setCamera(camera_, request_.width, request_.height);
  graph_->device = device_;
  plan();
  graph_->hasRenderer = true;
}

Renderer::~Renderer() {
  executor_.reset();
  graph_->hasRenderer = false;
}

bool Renderer::isPlanCurrent() const { return executor_ != nullptr && planVersion_ == planVersionOf(graph_->graph); }

void Renderer::plan() {
  executor_.reset();  // its memory first
  planVersion_ = planVersionOf(graph_->graph);
  traits_ = scene::traitsFor(*scene_, {});
  std::vector<graph::Import> shapes = gpuScene_->imports();
  for (const auto& [name, imported] : imports_) shapes.push_back(imported.shape);
  graph::Plan made = graph::compile(graph_->graph, {traits_, request_, device_->capabilities(), shapes, gpuScene_->counts()});
  executor_ = std::make_unique<graph::Executor>(*device_, graph_->graph, std::move(made), traits_, request_, gpuScene_->counts());
  importAll();
}

void Renderer::importAll() {
  gpuScene_->importInto(*executor_);
  for (auto& [name, imported] : imports_) {
    if (imported.image) executor_->importImage(name, imported.image, imported.version);
    if (imported.buffer) executor_->importBuffer(name, imported.buffer, imported.version);
  }
}

Renderer::Imported& Renderer::findImport(const std::string& name) {
  const auto found = imports_.find(name);
  if (found != imports_.end()) return found->second;
  std::vector<std::string> names;
  for (const auto& [known, imported] : imports_) names.push_back(known);
  const std::string near = params::nearestName(name, names);
  throw Error(ErrorCode::BadInput,
              name + ": no such import; " + (near.empty() ? "name it in RadivoxRendererInfo::imports" : "did you mean " + near + "?"));
}

void Renderer::setCamera(const scene::CameraDescription& camera) {
  camera_ = camera;
  gpuScene_->setCamera(camera_, request_.width, request_.height);
  if (executor_ != nullptr) gpuScene_->importInto(*executor_);
}

void Renderer::setLights() {
  gpuScene_->setLights(*scene_);
  takeScene();
}

void Renderer::setGeometry() {
  gpuScene_->setGeometry(*scene_);
  takeScene();
}

void Renderer::takeScene() {
  if (!isSamePlanFor(traits_, scene::traitsFor(*scene_, {}))) executor_.reset();  // planned anew by the next run
  if (executor_ == nullptr) return;
  for (const auto& [name, value] : gpuScene_->counts()) executor_->setCount(name, value);
  gpuScene_->importInto(*executor_);
}

void Renderer::resize(uint32_t width, uint32_t height) {
  checkSize(width, height);
  if (width == request_.width && height == request_.height) return;
  request_.width = width;
  request_.height = height;
  for (auto& [name, imported] : imports_) imported.isGiven = imported.isGiven && !imported.image;  // images are of the old size
  gpuScene_->setCamera(camera_, width, height);
  if (executor_ == nullptr) return;
  // Voxels, clusters and light stay: only what has the picture's size is made anew.
  executor_->setCount("width", width);
  executor_->setCount("height", height);
  gpuScene_->importInto(*executor_);
}

void Renderer::importImage(const std::string& name, const RadivoxImageInfo& image, uint64_t version) {
  Imported& imported = findImport(name);
  if (imported.shape.shape.kind != graph::ResourceKind::Image) throw Error(ErrorCode::BadInput, name + " is a buffer in this renderer");
  require(image.image, "image->image");
  require(image.view, "image->view");
  if (image.format != imported.shape.shape.format || image.width != request_.width || image.height != request_.height) {
    throw Error(ErrorCode::BadInput, name + ": " + std::to_string(image.width) + "x" + std::to_string(image.height) + ", format " +
                                         std::to_string(image.format) + "; the renderer has " + std::to_string(request_.width) + "x" +
                                         std::to_string(request_.height) + ", format " + std::to_string(imported.shape.shape.format));
  }
  const gpu::ImageInfo info{.width = image.width, .height = image.height, .layers = std::max(image.layers, 1u), .format = image.format};
  imported.image = gpu::Image(image.image, image.view, info, image.layout);
  imported.version = version;
  imported.isGiven = true;
  if (executor_ != nullptr) executor_->importImage(name, imported.image, version);
}

void Renderer::importBuffer(const std::string& name, const RadivoxBufferInfo& buffer, uint64_t version) {
  Imported& imported = findImport(name);
  if (imported.shape.shape.kind != graph::ResourceKind::Buffer) throw Error(ErrorCode::BadInput, name + " is an image in this renderer");
  require(buffer.buffer, "buffer->buffer");
  const uint64_t needed = imported.shape.shape.elements.evaluate({}).value_or(0);
  if (buffer.bytes < needed) {
    throw Error(ErrorCode::BadInput, name + ": " + std::to_string(buffer.bytes) + " bytes; the renderer needs " + std::to_string(needed));
  }
  imported.buffer = gpu::Buffer(name, buffer.buffer, buffer.bytes, buffer.address);
  imported.version = version;
  imported.isGiven = true;
  if (executor_ != nullptr) executor_->importBuffer(name, imported.buffer, version);
}

void Renderer::run(RadivoxProgress progress, void* user) {
  for (const auto& [name, imported] : imports_) {
    if (!imported.isGiven) throw Error(ErrorCode::BadInput, "the import " + name + " is not given (or not since the last radivoxResize)");
  }
  if (!isPlanCurrent()) plan();
  if (progress == nullptr) return executor_->run();
  bool goesOn = true;
  const auto tell = [&](std::string_view node, double fraction) {
    text = node;
    goesOn = progress(user, text.c_str(), fraction) != VK_FALSE && goesOn;
  };
  try {
    executor_->run(tell, [&] { return !goesOn; });
  } catch (const Error&) {
    if (!goesOn) throw Interrupted{};
    throw;
  }
  if (!goesOn) throw Interrupted{};
}

bool Renderer::isReadyToRecord() {
  const bool hasImports = std::all_of(imports_.begin(), imports_.end(), [](const auto& entry) { return entry.second.isGiven; });
  return hasImports && isPlanCurrent() && executor_->isReadyToRecord();
}

gpu::Image& Renderer::findImage(const std::string& endpoint) {
  if (executor_ == nullptr) throw Error(ErrorCode::BadInput, endpoint + ": the plan is out of date; call radivoxRun first");
  gpu::Image* image = executor_->findImage(endpoint);
  if (image == nullptr) {
    throw Error(ErrorCode::BadInput, endpoint + " is no image of this plan, or has not been made yet; radivoxDescribePlan says what is");
  }
  return *image;
}

const gpu::Buffer& Renderer::findBuffer(const std::string& endpoint) {
  if (executor_ == nullptr) throw Error(ErrorCode::BadInput, endpoint + ": the plan is out of date; call radivoxRun first");
  const gpu::Buffer* buffer = executor_->findBuffer(endpoint);
  if (buffer == nullptr) {
    throw Error(ErrorCode::BadInput, endpoint + " is no buffer of this plan, or has not been made yet; radivoxDescribePlan says what is");
  }
  return *buffer;
}

}  // namespace radivox::c

using namespace radivox;
using c::guarded;

namespace {

c::Renderer& of(RadivoxRenderer* renderer) { return *c::require(renderer, "renderer").renderer; }

graph::Executor& executorOf(RadivoxRenderer* renderer) {
  if (!of(renderer).hasPlan()) throw Error(ErrorCode::BadInput, "the plan is out of date; call radivoxRun first");
  return of(renderer).executor();
}

void writePicture(c::Renderer& renderer, const std::string& endpoint, const std::string& file) {
  const bool isPng = file.size() > 4 && file.compare(file.size() - 4, 4, ".png") == 0;
  const bool isExr = file.size() > 4 && file.compare(file.size() - 4, 4, ".exr") == 0;
  if (!isPng && !isExr) throw Error(ErrorCode::BadInput, file + ": unknown kind of file; end the name in .exr or .png");
  image::checkWritable(file);
  gpu::Image& source = renderer.findImage(endpoint);
  if (source.info().format != VK_FORMAT_R32G32B32A32_SFLOAT) {
    throw Error(ErrorCode::Unsupported, endpoint + " is not RGBA32F; only such images are written");
  }
  const std::vector<std::byte> bytes = gpu::download(renderer.device(), source);
  image::Image picture{source.info().width, source.info().height, 3, {}};
  const size_t pixelCount = size_t{picture.width} * picture.height;
  picture.data.resize(3 * pixelCount);
  for (size_t i = 0; i < pixelCount; ++i) std::memcpy(&picture.data[3 * i], bytes.data() + 16 * i, 3 * sizeof(float));
  if (isExr) return image::writeExr(file, {{"color", std::move(picture)}});
  image::writePng(file, image::scaled(picture, image::exposureOf(picture)));
}

}  // namespace

RadivoxResult radivoxCreateRenderer(const RadivoxRendererInfo* info, RadivoxRenderer** renderer) {
  return guarded([&] {
    c::require(renderer, "renderer");
    *renderer = new RadivoxRenderer{std::make_unique<c::Renderer>(c::takeStruct(info, "info"))};
  });
}

void radivoxDestroyRenderer(RadivoxRenderer* renderer) { delete renderer; }

RadivoxResult radivoxSetCamera(RadivoxRenderer* renderer, const RadivoxCamera* camera) {
  return guarded([&] { of(renderer).setCamera(c::takeCamera(camera)); });
}

RadivoxResult radivoxSetLights(RadivoxRenderer* renderer) {
  return guarded([&] { of(renderer).setLights(); });
}

RadivoxResult radivoxSetGeometry(RadivoxRenderer* renderer) {
  return guarded([&] { of(renderer).setGeometry(); });
}

RadivoxResult radivoxResize(RadivoxRenderer* renderer, uint32_t width, uint32_t height) {
  return guarded([&] { of(renderer).resize(width, height); });
}

RadivoxResult radivoxImportImage(RadivoxRenderer* renderer, const char* name, const RadivoxImageInfo* image, uint64_t version) {
  return guarded([&] { of(renderer).importImage(c::requireText(name, "name"), c::takeStruct(image, "image"), version); });
}

RadivoxResult radivoxImportBuffer(RadivoxRenderer* renderer, const char* name, const RadivoxBufferInfo* buffer, uint64_t version) {
  return guarded([&] { of(renderer).importBuffer(c::requireText(name, "name"), c::takeStruct(buffer, "buffer"), version); });
}

RadivoxResult radivoxRun(RadivoxRenderer* renderer, RadivoxProgress progress, void* user) {
  return guarded([&] { of(renderer).run(progress, user); });
}

VkBool32 radivoxIsReadyToRecord(RadivoxRenderer* renderer) {
  bool ready = false;
  guarded([&] { ready = of(renderer).isReadyToRecord(); });
  return ready ? VK_TRUE : VK_FALSE;
}

RadivoxResult radivoxRecord(RadivoxRenderer* renderer, VkCommandBuffer commands) {
  return guarded([&] {
    c::require(commands, "commands");
    if (!of(renderer).isReadyToRecord()) {
      throw Error(ErrorCode::BadInput, "this frame cannot be recorded (radivoxIsReadyToRecord is VK_FALSE); call radivoxRun for it");
    }
    of(renderer).executor().record(commands);
  });
}

RadivoxResult radivoxFrameCompleted(RadivoxRenderer* renderer) {
  return guarded([&] { executorOf(renderer).frameCompleted(); });
}

RadivoxResult radivoxFindImage(RadivoxRenderer* renderer, const char* endpoint, RadivoxImageInfo* image) {
  return guarded([&] {
    const gpu::Image& found = of(renderer).findImage(c::requireText(endpoint, "endpoint"));
    RadivoxImageInfo to{};
    to.format = found.info().format;
    to.image = found.handle();
    to.view = found.view();
    to.layout = found.layout;
    to.width = found.info().width;
    to.height = found.info().height;
    to.layers = found.info().layers;
    c::giveStruct(image, to, "image");
  });
}

RadivoxResult radivoxFindBuffer(RadivoxRenderer* renderer, const char* endpoint, RadivoxBufferInfo* buffer) {
  return guarded([&] {
    const gpu::Buffer& found = of(renderer).findBuffer(c::requireText(endpoint, "endpoint"));
    RadivoxBufferInfo to{};
    to.buffer = found.handle();
    to.bytes = found.bytes();
    to.address = found.address();
    c::giveStruct(buffer, to, "buffer");
  });
}

RadivoxResult radivoxWritePicture(RadivoxRenderer* renderer, const char* endpoint, const char* file) {
  return guarded([&] { writePicture(of(renderer), c::requireText(endpoint, "endpoint"), c::requireText(file, "file")); });
}

RadivoxResult radivoxDescribePlan(RadivoxRenderer* renderer, const char** text) {
  return guarded([&] {
    c::require(text, "text");
    of(renderer).text = executorOf(renderer).plan().printText(executorOf(renderer).counts());
    *text = of(renderer).text.c_str();
  });
}

uint32_t radivoxNodeCount(const RadivoxRenderer* renderer) {
  if (renderer == nullptr || !renderer->renderer->hasPlan()) return 0;
  return static_cast<uint32_t>(renderer->renderer->executor().plan().steps.size());
}

RadivoxResult radivoxGetNodeTime(RadivoxRenderer* renderer, uint32_t index, RadivoxNodeTime* time) {
  return guarded([&] {
    of(renderer).stats = executorOf(renderer).stats();
    const auto& nodes = of(renderer).stats.nodes;
    if (index >= nodes.size()) throw Error(ErrorCode::BadInput, "node " + std::to_string(index) + " of " + std::to_string(nodes.size()));
    RadivoxNodeTime to{};
    to.ranLastFrame = nodes[index].ranLastFrame ? VK_TRUE : VK_FALSE;
    to.name = nodes[index].name.c_str();
    to.gpuMilliseconds = nodes[index].gpuMs;
    c::giveStruct(time, to, "time");
  });
}
