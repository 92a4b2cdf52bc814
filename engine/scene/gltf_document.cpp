// A .gltf or .glb through tinygltf 2.7: container and URIs here, where that is lax, the rest in its model. Accessors are read in
// gltf_accessor.cpp, compressed data in gltf_compressed.cpp.
#include "engine/scene/gltf_document.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>

#include "engine/error.h"
#include "engine/scene/gltf_check.h"
#include "engine/scene/gltf_compressed.h"

namespace radivox::scene::gltf {

namespace {

using nlohmann::json;

constexpr uint32_t kMagic = 0x46546c67;      // "glTF"
constexpr uint32_t kJsonChunk = 0x4e4f534a;  // "JSON"
constexpr uint32_t kBinaryChunk = 0x004e4942;

/// Extensions whose meaning the importer honours, or reads as the nearest diffuse surface.
constexpr std::string_view kSupported[] = {"KHR_lights_punctual",   "KHR_materials_emissive_strength",     "KHR_materials_unlit",
                                           "KHR_mesh_quantization", "KHR_materials_pbrSpecularGlossiness", "KHR_texture_transform",
                                           "KHR_materials_variants"};  // variants: the default one is shown

uint32_t readWord(std::span<const std::byte> bytes, size_t offset) {
  uint32_t word = 0;
  std::memcpy(&word, bytes.data() + offset, sizeof word);
  return word;
}

bool isSupported(std::string_view name) {
  return std::find(std::begin(kSupported), std::end(kSupported), name) != std::end(kSupported) || canDecompress(name);
}

/// %41 → A. Nothing when an escape is broken. Not tinygltf's: that makes spaces of plus signs and zeros of broken escapes.
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
    out.push_back(static_cast<char>(digit(text[i + 1]) * 16 + digit(text[i + 2])));
    i += 2;
  }
  return out;
}

bool isDataUri(std::string_view uri) { return uri.starts_with("data:"); }

std::string uriForMessages(const std::string& uri) { return isDataUri(uri) ? "the data URI" : "\"" + uri + "\""; }

template <class Use>
void forEachEntry(json& root, const char* place, Use use) {
  const json::json_pointer pointer(place);
  if (!root.contains(pointer)) return;
  for (json& entry : root[pointer]) use(entry);
}

/// Calls `use` with every texture info that the importer reads (gltf_materials.cpp).
template <class Use>
void forEachTextureInfo(json& root, Use use) {
  static const json::json_pointer kPlaces[] = {json::json_pointer("/pbrMetallicRoughness/baseColorTexture"),
                                               json::json_pointer("/emissiveTexture"),
                                               json::json_pointer("/extensions/KHR_materials_pbrSpecularGlossiness/diffuseTexture")};
  forEachEntry(root, "/materials", [&](const json& material) {
    for (const auto& place : kPlaces) {
      if (material.contains(place)) use(material[place]);
    }
  });
}

bool isCompressed(const json& view) {
  return view.contains("extensions") &&
         (view["extensions"].contains("EXT_meshopt_compression") || view["extensions"].contains("KHR_meshopt_compression"));
}

}  // namespace

std::vector<unsigned char> readFile(const std::string& path) {
  std::error_code ignored;
  const auto status = std::filesystem::status(path, ignored);
  if (status.type() == std::filesystem::file_type::not_found) failAt(path, "", "no such file; check the path");
  if (std::filesystem::is_directory(status)) failAt(path, "", "is a directory; name the .gltf or .glb file in it");
  if (!std::filesystem::is_regular_file(status)) failAt(path, "", "is not a regular file; name a .gltf or .glb file");
  std::ifstream in(path, std::ios::binary);
  const auto size = std::filesystem::file_size(path, ignored);
  if (!in || ignored) failAt(path, "", "cannot be opened; check its permissions");
  std::vector<unsigned char> bytes(size);
  if (size > 0) in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
  if (!in) failAt(path, "", "cannot be read to its end; check the disk, copy it again");
  return bytes;
}

