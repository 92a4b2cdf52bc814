// Accessors: typed, strided, sparse views of buffers. All ranges are checked in 64 bits before a byte is read.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "engine/error.h"
#include "engine/scene/gltf_document.h"

namespace radivox::scene::gltf {

namespace {

// glTF component types.
constexpr uint32_t kByte = 5120, kUnsignedByte = 5121, kShort = 5122, kUnsignedShort = 5123, kUnsignedInt = 5125, kFloat = 5126;

/// More elements than any scene that fits in 32-bit indices; keeps every product below in 64 bits.
constexpr uint64_t kMaxElements = 0xffffffffull;
/// Accessors without a buffer view are zeros: nothing in the file bounds their count, so this does.
constexpr uint64_t kMaxZeroElements = 1ull << 24;

uint32_t componentBytes(uint32_t type) {
  switch (type) {
    case kByte:
    case kUnsignedByte:
      return 1;
    case kShort:
    case kUnsignedShort:
      return 2;
    case kUnsignedInt:
    case kFloat:
      return 4;
    default:
      return 0;
  }
}

template <class T>
T load(const std::byte* from) {
  T value;
  std::memcpy(&value, from, sizeof value);
  return value;
}

float loadFloat(const std::byte* from, uint32_t type, bool normalized) {
  switch (type) {
    case kByte: {
      const auto v = static_cast<float>(load<int8_t>(from));
      return normalized ? std::max(v / 127.f, -1.f) : v;
    }
    case kUnsignedByte: {
      const auto v = static_cast<float>(load<uint8_t>(from));
      return normalized ? v / 255.f : v;
    }
    case kShort: {
      const auto v = static_cast<float>(load<int16_t>(from));
      return normalized ? std::max(v / 32767.f, -1.f) : v;
    }
    case kUnsignedShort: {
      const auto v = static_cast<float>(load<uint16_t>(from));
      return normalized ? v / 65535.f : v;
    }
    case kUnsignedInt:
      return static_cast<float>(load<uint32_t>(from));
    default:
      return load<float>(from);
  }
}

uint32_t loadIndex(const std::byte* from, uint32_t type) {
  if (type == kUnsignedByte) return load<uint8_t>(from);
  if (type == kUnsignedShort) return load<uint16_t>(from);
  return load<uint32_t>(from);
}

uint32_t componentCount(std::string_view type) {
  if (type == "SCALAR") return 1;
  if (type == "VEC2") return 2;
  if (type == "VEC3") return 3;
  if (type == "VEC4") return 4;
  return 0;
}

/// `count` elements of `elementBytes`, `stride` apart, from `offset`, inside `bytes`?
bool fits(uint64_t offset, uint64_t count, uint64_t stride, uint64_t elementBytes, uint64_t bytes) {
  if (count == 0) return true;
  if (offset > bytes || elementBytes > bytes - offset) return false;
  return (count - 1) <= (bytes - offset - elementBytes) / stride;
}

}  // namespace

struct Document::Accessor {
  std::string type;
  uint32_t components = 0;
  uint32_t componentType = 0;
  bool normalized = false;
  uint64_t count = 0;
  uint64_t stride = 0;
  const std::byte* first = nullptr;  ///< null: zeros
  uint64_t sparseCount = 0;
  uint32_t sparseIndexType = 0;
  const std::byte* sparseIndices = nullptr;
  const std::byte* sparseValues = nullptr;
  uint64_t elementBytes() const { return static_cast<uint64_t>(components) * componentBytes(componentType); }
};

Document::Accessor Document::describe(size_t index, const Value& use) const {
  const Value json = entry("accessors", index);
  const auto fail = [&](const std::string& message) { use.fail(json.place() + ": " + message + "; export the file again"); };
  Accessor a;
  a.type = json.at("type").text();
  a.components = componentCount(a.type);
  if (a.components == 0) fail("type " + a.type + " has no use here");
  const uint64_t componentType = json.at("componentType").whole();
  a.componentType = componentType <= 0xffff ? static_cast<uint32_t>(componentType) : 0;
  if (componentBytes(a.componentType) == 0) fail("componentType " + std::to_string(componentType) + " is unknown");
  a.normalized = json.flagOr("normalized", false);
  a.count = json.at("count").whole();
  if (a.count > kMaxElements) fail("count " + std::to_string(a.count) + " is beyond 32 bits");

  const size_t viewCount = count("bufferViews");
  if (const auto view = json.indexOr("bufferView", viewCount, "bufferViews")) {
    const auto bytes = bufferView(*view);
    const Value viewJson = entry("bufferViews", *view);
    a.stride = viewJson.wholeOr("byteStride", a.elementBytes());
    if (a.stride < a.elementBytes() || a.stride > 252) {
      fail("byteStride " + std::to_string(a.stride) + " of " + viewJson.place() + " does not suit elements of " +
           std::to_string(a.elementBytes()) + " bytes");
    }
    const uint64_t offset = json.wholeOr("byteOffset", 0);
    if (!fits(offset, a.count, a.stride, a.elementBytes(), bytes.size())) {
      fail(std::to_string(a.count) + " elements of " + std::to_string(a.elementBytes()) + " bytes from byte " + std::to_string(offset) +
           " end beyond " + viewJson.place() + ", which has " + std::to_string(bytes.size()) + " bytes");
    }
    a.first = bytes.data() + offset;
  } else if (a.count > kMaxZeroElements) {
    fail("has no bufferView, so all its " + std::to_string(a.count) + " elements would be zero");
  }

  if (const auto sparse = json.findObject("sparse")) {
    a.sparseCount = sparse->at("count").whole();
    if (a.sparseCount > a.count) fail("sparse.count " + std::to_string(a.sparseCount) + " is above count " + std::to_string(a.count));
    const Value indices = sparse->at("indices"), values = sparse->at("values");
    const uint64_t indexType = indices.at("componentType").whole();
    if (indexType != kUnsignedByte && indexType != kUnsignedShort && indexType != kUnsignedInt)
      fail("sparse.indices.componentType is no index type");
    a.sparseIndexType = static_cast<uint32_t>(indexType);
    const auto slice = [&](const Value& part, uint64_t bytesEach) {
      const auto bytes = bufferView(part.index("bufferView", viewCount, "bufferViews"));
      const uint64_t offset = part.wholeOr("byteOffset", 0);
      if (!fits(offset, a.sparseCount, bytesEach, bytesEach, bytes.size())) fail("sparse data ends beyond its bufferView");
      return bytes.data() + offset;
    };
    a.sparseIndices = slice(indices, componentBytes(a.sparseIndexType));
    a.sparseValues = slice(values, a.elementBytes());
    uint64_t next = 0;
    for (uint64_t i = 0; i < a.sparseCount; ++i) {
      const uint64_t at = loadIndex(a.sparseIndices + i * componentBytes(a.sparseIndexType), a.sparseIndexType);
      if (at >= a.count || at < next)
        fail("sparse.indices[" + std::to_string(i) + "] = " + std::to_string(at) + " is out of range or out of order");
      next = at + 1;
    }
  }
  return a;
}

template <class Store>
void Document::forEachComponent(const Accessor& a, Store store) const {
  const uint32_t bytes = componentBytes(a.componentType);
  if (a.first != nullptr) {
    for (uint64_t i = 0; i < a.count; ++i) {
      for (uint32_t c = 0; c < a.components; ++c) store(i * a.components + c, a.first + i * a.stride + c * bytes);
    }
  }
  for (uint64_t k = 0; k < a.sparseCount; ++k) {
    const uint64_t i = loadIndex(a.sparseIndices + k * componentBytes(a.sparseIndexType), a.sparseIndexType);
    for (uint32_t c = 0; c < a.components; ++c) store(i * a.components + c, a.sparseValues + k * a.elementBytes() + c * bytes);
  }
}

FloatData Document::readFloats(size_t accessor, std::string_view type, const Value& use) const {
  const Accessor a = describe(accessor, use);
  if (type.find(a.type) == std::string_view::npos)
    use.fail("accessors[" + std::to_string(accessor) + "] is " + a.type + ", should be " + std::string(type) + "; export the file again");
  FloatData data;
  data.components = a.components;
  data.values.assign(a.count * a.components, 0.f);
  forEachComponent(a, [&](uint64_t at, const std::byte* from) { data.values[at] = loadFloat(from, a.componentType, a.normalized); });
  return data;
}

std::vector<uint32_t> Document::readIndices(size_t accessor, const Value& use) const {
  const Accessor a = describe(accessor, use);
  if (a.type != "SCALAR" || a.componentType == kByte || a.componentType == kShort || a.componentType == kFloat) {
    use.fail("accessors[" + std::to_string(accessor) + "] does not hold unsigned integers; export the file again");
  }
  std::vector<uint32_t> indices(a.count, 0u);
  forEachComponent(a, [&](uint64_t at, const std::byte* from) { indices[at] = loadIndex(from, a.componentType); });
  return indices;
}

}  // namespace radivox::scene::gltf
