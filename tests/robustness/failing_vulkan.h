// Vulkan that fails on demand. failing_vulkan.cpp defines the entry points that can fail in this very program, so that the engine's calls meet
// them first: each counts, fails if it is its turn, and else goes on to the loader's own. Objects made and destroyed are counted as well.
#pragma once

#include <cstdint>
#include <string>

namespace radivox::tests {

/// From now on calls are counted from 1, and the n-th fails; 0: none does.
void failCall(uint64_t n);
uint64_t callCount();
/// Name of the call that failed last; empty: none has since failCall.
std::string failedCall();
/// Objects and memory that were made and not yet destroyed.
int64_t liveObjectCount();

}  // namespace radivox::tests
