// Private to engine/gpu: what the machine can still give. On CPU devices (lavapipe) device memory is the machine's, and the system
// promises more than it has: without this check a scene too large ends in a kill, not in an error.
#pragma once

#include <cstdint>
#include <string>

namespace radivox::gpu {

/// Bytes that new allocations may use now: what the system calls available, or what the control group leaves, whichever is less.
/// The largest uint64_t where neither can be read. `root` (tests) stands before every path read.
uint64_t availableHostMemory(const std::string& root = "");

}  // namespace radivox::gpu
