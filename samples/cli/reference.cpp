// radivox reference: path-traced truth, with variances; pictures, or irradiance at points.
#include "engine/error.h"
#include "samples/cli/options.h"

#ifndef RADIVOX_WITH_REFERENCE

#include "samples/cli/missing.h"

namespace radivox::cli {

int runReference(const Options&, const ReferenceOptions&) {
  throw Error(ErrorCode::Unsupported, std::string("this build has no path tracer; ") + kGetPathTracer);
}

}  // namespace radivox::cli

#else

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>

#include "modules/reference/path_tracer.h"
#include "samples/cli/assets.h"
#include "samples/cli/interrupt.h"
#include "samples/cli/picture.h"
#include "samples/cli/progress.h"

namespace radivox::cli {

namespace {

using nlohmann::ordered_json;
using reference::Images;

constexpr double kCheckpointSeconds = 60;

std::string extensionOf(const std::string& path) { return std::filesystem::path(path).extension().string(); }

/// "a/b.exr" → "a/b_a.exr".
std::string halfName(const std::string& path, const char* half) {
  const std::filesystem::path p(path);
  return (p.parent_path() / (p.stem().string() + "_" + half + p.extension().string())).string();
}

std::vector<std::string> filesToWrite(const Options& options, const ReferenceOptions& reference) {
  std::vector<std::string> files = options.outputs;
  if (reference.halves) {
    for (const std::string& path : options.outputs) {
      files.push_back(halfName(path, "a"));
      files.push_back(halfName(path, "b"));
    }
  }
  if (!options.stats.empty()) files.push_back(options.stats);
  if (!reference.checkpoint.empty()) files.push_back(reference.checkpoint);
  return files;
}

/// Everything that can be wrong with the files, before the long work.
void checkFiles(const Options& options, const ReferenceOptions& reference) {
  const bool probes = !reference.probe.empty();
  const std::string kinds = probes ? ".csv" : ".exr or .png";
  if (options.outputs.empty()) throw Error(ErrorCode::BadInput, "--out is missing; give a " + kinds + " file to write");
  for (const std::string& path : options.outputs) {
    const std::string extension = extensionOf(path);
    if (probes ? extension != ".csv" : extension != ".exr" && extension != ".png")
      throw Error(ErrorCode::BadInput, "--out '" + path + "': unknown kind of file; end the name in " + kinds);
  }
  if (!options.stats.empty() && extensionOf(options.stats) != ".json")
    throw Error(ErrorCode::BadInput, "--stats '" + options.stats + "': end the name in .json");
  std::vector<std::string> files = filesToWrite(options, reference);
  for (const std::string& path : files) image::checkWritable(path);
  std::sort(files.begin(), files.end());
  const auto twice = std::adjacent_find(files.begin(), files.end());
  if (twice != files.end()) throw Error(ErrorCode::BadInput, "'" + *twice + "' would be written twice; give different names");
  const auto refuse = [&](bool given, const char* option) {
    if (probes && given) throw Error(ErrorCode::BadInput, std::string(option) + " is for pictures; leave it out with --probe");
  };
  refuse(reference.halves, "--halves");
  refuse(!reference.checkpoint.empty(), "--checkpoint");
  refuse(!reference.resume.empty(), "--resume");
  refuse(!reference.targetError.empty(), "--target-error");
  refuse(!reference.timeLimit.empty(), "--time-limit");
}

std::string readFile(const std::string& option, const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in || std::filesystem::is_directory(path)) throw Error(ErrorCode::BadInput, option + " '" + path + "': no such file");
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

/// Layers as `render` names them, each followed by its variance.
std::vector<image::Layer> listLayers(const Images& images, const std::vector<std::string>& aovs) {
  std::vector<image::Layer> layers;
  for (const std::string& name : aovs) {
    layers.push_back({name, images.find(name).mean});
    layers.push_back({name + "_variance", images.find(name).variance});
  }
  return layers;
}

void writePictures(const std::string& path, const Images& images, const std::vector<std::string>& aovs) {
  if (extensionOf(path) == ".exr") return image::writeExr(path, listLayers(images, aovs));
  const bool hasColor = std::find(aovs.begin(), aovs.end(), "color") != aovs.end();
  const std::string& name = hasColor ? "color" : aovs.front();
  writePreview(path, {name, images.find(name).mean});
}

/// 0 where a single pass leaves it unknown: JSON has no infinity.
ordered_json printKnown(double value) { return std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr); }

std::string printStats(const Options& options, const reference::PathTracer& tracer, const reference::Settings& settings,
                       const reference::Rendering& rendering, const Images& images) {
  ordered_json errors = ordered_json::object();
  for (const std::string& name : Images::names()) {
    double variance = 0;
    for (const float v : images.find(name).variance.data) variance += static_cast<double>(v);
    errors[name] = {{"relative_error", printKnown(reference::relativeError(images.find(name)))},
                    {"rms_standard_error", printKnown(std::sqrt(variance / static_cast<double>(images.find(name).variance.data.size())))},
                    {"mean", image::meanOf(images.find(name).mean)}};
  }
  const double samples = static_cast<double>(images.samples) * settings.width * settings.height;
  const ordered_json bounces = settings.bounces == scene::kAllBounces ? ordered_json("all") : ordered_json(settings.bounces);
  return ordered_json{{"scene", options.scene},
                      {"width", settings.width},
                      {"height", settings.height},
                      {"bounces", bounces},
                      {"seed", settings.seed},
                      {"samples", images.samples},
                      {"passes", rendering.passes()},
                      {"build_seconds", tracer.buildSeconds()},
                      {"seconds", images.seconds},
                      {"samples_per_second", images.seconds > 0 ? samples / images.seconds : 0.0},
                      {"aovs", errors}}
             .dump(2) +
         "\n";
}

int renderPicture(const Options& options, const ReferenceOptions& from, const scene::Scene& scene, const reference::PathTracer& tracer,
                  const reference::Settings& settings, const std::vector<std::string>& aovs, const std::string& state) {
  reference::Rendering rendering(tracer, scene::findCamera(scene, options.camera.empty() ? "0" : options.camera), settings);
  if (!from.resume.empty()) rendering.resume(state, "--resume '" + from.resume + "'");
  const auto save = [&] {
    if (!from.checkpoint.empty()) image::writeFileAtomically(from.checkpoint, rendering.checkpoint());
  };
  {
    ProgressBar bar;
    reference::Callbacks callbacks;
    callbacks.progress = [&](double pass) {
      const double passSamples = rendering.passes() > 0 ? static_cast<double>(rendering.samples()) / rendering.passes() : settings.spp;
      double done = (rendering.samples() + pass * passSamples) / settings.spp;
      if (settings.timeLimitSeconds > 0) done = std::max(done, rendering.seconds() / settings.timeLimitSeconds);
      bar.show("reference", done);
    };
    callbacks.cancelled = isInterrupted;
    auto saved = std::chrono::steady_clock::now();
    while (!rendering.isDone() || (from.halves && rendering.passes() < 2)) {
      const bool went = rendering.advance(callbacks);
      const auto now = std::chrono::steady_clock::now();
      if (!went || std::chrono::duration<double>(now - saved).count() > kCheckpointSeconds) {
        save();
        saved = now;
      }
      stopIfInterrupted();
    }
  }
  save();
  const Images images = rendering.images();
  for (const std::string& path : options.outputs) {
    writePictures(path, images, aovs);
    if (!from.halves) continue;
    writePictures(halfName(path, "a"), rendering.half(0), aovs);
    writePictures(halfName(path, "b"), rendering.half(1), aovs);
  }
  if (!options.stats.empty()) image::writeFileAtomically(options.stats, printStats(options, tracer, settings, rendering, images));
  return 0;
}

/// Six numbers a line, world metres; empty lines and those that begin with # are passed over, and so is a first line of names.
std::vector<reference::ProbePoint> readPoints(const std::string& path, const std::string& text, const glm::dvec3& origin) {
  std::vector<reference::ProbePoint> points;
  std::istringstream lines(text);
  std::string line;
  for (size_t number = 1; std::getline(lines, line); ++number) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.empty() || line[0] == '#' || (number == 1 && line.rfind("x,", 0) == 0)) continue;
    double values[6];
    const char* at = line.data();
    const char* const end = line.data() + line.size();
    bool good = true;
    for (int i = 0; i < 6 && good; ++i) {
      const auto result = std::from_chars(at, end, values[i]);
      good = result.ec == std::errc() && std::isfinite(values[i]) && (i == 5 ? result.ptr == end : result.ptr != end && *result.ptr == ',');
      at = result.ptr + 1;
    }
    const glm::dvec3 normal(values[3], values[4], values[5]);
    if (!good || !(glm::length(normal) > 1e-6)) {
      throw Error(ErrorCode::BadInput, "--probe '" + path + "', line " + std::to_string(number) +
                                           ": give a position and a normal as x,y,z,nx,ny,nz, as in 0,1.5,0,0,1,0");
    }
    points.push_back({glm::vec3(glm::dvec3(values[0], values[1], values[2]) - origin), glm::vec3(glm::normalize(normal))});
  }
  if (points.empty()) throw Error(ErrorCode::BadInput, "--probe '" + path + "': no points; give lines of x,y,z,nx,ny,nz");
  return points;
}

