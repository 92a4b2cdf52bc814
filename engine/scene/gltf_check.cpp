#include "engine/scene/gltf_check.h"

#include <cmath>
#include <limits>

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
  Numbers,  ///< `size` of them, or any number of them when that is 0
  Whole,
  Small,  ///< a whole number that tinygltf keeps in an int
  Index,  ///< below the length of the list that `detail` names
};

struct Rule {
  std::string_view place;  ///< "[]": every entry of a list, "*": every member
  Kind kind;
  std::string_view detail = {};
  size_t size = 0;
  bool required = false;
  const char* fallback = nullptr;  ///< JSON to write where the member is missing
};

constexpr std::string_view kLights = "extensions.KHR_lights_punctual.lights";

#define RADIVOX_TEXTURE_RULES(PLACE)                                                            \
  {PLACE ".index", Kind::Index, "textures", 0, true}, {PLACE ".texCoord", Kind::Small},         \
      {PLACE ".extensions.KHR_texture_transform.offset", Kind::Numbers, {}, 2},                 \
      {PLACE ".extensions.KHR_texture_transform.scale", Kind::Numbers, {}, 2},                  \
      {PLACE ".extensions.KHR_texture_transform.rotation", Kind::Number},                       \
      {PLACE ".extensions.KHR_texture_transform.texCoord", Kind::Small}
#define RADIVOX_MESHOPT_RULES(PLACE)                                                                                       \
  {PLACE ".buffer", Kind::Index, "buffers", 0, true}, {PLACE ".byteOffset", Kind::Small},                                  \
      {PLACE ".byteLength", Kind::Small, {}, 0, true}, {PLACE ".byteStride", Kind::Small, {}, 0, true},                    \
      {PLACE ".count", Kind::Small, {}, 0, true}, {PLACE ".mode", Kind::Choice, "ATTRIBUTES TRIANGLES INDICES", 0, true},  \
      {PLACE ".filter", Kind::Choice, "NONE OCTAHEDRAL QUATERNION EXPONENTIAL"}