std::string placeOf(std::string_view table, size_t index) { return std::string(table) + "[" + std::to_string(index) + "]"; }

const tinygltf::Value* findExtension(const tinygltf::ExtensionMap& extensions, const std::string& name) {
  const auto found = extensions.find(name);
  return found == extensions.end() ? nullptr : &found->second;
}

double numberOr(const tinygltf::Value& object, const std::string& key, double fallback) {
  return object.Has(key) ? object.Get(key).GetNumberAsDouble() : fallback;
}

void Warnings::appendTo(std::vector<std::string>& lines) const {
  for (const auto& [message, times] : counts_) lines.push_back(times > 1 ? std::to_string(times) + " × " + message : message);
}

/// What tinygltf asks for while it loads. All URIs it gets are places ("buffers[3]"), so it never chooses a file by itself.
struct Document::Loader {
  static size_t indexOf(const std::string& place) { return std::strtoull(place.c_str() + place.find('[') + 1, nullptr, 10); }

  static bool exists(const std::string& place, void* user) {
    const auto& document = *static_cast<const Document*>(user);
    return place.starts_with("buffers") || document.wantedImages_[indexOf(place)];
  }

  static std::string expand(const std::string& place, void*) { return place; }

  static bool read(std::vector<unsigned char>* out, std::string*, const std::string& place, void* user) {
    auto& document = *static_cast<Document*>(user);
    const size_t index = indexOf(place);
    if (place.starts_with("buffers")) {
      document.readBuffer(index, document.bufferLengths_[index], *out);
      return true;
    }
    std::string problem;
    if (auto bytes = document.readUri(document.imageUris_[index], problem)) *out = std::move(*bytes);
    if (!out->empty()) return true;
    document.warnings.add(document.describeImage(index) + " " + (problem.empty() ? "is missing or empty" : problem) +
                          ", its texture is left out; put it beside the .gltf, or export as .glb");
    return false;
  }

  static bool write(std::string*, const std::string&, const std::vector<unsigned char>&, void*) { return false; }

  /// Keeps the encoded bytes: decoded when a material wants them, after a look at their size (gltf_images.cpp).
  static bool image(tinygltf::Image* image, int, std::string*, std::string*, int, int, const unsigned char* bytes, int size, void*) {
    image->as_is = true;
    if (size > 0) image->image.assign(bytes, bytes + size);
    return true;
  }
};

Document::Document(const std::string& path) : path_(path), bytes_(readFile(path)) {
  const auto all = std::as_bytes(std::span(bytes_));
  const std::span<const std::byte> text = splitContainer(all);
  json root = parseJson(path_, text, static_cast<size_t>(text.data() - all.data()));
  checkJson(path_, root);
  checkExtensions(root);
  adaptForTinygltf(root);
  load(root);
  decompressViews();
  decompressPrimitives();
}

void Document::fail(const std::string& place, const std::string& message) const { failAt(path_, place, message); }

