// A glTF file in memory: tinygltf's model of it, checked, and its numbers and images decoded. Internal to engine/scene.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/scene/gltf_tinygltf.h"

namespace radivox::scene::gltf {

/// Numbers of one accessor, decoded.
struct FloatData {
  uint32_t components = 0;
  std::vector<float> values;
  size_t count() const { return components == 0 ? 0 : values.size() / components; }
};

/// Counts equal warnings, so that a thousand bad meshes make one line.
class Warnings {
 public:
  void add(const std::string& message, uint64_t times = 1) { counts_[message] += times; }
  /// "3 × message" in the order of the text.
  void appendTo(std::vector<std::string>& lines) const;

 private:
  std::map<std::string, uint64_t> counts_;
};

class Document {
 public:
  /// Reads the file and its buffers, checks container, types, asset version and required extensions. Throws BadInput.
  explicit Document(const std::string& path);
  Document(const Document&) = delete;
  Document& operator=(const Document&) = delete;

  const std::string& path() const { return path_; }
  /// Types and indices are right (gltf_check.h); what lies in buffers is checked when it is read.
  const tinygltf::Model& model() const { return model_; }
  /// Throws BadInput naming file and place.
  [[noreturn]] void fail(const std::string& place, const std::string& message) const;

  /// accessors[index] as floats: floats, normalized or plain integers, sparse or not. `types` lists what it may be ("VEC3 VEC4"),
  /// `place` says who reads it.
  FloatData readFloats(int accessor, std::string_view types, const std::string& place) const;
  std::vector<uint32_t> readIndices(int accessor, const std::string& place) const;
  /// The encoded bytes of images[index]; empty when they could not be read, and why is a warning.
  std::span<const unsigned char> image(size_t index) const;
  /// `images[3] ("wall.png")`
  std::string describeImage(size_t index) const;
  std::string imageFile(size_t index) const;  ///< "" when it is in the file itself

  Warnings warnings;

 private:
  struct Accessor;
  struct Loader;
  std::span<const std::byte> splitContainer(std::span<const std::byte> file);
  void checkExtensions(const nlohmann::json& root);
  void adaptForTinygltf(nlohmann::json& root);
  void adaptImages(nlohmann::json& root);
  void load(const nlohmann::json& root);
  std::optional<std::vector<unsigned char>> readUri(const std::string& uri, std::string& problem) const;
  void readBuffer(size_t index, uint64_t byteLength, std::vector<unsigned char>& out) const;
  void decompressViews();
  void decompressPrimitives();
  std::span<const std::byte> bufferView(size_t index) const;
  std::span<const std::byte> slice(size_t buffer, size_t offset, size_t length, const std::string& place) const;
  Accessor describe(int index, std::string_view types, const std::string& place) const;
  template <class Store>
  void forEachComponent(const Accessor& accessor, Store store) const;

  std::string path_;
  std::vector<unsigned char> bytes_;  ///< the file; empty once it is loaded
  std::optional<std::span<const std::byte>> binaryChunk_;
  std::vector<std::string> bufferUris_, imageUris_;
  std::vector<uint64_t> bufferLengths_;
  std::vector<bool> wantedImages_;
  size_t noView_ = 0;  ///< the view given to accessors that have none (gltf_document.cpp)
  tinygltf::Model model_;
};

/// "meshes[3]"
std::string placeOf(std::string_view table, size_t index);

/// Extension values. The checks have seen to their types.
const tinygltf::Value* findExtension(const tinygltf::ExtensionMap& extensions, const std::string& name);
double numberOr(const tinygltf::Value& object, const std::string& key, double fallback);
template <size_t N>
std::array<double, N> numbersOr(const tinygltf::Value& object, const std::string& key, std::array<double, N> fallback) {
  if (!object.Has(key)) return fallback;
  for (size_t i = 0; i < N; ++i) fallback[i] = object.Get(key).Get(static_cast<int>(i)).GetNumberAsDouble();
  return fallback;
}

/// The whole file. Throws BadInput (missing, a directory, unreadable).
std::vector<unsigned char> readFile(const std::string& path);

}  // namespace radivox::scene::gltf
