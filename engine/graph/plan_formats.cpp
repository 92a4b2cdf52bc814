// The plan as DOT and as JSON, for tools.
#include <nlohmann/json.hpp>
#include <set>

#include "engine/graph/plan_print.h"

namespace radivox::graph {

using namespace detail;

std::string Plan::printDot() const {
  std::string text = "digraph plan {\n  rankdir=LR;\n  node [shape=box];\n";
  const auto quote = [](const std::string& name) {
    std::string out = "\"";
    for (const char c : name) out += c == '"' || c == '\\' ? std::string("\\") + c : std::string(1, c);
    return out + "\"";
  };
  std::set<std::string> lines;
  for (uint32_t segment = 0; segment < segmentCount; ++segment) {
    text += "  subgraph cluster_" + std::to_string(segment) + " {\n    label=\"segment " + std::to_string(segment) + "\";\n";
    for (const PlannedStep& step : steps) {
      if (step.segment != segment) continue;
      const std::string& name = nodeNames[step.node];
      text +=
          "    " + quote(name) + " [tooltip=" + quote(step.type + ", " + printRuns(step)) + (step.hostPaced ? ", style=bold" : "") + "];\n";
    }
    text += "  }\n";
  }
  for (const PlannedResource& resource : resources) {
    if (resource.imported) text += "  " + quote(resource.name) + " [shape=ellipse];\n";
  }
  for (size_t i = 0; i < steps.size(); ++i) {
    for (const PlannedPort& port : steps[i].ports) {
      if (port.resource == kNoResource || (port.access != Access::Read && port.access != Access::Modify)) continue;
      const uint32_t link = port.access == Access::Modify ? port.version - 1 : port.version;
      std::string from = resources[port.resource].name;
      for (const PlannedStep& writer : steps) {
        for (const PlannedPort& out : writer.ports) {
          const bool writes = out.access == Access::Write || out.access == Access::Modify;
          if (writes && out.resource == port.resource && out.version == link && !(resources[port.resource].imported && link == 0))
            from = nodeNames[writer.node];
        }
      }
      text += "  " + quote(from) + " -> " + quote(nodeNames[steps[i].node]) + " [label=" + quote(port.name) +
              (port.access == Access::Modify ? ", style=bold" : "") + "];\n";
    }
  }
  for (const CulledNode& node : culled) text += "  " + quote(node.name) + " [style=dotted, tooltip=" + quote(node.reason) + "];\n";
  return text + "}\n";
}

std::string Plan::printJson(const Counts& counts) const {
  using Json = nlohmann::ordered_json;
  const auto bytesOf = [&](const PlannedResource& resource) {
    const auto bytes = resource.growable ? std::nullopt : shapeBytes(resource.shape, counts);
    return bytes ? Json(*bytes) : Json(nullptr);
  };
  Json json;
  json["segments"] = segmentCount;
  json["steps"] = Json::array();
  for (const PlannedStep& step : steps) {
    Json s;
    s["node"] = nodeNames[step.node];
    s["type"] = step.type;
    s["segment"] = step.segment;
    s["runs"] = step.everyFrame ? "every frame" : "on change";
    s["host_paced"] = step.hostPaced;
    s["ports"] = Json::array();
    for (const PlannedPort& port : step.ports) {
      Json p;
      p["name"] = port.name;
      p["access"] = printAccess(port.access);
      p["resource"] = port.resource == kNoResource ? Json(nullptr) : Json(resources[port.resource].name);
      if (port.resource != kNoResource && resources[port.resource].versionCount > 1) p["version"] = port.version;
      p["use"] = printUse(port.use);
      p["meaning"] = port.meaning;
      s["ports"].push_back(std::move(p));
    }
    s["barriers"] = Json::array();
    for (const PlannedBarrier& barrier : step.barriers) {
      s["barriers"].push_back({{"resource", resources[barrier.resource].name},
                               {"from", std::string(barrier.writeBefore ? "write " : "read ") + printUse(barrier.fromUse)},
                               {"to", std::string(barrier.writeAfter ? "write " : "read ") + printUse(barrier.toUse)}});
    }
    s["counts"] = Json::array();
    for (const auto& count : step.counts) s["counts"].push_back(count.name);
    json["steps"].push_back(std::move(s));
  }
  json["resources"] = Json::array();
  for (const PlannedResource& resource : resources) {
    Json r;
    r["name"] = resource.name;
    r["kind"] = resource.shape.kind == ResourceKind::Buffer ? "buffer" : "image";
    r["shape"] = resource.growable ? "grows" : resource.shape.print();
    r["bytes"] = bytesOf(resource);
    r["imported"] = resource.imported;
    r["persistent"] = resource.persistent;
    r["output"] = resource.output;
    r["host_visible"] = resource.hostVisible;
    r["first_use"] = resource.firstUse;
    r["last_use"] = resource.lastUse;
    r["alias_slot"] = resource.aliasSlot != kNoSlot ? Json(resource.aliasSlot) : Json(nullptr);
    r["memory_of"] = resource.lender != kNoResource ? Json(resources[resource.lender].name) : Json(nullptr);
    json["resources"].push_back(std::move(r));
  }
  json["left_out"] = Json::array();
  for (const CulledNode& node : culled) json["left_out"].push_back({{"node", node.name}, {"type", node.type}, {"reason", node.reason}});
  json["advice"] = Json::array();
  for (const auto& [node, words] : advice) json["advice"].push_back({{"node", node}, {"advice", words}});
  const Totals sums = totals(*this, counts);
  json["memory"] = {{"complete", !sums.open},  {"kept", sums.kept},
                    {"scratch", sums.scratch}, {"scratch_unshared", sums.scratchUnshared},
                    {"host", sums.host},       {"imported", sums.imported}};
  return json.dump(2);
}

}  // namespace radivox::graph
