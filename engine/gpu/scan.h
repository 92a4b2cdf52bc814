// Prefix scan and compaction: the two primitives that the nodes share. Exclusive sums of uint32, any length up to 2³¹; total
// overflow beyond 32 bits is reported in the total's high word.
#pragma once

#include "engine/gpu/commands.h"

namespace radivox::gpu {

class Scan {
 public:
  static constexpr uint32_t kBlock = 1024;  ///< items a workgroup sums (256 lanes × 4)
  explicit Scan(Device& device);

  /// Bytes of scratch that scan() needs for `itemCount` items.
  static VkDeviceSize scratchBytes(uint64_t itemCount);

  /// output[i] = Σ_{j<i} input[j]; `total` (optional: 2 words, low and high) gets the sum. input and output may be the same buffer.
  /// Records all barriers between its own passes and one before and after.
  void scan(Commands& commands, const Buffer& input, const Buffer& output, uint64_t itemCount, const Buffer& scratch,
            const Buffer* total = nullptr, VkDeviceSize totalOffset = 0) const;

  /// The indices i < itemCount whose bit i of `bits` is set, in order, to `output`; their number to count[0], and indirect dispatch
  /// arguments for groups of `groupSize` (folded as dispatchItems) to count[1..3]. Scratch: scratchBytes(words) + 4·words.
  static VkDeviceSize compactScratchBytes(uint64_t itemCount);
  void compactBits(Commands& commands, const Buffer& bits, uint64_t itemCount, const Buffer& output, const Buffer& count,
                   uint32_t groupSize, const Buffer& scratch) const;

 private:
  Pipeline blockSums_;
  Pipeline addOffsets_;
  Pipeline countBits_;
  Pipeline scatterBits_;
  Pipeline writeArguments_;
};

}  // namespace radivox::gpu
