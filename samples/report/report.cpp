// radivox report: measures every method on every scene, then writes what was found.
#include "samples/report/options.h"

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <set>
#include <thread>

#include "engine/error.h"
#include "engine/text.h"
#include "samples/cli/cache.h"
#include "samples/cli/missing.h"
#include "samples/report/content_key.h"
#include "samples/report/gnuplot.h"
#include "samples/report/page.h"
#include "samples/report/scene_run.h"

namespace radivox::report {

namespace {

namespace fs = std::filesystem;

double parseNumber(const std::string& option, const std::string& text, double least) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != 0 || !std::isfinite(value) || value < least) {
    throw Error(ErrorCode::BadInput, option + " '" + text + "': give a number of at least " + printNumber(least));
  }
  return value;
}

void makeFolder(const std::string& path, const char* option) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error || !fs::is_directory(path)) {
    throw Error(ErrorCode::BadInput, std::string(option) + " '" + path + "': cannot make this folder (" +
                                         (error ? error.message() : "a file of this name is there") + "); choose another");
  }
}

std::string defaultCache() {
  const std::string pipelines = cli::pipelineCacheFile();
  return pipelines.empty() ? "" : (fs::path(pipelines).parent_path() / "references").string();
}

/// "Name of the CPU, 2 threads"
std::string describeHost() {
  std::ifstream file("/proc/cpuinfo");
  std::string line, name = "CPU";
  while (std::getline(file, line)) {
    const size_t colon = line.find(": ");
    if (line.rfind("model name", 0) != 0 || colon == std::string::npos) continue;
    name = line.substr(colon + 2);
    break;
  }
  return name + ", " + std::to_string(std::thread::hardware_concurrency()) + " threads";
}

std::string nameOf(const std::string& scene, const std::set<std::string>& taken) {
  const std::string prefix = "builtin:";
  std::string name = scene.rfind(prefix, 0) == 0 ? scene.substr(prefix.size()) : fs::path(scene).stem().string();
  name = name.substr(0, name.find('?'));
  std::string unique = name;
  for (int i = 2; taken.count(unique) != 0; ++i) unique = name + "-" + std::to_string(i);
  return unique;
}

}  // namespace

int runReport(const ReportOptions& options, const cli::Options& commonOptions) {
  const Clock clock(options.timeLimit.empty() ? 0 : parseNumber("--time-limit", options.timeLimit, 1));
  const double referenceError = parseNumber("--reference-error", options.referenceError, 1e-4);
  if (!options.weights.empty()) cli::parseWeights(options.weights);
  if (options.out.empty()) throw Error(ErrorCode::BadInput, "--out is missing; give a folder to write the report to");
  if (!options.reference.empty() && options.scenes.size() > 1) {
    throw Error(ErrorCode::BadInput, "--reference is of one scene, and there are " + std::to_string(options.scenes.size()) + "; give one");
  }
  if (options.reference.empty() && !hasPathTracer()) {
    throw Error(
        ErrorCode::Unsupported,
        std::string("this build has no path tracer to make a reference with; give --reference FILE.exr, or ") + cli::kGetPathTracer);
  }
  for (const std::string& path : options.reference.empty() ? std::vector<std::string>{} : cli::splitReference(options.reference)) {
    if (!fs::exists(path)) throw Error(ErrorCode::BadInput, "--reference '" + path + "': no such file; check the path");
  }
  checkGnuplot();
  makeFolder(options.out, "--out");
  for (const char* folder : {"/pictures", "/plots", "/cache"}) makeFolder(options.out + folder, "--out");
  const std::string cache = !options.cache.empty() ? options.cache : !defaultCache().empty() ? defaultCache() : options.out + "/cache";
  makeFolder(cache, "--cache");
  image::checkWritable(options.out + "/report.html");

  cli::Options common = commonOptions;
  common.size = options.size;
  const uint32_t bounces = common.bounces ? cli::parseBounces(*common.bounces) : scene::kAllBounces;
  gpu::DeviceOptions deviceOptions;
  deviceOptions.index = cli::parseDevice(common.device);
  deviceOptions.pipelineCacheFile = cli::pipelineCacheFile();
  const auto device = gpu::Device::create(deviceOptions);
  cli::ProgressBar bar;
  Session session{options,
                  common,
                  cli::parseSize(options.size),
                  bounces,
                  referenceError,
                  *device,
                  clock,
                  bar,
                  cache,
                  options.out + "/pictures",
                  RowCache(options.out + "/cache"),
                  programKey()};

  Results results;
  results.device = device->capabilities().deviceName;
  results.driver = device->capabilities().driverName + " " + device->capabilities().driverInfo;
  results.host = describeHost();
  results.width = session.size.width;
  results.height = session.size.height;
  results.bounces = bounces == scene::kAllBounces ? "all" : std::to_string(bounces);
  results.folder = options.out;
  results.sets = common.sets;
  std::set<std::string> names;
  for (size_t i = 0; i < options.scenes.size(); ++i) {
    const std::string name = nameOf(options.scenes[i], names);
    names.insert(name);
    results.scenes.push_back(runScene(session, options.scenes[i], name, 1.0 / static_cast<double>(options.scenes.size() - i)));
  }
  bar.show("writing", 1.0);
  writeData(results);
  writePage(results);
  std::cout << options.out << "/report.html\n";
  return 0;
}

}  // namespace radivox::report