/// The JSON's bytes; finds the binary chunk. Not tinygltf's: its last chunk may end 8 bytes behind the file, and it refuses binary chunks
/// that are not a multiple of 4 bytes or come after another chunk.
std::span<const std::byte> Document::splitContainer(std::span<const std::byte> file) {
  if (file.empty()) fail("", "is empty; export it again");
  if (file.size() < 4 || readWord(file, 0) != kMagic) {
    // A byte order mark or white space may precede the brace; anything else is another format.
    const std::string_view text(reinterpret_cast<const char*>(file.data()), file.size());
    const size_t start = text.find_first_not_of("\xef\xbb\xbf \t\r\n");
    if (start == std::string_view::npos || text[start] != '{')
      fail("", "is neither GLB (no \"glTF\" at its start) nor JSON; name a .gltf or .glb file");
    return file;
  }
  if (file.size() < 20) fail("", "ends inside the GLB header (" + std::to_string(file.size()) + " bytes); copy or export it again");
  if (readWord(file, 4) != 2) fail("", "is GLB version " + std::to_string(readWord(file, 4)) + "; export it as glTF 2.0");
  const uint64_t length = readWord(file, 8);
  if (length > file.size()) {
    fail("", "is truncated: its GLB header declares " + std::to_string(length) + " bytes, the file has " + std::to_string(file.size()) +
                 "; copy or export it again");
  }
  if (length < file.size()) warnings.add(std::to_string(file.size() - length) + " bytes after the declared end of the file are ignored");
  const uint64_t jsonBytes = readWord(file, 12);
  if (readWord(file, 16) != kJsonChunk) fail("byte 16", "the first GLB chunk is not JSON; export it again");
  if (length < 20 || jsonBytes > length - 20) fail("byte 12", "the JSON chunk is longer than the file; copy or export it again");
  for (uint64_t offset = 20 + jsonBytes; !binaryChunk_ && offset + 8 <= length;) {
    const uint64_t chunkBytes = readWord(file, offset);
    if (chunkBytes > length - offset - 8) {
      fail("byte " + std::to_string(offset),
           "a GLB chunk of " + std::to_string(chunkBytes) + " bytes is longer than the file; copy or export it again");
    }
    if (readWord(file, offset + 4) == kBinaryChunk) binaryChunk_ = file.subspan(offset + 8, chunkBytes);
    offset += 8 + chunkBytes;
  }
  return file.subspan(20, jsonBytes);
}

void Document::checkExtensions(const json& root) {
  const auto list = [&](const char* key) { return root.value(key, std::vector<std::string>()); };
  const std::vector<std::string> required = list("extensionsRequired");
  for (size_t i = 0; i < required.size(); ++i) {
    if (isSupported(required[i])) continue;
    fail(placeOf("extensionsRequired", i), "the file requires " + required[i] + ", which is not supported; export it without " +
                                               (isCompression(required[i]) ? "mesh compression" : "it"));
  }
  for (const std::string& name : list("extensionsUsed")) {
    if (!isSupported(name)) warnings.add("extension " + name + " is not supported; what it adds is left out");
  }
}

/// Makes of a legal file one that tinygltf loads, and one that it loads safely: it reads any file that a URI names, wants buffers of
/// exactly the declared length, refuses index accessors without a view (Draco's have none) and lenses without all their numbers, and
/// points images at unchecked ranges.
void Document::adaptForTinygltf(json& root) {
  if (root.contains("animations")) warnings.add("animations are left out, the rest pose is used");
  root.erase("animations");
  for (const char* table : {"buffers", "bufferViews"}) {
    if (!root.contains(table)) root[table] = json::array();
  }
  for (size_t i = 0; i < root["buffers"].size(); ++i) {
    json& buffer = root["buffers"][i];
    bufferUris_.push_back(buffer.value("uri", ""));
    // The fallback buffer of compressed data has no bytes: legal until somebody reads from it. tinygltf wants one byte at least.
    const bool isEmpty = !buffer.contains("uri") && !(i == 0 && binaryChunk_) && buffer.contains("extensions");
    if (isEmpty || buffer["byteLength"] == 0u) {
      bufferUris_.back() = "data:;base64,AA==";
      buffer["byteLength"] = 1u;
    }
    bufferLengths_.push_back(buffer["byteLength"].get<uint64_t>());
    buffer["uri"] = placeOf("buffers", i);
  }
  for (size_t i = 0; i < root["bufferViews"].size(); ++i) {
    const uint64_t stride = root["bufferViews"][i].value("byteStride", uint64_t{0});
    if (stride % 4 == 0 && stride <= 252) continue;
    fail(placeOf("bufferViews", i) + ".byteStride",
         "is " + std::to_string(stride) + ", should be a multiple of 4 up to 252; export the file again");
  }
  adaptImages(root);
  noView_ = root["bufferViews"].size();
  root["bufferViews"].push_back({{"buffer", 0}, {"byteLength", 1}});
  forEachEntry(root, "/accessors", [&](json& accessor) { accessor.emplace("bufferView", noView_); });
  forEachEntry(root, "/cameras", [](json& camera) {
    json& lens = camera[camera["type"].get<std::string>()];
    for (const char* key : {"yfov", "xmag", "ymag", "znear", "zfar"}) lens.emplace(key, 0.0);
  });
  forEachEntry(root, "/extensions/KHR_lights_punctual/lights", [](json& light) { light.emplace("spot", json::object()); });
}