constexpr Rule kRules[] = {
    {"asset", Kind::Object, {}, 0, true},
    {"asset.version", Kind::Text, {}, 0, true},
    {"extensionsUsed[]", Kind::Text},
    {"extensionsRequired[]", Kind::Text},
    {"buffers[].byteLength", Kind::Whole, {}, 0, true},
    {"buffers[].uri", Kind::Text},
    {"bufferViews[].buffer", Kind::Index, "buffers", 0, true},
    {"bufferViews[].byteOffset", Kind::Whole},
    {"bufferViews[].byteLength", Kind::Whole, {}, 0, true},
    {"bufferViews[].byteStride", Kind::Whole},
    RADIVOX_MESHOPT_RULES("bufferViews[].extensions.EXT_meshopt_compression"),
    RADIVOX_MESHOPT_RULES("bufferViews[].extensions.KHR_meshopt_compression"),
    {"accessors[].type", Kind::Choice, "SCALAR VEC2 VEC3 VEC4 MAT2 MAT3 MAT4", 0, true},
    {"accessors[].componentType", Kind::Whole, {}, 0, true},
    {"accessors[].count", Kind::Whole, {}, 0, true},
    {"accessors[].bufferView", Kind::Index, "bufferViews"},
    {"accessors[].byteOffset", Kind::Whole},
    {"accessors[].normalized", Kind::Flag},
    {"accessors[].sparse.count", Kind::Small, {}, 0, true},
    {"accessors[].sparse.indices", Kind::Object, {}, 0, true},
    {"accessors[].sparse.indices.bufferView", Kind::Index, "bufferViews", 0, true},
    {"accessors[].sparse.indices.byteOffset", Kind::Small},
    {"accessors[].sparse.indices.componentType", Kind::Small, {}, 0, true},
    {"accessors[].sparse.values", Kind::Object, {}, 0, true},
    {"accessors[].sparse.values.bufferView", Kind::Index, "bufferViews", 0, true},
    {"accessors[].sparse.values.byteOffset", Kind::Small},
    {"images[].bufferView", Kind::Index, "bufferViews"},
    {"images[].uri", Kind::Text},
    {"images[].name", Kind::Text},
    {"samplers[].wrapS", Kind::Small},
    {"samplers[].wrapT", Kind::Small},
    {"samplers[].magFilter", Kind::Small},
    {"textures[].source", Kind::Index, "images"},
    {"textures[].sampler", Kind::Index, "samplers"},
    {"textures[].name", Kind::Text},
    {"materials[].name", Kind::Text},
    {"materials[].pbrMetallicRoughness.baseColorFactor", Kind::Numbers, {}, 4},
    RADIVOX_TEXTURE_RULES("materials[].pbrMetallicRoughness.baseColorTexture"),
    {"materials[].extensions.KHR_materials_pbrSpecularGlossiness.diffuseFactor", Kind::Numbers, {}, 4},
    RADIVOX_TEXTURE_RULES("materials[].extensions.KHR_materials_pbrSpecularGlossiness.diffuseTexture"),
    {"materials[].extensions.KHR_materials_unlit", Kind::Object},
    {"materials[].emissiveFactor", Kind::Numbers, {}, 3},
    RADIVOX_TEXTURE_RULES("materials[].emissiveTexture"),
    {"materials[].extensions.KHR_materials_emissive_strength.emissiveStrength", Kind::Number},
    {"materials[].alphaMode", Kind::Choice, "OPAQUE MASK BLEND"},
    {"materials[].alphaCutoff", Kind::Number},
    {"materials[].doubleSided", Kind::Flag},
    {"meshes[].primitives", Kind::List, {}, 0, true},
    {"meshes[].primitives[].attributes", Kind::Object, {}, 0, true},
    {"meshes[].primitives[].attributes.*", Kind::Index, "accessors"},
    {"meshes[].primitives[].indices", Kind::Index, "accessors"},
    {"meshes[].primitives[].material", Kind::Index, "materials"},
    {"meshes[].primitives[].mode", Kind::Small},
    {"meshes[].primitives[].targets[].*", Kind::Index, "accessors"},
    {"meshes[].primitives[].extensions.KHR_draco_mesh_compression.bufferView", Kind::Index, "bufferViews", 0, true},
    {"meshes[].primitives[].extensions.KHR_draco_mesh_compression.attributes", Kind::Object, {}, 0, true},
    {"meshes[].primitives[].extensions.KHR_draco_mesh_compression.attributes.*", Kind::Small},
    {"meshes[].weights", Kind::Numbers},
    {"nodes[].name", Kind::Text},
    {"nodes[].mesh", Kind::Index, "meshes"},
    {"nodes[].skin", Kind::Index, "skins"},
    {"nodes[].camera", Kind::Index, "cameras"},
    {"nodes[].children[]", Kind::Index, "nodes"},
    {"nodes[].matrix", Kind::Numbers, {}, 16},
    {"nodes[].translation", Kind::Numbers, {}, 3},
    {"nodes[].rotation", Kind::Numbers, {}, 4},
    {"nodes[].scale", Kind::Numbers, {}, 3},
    {"nodes[].weights", Kind::Numbers},
    {"nodes[].extensions.KHR_lights_punctual.light", Kind::Index, kLights, 0, true},
    {"skins[].joints", Kind::List, {}, 0, true},
    {"skins[].joints[]", Kind::Index, "nodes"},
    {"skins[].inverseBindMatrices", Kind::Index, "accessors"},
    {"cameras[].name", Kind::Text},
    {"cameras[].type", Kind::Choice, "perspective orthographic", 0, true},
    {"cameras[].perspective", Kind::Object, {}, 0, false, "{}"},
    {"cameras[].perspective.yfov", Kind::Number, {}, 0, false, "0.0"},
    {"cameras[].perspective.znear", Kind::Number, {}, 0, false, "0.0"},
    {"cameras[].orthographic", Kind::Object, {}, 0, false, "{}"},
    {"cameras[].orthographic.xmag", Kind::Number, {}, 0, false, "0.0"},
    {"cameras[].orthographic.ymag", Kind::Number, {}, 0, false, "0.0"},
    {"cameras[].orthographic.znear", Kind::Number, {}, 0, false, "0.0"},
    {"cameras[].orthographic.zfar", Kind::Number, {}, 0, false, "0.0"},
    {"extensions.KHR_lights_punctual.lights[].name", Kind::Text},
    {"extensions.KHR_lights_punctual.lights[].type", Kind::Choice, "directional point spot", 0, true},
    {"extensions.KHR_lights_punctual.lights[].color", Kind::Numbers, {}, 3},
    {"extensions.KHR_lights_punctual.lights[].intensity", Kind::Number},
    {"extensions.KHR_lights_punctual.lights[].range", Kind::Positive},
    {"extensions.KHR_lights_punctual.lights[].spot", Kind::Object, {}, 0, false, "{}"},
    {"extensions.KHR_lights_punctual.lights[].spot.innerConeAngle", Kind::Number},
    {"extensions.KHR_lights_punctual.lights[].spot.outerConeAngle", Kind::Number},
    {"scenes[].nodes[]", Kind::Index, "nodes"},
    {"scene", Kind::Index, "scenes"},
};

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
  void check(const Rule& rule) { visit(rule, rule.place, root_, Place{}); }

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
    const size_t end = rest.find('.');
    std::string_view name = rest.substr(0, end);
    rest = end == std::string_view::npos ? std::string_view() : rest.substr(end + 1);
    if (name == "*") {
      for (auto it = value.begin(); it != value.end(); ++it) visit(rule, rest, it.value(), Place{&place, it.key()});
      return;
    }
    const bool list = name.ends_with("[]");
    if (list) name.remove_suffix(2);
    auto found = value.find(name);
    if (found == value.end()) {
      if (!rest.empty() || list) return;
      if (rule.required) fail(place, "required property \"" + std::string(name) + "\" is missing; export the file again or add it");
      if (rule.fallback != nullptr) value[std::string(name)] = json::parse(rule.fallback);
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
        if (rule.size > 0 && value.size() != rule.size)
          fail(place, "has " + std::to_string(value.size()) + " numbers instead of " + std::to_string(rule.size));
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
      const std::string_view word = words.substr(0, words.find(' '));
      if (text == word) return;
      words.remove_prefix(std::min(words.size(), word.size() + 1));
    }
    fail(place, "is \"" + text.substr(0, 60) + "\", should be one of " + std::string(rule.detail));
  }

  void checkIndex(std::string_view table, uint64_t index, const Place& place) const {
    const json* at = &root_;
    const std::string_view name = table.substr(table.rfind('.') + 1);  // all of it when there is no dot
    while (at != nullptr && !table.empty()) {
      const std::string_view member = table.substr(0, table.find('.'));
      table.remove_prefix(std::min(table.size(), member.size() + 1));
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
    if (rule.place != "asset.version") continue;  // before the rest, which version 1 lays out differently
    const std::string version = root["asset"]["version"].get<std::string>();
    if (!version.starts_with("2.")) failAt(file, "asset.version", "is \"" + version.substr(0, 20) + "\"; export the file as glTF 2.0");
  }
}

}  // namespace radivox::scene::gltf
