// Prefix scan and compaction: the two primitives that the nodes share. Exclusive sums of uint32, any length that
// memory allows; a sum past 32 bits shows in the total's high word (output then holds the low words).
#pragma once

#include "engine/gpu/commands.h"

namespace radivox::gpu {

class Scan {
 public:
  static constexpr uint32_t kBlock = 1024;  ///< items a workgroup sums
  /// `mostPieceItems` (tests) makes pieces smaller than the device's binding range asks for; it is rounded down to 32768 at least.
  explicit Scan(Device& device, uint64_t mostPieceItems = uint64_t{1} << 27);

  /// Bytes of scratch that scan() needs for `itemCount` items.
  static VkDeviceSize scratchBytes(uint64_t itemCount);

  /// output[i] = Σ_{j<i} input[j]; `total` (optional: 2 words, low and high) gets the sum. input and output may be the same buffer.
  /// Records all barriers between its own passes and one before and after.
  void scan(Commands& commands, const Buffer& input, const Buffer& output, uint64_t itemCount, const Buffer& scratch,
            const Buffer* total = nullptr, VkDeviceSize totalOffset = 0) const;

  /// The indices i < itemCount whose bit i of `bits` is set, in order, to `output`; their number to count[0], and indirect dispatch
  /// arguments for groups of `groupSize` (folded as dispatchItems) to count[1..3]. An output too small for all of them gets the
  /// first ones, and count[0] still says how many there are. `output` is written by device address and may be of any size.
  static VkDeviceSize compactScratchBytes(uint64_t itemCount);
  void compactBits(Commands& commands, const Buffer& bits, uint64_t itemCount, const Buffer& output, const Buffer& count,
                   uint32_t groupSize, const Buffer& scratch) const;

 private:
  // Reduce, then scan: blocks are summed, the sums are summed in turn until one is left; then, from the top down, each level is
  // scanned with the level above as its offsets. Two reads and one write of the items. Items that one binding cannot show are done
  // in pieces.
  static constexpr uint32_t kMaxLevels = 8;
  struct Levels {
    uint32_t count = 0;  ///< of sums; level 0 sums the items, the last one is the total
    uint64_t items[kMaxLevels] = {};
    VkDeviceSize offset[kMaxLevels] = {};  ///< in the scratch
    VkDeviceSize bytes = 0;
  };
  static Levels planLevels(uint64_t itemCount);
  BoundResource showLevel(const Buffer& scratch, const Levels& levels, uint32_t level, uint64_t firstItem = 0) const;
  void reduce(Commands& commands, const Pipeline& pipeline, const Buffer& source, uint64_t itemCount, uint32_t lastWordMask,
              const Levels& levels, const Buffer& scratch) const;
  void scanLevels(Commands& commands, const Levels& levels, const Buffer& scratch) const;

  uint64_t pieceItems_ = 0;  ///< words that one binding shows
  Pipeline reduceWords_;
  Pipeline reducePairs_;
  Pipeline reduceBits_;
  Pipeline scanWords_;
  Pipeline scanWordsInPlace_;
  Pipeline scanPairs_;
  Pipeline scatterBits_;
  Pipeline writeArguments_;
};

}  // namespace radivox::gpu
