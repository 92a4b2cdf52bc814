#include "engine/scene/gltf_check.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/error.h"

namespace radivox::scene::gltf {

namespace {

using nlohmann::json;

enum class Kind {
  Object,
  List,
  Text,
  Choice,  ///< one of the words in `detail`
  Flag,
  Number,
  Positive,
  Numbers,  ///< as many as `detail` says, or any number of them
  Whole,
  Small,  ///< a whole number that tinygltf keeps in an int
  Index,  ///< below the length of the list that `detail` names
};

struct Rule {
  Kind kind;
  std::string_view detail;
  /// "[]": every entry of a list, "*": every member, "!": required where what holds it is there, "$": see kPrefixes.
  std::string_view places;
};

/// Objects that stand in several places.
constexpr std::pair<std::string_view, std::string_view> kPrefixes[] = {
    {"$texture", "materials[].pbrMetallicRoughness.baseColorTexture"},
    {"$texture", "materials[].emissiveTexture"},
    {"$texture", "materials[].extensions.KHR_materials_pbrSpecularGlossiness.diffuseTexture"},
    {"$meshopt", "bufferViews[].extensions.EXT_meshopt_compression"},
    {"$meshopt", "bufferViews[].extensions.KHR_meshopt_compression"},
    {"$draco", "meshes[].primitives[].extensions.KHR_draco_mesh_compression"},
    {"$light", "extensions.KHR_lights_punctual.lights[]"},
};

constexpr Rule kRules[] = {
    {Kind::Object, "", "asset!"},
    {Kind::Text, "", "asset.version!"},
    {Kind::Object, "", "accessors[].sparse.indices! accessors[].sparse.values! materials[].extensions.KHR_materials_unlit"},
    {Kind::Object, "", "meshes[].primitives[].attributes! $draco.attributes!"},
    {Kind::List, "", "meshes[].primitives! skins[].joints!"},
    {Kind::Text, "", "extensionsUsed[] extensionsRequired[] buffers[].uri images[].uri images[].name textures[].name"},
    {Kind::Text, "", "materials[].name nodes[].name cameras[].name $light.name"},
    {Kind::Choice, "SCALAR VEC2 VEC3 VEC4 MAT2 MAT3 MAT4", "accessors[].type!"},
    {Kind::Choice, "OPAQUE MASK BLEND", "materials[].alphaMode"},
    {Kind::Choice, "perspective orthographic", "cameras[].type!"},
    {Kind::Choice, "directional point spot", "$light.type!"},
    {Kind::Choice, "ATTRIBUTES TRIANGLES INDICES", "$meshopt.mode!"},
    {Kind::Choice, "NONE OCTAHEDRAL QUATERNION EXPONENTIAL", "$meshopt.filter"},
    {Kind::Flag, "", "accessors[].normalized materials[].doubleSided"},
    {Kind::Number, "", "$texture.extensions.KHR_texture_transform.rotation materials[].alphaCutoff"},
    {Kind::Number, "", "materials[].extensions.KHR_materials_emissive_strength.emissiveStrength"},
    {Kind::Number, "", "cameras[].perspective.yfov cameras[].perspective.znear"},
    {Kind::Number, "", "cameras[].orthographic.xmag cameras[].orthographic.ymag cameras[].orthographic.znear cameras[].orthographic.zfar"},
    {Kind::Number, "", "$light.intensity $light.spot.innerConeAngle $light.spot.outerConeAngle"},
    {Kind::Positive, "", "$light.range"},
    {Kind::Numbers, "", "meshes[].weights nodes[].weights"},
    {Kind::Numbers, "2", "$texture.extensions.KHR_texture_transform.offset $texture.extensions.KHR_texture_transform.scale"},
    {Kind::Numbers, "3", "materials[].emissiveFactor nodes[].translation nodes[].scale $light.color"},
    {Kind::Numbers, "4", "materials[].pbrMetallicRoughness.baseColorFactor nodes[].rotation"},
    {Kind::Numbers, "4", "materials[].extensions.KHR_materials_pbrSpecularGlossiness.diffuseFactor"},
    {Kind::Numbers, "16", "nodes[].matrix"},
    {Kind::Whole, "", "buffers[].byteLength! bufferViews[].byteOffset bufferViews[].byteLength! bufferViews[].byteStride"},
    {Kind::Whole, "", "accessors[].componentType! accessors[].count! accessors[].byteOffset"},
    {Kind::Small, "", "accessors[].sparse.count! accessors[].sparse.indices.byteOffset accessors[].sparse.indices.componentType!"},
    {Kind::Small, "", "accessors[].sparse.values.byteOffset samplers[].wrapS samplers[].wrapT samplers[].magFilter"},
    {Kind::Small, "", "$texture.texCoord $texture.extensions.KHR_texture_transform.texCoord meshes[].primitives[].mode"},
    {Kind::Small, "", "$meshopt.byteOffset $meshopt.byteLength! $meshopt.byteStride! $meshopt.count! $draco.attributes.*"},
    {Kind::Index, "buffers", "bufferViews[].buffer! $meshopt.buffer!"},
    {Kind::Index, "bufferViews", "accessors[].bufferView accessors[].sparse.indices.bufferView! accessors[].sparse.values.bufferView!"},
    {Kind::Index, "bufferViews", "images[].bufferView $draco.bufferView!"},
    {Kind::Index, "accessors", "meshes[].primitives[].attributes.* meshes[].primitives[].indices meshes[].primitives[].targets[].*"},
    {Kind::Index, "accessors", "skins[].inverseBindMatrices"},
    {Kind::Index, "images", "textures[].source"},
    {Kind::Index, "samplers", "textures[].sampler"},
    {Kind::Index, "textures", "$texture.index!"},
    {Kind::Index, "materials", "meshes[].primitives[].material"},
    {Kind::Index, "meshes", "nodes[].mesh"},
    {Kind::Index, "skins", "nodes[].skin"},
    {Kind::Index, "cameras", "nodes[].camera"},
    {Kind::Index, "nodes", "nodes[].children[] skins[].joints[] scenes[].nodes[]"},
    {Kind::Index, "scenes", "scene"},
    {Kind::Index, "extensions.KHR_lights_punctual.lights", "nodes[].extensions.KHR_lights_punctual.light!"},
};

/// The first word of `words`, which loses it.
std::string_view takeWord(std::string_view& words, char separator) {
  const std::string_view word = words.substr(0, words.find(separator));
  words.remove_prefix(std::min(words.size(), word.size() + 1));
  return word;
}

/// tinygltf walks extensions and extras recursively: a file must not choose how deep.
constexpr int kMaxDepth = 128;

bool nestsTooDeep(std::string_view text) {
  int depth = 0;
  bool inString = false;
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"') inString = !inString;
    if (c == '\\') ++i;  // only in strings, where it may hide a quote
    if (inString) continue;
    if (c == '{' || c == '[') ++depth;
    if (c == '}' || c == ']') --depth;
    if (depth > kMaxDepth) return true;
  }
  return false;
}

/// The chain of members and entries that leads to a value; put into words only for errors.
struct Place {
  const Place* parent = nullptr;
  std::string_view member = {};
  size_t entry = 0;
  std::string print() const {
    if (parent == nullptr) return {};
    std::string before = parent->print();
    if (member.empty()) return before + "[" + std::to_string(entry) + "]";
    return before.empty() ? std::string(member) : before + "." + std::string(member);
  }
};

class Checker {
 public:
  Checker(const std::string& file, json& root) : file_(file), root_(root) {}
  void check(const Rule& rule) {
    for (std::string_view places = rule.places; !places.empty();) {
      const std::string_view place = takeWord(places, ' ');
      if (place[0] != '$') visit(rule, place, root_, Place{});
      for (const auto& [prefix, meaning] : kPrefixes) {
        if (place.starts_with(prefix)) visit(rule, std::string(meaning).append(place.substr(prefix.size())), root_, Place{});
      }
    }
  }