/// Images that no material uses are not read.
void Document::adaptImages(json& root) {
  if (!root.contains("images")) return;
  wantedImages_.assign(root["images"].size(), false);
  forEachTextureInfo(root, [&](const json& info) {
    const json& texture = root["textures"][info["index"].get<size_t>()];
    if (texture.contains("source")) wantedImages_[texture["source"].get<size_t>()] = true;
  });
  for (size_t i = 0; i < wantedImages_.size(); ++i) {
    json& image = root["images"][i];
    imageUris_.push_back(image.value("uri", ""));
    image.erase("uri");
    if (image.contains("bufferView")) imageUris_.back().clear();
    if (wantedImages_[i] && image.contains("bufferView")) {
      const size_t index = image["bufferView"].get<size_t>();
      const json& view = root["bufferViews"][index];
      const uint64_t offset = view.value("byteOffset", uint64_t{0}), length = view["byteLength"].get<uint64_t>();
      const uint64_t size = bufferLengths_[view["buffer"].get<size_t>()];
      if (offset < size && length <= size - offset && length > 0 && !isCompressed(view)) continue;
      fail(placeOf("images", i),
           "its bytes end beyond the buffer of bufferViews[" + std::to_string(index) + "]; copy or export the file again");
    }
    image.erase("bufferView");
    image["uri"] = placeOf("images", i);
  }
}

void Document::load(const json& root) {
  tinygltf::TinyGLTF loader;
  loader.SetFsCallbacks({Loader::exists, Loader::expand, Loader::read, Loader::write, this});
  loader.SetImageLoader(Loader::image, nullptr);
  const std::string text = root.dump();
  if (text.size() > std::numeric_limits<unsigned int>::max()) fail("", "its JSON is beyond 4 GiB; export it as .glb");
  std::string error, ignored;
  if (!loader.LoadASCIIFromString(&model_, &error, &ignored, text.c_str(), static_cast<unsigned int>(text.size()), "")) {
    fail("", error.substr(0, std::min<size_t>(error.find('\n'), 200)) + " (tinygltf); export the file again");
  }
  // Each of these would be an accident of tinygltf's that the checks did not foresee; places and indices count on the lengths.
  const auto expect = [&](const char* table, size_t count) {
    if (count != (root.contains(table) ? root[table].size() : 0)) fail(table, "not all of them can be read; export the file again");
  };
  expect("accessors", model_.accessors.size());
  expect("nodes", model_.nodes.size());
  expect("meshes", model_.meshes.size());
  for (size_t m = 0; m < model_.meshes.size(); ++m) {
    if (model_.meshes[m].primitives.size() != root["meshes"][m]["primitives"].size())
      fail(placeOf("meshes", m) + ".primitives", "not all of them can be read; export the file again");
  }
  bytes_ = {};
  binaryChunk_.reset();
}

