// glTF materials → Lambertian ones. What is not diffuse is left out and said so.
#include "engine/scene/gltf_materials.h"

#include <algorithm>
#include <cmath>

namespace radivox::scene::gltf {

namespace {

constexpr float kMaxAlbedo = 0.999f;  // METHODS section 0: keeps the bounce a contraction

/// Textures by glTF index: each is decoded once.
class TextureTable {
 public:
  TextureTable(const Document& document, Scene& scene, Warnings& warnings) : document_(document), scene_(scene), warnings_(warnings) {}

  /// Index in scene.textures, or kNoTexture when it has to be left out.
  uint32_t find(const Value& info) {
    const size_t texture = info.index("index", document_.count("textures"), "textures");
    const auto known = byTexture_.find(texture);
    if (known != byTexture_.end()) return known->second;
    const uint32_t index = load(document_.entry("textures", texture));
    byTexture_[texture] = index;
    return index;
  }

 private:
  uint32_t load(const Value& texture) {
    const auto source = texture.indexOr("source", document_.count("images"), "images");
    if (!source) {
      warnings_.add(texture.place() + " has no PNG or JPEG source and is left out; export the file with PNG textures");
      return shared::kNoTexture;
    }
    const Value image = document_.entry("images", *source);
    std::optional<TextureImage> decoded;
    std::string name = image.place();
    if (const auto view = image.indexOr("bufferView", document_.count("bufferViews"), "bufferViews")) {
      decoded = decodeImage(document_.bufferView(*view));
    } else {
      const Value uri = image.at("uri");
      name += " (" + document_.uriForMessages(uri) + ")";
      const auto bytes = document_.readUri(uri);
      if (!bytes) {
        warnings_.add(name + " is missing, its texture is left out; put it beside the .gltf, or export as .glb");
        return shared::kNoTexture;
      }
      decoded = decodeImage(*bytes);
    }
    if (!decoded) {
      warnings_.add(name + " is no PNG or JPEG of at most 16384 texels a side, its texture is left out; convert it to PNG");
      return shared::kNoTexture;
    }
    decoded->name =
        texture.textOr("name", image.textOr("name", image.textOr("uri", "").rfind("data:", 0) == 0 ? "" : image.textOr("uri", "")));
    if (const auto index = texture.indexOr("sampler", document_.count("samplers"), "samplers")) {
      const Value sampler = document_.entry("samplers", *index);
      decoded->wrapU = wrapMode(sampler, "wrapS");
      decoded->wrapV = wrapMode(sampler, "wrapT");
      decoded->nearest = sampler.wholeOr("magFilter", 9729) == 9728;
    }
    scene_.textures.push_back(std::move(*decoded));
    return static_cast<uint32_t>(scene_.textures.size() - 1);
  }

  static uint32_t wrapMode(const Value& sampler, std::string_view key) {
    switch (sampler.wholeOr(key, 10497)) {
      case 10497:
        return shared::kWrapRepeat;
      case 33071:
        return shared::kWrapClamp;
      case 33648:
        return shared::kWrapMirror;
      default:
        sampler.at(key).fail("is no wrap mode (10497 repeat, 33071 clamp, 33648 mirror)");
    }
  }

