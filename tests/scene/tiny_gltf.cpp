#include "tests/scene/tiny_gltf.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>

namespace radivox::tests {

TempFolder::TempFolder() {
  std::string pattern = std::filesystem::temp_directory_path() / "radivox_test_XXXXXX";
  if (mkdtemp(pattern.data()) == nullptr) ADD_FAILURE() << "no temporary folder";
  folder_ = pattern;
}

TempFolder::~TempFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

std::string TempFolder::write(const std::string& name, const std::string& bytes) const {
  std::ofstream(path(name), std::ios::binary) << bytes;
  return path(name);
}

std::string readBytes(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::string encodeBase64(const std::string& bytes) {
  static const char* const kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t word = 0;
    for (size_t k = 0; k < 3; ++k) word = word << 8 | (i + k < bytes.size() ? static_cast<uint8_t>(bytes[i + k]) : 0u);
    for (size_t k = 0; k < 4; ++k) out.push_back(i + k <= bytes.size() ? kDigits[word >> (18 - 6 * k) & 63u] : '=');
  }
  return out;
}

TinyGltf::TinyGltf() {
  json["asset"]["version"] = "2.0";
  json["scene"] = 0;
  json["scenes"] = nlohmann::json::array({{{"nodes", nlohmann::json::array()}}});
}

size_t TinyGltf::addView(const void* data, size_t bytes, size_t stride) {
  binary.append((4 - binary.size() % 4) % 4, '\0');
  nlohmann::json view = {{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", bytes}};
  if (stride > 0) view["byteStride"] = stride;
  binary.append(static_cast<const char*>(data), bytes);
  json["bufferViews"].push_back(view);
  return json["bufferViews"].size() - 1;
}

size_t TinyGltf::addMesh(const nlohmann::json& primitive) {
  json["meshes"].push_back({{"primitives", nlohmann::json::array({primitive})}});
  return json["meshes"].size() - 1;
}

size_t TinyGltf::addNode(const nlohmann::json& node) {
  json["nodes"].push_back(node);
  const size_t index = json["nodes"].size() - 1;
  json["scenes"][0]["nodes"].push_back(index);
  return index;
}

void TinyGltf::addTriangle() {
  const size_t positions = addVec3({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  addNode({{"mesh", addMesh({{"attributes", {{"POSITION", positions}}}})}});
}

std::string TinyGltf::gltf(const std::string& uri) const {
  nlohmann::json out = json;
  if (!binary.empty() && !out.contains("buffers")) out["buffers"] = nlohmann::json::array({{{"byteLength", binary.size()}, {"uri", uri}}});
  return out.dump(1);
}

std::string TinyGltf::gltf() const { return gltf("data:application/octet-stream;base64," + encodeBase64(binary)); }

std::string TinyGltf::glb() const {
  nlohmann::json out = json;
  if (!binary.empty() && !out.contains("buffers")) out["buffers"] = nlohmann::json::array({{{"byteLength", binary.size()}}});
  std::string text = out.dump();
  text.append((4 - text.size() % 4) % 4, ' ');
  std::string padded = binary;
  padded.append((4 - padded.size() % 4) % 4, '\0');
  const auto word = [](size_t value) {
    const auto w = static_cast<uint32_t>(value);
    return std::string(reinterpret_cast<const char*>(&w), 4);
  };
  std::string file = "glTF" + word(2) + word(12 + 8 + text.size() + (padded.empty() ? 0 : 8 + padded.size()));
  file += word(text.size()) + "JSON" + text;
  if (!padded.empty()) file += word(padded.size()) + std::string("BIN\0", 4) + padded;
  return file;
}

}  // namespace radivox::tests
