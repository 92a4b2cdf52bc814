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
  uint32_t find(int texture) {
    const auto known = byTexture_.find(texture);
    if (known != byTexture_.end()) return known->second;
    const uint32_t index = load(static_cast<size_t>(texture));
    byTexture_[texture] = index;
    return index;
  }

 private:
  uint32_t load(size_t index) {
    const tinygltf::Texture& texture = document_.model().textures[index];
    if (texture.source < 0) {
      warnings_.add(placeOf("textures", index) + " has no PNG or JPEG source and is left out; export the file with PNG textures");
      return shared::kNoTexture;
    }
    const auto source = static_cast<size_t>(texture.source);
    const auto bytes = document_.image(source);
    if (bytes.empty()) return shared::kNoTexture;  // the document has said why
    auto decoded = decodeImage(bytes);
    if (!decoded) {
      warnings_.add(document_.describeImage(source) +
                    " is no PNG or JPEG of at most 16384 texels a side, its texture is left out; convert it to PNG");
      return shared::kNoTexture;
    }
    const tinygltf::Image& image = document_.model().images[source];
    decoded->name = !texture.name.empty() ? texture.name : !image.name.empty() ? image.name : document_.imageFile(source);
    if (texture.sampler >= 0) {
      const auto at = static_cast<size_t>(texture.sampler);
      const tinygltf::Sampler& sampler = document_.model().samplers[at];
      decoded->wrapU = wrapMode(sampler.wrapS, placeOf("samplers", at) + ".wrapS");
      decoded->wrapV = wrapMode(sampler.wrapT, placeOf("samplers", at) + ".wrapT");
      decoded->nearest = sampler.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST;
    }
    scene_.textures.push_back(std::move(*decoded));
    return static_cast<uint32_t>(scene_.textures.size() - 1);
  }

  uint32_t wrapMode(int mode, const std::string& place) const {
    switch (mode) {
      case TINYGLTF_TEXTURE_WRAP_REPEAT:
        return shared::kWrapRepeat;
      case TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE:
        return shared::kWrapClamp;
      case TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT:
        return shared::kWrapMirror;
      default:
        document_.fail(place, "is no wrap mode (10497 repeat, 33071 clamp, 33648 mirror)");
    }
  }

  const Document& document_;
  Scene& scene_;
  Warnings& warnings_;
  std::map<int, uint32_t> byTexture_;
};

