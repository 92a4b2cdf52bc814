// The container: a .gltf or .glb, its JSON, its buffers. Accessors are read in gltf_accessor.cpp.
#include "engine/scene/gltf_document.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "engine/error.h"

namespace radivox::scene::gltf {

namespace {

constexpr uint32_t kMagic = 0x46546c67;      // "glTF"
constexpr uint32_t kJsonChunk = 0x4e4f534a;  // "JSON"
constexpr uint32_t kBinaryChunk = 0x004e4942;

/// Extensions whose meaning the importer honours, or reads as the nearest diffuse surface.
constexpr std::string_view kSupported[] = {"KHR_lights_punctual",   "KHR_materials_emissive_strength",     "KHR_materials_unlit",
                                           "KHR_mesh_quantization", "KHR_materials_pbrSpecularGlossiness", "KHR_texture_transform"};
constexpr std::string_view kCompressed[] = {"KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression"};

[[noreturn]] void failFile(const std::string& path, const std::string& message) { throw Error(ErrorCode::BadInput, path + ": " + message); }

uint32_t readWord(std::span<const std::byte> bytes, size_t offset) {
  uint32_t word = 0;
  std::memcpy(&word, bytes.data() + offset, sizeof word);
  return word;
}

bool contains(std::span<const std::string_view> names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// %41 → A. Nothing when an escape is broken.
std::optional<std::string> decodePercent(std::string_view text) {
  std::string out;
  const auto digit = [](char c) -> int {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
  };
  for (size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      out.push_back(text[i]);
      continue;
    }
    if (i + 2 >= text.size() || digit(text[i + 1]) < 0 || digit(text[i + 2]) < 0) return std::nullopt;
    const int value = digit(text[i + 1]) * 16 + digit(text[i + 2]);
    if (value == 0) return std::nullopt;  // no file name holds it
    out.push_back(static_cast<char>(value));
    i += 2;
  }
  return out;
}

}  // namespace

std::vector<std::byte> readFile(const std::string& path) {
  std::error_code ignored;
  const auto status = std::filesystem::status(path, ignored);
  if (status.type() == std::filesystem::file_type::not_found) failFile(path, "no such file; check the path");
  if (std::filesystem::is_directory(status)) failFile(path, "is a directory; name the .gltf or .glb file in it");
  if (!std::filesystem::is_regular_file(status)) failFile(path, "is not a regular file; name a .gltf or .glb file");
  std::ifstream in(path, std::ios::binary);
  const auto size = std::filesystem::file_size(path, ignored);
  if (!in || ignored) failFile(path, "cannot be opened; check its permissions");
  std::vector<std::byte> bytes(size);
  if (size > 0) in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
  if (!in) failFile(path, "cannot be read to its end; check the disk, copy it again");
  return bytes;
}

std::optional<std::vector<std::byte>> decodeBase64(std::string_view text) {
  while (!text.empty() && text.back() == '=') text.remove_suffix(1);
  std::vector<std::byte> out;
  out.reserve(text.size() * 3 / 4);
  uint32_t bits = 0;
  int bitCount = 0;
  for (const char c : text) {
    uint32_t value = 0;
    if (c >= 'A' && c <= 'Z')
      value = static_cast<uint32_t>(c - 'A');
    else if (c >= 'a' && c <= 'z')
      value = static_cast<uint32_t>(c - 'a') + 26;
    else if (c >= '0' && c <= '9')
      value = static_cast<uint32_t>(c - '0') + 52;
    else if (c == '+' || c == '-')
      value = 62;
    else if (c == '/' || c == '_')
      value = 63;
    else
      return std::nullopt;
    bits = (bits << 6 | value) & 0xffffffu;
    bitCount += 6;
    if (bitCount >= 8) {
      bitCount -= 8;
      out.push_back(static_cast<std::byte>(bits >> bitCount & 0xffu));
    }
  }
  if (text.size() % 4 == 1) return std::nullopt;
  return out;
}

Document::Document(const std::string& path) : path_(path), bytes_(readFile(path)) {
  const std::span<const std::byte> all(bytes_);
  if (all.empty()) failFile(path, "is empty; export it again");
  std::optional<std::span<const std::byte>> binary;
  if (all.size() >= 4 && readWord(all, 0) == kMagic) {
    if (all.size() < 20) failFile(path, "ends inside the GLB header (" + std::to_string(all.size()) + " bytes); copy or export it again");
    if (readWord(all, 4) != 2) failFile(path, "is GLB version " + std::to_string(readWord(all, 4)) + "; export it as glTF 2.0");
    const uint64_t length = readWord(all, 8);
    if (length > all.size()) {
      failFile(path, "is truncated: its GLB header declares " + std::to_string(length) + " bytes, the file has " +
                         std::to_string(all.size()) + "; copy or export it again");
    }
    if (length < all.size())
      warnings.push_back(std::to_string(all.size() - length) + " bytes after the declared end of the file are ignored");
    const uint64_t jsonBytes = readWord(all, 12);
    if (readWord(all, 16) != kJsonChunk) failFile(path, "byte 16: the first GLB chunk is not JSON; export it again");
    if (length < 20 || jsonBytes > length - 20) failFile(path, "byte 12: the JSON chunk is longer than the file; copy or export it again");
    uint64_t offset = 20 + jsonBytes;
    while (!binary && offset + 8 <= length) {
      const uint64_t chunkBytes = readWord(all, offset);
      if (chunkBytes > length - offset - 8) {
        failFile(path, "byte " + std::to_string(offset) + ": a GLB chunk of " + std::to_string(chunkBytes) +
                           " bytes is longer than the file; copy or export it again");
      }
      if (readWord(all, offset + 4) == kBinaryChunk) binary = all.subspan(offset + 8, chunkBytes);
      offset += 8 + chunkBytes;
    }
    parse(all.subspan(20, jsonBytes), 20);
  } else {
    // A byte order mark or white space may precede the brace; anything else is another format.
    const std::string_view text(reinterpret_cast<const char*>(all.data()), all.size());
    const size_t start = text.find_first_not_of("\xef\xbb\xbf \t\r\n");
    if (start == std::string_view::npos || text[start] != '{') {
      failFile(path, "is neither GLB (no \"glTF\" at its start) nor JSON; name a .gltf or .glb file");
    }
    parse(all, 0);
  }

  const Value top = root();
  const Value asset = top.at("asset");
  const std::string version = asset.at("version").text();
  if (version.rfind("2.", 0) != 0) asset.at("version").fail("is \"" + version + "\"; export the file as glTF 2.0");
  if (const auto required = top.findArray("extensionsRequired")) {
    for (size_t i = 0; i < required->size(); ++i) {
      const std::string name = (*required)[i].text();
      if (contains(kSupported, name)) continue;
      const bool compressed = contains(kCompressed, name);
      (*required)[i].fail("the file requires " + name + ", which is not supported; export it without " +
                          (compressed ? "mesh compression" : "it"));
    }
  }
  if (const auto used = top.findArray("extensionsUsed")) {
    for (size_t i = 0; i < used->size(); ++i) {
      const std::string name = (*used)[i].text();
      if (!contains(kSupported, name)) warnings.push_back("extension " + name + " is not supported; what it adds is left out");
    }
  }
  loadBuffers(binary);
}

void Document::parse(std::span<const std::byte> text, size_t offset) {
  const char* begin = reinterpret_cast<const char*>(text.data());
  try {
    json_ = nlohmann::json::parse(begin, begin + text.size());
  } catch (const nlohmann::json::parse_error& e) {
    failFile(path_, "byte " + std::to_string(offset + e.byte) + ": the JSON is malformed or cut off; copy or export the file again");
  } catch (const nlohmann::json::exception&) {  // numbers beyond double
    failFile(path_, "the JSON holds a number beyond any float; export the file again");
  }
  if (!json_.is_object()) failFile(path_, "the JSON's top level is no object; name a glTF file");
}

size_t Document::count(std::string_view table) const {
  const auto values = root().findArray(table);
  return values ? values->size() : 0;
}

Value Document::entry(std::string_view table, size_t index) const { return root().at(table)[index]; }

std::string Document::uriForMessages(const Value& uri) const {
  const std::string text = uri.text();
  return text.rfind("data:", 0) == 0 ? "the data URI" : "\"" + text + "\"";
}

std::optional<std::vector<std::byte>> Document::readUri(const Value& uri) const {
  const std::string text = uri.text();
  if (text.rfind("data:", 0) == 0) {
    const size_t comma = text.find(',');
    if (comma == std::string::npos || comma < 7 || text.compare(comma - 7, 7, ";base64") != 0)
      uri.fail("is a data URI that is not base64; export the file again");
    auto bytes = decodeBase64(std::string_view(text).substr(comma + 1));
    if (!bytes) uri.fail("holds broken base64; export the file again");
    return bytes;
  }
  const auto name = decodePercent(text);
  if (!name || name->empty() || name->find('\0') != std::string::npos) uri.fail("is no file name; correct it");
  if (name->find("://") != std::string::npos)
    uri.fail("\"" + text + "\" is not a file beside this one; download it and name it relative to this file");
  const std::string path = (std::filesystem::path(path_).parent_path() / *name).string();
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return std::nullopt;
  return readFile(path);
}

void Document::loadBuffers(std::optional<std::span<const std::byte>> binaryChunk) {
  const size_t bufferCount = count("buffers");
  buffers_.reserve(bufferCount);
  for (size_t i = 0; i < bufferCount; ++i) {
    const Value buffer = entry("buffers", i);
    const uint64_t length = buffer.at("byteLength").whole();
    std::span<const std::byte> bytes;
    std::string source = "the GLB's binary chunk";
    if (const auto uri = buffer.find("uri")) {
      source = uriForMessages(*uri);
      auto loaded = readUri(*uri);
      if (!loaded) uri->fail("external buffer " + source + " is missing; put it beside the .gltf, or export as .glb");
      ownedBuffers_.push_back(std::move(*loaded));
      bytes = ownedBuffers_.back();
    } else if (i == 0 && binaryChunk) {
      bytes = *binaryChunk;
    } else if (buffer.has("extensions")) {
      // A compression extension's fallback buffer has no bytes: legal until somebody reads from it.
      buffers_.emplace_back();
      continue;
    } else {
      buffer.fail("has neither a uri nor a GLB binary chunk; export the file again");
    }
    if (length > bytes.size()) {
      buffer.at("byteLength")
          .fail("is " + std::to_string(length) + ", but " + source + " has " + std::to_string(bytes.size()) +
                " bytes; copy or export it again");
    }
    buffers_.push_back(bytes.first(length));
  }
}

std::span<const std::byte> Document::bufferView(size_t index) const {
  const Value view = entry("bufferViews", index);
  const std::span<const std::byte> buffer = buffers_[view.index("buffer", buffers_.size(), "buffers")];
  const uint64_t offset = view.wholeOr("byteOffset", 0);
  const uint64_t length = view.at("byteLength").whole();
  if (offset > buffer.size() || length > buffer.size() - offset) {
    view.fail("bytes " + std::to_string(offset) + " + " + std::to_string(length) + " end beyond buffers[" +
              std::to_string(view.index("buffer", buffers_.size(), "buffers")) + "], which has " + std::to_string(buffer.size()) +
              "; copy or export the file again");
  }
  return buffer.subspan(offset, length);
}

}  // namespace radivox::scene::gltf