/// Bytes of a data URI or of a file beside this one. Nothing and no problem: there is no such file.
std::optional<std::vector<unsigned char>> Document::readUri(const std::string& uri, std::string& problem) const {
  const auto refuse = [&](const std::string& why) {
    problem = why;
    return std::nullopt;
  };
  if (uri.empty()) return refuse("has neither a uri nor a bufferView");
  if (isDataUri(uri)) {
    const size_t comma = uri.find(',');
    if (comma == std::string::npos || !uri.substr(0, comma).ends_with(";base64")) return refuse("is a data URI that is not base64");
    // tinygltf knows seven kinds of data URI by name and stops at the first strange character without a word.
    const size_t end = uri.find_last_not_of('=') + 1;
    const auto isDigit = [](unsigned char c) { return std::isalnum(c) != 0 || c == '+' || c == '/'; };
    if ((end - comma - 1) % 4 == 1 ||
        !std::all_of(uri.begin() + static_cast<std::ptrdiff_t>(comma) + 1, uri.begin() + static_cast<std::ptrdiff_t>(end), isDigit))
      return refuse("holds broken base64");
    std::vector<unsigned char> bytes;
    std::string mimeType;
    tinygltf::DecodeDataURI(&bytes, mimeType, "data:application/octet-stream;base64," + uri.substr(comma + 1), 0, false);
    return bytes;
  }
  const auto name = decodePercent(uri);
  if (!name || name->empty() || name->find('\0') != std::string::npos) return refuse("is no file name");
  if (name->find("://") != std::string::npos || std::filesystem::path(*name).is_absolute())
    return refuse(uriForMessages(uri) + " is not a file beside this one");
  const std::string path = (std::filesystem::path(path_).parent_path() / *name).string();
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return std::nullopt;
  return readFile(path);
}

void Document::readBuffer(size_t index, uint64_t byteLength, std::vector<unsigned char>& out) const {
  const std::string place = placeOf("buffers", index);
  const std::string& uri = bufferUris_[index];
  std::string source = "the GLB's binary chunk";
  if (!uri.empty()) {
    source = uriForMessages(uri);
    std::string problem;
    auto bytes = readUri(uri, problem);
    if (!bytes && problem.empty())
      fail(place + ".uri", "external buffer " + source + " is missing; put it beside the .gltf, or export as .glb");
    if (!bytes) fail(place + ".uri", problem + "; correct it or export the file as .glb");
    out = std::move(*bytes);
  } else if (index == 0 && binaryChunk_) {
    const auto* first = reinterpret_cast<const unsigned char*>(binaryChunk_->data());
    out.assign(first, first + std::min<uint64_t>(binaryChunk_->size(), byteLength));
  } else {
    fail(place, "has neither a uri nor a GLB binary chunk; export the file again");
  }
  if (byteLength > out.size()) {
    fail(place + ".byteLength",
         "is " + std::to_string(byteLength) + ", but " + source + " has " + std::to_string(out.size()) + " bytes; copy or export it again");
  }
  out.resize(byteLength);
}

std::span<const std::byte> Document::bufferView(size_t index) const {
  const tinygltf::BufferView& view = model_.bufferViews[index];
  return slice(static_cast<size_t>(view.buffer), view.byteOffset, view.byteLength, placeOf("bufferViews", index));
}

std::span<const std::byte> Document::slice(size_t index, size_t offset, size_t length, const std::string& place) const {
  const auto buffer = std::as_bytes(std::span(model_.buffers[index].data));
  if (offset > buffer.size() || length > buffer.size() - offset) {
    fail(place, "bytes " + std::to_string(offset) + " + " + std::to_string(length) + " end beyond " + placeOf("buffers", index) +
                    ", which has " + std::to_string(buffer.size()) + "; copy or export the file again");
  }
  return buffer.subspan(offset, length);
}

std::span<const unsigned char> Document::image(size_t index) const { return model_.images[index].image; }

std::string Document::describeImage(size_t index) const {
  const std::string& uri = imageUris_[index];
  return placeOf("images", index) + (uri.empty() ? "" : " (" + uriForMessages(uri) + ")");
}

std::string Document::imageFile(size_t index) const { return isDataUri(imageUris_[index]) ? "" : imageUris_[index]; }

}  // namespace radivox::scene::gltf
