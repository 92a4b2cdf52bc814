// GPU time between points of a command buffer. Where the device has no timestamps nothing is recorded and every time reads 0.
#pragma once

#include <vector>

#include "engine/gpu/device.h"

namespace radivox::gpu {

/// reset (host or recorded) → write each query once → device done → readNs. Move-only.
class Timestamps {
 public:
  Timestamps() = default;
  Timestamps(Device& device, uint32_t capacity);
  Timestamps(Timestamps&& other) noexcept;
  Timestamps& operator=(Timestamps&& other) noexcept;
  ~Timestamps();

  bool isActive() const { return pool_ != VK_NULL_HANDLE; }
  uint32_t capacity() const { return capacity_; }

  /// From the host; no work that uses the queries may be under way.
  void reset();
  void reset(VkCommandBuffer commands) const;  ///< outside of rendering
  /// The time when all commands recorded before are done.
  void write(VkCommandBuffer commands, uint32_t query) const;

  /// Nanoseconds from query `first` to each of the `count` queries from it on, after the device is done; counters that wrap are seen
  /// through. Queries that were not written since the last reset read 0.
  std::vector<double> readNs(uint32_t first, uint32_t count) const;

 private:
  void release() noexcept;
  Device* device_ = nullptr;
  VkQueryPool pool_ = VK_NULL_HANDLE;
  uint32_t capacity_ = 0;
};

}  // namespace radivox::gpu
