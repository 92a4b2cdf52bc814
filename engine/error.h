// The one exception type of Radivox. Thrown only while declaring, preparing, compiling or loading;
// recording commands never throws. Bugs of our own are asserts, not exceptions.
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

namespace radivox {

enum class ErrorCode {
  BadInput,      ///< usage, file, parameter or scene is wrong; exit code 2
  Unsupported,   ///< the device or build lacks what is asked for; exit code 3
  OutOfMemory,   ///< host or device memory, or a device limit; exit code 4
  DeviceFailed,  ///< a Vulkan call failed for another reason; exit code 3
};

/// `what()` is one line: what is wrong, where (file and place in it), and the mend.
class Error : public std::runtime_error {
 public:
  Error(ErrorCode code, const std::string& message) : std::runtime_error(onOneLine(message)), code_(code) {}
  ErrorCode code() const { return code_; }

 private:
  /// Names out of files may hold anything, line ends and terminal codes too.
  static std::string onOneLine(std::string text) {
    for (char& c : text) {
      if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
    }
    return text;
  }
  ErrorCode code_;
};

}  // namespace radivox
