#include <cstdio>

#include "bindings/c/handles.h"

namespace radivox::c {

namespace {

/// The one thing here that is not in a handle: a thread's own, like errno.
thread_local char lastError[4096] = "";

}  // namespace

RadivoxResult fail(RadivoxResult result, const char* message) noexcept {
  std::snprintf(lastError, sizeof lastError, "%s", message);
  std::replace(lastError, lastError + std::strlen(lastError), '\n', ' ');
  return result;
}

RadivoxResult resultOf(ErrorCode code) noexcept {
  switch (code) {
    case ErrorCode::BadInput:
      return RADIVOX_BAD_INPUT;
    case ErrorCode::Unsupported:
      return RADIVOX_UNSUPPORTED;
    case ErrorCode::OutOfMemory:
      return RADIVOX_OUT_OF_MEMORY;
    case ErrorCode::DeviceFailed:
      return RADIVOX_DEVICE_FAILED;
  }
  return RADIVOX_INTERNAL_ERROR;
}

std::string requireText(const char* text, const char* name) { return &require(text, name); }

}  // namespace radivox::c

const char* radivoxLastError(void) { return radivox::c::lastError; }

const char* radivoxVersion(void) { return RADIVOX_VERSION; }
