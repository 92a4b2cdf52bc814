// The plan as text, for people and for golden tests.
#include <algorithm>
#include <set>

#include "engine/graph/plan.h"
#include "engine/graph/plan_print.h"

namespace radivox::graph {

namespace detail {

std::optional<uint64_t> shapeBytes(const Shape& shape, const Counts& counts) {
  if (shape.kind == ResourceKind::Buffer) {
    const auto elements = shape.elements.evaluate(counts);
    if (!elements) return std::nullopt;
    return *elements * shape.elementBytes;
  }
  const auto width = shape.width.evaluate(counts), height = shape.height.evaluate(counts), layers = shape.layers.evaluate(counts);
  const uint32_t texel = texelBytes(shape.format);
  if (!width || !height || !layers || texel == 0) return std::nullopt;
  return *width * *height * *layers * texel;
}

uint32_t texelBytes(VkFormat format) {
  switch (format) {
    case VK_FORMAT_R8_UNORM:
    case VK_FORMAT_R8_UINT:
      return 1;
    case VK_FORMAT_D16_UNORM:
    case VK_FORMAT_R16_SFLOAT:
    case VK_FORMAT_R16_UINT:
      return 2;
    case VK_FORMAT_R8G8B8A8_UNORM:
    case VK_FORMAT_R8G8B8A8_SRGB:
    case VK_FORMAT_B8G8R8A8_UNORM:
    case VK_FORMAT_B8G8R8A8_SRGB:
    case VK_FORMAT_R16G16_SFLOAT:
    case VK_FORMAT_R32_UINT:
    case VK_FORMAT_R32_SINT:
    case VK_FORMAT_R32_SFLOAT:
    case VK_FORMAT_D32_SFLOAT:
      return 4;
    case VK_FORMAT_R16G16B16A16_SFLOAT:
    case VK_FORMAT_R32G32_UINT:
    case VK_FORMAT_R32G32_SFLOAT:
      return 8;
    case VK_FORMAT_R32G32B32A32_UINT:
    case VK_FORMAT_R32G32B32A32_SFLOAT:
      return 16;
    default:
      return 0;
  }
}

std::string printUse(uint32_t use) {
  static constexpr std::pair<uint32_t, const char*> kNames[] = {
      {UseCompute, "compute"},   {UseRaster, "raster"}, {UseAttachment, "attach"}, {UseTransfer, "transfer"},
      {UseIndirect, "indirect"}, {UseHost, "host"},     {UseAddress, "address"}};
  std::string text;
  for (const auto& [bit, name] : kNames) {
    if ((use & bit) != 0) text += (text.empty() ? "" : "|") + std::string(name);
  }
  return text.empty() ? "nothing" : text;
}

const char* printAccess(Access access) {
  switch (access) {
    case Access::Read:
      return "read";
    case Access::Write:
      return "write";
    case Access::Modify:
      return "modify";
    case Access::Scratch:
      return "scratch";
    case Access::ReadBack:
      return "read back";
  }
  return "";
}

std::string printRuns(const PlannedStep& step) {
  std::string text = step.everyFrame ? "every frame" : "on change";
  if (step.hostPaced) text += ", host-paced";
  return text;
}

std::string printBytes(const std::optional<uint64_t>& bytes) { return bytes ? std::to_string(*bytes) + " B" : "? B"; }

Totals totals(const Plan& plan, const Counts& counts) {
  Totals sums;
  std::map<uint32_t, std::pair<uint32_t, uint64_t>> slots;  // slot → members, largest
  for (const PlannedResource& resource : plan.resources) {
    if (resource.growable) {
      sums.open = true;
      continue;
    }
    const auto bytes = shapeBytes(resource.shape, counts);
    if (!bytes) sums.open = true;
    const uint64_t known = bytes.value_or(0);
    if (resource.scratch) {
      sums.scratchUnshared += known;
      if (resource.lender != kNoResource) continue;
      auto& [members, largest] = slots[resource.aliasSlot];
      ++members;
      largest = std::max(largest, known);
    } else if (resource.imported) {
      sums.imported += known;
    } else if (resource.hostVisible) {
      sums.host += known;
    } else {
      sums.kept += known;
    }
  }
  for (const auto& [slot, use] : slots) sums.scratch += use.second;
  return sums;
}

std::map<uint32_t, std::vector<ResourceId>> slotMembers(const Plan& plan) {
  std::map<uint32_t, std::vector<ResourceId>> members;
  for (ResourceId id = 0; id < plan.resources.size(); ++id) {
    if (plan.resources[id].aliasSlot != kNoSlot) members[plan.resources[id].aliasSlot].push_back(id);
  }
  return members;
}

}  // namespace detail

namespace {

using namespace detail;

/// Name of the resource where it is another's: "← voxelize.grid", with the link of its chain after a Modify.
std::string printSource(const Plan& plan, const PlannedPort& port) {
  const PlannedResource& resource = plan.resources[port.resource];
  std::string text = " ← " + resource.name;
  if (resource.versionCount > 1) text += " v" + std::to_string(port.access == Access::Modify ? port.version - 1 : port.version);
  return text;
}

std::string printPort(const Plan& plan, const PlannedPort& port, const Counts& counts) {
  std::string text = std::string(printAccess(port.access)) + " " + port.name;
  if (port.resource == kNoResource) return text + ": absent\n";
  const PlannedResource& resource = plan.resources[port.resource];
  if (port.access == Access::Read || port.access == Access::Modify) {
    text += printSource(plan, port);
    if (port.access == Access::Modify) text += port.frees ? ", then freed" : " → v" + std::to_string(port.version);
    return text + "\n";
  }
  text += resource.growable ? ": grows" : ": " + resource.shape.print() + " = " + printBytes(shapeBytes(resource.shape, counts));
  if (resource.persistent) text += ", persistent";
  if (resource.output && resource.versionCount == 1) text += ", output";
  if (resource.aliasSlot != kNoSlot) text += ", slot " + std::to_string(resource.aliasSlot);
  if (resource.lender != kNoResource) text += ", in " + plan.resources[resource.lender].name;
  return text + "\n";
}

std::string printBarrier(const Plan& plan, const PlannedBarrier& barrier) {
  const PlannedResource& resource = plan.resources[barrier.resource];
  std::string name = resource.lender != kNoResource ? plan.resources[resource.lender].name : resource.name;
  if (resource.aliasSlot != kNoSlot) name = "slot " + std::to_string(resource.aliasSlot);
  return "barrier " + name + ": " + (barrier.writeBefore ? "write " : "read ") + printUse(barrier.fromUse) + " → " +
         (barrier.writeAfter ? "write " : "read ") + printUse(barrier.toUse) + "\n";
}

}  // namespace

std::string Plan::printText(const Counts& counts) const {
  std::string text = "plan: " + std::to_string(steps.size()) + " nodes in " + std::to_string(segmentCount) + " segments, " +
                     std::to_string(culled.size()) + " left out\n";
  uint32_t segment = 0xffffffffu;
  for (size_t i = 0; i < steps.size(); ++i) {
    const PlannedStep& step = steps[i];
    if (step.segment != segment) text += "segment " + std::to_string(step.segment) + "\n";
    segment = step.segment;
    text += "  " + std::to_string(i) + " " + nodeNames[step.node] + " (" + step.type + "), " + printRuns(step) + "\n";
    for (const PlannedBarrier& barrier : step.barriers) text += "      " + printBarrier(*this, barrier);
    for (const PlannedPort& port : step.ports) text += "      " + printPort(*this, port, counts);
    for (const auto& count : step.counts) {
      const auto known = counts.find(count.name);
      text += "      count " + count.name +
              (count.port.empty() ? " from the host" : " from " + count.port + " + " + std::to_string(count.byteOffset) + " B") +
              (known == counts.end() ? "" : " = " + std::to_string(known->second)) + "\n";
    }
  }
  if (!culled.empty()) text += "left out\n";
  for (const CulledNode& node : culled) text += "  " + node.name + " (" + node.type + "): " + node.reason + "\n";

  if (!advice.empty()) text += "advice\n";
  for (const auto& [node, words] : advice) text += "  " + node + ": " + words + "\n";

  const auto slots = slotMembers(*this);
  if (!slots.empty()) text += "shared scratch memory\n";
  for (const auto& [slot, members] : slots) {
    uint64_t largest = 0;
    bool open = false;
    std::string names;
    for (const ResourceId id : members) {
      const auto bytes = shapeBytes(resources[id].shape, counts);
      open |= !bytes;
      largest = std::max(largest, bytes.value_or(0));
      names += (names.empty() ? "" : ", ") + resources[id].name;
    }
    text += "  slot " + std::to_string(slot) + ", segment " + std::to_string(steps[resources[members.front()].firstUse].segment) + ", " +
            (open ? "at least " : "") + std::to_string(largest) + " B: " + names + "\n";
  }
  const Totals sums = totals(*this, counts);
  text += std::string("memory") + (sums.open ? " (of what is known before the first run)" : "") + ": kept " + std::to_string(sums.kept) +
          " B, scratch " + std::to_string(sums.scratch) + " B (" + std::to_string(sums.scratchUnshared) + " B unshared), host " +
          std::to_string(sums.host) + " B, imported " + std::to_string(sums.imported) + " B\n";
  return text;
}

}  // namespace radivox::graph
