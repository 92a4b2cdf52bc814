// Order and segments.
#include <algorithm>

#include "engine/graph/compile.h"

namespace radivox::graph::detail {

std::vector<uint32_t> order(const Draft& draft) {
  const auto count = static_cast<uint32_t>(draft.declarations.size());
  std::vector<std::vector<uint32_t>> before(count);
  std::vector<char> placed(count, 0);
  for (uint32_t n = 0; n < count; ++n) before[n] = predecessors(draft, n);
  std::vector<uint32_t> result;
  bool progress = true;
  while (progress) {
    progress = false;
    for (uint32_t n = 0; n < count; ++n) {
      if (placed[n] != 0 || !draft.isLive(n)) continue;
      if (!std::all_of(before[n].begin(), before[n].end(), [&](uint32_t b) { return placed[b] != 0; })) continue;
      placed[n] = 1;
      result.push_back(n);
      progress = true;
      break;  // from the start again: the earliest added node that is ready goes first
    }
  }
  return result;
}

std::vector<uint32_t> segments(const Draft& draft, const std::vector<uint32_t>& order) {
  std::vector<uint32_t> result;
  std::vector<uint32_t> segmentOf(draft.declarations.size(), 0);
  uint32_t current = 0;
  bool closed = false;  // a host-paced node fills its segment alone
  for (size_t i = 0; i < order.size(); ++i) {
    const uint32_t node = order[i];
    bool next = i > 0 && (closed || draft.declarations[node].isHostPaced());
    for (uint32_t p = 0; p < draft.declarations[node].ports.size(); ++p) {
      if (isInput(draft.declarations[node].ports[p]) || !draft.exists(node, p)) continue;
      for (const std::string& count : shapeCounts(draft.declarations[node].ports[p])) {
        const uint32_t publisher = draft.publisher(count);
        next |= publisher != kNone && publisher != node && segmentOf[publisher] == current;
      }
    }
    if (next) ++current;
    closed = draft.declarations[node].isHostPaced();
    segmentOf[node] = current;
    result.push_back(current);
  }
  return result;
}

}  // namespace radivox::graph::detail