  const Document& document_;
  Scene& scene_;
  Warnings& warnings_;
  std::map<size_t, uint32_t> byTexture_;
};

TextureCoordinates readCoordinates(const Value& info) {
  TextureCoordinates out;
  uint64_t set = info.wholeOr("texCoord", 0);
  if (const auto transform = info.findExtension("KHR_texture_transform")) {
    set = transform->wholeOr("texCoord", set);
    const auto offset = transform->numbersOr<2>("offset", {0, 0});
    const auto scale = transform->numbersOr<2>("scale", {1, 1});
    const double rotation = transform->numberOr("rotation", 0);
    // Counter-clockwise as seen with v pointing down, which is what viewers and the sample model agree on (the specification's listing
    // has the sign of the sine the other way round).
    const double s = std::sin(rotation), c = std::cos(rotation);
    out.a = c * scale[0];
    out.b = s * scale[1];
    out.c = -s * scale[0];
    out.d = c * scale[1];
    out.offsetU = offset[0];
    out.offsetV = offset[1];
  }
  if (set > 15) info.fail("texCoord " + std::to_string(set) + " is above 15");
  out.set = static_cast<uint32_t>(set);
  return out;
}

float clampAlbedo(double value) { return std::clamp(static_cast<float>(value), 0.f, kMaxAlbedo); }

void readOne(const Value& json, TextureTable& textures, shared::Material& material, MaterialCoordinates& coordinates, Warnings& warnings) {
  const auto base = [&](const Value& from, std::string_view factorKey, std::string_view textureKey) {
    const auto factor = from.numbersOr<4>(factorKey, {1, 1, 1, 1});
    material.albedo = {clampAlbedo(factor[0]), clampAlbedo(factor[1]), clampAlbedo(factor[2])};
    material.alpha = std::clamp(static_cast<float>(factor[3]), 0.f, 1.f);
    if (const auto info = from.findObject(textureKey)) {
      material.baseTexture = textures.find(*info);
      if (material.baseTexture != shared::kNoTexture) coordinates.base = readCoordinates(*info);
    }
  };
  if (const auto specular = json.findExtension("KHR_materials_pbrSpecularGlossiness")) {
    warnings.add("specular-glossiness materials: only their diffuse colour is used");
    base(*specular, "diffuseFactor", "diffuseTexture");
  } else if (const auto pbr = json.findObject("pbrMetallicRoughness")) {
    base(*pbr, "baseColorFactor", "baseColorTexture");
  }
  if (json.findExtension("KHR_materials_unlit")) warnings.add("unlit materials: lit like any other, their base colour is the albedo");

  const auto emissive = json.numbersOr<3>("emissiveFactor", {0, 0, 0});
  double strength = 1;
  if (const auto extension = json.findExtension("KHR_materials_emissive_strength")) strength = extension->numberOr("emissiveStrength", 1);
  for (glm::length_t i = 0; i < 3; ++i) {
    const double value = emissive[static_cast<size_t>(i)] * strength;
    if (value < 0) json.fail("its emission is negative; correct emissiveFactor or emissiveStrength");
    if (value > 1e18) json.fail("its emission is beyond 1e18 W/(m² sr); correct emissiveStrength");
    material.emission[i] = static_cast<float>(value);
  }
  if (const auto info = json.findObject("emissiveTexture"); info && material.emission != glm::vec3(0.f)) {
    material.emissiveTexture = textures.find(*info);
    if (material.emissiveTexture != shared::kNoTexture) {
      coordinates.emissive = readCoordinates(*info);
    } else {
      // The factor alone would light the whole surface where the texture lit a spot of it.
      material.emission = glm::vec3(0.f);
      warnings.add(json.place() + ": without its emissive texture it does not emit");
    }
  }
  if (material.emission != glm::vec3(0.f)) material.flags |= shared::kMaterialEmissive;

  const std::string alphaMode = json.textOr("alphaMode", "OPAQUE");
  if (alphaMode == "MASK") {
    material.flags |= shared::kMaterialAlphaMask;
    material.alphaCutoff = static_cast<float>(json.numberOr("alphaCutoff", 0.5));
  } else if (alphaMode == "BLEND") {
    warnings.add("alpha-blended materials are taken as opaque");
  } else if (alphaMode != "OPAQUE") {
    json.at("alphaMode").fail("is \"" + alphaMode + "\", should be OPAQUE, MASK or BLEND");
  }
  if (json.flagOr("doubleSided", false)) material.flags |= shared::kMaterialDoubleSided;
}

shared::Material defaultMaterial() {
  shared::Material material{};
  material.albedo = glm::vec3(kMaxAlbedo);
  material.alpha = 1.f;
  material.emission = glm::vec3(0.f);
  material.alphaCutoff = 0.5f;
  material.baseTexture = shared::kNoTexture;
  material.emissiveTexture = shared::kNoTexture;
  material.flags = 0;
  return material;
}

}  // namespace

void Warnings::appendTo(std::vector<std::string>& lines) const {
  for (const auto& [message, times] : counts_) lines.push_back(times > 1 ? std::to_string(times) + " × " + message : message);
}

std::vector<MaterialCoordinates> readMaterials(const Document& document, bool wantsDefault, Scene& scene, Warnings& warnings) {
  const size_t count = document.count("materials");
  std::vector<MaterialCoordinates> coordinates(count);
  TextureTable textures(document, scene, warnings);
  for (size_t i = 0; i < count; ++i) {
    const Value json = document.entry("materials", i);
    scene.materials.push_back(defaultMaterial());
    scene.materialNames.push_back(json.textOr("name", "material " + std::to_string(i)));
    readOne(json, textures, scene.materials.back(), coordinates[i], warnings);
  }
  if (wantsDefault || count == 0) {
    scene.materials.push_back(defaultMaterial());
    scene.materialNames.push_back("default");
    coordinates.emplace_back();
  }
  return coordinates;
}

}  // namespace radivox::scene::gltf
