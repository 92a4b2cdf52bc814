// Scan: reads input, writes output and total · cost: 2 reads and 1 write of 4 B an item, 8 B of scratch for 1024 items · source: the
// usual reduce-then-scan, with sums of 64 bits so that an overflow shows.
#include "engine/gpu/scan.h"

#include <algorithm>
#include <cassert>

namespace radivox::gpu {

namespace {

constexpr VkDeviceSize kOffsetAlignment = 256;  // no device asks for more (Vulkan limits minStorageBufferOffsetAlignment to 256)

struct ReducePush {
  uint32_t itemCount;
  uint32_t lastWordMask;
};
struct ScanPush {
  uint32_t itemCount;
  uint32_t isTop;
};
struct ScatterPush {
  VkDeviceAddress indices;
  uint32_t capacity;
  uint32_t firstWord;
  uint32_t wordCount;
  uint32_t lastWordMask;
  uint32_t isTop;
  uint32_t pad;
};
struct ArgumentsPush {
  uint32_t groupSize;
  uint32_t maxGroupsX;
  uint32_t isEmpty;
};

uint64_t countBlocks(uint64_t itemCount) { return (itemCount + Scan::kBlock - 1) / Scan::kBlock; }

BoundResource showWords(const Buffer& buffer, uint64_t firstWord, uint64_t wordCount) { return {buffer, firstWord * 4, wordCount * 4}; }

Pipeline makePipeline(Device& device, std::string_view shader, size_t bufferCount, size_t pushBytes, uint32_t source) {
  // CPU time on lavapipe for 16 Mi words: 32 lanes 8 ns a word, 128 lanes 13, 256 lanes 26; below 32 no better.
  const uint32_t lanes = device.capabilities().deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU ? 32 : 256;
  return Pipeline(device, ComputePipelineInfo{.shader = shader,
                                              .bindings = std::vector<BindingType>(bufferCount, BindingType::StorageBuffer),
                                              .pushConstantBytes = static_cast<uint32_t>(pushBytes),
                                              .constants = {{0, source}, {1, lanes}}});
}

}  // namespace

Scan::Scan(Device& device, uint64_t mostPieceItems)
    : reduceWords_(makePipeline(device, "gpu/scan_reduce.comp", 2, sizeof(ReducePush), 0)),
      reducePairs_(makePipeline(device, "gpu/scan_reduce.comp", 2, sizeof(ReducePush), 1)),
      reduceBits_(makePipeline(device, "gpu/scan_reduce.comp", 2, sizeof(ReducePush), 2)),
      scanWords_(makePipeline(device, "gpu/scan_blocks.comp", 3, sizeof(ScanPush), 0)),
      scanWordsInPlace_(makePipeline(device, "gpu/scan_blocks.comp", 3, sizeof(ScanPush), 2)),
      scanPairs_(makePipeline(device, "gpu/scan_blocks.comp", 3, sizeof(ScanPush), 1)),
      scatterBits_(makePipeline(device, "gpu/scan_scatter_bits.comp", 2, sizeof(ScatterPush), 0)),
      writeArguments_(makePipeline(device, "gpu/scan_arguments.comp", 2, sizeof(ArgumentsPush), 0)) {
  // A piece's sums must start at an aligned offset too: 32 blocks' sums are 256 bytes.
  constexpr uint64_t kStep = kBlock * kOffsetAlignment / 8;
  constexpr uint64_t kMostItems = uint64_t{1} << 27;  // keeps every index of a piece within 32 bits
  const uint64_t most = std::min<uint64_t>({device.capabilities().maxStorageBufferRange / 8, mostPieceItems, kMostItems});
  pieceItems_ = std::max(most / kStep * kStep, kStep);
}

Scan::Levels Scan::planLevels(uint64_t itemCount) {
  Levels levels;
  uint64_t count = itemCount;
  do {
    count = std::max<uint64_t>(countBlocks(count), 1);
    levels.items[levels.count] = count;
    levels.offset[levels.count] = levels.bytes;
    levels.bytes += (count * 8 + kOffsetAlignment - 1) / kOffsetAlignment * kOffsetAlignment;
    ++levels.count;
  } while (count > 1);
  return levels;
}

VkDeviceSize Scan::scratchBytes(uint64_t itemCount) { return planLevels(itemCount).bytes; }

VkDeviceSize Scan::compactScratchBytes(uint64_t itemCount) { return scratchBytes((itemCount + 31) / 32); }

BoundResource Scan::showLevel(const Buffer& scratch, const Levels& levels, uint32_t level, uint64_t firstItem) const {
  const uint64_t items = std::min<uint64_t>(levels.items[level] - firstItem, pieceItems_);
  return {scratch, levels.offset[level] + firstItem * 8, items * 8};
}

void Scan::reduce(Commands& commands, const Pipeline& pipeline, const Buffer& source, uint64_t itemCount, uint32_t lastWordMask,
                  const Levels& levels, const Buffer& scratch) const {
  for (uint64_t first = 0; first < itemCount; first += pieceItems_) {
    const uint64_t items = std::min(itemCount - first, pieceItems_);
    commands.bind(pipeline, {showWords(source, first, items), showLevel(scratch, levels, 0, first / kBlock)});
    commands.push(ReducePush{static_cast<uint32_t>(items), first + items == itemCount ? lastWordMask : ~0u});
    commands.dispatchItems(countBlocks(items), 1);
  }
  commands.barrier();
}

void Scan::scanLevels(Commands& commands, const Levels& levels, const Buffer& scratch) const {
  for (uint32_t level = 0; level + 1 < levels.count; ++level) {
    assert(levels.items[level] <= pieceItems_);
    commands.bind(reducePairs_, {showLevel(scratch, levels, level), showLevel(scratch, levels, level + 1)});
    commands.push(ReducePush{static_cast<uint32_t>(levels.items[level]), 0});
    commands.dispatchItems(levels.items[level + 1], 1);
    commands.barrier();
  }
  // The last level holds the total and is left as it is: the one block below it has no offset.
  for (uint32_t level = levels.count - 1; level-- > 0;) {
    const BoundResource sums = showLevel(scratch, levels, level);
    const bool isTop = level + 2 == levels.count;
    commands.bind(scanPairs_, {sums, sums, showLevel(scratch, levels, level + 1)});
    commands.push(ScanPush{static_cast<uint32_t>(levels.items[level]), isTop ? 1u : 0u});
    commands.dispatchItems(levels.items[level + 1], 1);
    commands.barrier();
  }
}

void Scan::scan(Commands& commands, const Buffer& input, const Buffer& output, uint64_t itemCount, const Buffer& scratch,
                const Buffer* total, VkDeviceSize totalOffset) const {
  commands.barrier();
  if (itemCount == 0) {
    if (total != nullptr) commands.fill(*total, 0, totalOffset, 8);
    commands.barrier();
    return;
  }
  const Levels levels = planLevels(itemCount);
  assert(scratch.bytes() >= levels.bytes && input.bytes() >= itemCount * 4 && output.bytes() >= itemCount * 4);
  reduce(commands, reduceWords_, input, itemCount, ~0u, levels, scratch);
  scanLevels(commands, levels, scratch);
  for (uint64_t first = 0; first < itemCount; first += pieceItems_) {
    const uint64_t items = std::min(itemCount - first, pieceItems_);
    commands.bind(scanWords_,
                  {showWords(input, first, items), showWords(output, first, items), showLevel(scratch, levels, 0, first / kBlock)});
    commands.push(ScanPush{static_cast<uint32_t>(items), levels.count == 1 ? 1u : 0u});
    commands.dispatchItems(countBlocks(items), 1);
  }
  if (total != nullptr) commands.copy(scratch, *total, 8, levels.offset[levels.count - 1], totalOffset);
  commands.barrier();
}

void Scan::compactBits(Commands& commands, const Buffer& bits, uint64_t itemCount, const Buffer& output, const Buffer& count,
                       uint32_t groupSize, const Buffer& scratch) const {
  commands.barrier();
  const uint64_t wordCount = (itemCount + 31) / 32;
  const Levels levels = planLevels(wordCount);
  const BoundResource total = showLevel(scratch, levels, levels.count - 1);
  assert(itemCount <= uint64_t{1} << 32 && scratch.bytes() >= levels.bytes && bits.bytes() >= wordCount * 4 && count.bytes() >= 16);
  const uint32_t lastWordMask = itemCount % 32 == 0 ? ~0u : (1u << itemCount % 32) - 1u;
  if (itemCount > 0) {
    reduce(commands, reduceBits_, bits, wordCount, lastWordMask, levels, scratch);
    scanLevels(commands, levels, scratch);
  }
  for (uint64_t first = 0; first < wordCount; first += pieceItems_) {
    const uint64_t words = std::min(wordCount - first, pieceItems_);
    commands.bind(scatterBits_, {showWords(bits, first, words), showLevel(scratch, levels, 0, first / kBlock)});
    commands.push(ScatterPush{output.address(), static_cast<uint32_t>(std::min<uint64_t>(output.bytes() / 4, ~0u)),
                              static_cast<uint32_t>(first), static_cast<uint32_t>(words), first + words == wordCount ? lastWordMask : ~0u,
                              levels.count == 1 ? 1u : 0u, 0});
    commands.dispatchItems(countBlocks(words), 1);
  }
  commands.bind(writeArguments_, {total, count});
  commands.push(ArgumentsPush{groupSize, Commands::kMaxGroupsX, itemCount == 0 ? 1u : 0u});
  commands.dispatch(1);
  commands.barrier();
}

}  // namespace radivox::gpu
