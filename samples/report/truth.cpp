#include "samples/report/truth.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "engine/error.h"
#include "samples/report/content_key.h"

#ifdef RADIVOX_WITH_REFERENCE
#include "modules/reference/path_tracer.h"
#else
#include "samples/cli/missing.h"
#endif

namespace radivox::report {

namespace {

constexpr double kSecondsBetweenSaves = 20;
constexpr double kTwoSided95 = 1.959964;

void addKey(ContentKey& key, const cli::LayerTruth& truth) {
  for (const image::Image* image : {&truth.truth.mean, &truth.truth.a, &truth.truth.b}) {
    key.add(image->width).add(image->data.data(), image->data.size() * sizeof(float));
  }
}

double relativeFloor(const image::Truth& truth) {
  const image::Comparison c = image::compare(truth, truth.mean);
  return c.uncertainty && c.meanReference > 0 ? c.uncertainty->floorRmse / c.meanReference : 0.0;
}

SceneTruth finish(const std::vector<cli::PictureFile>& files, double shareOfA, std::string about, const TruthOptions& options) {
  SceneTruth truth;
  truth.about = std::move(about);
  truth.shareOfA = shareOfA;
  truth.full = cli::takeTruth(files, "color", shareOfA);
  for (const cli::PictureFile& file : files) {
    if (file.layers.size() > 1) continue;
    throw Error(ErrorCode::BadInput, "'" + file.path + "' has one layer; a reference needs color and irradiance_indirect");
  }
  truth.indirect = cli::takeTruth(files, "irradiance_indirect", shareOfA);
  const image::Image& mean = truth.full.truth.mean;
  if (mean.width != options.width || mean.height != options.height || mean.channels != 3) {
    throw Error(ErrorCode::BadInput, "'" + files[0].path + "' is " + std::to_string(mean.width) + "x" + std::to_string(mean.height) +
                                         " with " + std::to_string(mean.channels) + " channels; give --size " + std::to_string(mean.width) +
                                         "x" + std::to_string(mean.height) + " and a reference in RGB");
  }
  ContentKey key;
  addKey(key, truth.full);
  addKey(key, truth.indirect);
  truth.key = key.print();
  truth.exposureFull = image::exposureOf(mean);
  truth.exposureIndirect = image::exposureOf(truth.indirect.truth.mean);
  truth.floorFull = relativeFloor(truth.full.truth);
  truth.floorIndirect = relativeFloor(truth.indirect.truth);
  return truth;
}

#ifdef RADIVOX_WITH_REFERENCE

std::string printBounces(uint32_t bounces) {
  return bounces == scene::kAllBounces ? "all bounces" : std::to_string(bounces) + (bounces == 1 ? " bounce" : " bounces");
}

std::string slurp(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

cli::PictureFile pictureOf(const reference::Images& images, const std::string& name) {
  cli::PictureFile file{name, false, {}};
  for (const char* layer : {"color", "irradiance_indirect", "albedo"}) file.layers.push_back({layer, images.find(layer).mean});
  return file;
}

reference::Callbacks callbacksOf(const TruthOptions& options, const std::string& what, std::function<double(double)> fraction) {
  reference::Callbacks callbacks;
  callbacks.cancelled = options.cancelled;
  callbacks.progress = [&options, what, fraction = std::move(fraction)](double passFraction) {
    if (options.progress) options.progress(what, fraction(passFraction));
  };
  return callbacks;
}

/// The state of the rendering on disk goes on where it ended; more samples are only traced for a lower target.
SceneTruth traceTruth(const scene::Scene& scene, const scene::CameraDescription& camera, const TruthOptions& options) {
  const reference::PathTracer tracer(scene);
  reference::Settings settings;
  settings.width = options.width;
  settings.height = options.height;
  settings.bounces = options.bounces;
  settings.spp = 1u << 20;
  settings.samplesPerPass = 4;
  settings.targetError = options.targetError;
  reference::Rendering rendering(tracer, camera, settings);
  ContentKey key;
  key.add("reference 1").add(scene).add(camera).add(options.width).add(options.height).add(options.bounces).add(tracer.fingerprint());
  std::filesystem::create_directories(options.cacheFolder);
  const std::string path = options.cacheFolder + "/reference_" + key.print() + ".state";
  if (std::filesystem::exists(path)) {
    try {
      rendering.resume(slurp(path), path);
    } catch (const Error& e) {
      // Of another version, or cut short: nothing that cannot be traced again.
      if (e.code() != ErrorCode::BadInput) throw;
    }
  }
  // A reference that was good enough once stays: with more samples in it all that was judged by it would have to be judged again.
  const std::string donePath = path + ".done";
  const std::string doneText = slurp(donePath);
  const bool isDone = rendering.passes() >= 2 && !doneText.empty() && std::strtod(doneText.c_str(), nullptr) <= options.targetError;
  const double before = rendering.seconds();
  double saved = before;
  uint32_t savedPasses = rendering.passes();
  const auto save = [&] {
    if (rendering.passes() == savedPasses) return;
    image::writeFileAtomically(path, rendering.checkpoint());
    saved = rendering.seconds();
    savedPasses = rendering.passes();
  };
  const auto callbacks = callbacksOf(options, "reference", [&](double) { return (rendering.seconds() - before) / options.timeLimit; });
  // Two passes make two halves.
  while (!isDone && (rendering.passes() < 2 || (!rendering.isDone() && rendering.seconds() - before < options.timeLimit))) {
    if (!rendering.advance(callbacks)) {
      save();
      throw cli::Interrupted{};
    }
    if (rendering.seconds() - saved > kSecondsBetweenSaves) save();
  }
  save();
  if (!isDone) {
    char target[32];
    std::snprintf(target, sizeof target, "%.9g\n", options.targetError);
    image::writeFileAtomically(donePath, target);
  }
  const std::string about = "path tracer, " + std::to_string(rendering.samples()) + " samples a pixel, " + printBounces(options.bounces);
  const reference::Images halves[] = {rendering.half(0), rendering.half(1)};
  const double shareOfA = static_cast<double>(halves[0].samples) / (halves[0].samples + halves[1].samples);
  std::vector<cli::PictureFile> files = {pictureOf(halves[0], "reference, half 0"), pictureOf(halves[1], "reference, half 1")};
  SceneTruth truth = finish(files, shareOfA, about, options);
  truth.halves = std::move(files);
  return truth;
}

#endif

}  // namespace

#ifdef RADIVOX_WITH_REFERENCE

bool hasPathTracer() { return true; }

std::optional<TracedPicture> tracePicture(const scene::Scene& scene, const scene::CameraDescription& camera, const TruthOptions& options,
                                          uint32_t samples) {
  const reference::PathTracer tracer(scene);
  reference::Settings settings;
  settings.width = options.width;
  settings.height = options.height;
  settings.bounces = options.bounces;
  settings.spp = samples;
  settings.samplesPerPass = samples;  // stratified as one
  settings.seed = 0x5eed + samples;   // none of the reference's own samples
  reference::Rendering rendering(tracer, camera, settings);
  const auto callbacks = callbacksOf(options, "path tracer", [](double fraction) { return fraction; });
  while (rendering.samples() < samples) {
    if (!rendering.advance(callbacks)) return std::nullopt;
  }
  const reference::Images images = rendering.images();
  return TracedPicture{images.color.mean, images.irradianceIndirect.mean, tracer.buildSeconds(), rendering.seconds()};
}

#else

bool hasPathTracer() { return false; }

std::optional<TracedPicture> tracePicture(const scene::Scene&, const scene::CameraDescription&, const TruthOptions&, uint32_t) {
  throw Error(ErrorCode::Unsupported, std::string("this build has no path tracer; ") + cli::kGetPathTracer);
}

#endif

SceneTruth findTruth(const scene::Scene& scene, const scene::CameraDescription& camera, const TruthOptions& options) {
  if (!options.files.empty()) {
    std::vector<cli::PictureFile> files;
    std::string about;
    for (const std::string& path : options.files) {
      files.push_back(cli::readPicture(path));
      if (files.back().displayReferred) throw Error(ErrorCode::BadInput, "'" + path + "': a reference is linear; give .exr files");
      about += (about.empty() ? "" : " and ") + std::filesystem::path(path).filename().string();
    }
    return finish(files, options.shareOfA, about, options);
  }
#ifdef RADIVOX_WITH_REFERENCE
  return traceTruth(scene, camera, options);
#else
  (void)scene;
  (void)camera;
  throw Error(ErrorCode::Unsupported, std::string("this build has no path tracer to make a reference with; ") + cli::kGetPathTracer);
#endif
}

Judgement judge(const cli::LayerTruth& truth, float exposure, image::Image& test, bool wantsHdr) {
  truth.maskPixels(test);
  const image::Image& mean = truth.truth.mean;
  const image::Comparison c = image::compare(truth.truth, test, exposure);
  Judgement result;
  ErrorFigures& f = result.figures;
  const double reference = c.meanReference > 0 ? c.meanReference : 1.0;
  f.bias = f.biasLow = f.biasHigh = c.bias;
  f.rmse = f.rmseLow = f.rmseHigh = c.rmse;
  if (c.uncertainty) {
    f.biasLow = c.bias - kTwoSided95 * c.uncertainty->biasError;
    f.biasHigh = c.bias + kTwoSided95 * c.uncertainty->biasError;
    f.rmseLow = c.uncertainty->rmseLow;
    f.rmseHigh = c.uncertainty->rmseHigh;
  }
  f.relRmse = f.rmse / reference;
  f.relRmseLow = f.rmseLow / reference;
  f.relRmseHigh = f.rmseHigh / reference;
  f.relMse = c.relMse;
  f.psnr = c.psnr;
  f.psnrBlocks = c.psnrBlocks;
  image::FlipMap ldr = image::flip(image::scaled(mean, exposure), image::scaled(test, exposure));
  f.flip = ldr.mean;
  f.flip99 = ldr.percentile;
  if (wantsHdr) f.hdrFlip = image::hdrFlip(mean, test).mean;
  result.flip = std::move(ldr.error);
  return result;
}

}  // namespace radivox::report
