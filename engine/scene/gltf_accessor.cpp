// Accessors: typed, strided, sparse views of buffers. All ranges are checked in 64 bits before a byte is read.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "engine/scene/gltf_document.h"

namespace radivox::scene::gltf {

namespace {

// glTF component types.
constexpr int kByte = TINYGLTF_COMPONENT_TYPE_BYTE, kUnsignedByte = TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE;
constexpr int kShort = TINYGLTF_COMPONENT_TYPE_SHORT, kUnsignedShort = TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT;
constexpr int kUnsignedInt = TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, kFloat = TINYGLTF_COMPONENT_TYPE_FLOAT;

/// More elements than any scene that fits in 32-bit indices; keeps every product below in 64 bits.
constexpr uint64_t kMaxElements = 0xffffffffull;
/// Accessors without a buffer view are zeros: nothing in the file bounds their count, so this does.
constexpr uint64_t kMaxZeroElements = 1ull << 24;

uint64_t componentBytes(int type) { return static_cast<uint64_t>(tinygltf::GetComponentSizeInBytes(static_cast<uint32_t>(type))); }

template <class T>
T load(const std::byte* from) {
  T value;
  std::memcpy(&value, from, sizeof value);
  return value;
}

float loadFloat(const std::byte* from, int type, bool normalized) {
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

uint32_t loadIndex(const std::byte* from, int type) {
  if (type == kUnsignedByte) return load<uint8_t>(from);
  if (type == kUnsignedShort) return load<uint16_t>(from);
  return load<uint32_t>(from);
}

std::string_view typeName(int type) {
  switch (type) {
    case TINYGLTF_TYPE_SCALAR:
      return "SCALAR";
    case TINYGLTF_TYPE_VEC2:
      return "VEC2";
    case TINYGLTF_TYPE_VEC3:
      return "VEC3";
    case TINYGLTF_TYPE_VEC4:
      return "VEC4";
    case TINYGLTF_TYPE_MAT4:
      return "MAT4";
    default:
      return type == TINYGLTF_TYPE_MAT2 ? "MAT2" : "MAT3";
  }
}

/// `count` elements of `elementBytes`, `stride` apart, from `offset`, inside `bytes`?
bool fits(uint64_t offset, uint64_t count, uint64_t stride, uint64_t elementBytes, uint64_t bytes) {
  if (count == 0) return true;
  if (offset > bytes || elementBytes > bytes - offset) return false;
  return (count - 1) <= (bytes - offset - elementBytes) / stride;
}

}  // namespace

struct Document::Accessor {
  uint64_t components = 0;
  int componentType = 0;
  bool normalized = false;
  uint64_t count = 0;
  uint64_t stride = 0;
  const std::byte* first = nullptr;  ///< null: zeros
  uint64_t sparseCount = 0;
  int sparseIndexType = 0;
  const std::byte* sparseIndices = nullptr;
  const std::byte* sparseValues = nullptr;
  uint64_t elementBytes() const { return components * componentBytes(componentType); }
};

Document::Accessor Document::describe(int index, std::string_view types, const std::string& place) const {
  const tinygltf::Accessor& source = model_.accessors[static_cast<size_t>(index)];
  const std::string name = placeOf("accessors", static_cast<size_t>(index));
  const auto refuse = [&](const std::string& message) { fail(place, name + ": " + message + "; export the file again"); };
  const std::string_view type = typeName(source.type);
  if (type.starts_with("MAT") && types.find(type) == std::string_view::npos) refuse("type " + std::string(type) + " has no use here");
  Accessor a;
  a.components = static_cast<uint64_t>(tinygltf::GetNumComponentsInType(static_cast<uint32_t>(source.type)));
  a.componentType = source.componentType;
  if (a.componentType == TINYGLTF_COMPONENT_TYPE_INT || a.componentType > kFloat)
    refuse("componentType " + std::to_string(a.componentType) + " is unknown");
  a.normalized = source.normalized;
  a.count = source.count;
  if (a.count > kMaxElements) refuse("count " + std::to_string(a.count) + " is beyond 32 bits");

  if (const auto viewIndex = static_cast<size_t>(source.bufferView); viewIndex != noView_) {
    const auto bytes = bufferView(viewIndex);
    const std::string viewName = placeOf("bufferViews", viewIndex);
    const uint64_t stride = model_.bufferViews[viewIndex].byteStride;
    a.stride = stride == 0 ? a.elementBytes() : stride;
    if (a.stride < a.elementBytes()) {
      refuse("byteStride " + std::to_string(a.stride) + " of " + viewName + " does not suit elements of " +
             std::to_string(a.elementBytes()) + " bytes");
    }
    if (!fits(source.byteOffset, a.count, a.stride, a.elementBytes(), bytes.size())) {
      refuse(std::to_string(a.count) + " elements of " + std::to_string(a.elementBytes()) + " bytes from byte " +
             std::to_string(source.byteOffset) + " end beyond " + viewName + ", which has " + std::to_string(bytes.size()) + " bytes");
    }
    a.first = bytes.data() + source.byteOffset;
  } else if (a.count > kMaxZeroElements) {
    refuse("has no bufferView, so all its " + std::to_string(a.count) + " elements would be zero");
  }

  if (source.sparse.isSparse) {
    a.sparseCount = static_cast<uint64_t>(source.sparse.count);
    if (a.sparseCount > a.count) refuse("sparse.count " + std::to_string(a.sparseCount) + " is above count " + std::to_string(a.count));
    a.sparseIndexType = source.sparse.indices.componentType;
    if (a.sparseIndexType != kUnsignedByte && a.sparseIndexType != kUnsignedShort && a.sparseIndexType != kUnsignedInt)
      refuse("sparse.indices.componentType is no index type");
    const auto slice = [&](const auto& part, uint64_t bytesEach) {
      const auto bytes = bufferView(static_cast<size_t>(part.bufferView));
      const auto offset = static_cast<uint64_t>(part.byteOffset);
      if (!fits(offset, a.sparseCount, bytesEach, bytesEach, bytes.size())) refuse("sparse data ends beyond its bufferView");
      return bytes.data() + offset;
    };
    a.sparseIndices = slice(source.sparse.indices, componentBytes(a.sparseIndexType));
    a.sparseValues = slice(source.sparse.values, a.elementBytes());
    uint64_t next = 0;
    for (uint64_t i = 0; i < a.sparseCount; ++i) {
      const uint64_t at = loadIndex(a.sparseIndices + i * componentBytes(a.sparseIndexType), a.sparseIndexType);
      if (at >= a.count || at < next)
        refuse("sparse.indices[" + std::to_string(i) + "] = " + std::to_string(at) + " is out of range or out of order");
      next = at + 1;
    }
  }
  if (types.find(type) == std::string_view::npos)
    fail(place, name + " is " + std::string(type) + ", should be " + std::string(types) + "; export the file again");
  return a;
}

template <class Store>
void Document::forEachComponent(const Accessor& a, Store store) const {
  const uint64_t bytes = componentBytes(a.componentType);
  if (a.first != nullptr) {
    for (uint64_t i = 0; i < a.count; ++i) {
      for (uint64_t c = 0; c < a.components; ++c) store(i * a.components + c, a.first + i * a.stride + c * bytes);
    }
  }
  for (uint64_t k = 0; k < a.sparseCount; ++k) {
    const uint64_t i = loadIndex(a.sparseIndices + k * componentBytes(a.sparseIndexType), a.sparseIndexType);
    for (uint64_t c = 0; c < a.components; ++c) store(i * a.components + c, a.sparseValues + k * a.elementBytes() + c * bytes);
  }
}

FloatData Document::readFloats(int accessor, std::string_view types, const std::string& place) const {
  const Accessor a = describe(accessor, types, place);
  FloatData data;
  data.components = static_cast<uint32_t>(a.components);
  data.values.assign(a.count * a.components, 0.f);
  forEachComponent(a, [&](uint64_t at, const std::byte* from) { data.values[at] = loadFloat(from, a.componentType, a.normalized); });
  return data;
}

std::vector<uint32_t> Document::readIndices(int accessor, const std::string& place) const {
  const Accessor a = describe(accessor, "SCALAR", place);
  if (a.componentType == kByte || a.componentType == kShort || a.componentType == kFloat) {
    fail(place, placeOf("accessors", static_cast<size_t>(accessor)) + " does not hold unsigned integers; export the file again");
  }
  std::vector<uint32_t> indices(a.count, 0u);
  forEachComponent(a, [&](uint64_t at, const std::byte* from) { indices[at] = loadIndex(from, a.componentType); });
  return indices;
}

}  // namespace radivox::scene::gltf
