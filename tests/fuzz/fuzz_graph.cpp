// libFuzzer target: bytes that claim to be a graph and, after a line of "===", a preset for it. The command's own path from text to
// printed plan: they give a plan, or are refused in one line; anything else is a finding.
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>

#include "engine/error.h"
#include "engine/graph/plan.h"
#include "engine/scene/gpu_scene.h"
#include "samples/cli/job.h"

namespace {

using namespace radivox;

[[noreturn]] void reportFinding(const std::string& what) {
  std::fprintf(stderr, "finding: %s\n", what.c_str());
  std::abort();
}

/// A file that lives in memory, under a name that ends in .json.
class MemoryFile {
 public:
  explicit MemoryFile(const char* name) : descriptor_(memfd_create(name, 0)) {
    path_ = (std::filesystem::temp_directory_path() / (std::to_string(::getpid()) + "_" + name + ".json")).string();
    std::filesystem::remove(path_);
    std::filesystem::create_symlink("/proc/self/fd/" + std::to_string(descriptor_), path_);
  }
  ~MemoryFile() { std::filesystem::remove(path_); }
  void set(std::string_view text) const {
    if (ftruncate(descriptor_, 0) != 0 || pwrite(descriptor_, text.data(), text.size(), 0) != static_cast<ssize_t>(text.size()))
      reportFinding("no memory for the file");
  }
  const std::string& path() const { return path_; }

 private:
  int descriptor_;
  std::string path_;
};

struct World {
  scene::Scene scene = scene::loadScene("builtin:cornell");
  gpu::Capabilities capabilities;
  MemoryFile graph{"graph"}, preset{"preset"};
};

void planIt(const World& world, std::string_view text) {
  const size_t split = text.find("\n===\n");
  world.graph.set(text.substr(0, split));
  cli::Options options;
  options.size = "64x48";
  options.graph = world.graph.path();
  if (split != std::string_view::npos) {
    world.preset.set(text.substr(split + 5));
    options.presets.push_back(world.preset.path());
  }
  cli::Job job;
  cli::prepareJob(options, true, job);
  const scene::SceneShapes shapes = scene::describeShapes(world.scene, job.lights, job.request.width, job.request.height);
  const scene::Traits traits = scene::traitsFor(world.scene, job.lights);
  const graph::Plan plan = graph::compile(job.graph, {traits, job.request, world.capabilities, shapes.imports, shapes.counts});
  if (plan.printText(shapes.counts).empty() || plan.printDot().empty() || plan.printJson(shapes.counts).empty())
    reportFinding("a plan that prints nothing");
  // What is written reads back as the same graph.
  const std::string written = job.graph.toJson();
  if (graph::Graph::fromJson(written, "written", job.registry).toJson() != written) reportFinding("toJson does not read back: " + written);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const World world;
  try {
    planIt(world, {reinterpret_cast<const char*>(data), size});
  } catch (const Error& error) {
    const std::string text = error.what();
    if (text.empty() || text.find('\n') != std::string::npos) reportFinding("an error of several lines, or of none: " + text);
  }
  return 0;
}