int probePoints(const Options& options, const scene::Scene& scene, const reference::PathTracer& tracer, const reference::Settings& settings,
                const std::vector<reference::ProbePoint>& points) {
  reference::ProbeSettings probe;
  probe.bounces = settings.bounces;
  probe.spp = settings.spp;
  probe.seed = settings.seed;
  probe.samplesPerPass = settings.samplesPerPass;
  probe.threads = settings.threads;
  std::vector<reference::ProbeValue> values;
  {
    ProgressBar bar;
    values = tracer.probe(points, probe, {[&](double fraction) { bar.show("reference", fraction); }, isInterrupted});
  }
  std::string text = "x,y,z,nx,ny,nz";
  for (const char* what : {"direct", "direct_error", "indirect", "indirect_error"}) {
    for (const char* channel : {"_r", "_g", "_b"}) text += std::string(",") + what + channel;
  }
  text += "\n";
  const auto print = [&](double value, const char* format) {
    char buffer[40];
    text.append(buffer, static_cast<size_t>(std::snprintf(buffer, sizeof(buffer), format, value)));
  };
  for (size_t i = 0; i < points.size(); ++i) {
    const glm::dvec3 position = glm::dvec3(points[i].position) + scene.origin;
    for (glm::length_t c = 0; c < 3; ++c) print(position[c], c == 0 ? "%.9g" : ",%.9g");
    for (glm::length_t c = 0; c < 3; ++c) print(static_cast<double>(points[i].normal[c]), ",%.7g");
    for (const glm::vec3& v : {values[i].direct, values[i].directError, values[i].indirect, values[i].indirectError}) {
      for (glm::length_t c = 0; c < 3; ++c) print(static_cast<double>(v[c]), ",%.7g");
    }
    text += "\n";
  }
  for (const std::string& path : options.outputs) image::writeFileAtomically(path, text);
  return 0;
}

}  // namespace