 private:
  [[noreturn]] void fail(const Place& place, const std::string& message) const {
    const std::string text = place.print();
    failAt(file_, text.empty() ? "top level" : text, message);
  }
  [[noreturn]] void failType(const Place& place, const std::string& wanted, const json& value) const {
    fail(place, "should be " + wanted + ", is " + value.type_name());
  }

  /// `rest` is what the rule's place says below `value`.
  void visit(const Rule& rule, std::string_view rest, json& value, const Place& place) {
    if (rest.empty()) return checkValue(rule, value, place);
    if (!value.is_object()) failType(place, "an object", value);
    std::string_view name = takeWord(rest, '.');
    if (name == "*") {
      for (auto it = value.begin(); it != value.end(); ++it) visit(rule, rest, it.value(), Place{&place, it.key()});
      return;
    }
    const bool required = name.ends_with('!'), list = name.ends_with("[]");
    name.remove_suffix(required ? 1 : list ? 2 : 0);
    const auto found = value.find(name);
    if (found == value.end()) {
      if (required) fail(place, "required property \"" + std::string(name) + "\" is missing; export the file again or add it");
      return;
    }
    const Place here{&place, name};
    if (!list) return visit(rule, rest, *found, here);
    if (!found->is_array()) failType(here, "an array", *found);
    for (size_t i = 0; i < found->size(); ++i) visit(rule, rest, (*found)[i], Place{&here, {}, i});
  }

