#include "engine/gpu/timestamps.h"

#include <cassert>
#include <utility>

namespace radivox::gpu {

Timestamps::Timestamps(Device& device, uint32_t capacity) : device_(&device), capacity_(capacity) {
  if (device.capabilities().timestampPeriodNs <= 0.f || capacity == 0) return;
  VkQueryPoolCreateInfo info{VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO};
  info.queryType = VK_QUERY_TYPE_TIMESTAMP;
  info.queryCount = capacity;
  check(vkCreateQueryPool(device.handle(), &info, nullptr, &pool_), "vkCreateQueryPool");
  reset();
}

Timestamps::Timestamps(Timestamps&& other) noexcept { *this = std::move(other); }

Timestamps& Timestamps::operator=(Timestamps&& other) noexcept {
  if (this == &other) return *this;
  release();
  device_ = std::exchange(other.device_, nullptr);
  pool_ = std::exchange(other.pool_, VK_NULL_HANDLE);
  capacity_ = std::exchange(other.capacity_, 0);
  return *this;
}

Timestamps::~Timestamps() { release(); }

void Timestamps::release() noexcept {
  if (pool_ != VK_NULL_HANDLE) vkDestroyQueryPool(device_->handle(), pool_, nullptr);
  pool_ = VK_NULL_HANDLE;
}

void Timestamps::reset() {
  if (isActive()) vkResetQueryPool(device_->handle(), pool_, 0, capacity_);
}

void Timestamps::reset(VkCommandBuffer commands) const {
  if (isActive()) vkCmdResetQueryPool(commands, pool_, 0, capacity_);
}

void Timestamps::write(VkCommandBuffer commands, uint32_t query) const {
  assert(query < capacity_);
  if (isActive()) vkCmdWriteTimestamp2(commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, pool_, query);
}

std::vector<double> Timestamps::readNs(uint32_t first, uint32_t count) const {
  assert(first + count <= capacity_);
  std::vector<double> times(count, 0.0);
  if (!isActive() || count == 0) return times;
  struct Result {
    uint64_t ticks;
    uint64_t written;
  };
  std::vector<Result> results(count);
  const VkResult result = vkGetQueryPoolResults(device_->handle(), pool_, first, count, results.size() * sizeof(Result), results.data(),
                                                sizeof(Result), VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WITH_AVAILABILITY_BIT);
  check(result, "vkGetQueryPoolResults");
  const Capabilities& can = device_->capabilities();
  const uint64_t mask = can.timestampValidBits >= 64 ? ~uint64_t{0} : (uint64_t{1} << can.timestampValidBits) - 1;
  if (results[0].written == 0) return times;
  for (uint32_t i = 1; i < count; ++i) {
    const uint64_t ticks = (results[i].ticks - results[0].ticks) & mask;
    if (results[i].written != 0) times[i] = static_cast<double>(ticks) * static_cast<double>(can.timestampPeriodNs);
  }
  return times;
}

}  // namespace radivox::gpu
