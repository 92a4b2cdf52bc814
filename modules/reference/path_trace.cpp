#include "modules/reference/path_trace.h"

#include <cmath>
#include <cstring>

#include "modules/reference/scene_from_buffers.h"

namespace radivox::reference {

using gpu::BindingType;
using graph::Extent;
using graph::Shape;

namespace {

constexpr const char* kScenePorts[] = {"scene.vertices",  "scene.indices",  "scene.triangle_materials",
                                       "scene.materials", "scene.textures", "scene.info",
                                       "scene.lights",    "scene.sky"};

struct Result {
  const char* port;
  const char* aov;
  bool variance;
  float alpha;
  const char* meaning;
};
constexpr Result kResults[] = {{"color", "color", false, 1.f, "radiance, W/(m² sr)"},
                               {"direct", "direct", false, 1.f, "ρ E_direct/π, W/(m² sr)"},
                               {"indirect", "indirect", false, 1.f, "ρ E_indirect/π, W/(m² sr)"},
                               {"irradiance_direct", "irradiance_direct", false, 1.f, "E_direct with the sky's light, W/m²"},
                               {"irradiance", "irradiance_indirect", false, 0.f, "E_indirect, W/m²; a: 0"},
                               {"albedo", "albedo", false, 1.f, "ρ"},
                               {"color_variance", "color", true, 1.f, "variance of color's mean; 0: unknown"},
                               {"irradiance_variance", "irradiance_indirect", true, 1.f, "variance of irradiance's mean; 0: unknown"}};

}  // namespace

PathTrace::PathTrace()
    : table_({params::choice("sides", &sides_, {"both", "gltf"},
                             "both: every surface is there from both sides; gltf: back faces of single-sided materials are not",
                             params::Invalidates::Rerun),
              params::number("spp", &spp_, {1, 1048576}, "most samples a pixel", params::Invalidates::Rerun),
              params::number("seed", &seed_, {0, 4294967295.0}, "another seed is another, independent picture", params::Invalidates::Rerun),
              params::number("target_error", &targetError_, {0, 1000},
                             "stop when color's expected relative error is at most this; 0: never", params::Invalidates::Rerun),
              params::number("time_limit", &timeLimit_, {0, 1e7}, "begin no pass that would end later, s; 0: never",
                             params::Invalidates::Rerun)}) {}

void PathTrace::declare(graph::Declaration& d) {
  for (const char* port : kScenePorts) {
    constexpr uint32_t kUse = graph::UseTransfer | graph::UseCompute;
    if (std::string_view(port) == "scene.sky")
      d.readIf(d.traits.skyImage, port, "the scene", "the sky has no image", kUse);
    else
      d.read(port, "the scene", kUse);
  }
  d.read("view.camera", "Camera", graph::UseTransfer);
  for (const Result& result : kResults) {
    d.write(result.port, Shape::image(VK_FORMAT_R32G32B32A32_SFLOAT, Extent::of("width"), Extent::of("height")), result.meaning).optional =
        true;
  }
  if (d.traits.textureCount > 0) d.write("texels", {}, "level 0 of each texture, on its way to the host").growable = true;
  d.hostPaced();
}

void PathTrace::prepare(graph::PrepareContext& context) {
  device_ = &context.device();
  if (context.traits().textureCount > 0) {
    copyTexels_ = gpu::Pipeline(*device_, gpu::ComputePipelineInfo{.shader = "reference/copy_texels.comp",
                                                                   .bindings = {BindingType::StorageBuffer, BindingType::StorageBuffer},
                                                                   .pushConstantBytes = 8});
  }
  toImage_ = gpu::Pipeline(*device_, gpu::ComputePipelineInfo{.shader = "reference/to_image.comp",
                                                              .bindings = {BindingType::StorageBuffer, BindingType::StorageImage}});
}

// Step 0 reads the inputs; with textures step 1 copies their texels; then a step a pass, and one that fills the images.
uint32_t PathTrace::stepCount(graph::RecordContext& context) { return context.step() + (phase_ == Phase::Done ? 1 : 2); }

void PathTrace::record(graph::RecordContext& context) {
  if (context.step() == 0) return;
  gpu::Commands& commands = context.commands();
  if (phase_ == Phase::CopyTexels) {
    const auto texels = context.grown("texels");
    for (uint32_t i = 0; i < scene_.textures.size(); ++i) {
      const uint32_t push[] = {scene_.textures[i].width * scene_.textures[i].height, i};
      commands.bind(copyTexels_, {context.buffer("scene.textures"), *texels[i]});
      commands.push(push);
      commands.dispatchItems(push[0], 256);
    }
  } else if (phase_ == Phase::Write) {
    for (const Staged& staged : staged_) {
      commands.bind(toImage_, {staged.pixels, context.image(staged.port)});
      commands.dispatch((width_ + 7) / 8, (height_ + 7) / 8);
    }
  }
}

void PathTrace::stepDone(graph::RecordContext& context) {
  if (context.step() == 0) return readInputs(context);
  switch (phase_) {
    case Phase::CopyTexels:
      takeTexels(context);
      return startRendering(context);
    case Phase::Trace:
      return tracePass(context);
    case Phase::Write:
      staged_.clear();
      phase_ = Phase::Done;
      return;
    case Phase::Done:
      return;
  }
}

bool PathTrace::sceneChanged(graph::RecordContext& context) const {
  bool changed = !tracer_;
  for (const char* port : kScenePorts) changed = changed || (context.has(port) && context.changed(port));
  return changed;
}

void PathTrace::readInputs(graph::RecordContext& context) {
  rendering_.reset();
  staged_.clear();
  camera_ = readCamera(context, width_, height_);
  if (!sceneChanged(context)) return startRendering(context);
  tracer_.reset();
  scene_ = readScene(context);
  if (scene_.textures.empty()) return startRendering(context);
  context.clearGrown("texels");
  for (const scene::TextureImage& texture : scene_.textures) context.grow("texels", uint64_t{4} * texture.width * texture.height);
  phase_ = Phase::CopyTexels;
}

void PathTrace::takeTexels(graph::RecordContext& context) {
  const auto texels = context.grown("texels");
  for (size_t i = 0; i < scene_.textures.size(); ++i) {
    const std::vector<std::byte> raw =
        gpu::download(*device_, *texels[i], 0, VkDeviceSize{4} * scene_.textures[i].width * scene_.textures[i].height);
    scene_.textures[i].rgba.resize(raw.size());
    std::memcpy(scene_.textures[i].rgba.data(), raw.data(), raw.size());
  }
  context.clearGrown("texels");
}

void PathTrace::startRendering(graph::RecordContext& context) {
  if (!tracer_) {
    tracer_.emplace(scene_, sides_);
    scene_ = {};
  }
  Settings settings;
  settings.width = width_;
  settings.height = height_;
  settings.bounces = context.request().bounces;
  settings.spp = spp_;
  settings.seed = seed_;
  settings.targetError = static_cast<double>(targetError_);
  settings.timeLimitSeconds = static_cast<double>(timeLimit_);
  rendering_.emplace(*tracer_, camera_, settings);
  phase_ = Phase::Trace;
}

void PathTrace::tracePass(graph::RecordContext& context) {
  rendering_->advance();
  double done = static_cast<double>(rendering_->samples()) / spp_;
  if (timeLimit_ > 0.f) done = std::max(done, rendering_->seconds() / static_cast<double>(timeLimit_));
  context.reportProgress(std::min(done, 1.0));
  if (!rendering_->isDone()) return;
  stageResults(context);
  rendering_.reset();
  phase_ = Phase::Write;
}

void PathTrace::stageResults(graph::RecordContext& context) {
  const Images images = rendering_->images();
  const size_t pixelCount = size_t{width_} * height_;
  for (const Result& result : kResults) {
    if (!context.has(result.port)) continue;
    const Estimate& estimate = images.find(result.aov);
    const std::vector<float>& from = result.variance ? estimate.variance.data : estimate.mean.data;
    std::vector<glm::vec4> pixels(pixelCount);
    for (size_t i = 0; i < pixelCount; ++i) {
      for (glm::length_t c = 0; c < 3; ++c) {
        const float value = from[3 * i + static_cast<size_t>(c)];
        pixels[i][c] = std::isfinite(value) ? value : 0.f;
      }
      pixels[i].w = result.alpha;
    }
    Staged staged{result.port, gpu::Buffer(*device_, std::string("path_trace ") + result.port, pixelCount * sizeof(glm::vec4))};
    gpu::upload(*device_, staged.pixels, pixels);
    staged_.push_back(std::move(staged));
  }
  context.reportStat("samples", images.samples);
  context.reportStat("seconds", images.seconds);
  context.reportStat("build_seconds", tracer_->buildSeconds());
  context.reportStat("samples_per_second", images.seconds > 0 ? static_cast<double>(pixelCount) * images.samples / images.seconds : 0.0);
  const double error = relativeError(images.color);
  if (std::isfinite(error)) context.reportStat("relative_error", error);
}

}  // namespace radivox::reference