TextureCoordinates readCoordinates(const Document& document, int texCoord, const tinygltf::Value* transform, const std::string& place) {
  TextureCoordinates out;
  if (transform != nullptr) {
    texCoord = static_cast<int>(numberOr(*transform, "texCoord", texCoord));
    const auto offset = numbersOr<2>(*transform, "offset", {0, 0});
    const auto scale = numbersOr<2>(*transform, "scale", {1, 1});
    const double rotation = numberOr(*transform, "rotation", 0);
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
  if (texCoord > 15) document.fail(place, "texCoord " + std::to_string(texCoord) + " is above 15; export the file again");
  out.set = static_cast<uint32_t>(texCoord);
  return out;
}

float clampAlbedo(double value) { return std::clamp(static_cast<float>(value), 0.f, kMaxAlbedo); }

/// A texture info inside an extension, as tinygltf reads the others.
tinygltf::TextureInfo readTextureInfo(const tinygltf::Value& extension, const std::string& key) {
  tinygltf::TextureInfo info;
  if (!extension.Has(key)) return info;
  const tinygltf::Value& json = extension.Get(key);
  info.index = json.Get("index").GetNumberAsInt();
  info.texCoord = static_cast<int>(numberOr(json, "texCoord", 0));
  if (json.Has("extensions") && json.Get("extensions").Has("KHR_texture_transform"))
    info.extensions["KHR_texture_transform"] = json.Get("extensions").Get("KHR_texture_transform");
  return info;
}

void readOne(const Document& document, size_t index, TextureTable& textures, shared::Material& material, MaterialCoordinates& coordinates,
             Warnings& warnings) {
  const tinygltf::Material& source = document.model().materials[index];
  const std::string place = placeOf("materials", index);
  const auto find = [&](const tinygltf::TextureInfo& info, std::optional<TextureCoordinates>& reads) {
    if (info.index < 0) return shared::kNoTexture;
    const uint32_t texture = textures.find(info.index);
    if (texture != shared::kNoTexture)
      reads = readCoordinates(document, info.texCoord, findExtension(info.extensions, "KHR_texture_transform"), place);
    return texture;
  };
  std::array<double, 4> base{};
  if (const auto* diffuse = findExtension(source.extensions, "KHR_materials_pbrSpecularGlossiness")) {
    warnings.add("specular-glossiness materials: only their diffuse colour is used");
    base = numbersOr<4>(*diffuse, "diffuseFactor", {1, 1, 1, 1});
    material.baseTexture = find(readTextureInfo(*diffuse, "diffuseTexture"), coordinates.base);
  } else {
    std::copy_n(source.pbrMetallicRoughness.baseColorFactor.begin(), 4, base.begin());
    material.baseTexture = find(source.pbrMetallicRoughness.baseColorTexture, coordinates.base);
  }
  material.albedo = {clampAlbedo(base[0]), clampAlbedo(base[1]), clampAlbedo(base[2])};
  material.alpha = std::clamp(static_cast<float>(base[3]), 0.f, 1.f);
  if (findExtension(source.extensions, "KHR_materials_unlit") != nullptr)
    warnings.add("unlit materials: lit like any other, their base colour is the albedo");

  double strength = 1;
  if (const auto* extension = findExtension(source.extensions, "KHR_materials_emissive_strength"))
    strength = numberOr(*extension, "emissiveStrength", 1);
  for (glm::length_t i = 0; i < 3; ++i) {
    const double value = source.emissiveFactor[static_cast<size_t>(i)] * strength;
    if (value < 0) document.fail(place, "its emission is negative; correct emissiveFactor or emissiveStrength");
    if (value > 1e18) document.fail(place, "its emission is beyond 1e18 W/(m² sr); correct emissiveStrength");
    material.emission[i] = static_cast<float>(value);
  }
  if (source.emissiveTexture.index >= 0 && material.emission != glm::vec3(0.f)) {
    material.emissiveTexture = find(source.emissiveTexture, coordinates.emissive);
    if (material.emissiveTexture == shared::kNoTexture) {
      // The factor alone would light the whole surface where the texture lit a spot of it.
      material.emission = glm::vec3(0.f);
      warnings.add(place + ": without its emissive texture it does not emit");
    }
  }
  if (material.emission != glm::vec3(0.f)) material.flags |= shared::kMaterialEmissive;

  if (source.alphaMode == "MASK") {
    material.flags |= shared::kMaterialAlphaMask;
    material.alphaCutoff = static_cast<float>(source.alphaCutoff);
  } else if (source.alphaMode == "BLEND") {
    warnings.add("alpha-blended materials are taken as opaque");
  }
  if (source.doubleSided) material.flags |= shared::kMaterialDoubleSided;
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

std::vector<MaterialCoordinates> readMaterials(const Document& document, bool wantsDefault, Scene& scene, Warnings& warnings) {
  const size_t count = document.model().materials.size();
  std::vector<MaterialCoordinates> coordinates(count);
  TextureTable textures(document, scene, warnings);
  for (size_t i = 0; i < count; ++i) {
    const std::string& name = document.model().materials[i].name;
    scene.materials.push_back(defaultMaterial());
    scene.materialNames.push_back(name.empty() ? "material " + std::to_string(i) : name);
    readOne(document, i, textures, scene.materials.back(), coordinates[i], warnings);
  }
  if (wantsDefault || count == 0) {
    scene.materials.push_back(defaultMaterial());
    scene.materialNames.push_back("default");
    coordinates.emplace_back();
  }
  return coordinates;
}

}  // namespace radivox::scene::gltf
