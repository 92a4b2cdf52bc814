#include "engine/graph/resource.h"

#include "engine/error.h"

namespace radivox::graph {
namespace {

/// Names of the formats that nodes use; others print as their number.
std::string printFormat(VkFormat format) {
  switch (format) {
    case VK_FORMAT_R8G8B8A8_UNORM:
      return "RGBA8";
    case VK_FORMAT_R8G8B8A8_SRGB:
      return "RGBA8_SRGB";
    case VK_FORMAT_R16G16_SFLOAT:
      return "RG16F";
    case VK_FORMAT_R16G16B16A16_SFLOAT:
      return "RGBA16F";
    case VK_FORMAT_R32_UINT:
      return "R32UI";
    case VK_FORMAT_R32_SFLOAT:
      return "R32F";
    case VK_FORMAT_R32G32_UINT:
      return "RG32UI";
    case VK_FORMAT_R32G32_SFLOAT:
      return "RG32F";
    case VK_FORMAT_R32G32B32A32_UINT:
      return "RGBA32UI";
    case VK_FORMAT_R32G32B32A32_SFLOAT:
      return "RGBA32F";
    case VK_FORMAT_D32_SFLOAT:
      return "D32F";
    case VK_FORMAT_D16_UNORM:
      return "D16";
    default:
      return "format " + std::to_string(static_cast<int>(format));
  }
}

}  // namespace

std::optional<uint64_t> Extent::evaluate(const Counts& counts) const {
  uint64_t value = scale_;
  bool overflow = false;
  for (const std::string& name : counts_) {
    const auto known = counts.find(name);
    if (known == counts.end()) return std::nullopt;
    overflow |= __builtin_mul_overflow(value, known->second, &value);
  }
  if (divide_ > 1) value = value / divide_ + (value % divide_ != 0 ? 1 : 0);
  overflow |= __builtin_add_overflow(value, add_, &value);
  if (overflow) {
    throw Error(ErrorCode::OutOfMemory, "size " + print() + " does not fit in 64 bits; use a smaller resolution");
  }
  return value;
}

std::string Extent::print() const {
  std::string text;
  if (scale_ != 1 || counts_.empty()) text = std::to_string(scale_);
  for (const std::string& name : counts_) text += (text.empty() ? "" : "·") + name;
  if (divide_ != 1) text += "/" + std::to_string(divide_);
  if (add_ != 0) text += "+" + std::to_string(add_);
  return text;
}

std::string Shape::print() const {
  if (kind == ResourceKind::Buffer) return std::to_string(elementBytes) + " B × " + elements.print();
  std::string text = printFormat(format) + " " + width.print() + " × " + height.print();
  if (arrayView || layers.print() != "1") text += " × " + layers.print();
  return text;
}

}  // namespace radivox::graph
