// The JSON of a glTF file, held to the specification's types before tinygltf reads it. Internal to engine/scene.
//
// tinygltf 2.7 takes what has the wrong type as missing, cuts integers to 32 bits, drops primitives it cannot read, and keeps no place
// for its errors. So the JSON is checked first, and every error names its place; afterwards whatever tinygltf holds has the right
// type, and its indices are in range.
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>

namespace radivox::scene::gltf {

/// Throws BadInput "FILE: place: message".
[[noreturn]] void failAt(const std::string& file, const std::string& place, const std::string& message);

/// Parses `text`, which begins at byte `offset` of the file. Throws BadInput.
nlohmann::json parseJson(const std::string& file, std::span<const std::byte> text, size_t offset);

/// Checks every value that the importer reads: type, required or not, indices in range. Whole numbers become integers and other
/// numbers become floats, as tinygltf tells them apart. Throws BadInput.
void checkJson(const std::string& file, nlohmann::json& root);

}  // namespace radivox::scene::gltf