int runReference(const Options& options, const ReferenceOptions& from) {
  checkFiles(options, from);
  const Size size = parseSize(options.size);
  reference::Settings settings;
  settings.width = size.width;
  settings.height = size.height;
  if (options.bounces) settings.bounces = parseBounces(*options.bounces);
  settings.spp = parseWhole("--spp", from.spp, 1, 1u << 30);
  settings.seed = parseWhole("--seed", from.seed, 0, 0xffffffffu);
  settings.threads = parseWhole("--threads", from.threads, 0, 1024);
  if (from.samplesPerPass != "0") {
    settings.samplesPerPass = parseWhole("--pass", from.samplesPerPass, 1, 65536);
    if ((settings.samplesPerPass & (settings.samplesPerPass - 1)) != 0)
      throw Error(ErrorCode::BadInput, "--pass '" + from.samplesPerPass + "': give a power of two from 1 to 65536");
  }
  if (!from.targetError.empty()) settings.targetError = parsePositive("--target-error", from.targetError);
  if (!from.timeLimit.empty()) settings.timeLimitSeconds = parsePositive("--time-limit", from.timeLimit);
  if (from.sides != "both" && from.sides != "gltf") failUnknown("sides", from.sides, {"both", "gltf"});
  const std::vector<std::string> aovs = options.aovs.empty() ? Images::names() : parseList("--aov", options.aovs);
  for (const std::string& aov : aovs) {
    const std::vector<std::string>& names = Images::names();
    if (std::find(names.begin(), names.end(), aov) == names.end()) failUnknown("AOV", aov, names);
  }
  if (from.halves && settings.spp < 2) throw Error(ErrorCode::BadInput, "--halves needs two passes; give --spp 2 or more");
  const std::string state = from.resume.empty() ? std::string() : readFile("--resume", from.resume);
  const std::string pointText = from.probe.empty() ? std::string() : readFile("--probe", from.probe);

  const scene::Scene scene = scene::loadScene(options.scene, options.sky);
  scene::findCamera(scene, options.camera.empty() ? "0" : options.camera);
  std::vector<reference::ProbePoint> points;
  if (!from.probe.empty()) points = readPoints(from.probe, pointText, scene.origin);
  for (const std::string& warning : scene.warnings) std::cerr << "radivox: warning: " << warning << "\n";
  stopIfInterrupted();
  const reference::PathTracer tracer(scene, from.sides == "gltf" ? reference::Sides::Gltf : reference::Sides::Both);
  stopIfInterrupted();
  if (!from.probe.empty()) return probePoints(options, scene, tracer, settings, points);
  return renderPicture(options, from, scene, tracer, settings, aovs, state);
}

}  // namespace radivox::cli

#endif
