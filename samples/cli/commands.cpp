// radivox graph and radivox scene: the plan without running it; a built-in scene as a file.
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>

#include "engine/error.h"
#include "engine/graph/left_out.h"
#include "engine/image/image.h"
#include "engine/scene/builtin.h"
#include "engine/scene/gltf.h"
#include "engine/scene/scene.h"
#include "samples/cli/assets.h"
#include "samples/cli/job.h"

namespace radivox::cli {

namespace {

/// Those of the device that would run it, or none at all: a plan can be read on any machine.
gpu::Capabilities findCapabilities(int index) {
  gpu::DeviceOptions options;
  options.index = index;
  try {
    return gpu::Device::create(options)->capabilities();
  } catch (const Error& e) {
    if (index >= 0 || (e.code() != ErrorCode::Unsupported && e.code() != ErrorCode::DeviceFailed)) throw;
    return {};
  }
}

}  // namespace

int runGraph(const Options& options) {
  const std::vector<std::string> formats = {"text", "dot", "json"};
  if (options.format != "text" && options.format != "dot" && options.format != "json") failUnknown("format", options.format, formats);
  Job job;
  prepareJob(options, true, job);
  const int deviceIndex = parseDevice(options.device);
  const scene::Scene scene = scene::loadScene(options.scene, options.sky);
  scene::findCamera(scene, options.camera.empty() ? "0" : options.camera);
  const gpu::Capabilities capabilities = findCapabilities(deviceIndex);
  const scene::SceneShapes shapes = scene::describeShapes(scene, job.lights, job.request.width, job.request.height);
  const scene::Traits traits = scene::traitsFor(scene, job.lights);
  const graph::CompileInput input{traits, job.request, capabilities, shapes.imports, shapes.counts};
  const std::vector<graph::LeftOut> leftOut = graph::listLeftOut(job.graph, input, shapes.counts);
  const graph::Plan plan = graph::compile(job.graph, input);
  if (options.format == "text") {
    std::cout << plan.printText(shapes.counts) << graph::printLeftOut(leftOut);
  } else if (options.format == "dot") {
    std::cout << plan.printDot();
  } else {
    auto json = nlohmann::ordered_json::parse(plan.printJson(shapes.counts));
    json["not_needed"] = nlohmann::ordered_json::array();
    for (const graph::LeftOut& entry : leftOut) {
      json["not_needed"].push_back({{"what", entry.what},
                                    {"why", entry.why},
                                    {"nodes", entry.nodes},
                                    {"resources", entry.resources},
                                    {"bytes", entry.bytes},
                                    {"more", entry.open},
                                    {"shaders", entry.shaders}});
    }
    std::cout << json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << "\n";
  }
  return 0;
}

int runScene(const Options& options) {
  if (options.outputs.size() != 1) throw Error(ErrorCode::BadInput, "--out is missing; give one .glb file to write");
  const std::string& path = options.outputs[0];
  if (std::filesystem::path(path).extension() != ".glb") {
    throw Error(ErrorCode::BadInput, "--out '" + path + "': unknown kind of file; end the name in .glb");
  }
  image::checkWritable(path);
  // A name alone is a built-in scene; files are written anew: flattened, with what was left out said.
  const std::string extension = std::filesystem::path(options.scene).extension();
  const bool isNamed = options.scene.rfind("builtin:", 0) != 0 && extension != ".gltf" && extension != ".glb";
  const scene::Scene scene = scene::loadScene(isNamed ? "builtin:" + options.scene : options.scene);
  for (const std::string& warning : scene.warnings) std::cerr << "radivox: warning: " << warning << "\n";
  if (scene.sky)
    std::cerr << "radivox: warning: a .glb holds no image of a sky; name it beside, in scenes[0].extras.radivox.sky, or give --sky\n";
  scene::exportGlb(scene, path);
  return 0;
}

}  // namespace radivox::cli
