// radivox nodes: every node as it describes itself. docs/nodes.md is what --format markdown prints.
#include <iostream>

#include "engine/graph/node.h"
#include "samples/cli/assets.h"
#include "samples/cli/describe.h"
#include "samples/cli/job.h"

namespace radivox::cli {

namespace {

/// A scene and a request with everything in it, so that nodes declare all they have; no device.
struct Everything {
  Everything() {
    traits.triangleCount = 1000;
    traits.vertexCount = 3000;
    traits.materialCount = traits.textureCount = 2;
    traits.directionalLightCount = traits.pointLightCount = traits.spotLightCount = 1;
    traits.emissiveTriangleCount = 1;
    traits.alphaMasked = traits.singleSided = traits.sky = traits.skyImage = true;
    traits.boundsMax = glm::vec3(1.f);
    traits.surfaceArea = 1;
    traits.emissiveArea = 0.01;
  }
  scene::Traits traits;
  scene::Request request;
  gpu::Capabilities capabilities;
};

std::string escapeCell(const std::string& text) {
  std::string cell;
  for (const char c : text) cell += c == '|' ? std::string("\\|") : std::string(1, c);
  return cell;
}

const char* printAccess(graph::Access access) {
  switch (access) {
    case graph::Access::Read:
      return "reads";
    case graph::Access::Write:
      return "writes";
    case graph::Access::Modify:
      return "modifies";
    case graph::Access::Scratch:
      return "scratch";
    case graph::Access::ReadBack:
      return "reads back";
  }
  return "";
}

std::string printPort(const graph::Port& port) {
  std::string type;
  if (port.access == graph::Access::Read || port.access == graph::Access::Modify) {
    if (port.kind) type = *port.kind == graph::ResourceKind::Image ? "image" : "buffer";
  } else if (port.growable) {
    type = "grows";
  } else {
    type = port.shape.print();
  }
  std::string notes;
  if (port.optional) notes += ", optional";
  if (port.persistent) notes += ", kept between runs";
  return "| `" + port.name + "` | " + printAccess(port.access) + notes + " | " + escapeCell(type) + " | " + escapeCell(port.meaning) +
         " |\n";
}

const char* printChange(params::Invalidates invalidates) {
  switch (invalidates) {
    case params::Invalidates::Plan:
      return "plan";
    case params::Invalidates::Rerun:
      return "run";
    case params::Invalidates::Frame:
      return "frame";
  }
  return "";
}

std::string printTable(const params::Table& table) {
  if (table.all().empty()) return "";
  std::string text = "\n| parameter | default | allowed | a change makes anew | what |\n|---|---|---|---|---|\n";
  for (const params::Param& param : table.all()) {
    std::string sweep;
    for (const std::string& value : param.sweep) sweep += (sweep.empty() ? "; worth trying: " : ", ") + value;
    text += "| `" + param.name + "` | " + param.defaultValue + " | " + escapeCell(printAllowed(param) + sweep) + " | " +
            printChange(param.invalidates) + " | " + escapeCell(param.help) + " |\n";
  }
  return text;
}

std::string printNode(const plugin::NodeType& type) {
  const std::unique_ptr<graph::Node> node = type.make();
  const Everything everything;
  graph::Declaration declaration(everything.traits, everything.request, everything.capabilities);
  node->declare(declaration);
  std::string help = escapeCell(type.help);
  if (!help.empty() && help[0] >= 'a' && help[0] <= 'z') help[0] = static_cast<char>(help[0] - 'a' + 'A');
  std::string text = "### " + type.name + "\n\n" + help + ".";
  text += declaration.runsEveryFrame() ? " Runs every frame" : " Runs when an input or a parameter changes";
  if (declaration.isHostPaced()) text += ", in steps that the host waits for: such a frame cannot be recorded";
  text += ".";
  std::string counts;
  for (const auto& count : declaration.publishedCounts) counts += (counts.empty() ? "" : ", ") + ("`" + count.name + "`");
  if (!counts.empty()) text += " Publishes " + counts + ".";
  text += "\n\n| port | | type | what |\n|---|---|---|---|\n";
  for (const graph::Port& port : declaration.ports) {
    if (port.access != graph::Access::Scratch) text += printPort(port);
  }
  return text + printTable(node->params()) + "\n";
}

std::string printMarkdown(const plugin::Registry& registry) {
  std::string text =
      "# Nodes\n\n<!-- Written by `radivox nodes --format markdown`; a test compares. -->\n\n"
      "Every node of this build as it describes itself: its ports, in the order of a graph's edges, and its parameters (`--set "
      "NODE.NAME=VALUE`,\n"
      "`\"params\"` in graphs, presets, `Graph::set`, `radivoxSetParameter`). Buffers' types are bytes an element × elements, in counts of "
      "the scene\n"
      "and of other nodes. A change of a parameter makes the *plan* anew, or only the node's *run* and what depends on it, or only the "
      "*frame*.\n"
      "Names that begin with `scene.` or `view.` connect themselves. Why things are as they are: `docs/data_flow.md` and each node's "
      "header.\n";
  std::string module;
  for (const plugin::NodeType& type : registry.types()) {
    const std::string owner = type.name.substr(0, type.name.find('.'));
    if (owner != module) text += "\n## " + owner + "\n\n";
    module = owner;
    text += printNode(type);
  }
  while (text.size() > 1 && text.compare(text.size() - 2, 2, "\n\n") == 0) text.pop_back();
  scene::LightOptions defaults;
  return text + "\n## lights\n\nOf every graph: how lights cast shadows.\n" + printTable(lightTable(defaults));
}

std::string printList(const plugin::Registry& registry) {
  std::string text;
  for (const plugin::NodeType& type : registry.types()) text += type.name + " (" + type.origin + "): " + type.help + "\n";
  return text;
}

}  // namespace

int runNodes(const Options& options) {
  if (options.format != "text" && options.format != "markdown") failUnknown("format", options.format, {"text", "markdown"});
  plugin::Registry registry;
  fillRegistry(options, registry);
  std::cout << (options.format == "text" ? printList(registry) : printMarkdown(registry));
  return 0;
}

}  // namespace radivox::cli
