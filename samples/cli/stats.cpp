#include "samples/cli/stats.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

namespace radivox::cli {

namespace {

using nlohmann::ordered_json;

ordered_json printVector(const glm::vec3& v) { return {v.x, v.y, v.z}; }

std::string printApiVersion(uint32_t version) {
  return std::to_string(VK_API_VERSION_MAJOR(version)) + "." + std::to_string(VK_API_VERSION_MINOR(version)) + "." +
         std::to_string(VK_API_VERSION_PATCH(version));
}

void addParams(const std::string& owner, const params::Table& table, ordered_json& to) {
  for (const params::Param& param : table.all()) {
    ordered_json& value = to[owner + "." + param.name];
    const std::string text = param.get();
    switch (param.type) {
      case params::Type::Bool:
        value = text == "true";
        break;
      case params::Type::UInt:
        value = std::stoull(text);
        break;
      case params::Type::Float:
        value = std::stod(text);
        break;
      case params::Type::Choice:
      case params::Type::Text:
        value = text;
        break;
    }
  }
}

ordered_json describeScene(const Options& options, const scene::Scene& scene) {
  const scene::Traits traits = scene.traits();
  return {{"file", options.scene},
          {"name", scene.name},
          {"triangles", traits.triangleCount},
          {"vertices", traits.vertexCount},
          {"materials", traits.materialCount},
          {"textures", traits.textureCount},
          {"cameras", scene.cameras.size()},
          {"lights",
           {{"directional", traits.directionalLightCount},
            {"point", traits.pointLightCount},
            {"spot", traits.spotLightCount},
            {"emissive_triangles", traits.emissiveTriangleCount},
            {"sky", traits.sky}}},
          {"surface_area", traits.surfaceArea},
          {"bounds_min", printVector(traits.boundsMin)},
          {"bounds_max", printVector(traits.boundsMax)},
          {"origin", {scene.origin.x, scene.origin.y, scene.origin.z}},
          {"warnings", scene.warnings}};
}

ordered_json describeNodes(const graph::FrameStats& frame) {
  ordered_json nodes = ordered_json::object();
  for (const graph::NodeStats& node : frame.nodes) {
    nodes[node.name] = {{"type", node.type},    {"runs", node.runCount},  {"ran_last_frame", node.ranLastFrame},
                        {"gpu_ms", node.gpuMs}, {"wall_ms", node.wallMs}, {"figures", node.figures}};
  }
  return nodes;
}

ordered_json describeMemory(const graph::FrameStats& frame) {
  ordered_json resources = ordered_json::object();
  uint64_t total = 0;
  for (const graph::ResourceStats& resource : frame.resources) {
    resources[resource.name] = {{"bytes", resource.bytes}, {"shape", resource.shape}, {"meaning", resource.meaning}};
    total += resource.bytes;
  }
  return {{"resources", std::move(resources)},
          {"resources_total", total},
          {"device_current", frame.memory.current},
          {"device_peak", frame.memory.peak},
          {"device_allocations", frame.memory.allocationCount}};
}

}  // namespace

double bytesPerVoxel(const graph::FrameStats& frame, const graph::Plan& plan) {
  const auto voxels = frame.counts.find("voxels");
  if (voxels == frame.counts.end() || voxels->second == 0) return 0.0;
  std::map<std::string, std::string> typeOf;
  for (const graph::NodeStats& node : frame.nodes) typeOf[node.name] = node.type;
  // Pictures are the request's, not the method's.
  std::set<std::string> pictures;
  for (const graph::PlannedResource& resource : plan.resources) {
    const bool isImage = resource.shape.kind == graph::ResourceKind::Image;
    const std::vector<std::string>& counts = isImage ? resource.shape.width.counts() : resource.shape.elements.counts();
    if (std::find(counts.begin(), counts.end(), "width") != counts.end()) pictures.insert(resource.name);
  }
  uint64_t bytes = 0;
  for (const graph::ResourceStats& resource : frame.resources) {
    const std::string& type = typeOf[resource.name.substr(0, resource.name.find('.'))];
    if (type.rfind("clustered_voxel.", 0) == 0 && pictures.count(resource.name) == 0) bytes += resource.bytes;
  }
  return static_cast<double>(bytes) / static_cast<double>(voxels->second);
}

std::string printStats(const Options& options, const Job& job, const scene::Scene& scene, const gpu::Capabilities& capabilities,
                       const graph::Plan& plan, const RunRecord& record) {
  const graph::FrameStats& last = record.frames.back();
  ordered_json params = ordered_json::object();
  addParams("lights", job.lightParams, params);
  for (const graph::Graph::Entry& entry : job.graph.nodes()) addParams(entry.name, entry.node->params(), params);
  ordered_json culled = ordered_json::object();
  for (const graph::CulledNode& node : last.culled) culled[node.name] = {{"type", node.type}, {"reason", node.reason}};
  ordered_json frames = ordered_json::array();
  for (const graph::FrameStats& frame : record.frames) {
    std::vector<std::string> ran;
    for (const graph::NodeStats& node : frame.nodes) {
      if (node.ranLastFrame) ran.push_back(node.name);
    }
    frames.push_back({{"wall_ms", frame.wallMs}, {"ran", ran}});
  }
  ordered_json aovs = ordered_json::array();
  for (const Aov& aov : job.aovs) aovs.push_back(aov.name);
  ordered_json bounces = job.request.bounces;
  if (job.request.bounces == scene::kAllBounces) bounces = "all";

  ordered_json stats = {
      {"radivox", RADIVOX_VERSION},
      {"device",
       {{"name", capabilities.deviceName},
        {"driver", capabilities.driverName},
        {"driver_info", capabilities.driverInfo},
        {"api_version", printApiVersion(capabilities.apiVersion)}}},
      {"scene", describeScene(options, scene)},
      {"request",
       {{"graph", job.graphName},
        {"presets", job.presetNames},
        {"camera", record.camera},
        {"width", job.size.width},
        {"height", job.size.height},
        {"supersample", job.supersample},
        {"bounces", std::move(bounces)},
        {"aovs", std::move(aovs)}}},
      {"params", std::move(params)},
      {"nodes", describeNodes(last)},
      {"culled", std::move(culled)},
      {"counts", last.counts},
      {"memory", describeMemory(last)},
      {"bytes_per_voxel", bytesPerVoxel(last, plan)},
      {"frames", std::move(frames)},
      {"notes", record.notes},
      {"wall_ms",
       {{"load", record.phases.loadMs},
        {"prepare", record.phases.prepareMs},
        {"run", record.phases.runMs},
        {"download", record.phases.downloadMs},
        {"write", record.phases.writeMs},
        {"total", record.phases.totalMs}}},
  };
  if (record.validated) stats["validation_messages"] = record.validationMessageCount;
  // Names come from files and may hold broken UTF-8: it is replaced, not an error after all the work.
  return stats.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace radivox::cli
