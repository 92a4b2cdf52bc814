// Private to engine/gpu: what copies and barriers share.
#pragma once

#include "engine/gpu/device.h"

namespace radivox::gpu {

/// Copies to and from the host go in pieces of this size, so that staging costs no second copy of a large buffer.
constexpr VkDeviceSize kStagingBytes = 32u << 20;

/// All earlier writes are seen by all later commands and by the host once it has waited.
void recordFullBarrier(VkCommandBuffer commands);

/// The aspects a layout change has to name: depth and stencil change together, though we only ever look at depth.
VkImageAspectFlags layoutAspects(VkFormat format);

/// Full barrier that also changes an image's layout.
void recordTransition(VkCommandBuffer commands, VkImage image, VkImageAspectFlags aspect, VkImageLayout from, VkImageLayout to);

}  // namespace radivox::gpu
