#include "samples/cli/options.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "engine/error.h"
#include "engine/scene/traits.h"

namespace radivox::cli {

namespace {

constexpr uint32_t kMostBounces = 1000000;

bool readWhole(std::string_view text, uint32_t& value) {
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  return result.ec == std::errc() && result.ptr == text.data() + text.size();
}

[[noreturn]] void refuse(const std::string& option, const std::string& text, const std::string& allowed) {
  throw Error(ErrorCode::BadInput, option + " '" + text + "': give " + allowed);
}

}  // namespace

Size parseSize(const std::string& text) {
  Size size;
  const size_t x = text.find('x');
  const bool read = x != std::string::npos && readWhole(std::string_view(text).substr(0, x), size.width) &&
                    readWhole(std::string_view(text).substr(x + 1), size.height);
  if (!read || size.width < 1 || size.height < 1 || size.width > kMaxSide || size.height > kMaxSide) {
    refuse("--size", text, "WIDTHxHEIGHT, each from 1 to " + std::to_string(kMaxSide) + ", as in 960x540");
  }
  return size;
}

uint32_t parseWhole(const std::string& option, const std::string& text, uint32_t min, uint32_t max) {
  uint32_t value = 0;
  if (!readWhole(text, value) || value < min || value > max) {
    refuse(option, text, "a whole number from " + std::to_string(min) + " to " + std::to_string(max));
  }
  return value;
}

uint32_t parseBounces(const std::string& text) {
  uint32_t value = 0;
  if (text == "all") return scene::kAllBounces;
  if (!readWhole(text, value) || value > kMostBounces) {
    refuse("--bounces", text, "'all', or a whole number from 0 (direct light only) to " + std::to_string(kMostBounces));
  }
  return value;
}

double parsePositive(const std::string& option, const std::string& text) {
  double value = 0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool read = result.ec == std::errc() && result.ptr == text.data() + text.size();
  if (!read || !std::isfinite(value) || !(value > 0)) refuse(option, text, "a number above 0");
  return value;
}

int parseDevice(const std::string& text) { return text == "-1" ? -1 : static_cast<int>(parseWhole("--device", text, 0, 1023)); }

std::vector<std::string> parseList(const std::string& option, const std::string& text) {
  std::vector<std::string> names;
  size_t begin = 0;
  while (begin <= text.size()) {
    const size_t end = std::min(text.find(',', begin), text.size());
    const std::string name = text.substr(begin, end - begin);
    if (name.empty()) refuse(option, text, "names with one comma between them");
    if (std::find(names.begin(), names.end(), name) != names.end()) refuse(option, text, "each name once ('" + name + "' is there twice)");
    names.push_back(name);
    begin = end + 1;
  }
  return names;
}

}  // namespace radivox::cli
