// Shared by the printers of a plan. Private to engine/graph.
#pragma once

#include <map>
#include <optional>

#include "engine/graph/plan.h"

namespace radivox::graph::detail {

/// Nothing while a count is unknown, or for formats without a fixed texel size.
std::optional<uint64_t> shapeBytes(const Shape& shape, const Counts& counts);
uint32_t texelBytes(VkFormat format);  ///< 0: not known here
std::string printUse(uint32_t use);
const char* printAccess(Access access);
std::string printRuns(const PlannedStep& step);
std::string printBytes(const std::optional<uint64_t>& bytes);

struct Totals {
  uint64_t kept = 0;             ///< device memory that stays between frames
  uint64_t scratch = 0;          ///< largest member of each slot
  uint64_t scratchUnshared = 0;  ///< what scratch would take without aliasing
  uint64_t host = 0;
  uint64_t imported = 0;
  bool open = false;  ///< something is not known yet and counts as 0
};
Totals totals(const Plan& plan, const Counts& counts);

std::map<uint32_t, std::vector<ResourceId>> slotMembers(const Plan& plan);

}  // namespace radivox::graph::detail
