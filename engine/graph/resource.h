// Shapes of resources as symbols, so that a graph can be declared, sized and printed without a GPU.
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace radivox::graph {

/// Named counts: "triangles", "width" … known from the scene and the request; "voxels", "faces" … published by nodes as they run.
using Counts = std::map<std::string, uint64_t>;

/// ceil(scale · Π counts / divide) + add. Unknown counts make it unknown until their node has run.
class Extent {
 public:
  Extent(uint64_t constant = 1) : scale_(constant) {}  // NOLINT: implicit on purpose
  static Extent of(std::string count) {
    Extent e;
    e.counts_.push_back(std::move(count));
    return e;
  }
  Extent operator*(uint64_t k) const {
    Extent e = *this;
    e.scale_ *= k;
    e.add_ *= k;
    return e;
  }
  Extent operator*(const std::string& count) const {
    Extent e = *this;
    e.counts_.push_back(count);
    return e;
  }
  Extent operator+(uint64_t k) const {
    Extent e = *this;
    e.add_ += k;
    return e;
  }
  /// Rounds up. Only before `+`.
  Extent operator/(uint64_t k) const {
    Extent e = *this;
    e.divide_ *= k;
    return e;
  }
  /// Nothing while a count is unknown; throws OutOfMemory on 64-bit overflow.
  std::optional<uint64_t> evaluate(const Counts& counts) const;
  const std::vector<std::string>& counts() const { return counts_; }
  std::string print() const;  ///< "4·faces/32+64"

 private:
  uint64_t scale_ = 1;
  uint64_t divide_ = 1;
  uint64_t add_ = 0;
  std::vector<std::string> counts_;
};

enum class ResourceKind : uint8_t { Buffer, Image };

struct Shape {
  ResourceKind kind = ResourceKind::Buffer;
  // Buffer
  uint32_t elementBytes = 4;
  Extent elements;
  // Image
  VkFormat format = VK_FORMAT_UNDEFINED;
  Extent width, height, layers;
  bool arrayView = false;

  static Shape buffer(uint32_t elementBytes, Extent elements) {
    Shape s;
    s.elementBytes = elementBytes;
    s.elements = std::move(elements);
    return s;
  }
  static Shape image(VkFormat format, Extent width, Extent height, Extent layers = 1, bool arrayView = false) {
    Shape s;
    s.kind = ResourceKind::Image;
    s.format = format;
    s.width = std::move(width);
    s.height = std::move(height);
    s.layers = std::move(layers);
    s.arrayView = arrayView;
    return s;
  }
  std::string print() const;
};

}  // namespace radivox::graph