  void checkValue(const Rule& rule, json& value, const Place& place) const {
    switch (rule.kind) {
      case Kind::Object:
        if (!value.is_object()) failType(place, "an object", value);
        break;
      case Kind::List:
        if (!value.is_array()) failType(place, "an array", value);
        break;
      case Kind::Text:
        if (!value.is_string()) failType(place, "a string", value);
        break;
      case Kind::Choice:
        checkChoice(rule, value, place);
        break;
      case Kind::Flag:
        if (!value.is_boolean()) failType(place, "true or false", value);
        break;
      case Kind::Number:
        makeFloat(value, place);
        break;
      case Kind::Positive:
        makeFloat(value, place);
        if (!(value.get<double>() > 0)) fail(place, "should be above 0; remove it for no limit");
        break;
      case Kind::Numbers:
        if (!value.is_array()) failType(place, "an array", value);
        if (!rule.detail.empty() && std::to_string(value.size()) != rule.detail)
          fail(place, "has " + std::to_string(value.size()) + " numbers instead of " + std::string(rule.detail));
        for (size_t i = 0; i < value.size(); ++i) makeFloat(value[i], Place{&place, {}, i});
        break;
      case Kind::Whole:
      case Kind::Small:
      case Kind::Index:
        makeWhole(value, place);
        if (rule.kind == Kind::Index) checkIndex(rule.detail, value.get<uint64_t>(), place);
        if (rule.kind == Kind::Small && value.get<uint64_t>() > std::numeric_limits<int>::max())
          fail(place, "is " + value.dump() + ", far beyond what it may be; export the file again");
        break;
    }
  }

  void checkChoice(const Rule& rule, const json& value, const Place& place) const {
    if (!value.is_string()) failType(place, "a string", value);
    const std::string text = value.get<std::string>();
    for (std::string_view words = rule.detail; !words.empty();) {
      if (text == takeWord(words, ' ')) return;
    }
    fail(place, "is \"" + text.substr(0, 60) + "\", should be one of " + std::string(rule.detail));
  }

  void checkIndex(std::string_view table, uint64_t index, const Place& place) const {
    const json* at = &root_;
    const std::string_view name = table.substr(table.rfind('.') + 1);  // all of it when there is no dot
    while (at != nullptr && !table.empty()) {
      const std::string_view member = takeWord(table, '.');
      const auto found = at->is_object() ? at->find(member) : at->end();
      at = found == at->end() ? nullptr : &*found;
    }
    const size_t count = at != nullptr && at->is_array() ? at->size() : 0;
    if (index < count) return;
    fail(place, "is " + std::to_string(index) + ", but the file has " + std::to_string(count) + " " + std::string(name) +
                    "; export the file again or correct the index");
  }

  /// Integers beyond an int lose their upper bits in tinygltf's extension values; floats do not.
  void makeFloat(json& value, const Place& place) const {
    if (!value.is_number()) failType(place, "a number", value);
    value = value.get<double>();
  }

  /// 2.0 counts as whole.
  void makeWhole(json& value, const Place& place) const {
    if (!value.is_number()) failType(place, "a number", value);
    if (value.is_number_unsigned()) return;
    const double number = value.get<double>();
    // 2^53: doubles above it no longer hold every integer.
    if (number < 0 || number != std::floor(number) || number > 9007199254740992.0)
      fail(place, "is " + value.dump() + ", should be a whole number, 0 or more");
    value = static_cast<uint64_t>(number);
  }

  const std::string& file_;
  json& root_;
};

}  // namespace

void failAt(const std::string& file, const std::string& place, const std::string& message) {
  throw Error(ErrorCode::BadInput, file + ": " + (place.empty() ? "" : place + ": ") + message);
}

nlohmann::json parseJson(const std::string& file, std::span<const std::byte> text, size_t offset) {
  const char* begin = reinterpret_cast<const char*>(text.data());
  if (nestsTooDeep({begin, text.size()}))
    failAt(file, "", "the JSON is malformed: it nests deeper than " + std::to_string(kMaxDepth) + " levels; export the file again");
  json root;
  try {
    root = json::parse(begin, begin + text.size());
  } catch (const json::parse_error& e) {
    failAt(file, "byte " + std::to_string(offset + e.byte), "the JSON is malformed or cut off; copy or export the file again");
  } catch (const json::exception&) {  // numbers beyond double
    failAt(file, "", "the JSON holds a number beyond any float; export the file again");
  }
  if (!root.is_object()) failAt(file, "", "the JSON's top level is no object; name a glTF file");
  return root;
}

void checkJson(const std::string& file, json& root) {
  Checker checker(file, root);
  for (const Rule& rule : kRules) {
    checker.check(rule);
    if (rule.places != "asset.version!") continue;  // before the rest, which version 1 lays out differently
    const std::string version = root["asset"]["version"].get<std::string>();
    if (!version.starts_with("2.")) failAt(file, "asset.version", "is \"" + version.substr(0, 20) + "\"; export the file as glTF 2.0");
  }
}

}  // namespace radivox::scene::gltf
