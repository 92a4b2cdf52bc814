// A glTF file in memory: container, JSON, buffers; every look into it is checked and knows its place, so that errors can name it.
// Internal to engine/scene.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace radivox::scene::gltf {

/// A JSON value, its place ("meshes[3].primitives[0]") and the file it is in. All getters throw BadInput naming both.
class Value {
 public:
  Value(const std::string& file, const nlohmann::json& json, std::string place) : file_(&file), json_(&json), place_(std::move(place)) {}
  const std::string& place() const { return place_; }
  const nlohmann::json& json() const { return *json_; }
  [[noreturn]] void fail(const std::string& message) const;

  bool has(std::string_view key) const { return find(key).has_value(); }
  std::optional<Value> find(std::string_view key) const;  ///< nothing when missing; throws when this is no object
  Value at(std::string_view key) const;
  std::optional<Value> findObject(std::string_view key) const;
  std::optional<Value> findArray(std::string_view key) const;
  std::optional<Value> findExtension(std::string_view name) const;

  size_t size() const;  ///< of an array
  Value operator[](size_t i) const;

  double number() const;   ///< finite
  uint64_t whole() const;  ///< an integer ≥ 0 (2.0 counts as one)
  bool flag() const;
  std::string text() const;

  double numberOr(std::string_view key, double fallback) const;
  uint64_t wholeOr(std::string_view key, uint64_t fallback) const;
  bool flagOr(std::string_view key, bool fallback) const;
  std::string textOr(std::string_view key, const std::string& fallback) const;
  /// Exactly N numbers.
  template <size_t N>
  std::array<double, N> numbersOr(std::string_view key, const std::array<double, N>& fallback) const {
    const auto value = find(key);
    if (!value) return fallback;
    if (value->size() != N) value->fail("has " + std::to_string(value->size()) + " numbers instead of " + std::to_string(N));
    std::array<double, N> out{};
    for (size_t i = 0; i < N; ++i) out[i] = (*value)[i].number();
    return out;
  }
  /// An index below `limit` of what `table` names, e.g. "accessors".
  std::optional<size_t> indexOr(std::string_view key, size_t limit, std::string_view table) const;
  size_t index(std::string_view key, size_t limit, std::string_view table) const;

 private:
  const std::string* file_;
  const nlohmann::json* json_;
  std::string place_;
};

/// Numbers of one accessor, decoded.
struct FloatData {
  uint32_t components = 0;
  std::vector<float> values;
  size_t count() const { return components == 0 ? 0 : values.size() / components; }
};

class Document {
 public:
  /// Reads the file and its buffers, checks the container, asset version and required extensions. Throws BadInput.
  explicit Document(const std::string& path);
  Document(const Document&) = delete;
  Document& operator=(const Document&) = delete;

  const std::string& path() const { return path_; }
  Value root() const { return Value(path_, json_, ""); }
  size_t count(std::string_view table) const;  ///< entries of a top-level array; 0 when missing
  Value entry(std::string_view table, size_t index) const;

  /// Bytes of bufferViews[index].
  std::span<const std::byte> bufferView(size_t index) const;
  /// accessors[index] as floats: floats, normalized or plain integers, sparse or not. `use` names who reads it, for errors.
  FloatData readFloats(size_t accessor, std::string_view type, const Value& use) const;
  std::vector<uint32_t> readIndices(size_t accessor, const Value& use) const;
  /// Bytes of a data URI or of a file beside this one; nothing when the file is not there or is no regular file.
  std::optional<std::vector<std::byte>> readUri(const Value& uri) const;
  std::string uriForMessages(const Value& uri) const;

  std::vector<std::string> warnings;  ///< about the container

 private:
  struct Accessor;
  void parse(std::span<const std::byte> text, size_t offset);
  void loadBuffers(std::optional<std::span<const std::byte>> binaryChunk);
  Accessor describe(size_t index, const Value& use) const;
  template <class Store>
  void forEachComponent(const Accessor& accessor, Store store) const;

  std::string path_;
  std::vector<std::byte> bytes_;
  nlohmann::json json_;
  std::vector<std::vector<std::byte>> ownedBuffers_;
  std::vector<std::span<const std::byte>> buffers_;
};

/// The whole file. Throws BadInput (missing, a directory, unreadable).
std::vector<std::byte> readFile(const std::string& path);
/// Nothing when `text` is no base64.
std::optional<std::vector<std::byte>> decodeBase64(std::string_view text);

}  // namespace radivox::scene::gltf
