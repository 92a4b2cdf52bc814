#include <cmath>
#include <glm/gtc/type_ptr.hpp>

#include "bindings/c/handles.h"

using namespace radivox;
using c::guarded;

namespace {

glm::vec3 vec3(const float (&v)[3]) { return {v[0], v[1], v[2]}; }

void give(const glm::vec3& from, float (&to)[3]) {
  for (int i = 0; i < 3; ++i) to[i] = from[i];
}

[[noreturn]] void refuse(const std::string& place, uint32_t index, const std::string& what) {
  throw Error(ErrorCode::BadInput, "info->" + place + "[" + std::to_string(index) + "]" + what);
}

bool isFinite(const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

/// A colour that light can have.
bool isLight(const glm::vec3& v) { return isFinite(v) && v.x >= 0 && v.y >= 0 && v.z >= 0; }

scene::PunctualLight takeLight(const RadivoxLight& given, uint32_t index) {
  scene::PunctualLight light;
  if (given.type > RADIVOX_LIGHT_SPOT) refuse("lights", index, ".type is no RadivoxLightType");
  light.type = given.type;
  light.position = vec3(given.position);
  light.direction = vec3(given.direction);
  light.intensity = vec3(given.intensity);
  light.range = given.range;
  light.innerConeAngle = given.innerConeAngle;
  light.outerConeAngle = given.outerConeAngle;
  if (!isFinite(light.position)) refuse("lights", index, ".position is not finite");
  if (!isLight(light.intensity)) refuse("lights", index, ".intensity must be finite and not negative");
  if (!(light.range >= 0)) refuse("lights", index, ".range must be 0 (unlimited) or above");
  if (light.type != shared::kLightPoint) {
    const float length = glm::length(light.direction);
    if (!(length > 1e-6f) || !std::isfinite(length)) refuse("lights", index, ".direction has no length");
    light.direction /= length;
  }
  if (light.type == shared::kLightSpot &&
      !(light.innerConeAngle >= 0 && light.innerConeAngle < light.outerConeAngle && light.outerConeAngle <= 1.5707964f)) {
    refuse("lights", index, ": the angles of a spot go 0 <= inner < outer <= pi/2");
  }
  return light;
}

std::vector<scene::PunctualLight> takeLights(const RadivoxLight* lights, uint32_t count) {
  if (count > 0) c::require(lights, "lights");
  std::vector<scene::PunctualLight> taken;
  for (uint32_t i = 0; i < count; ++i) taken.push_back(takeLight(lights[i], i));
  return taken;
}

glm::vec3 takeSky(const float (&radiance)[3]) {
  if (!isLight(vec3(radiance))) throw Error(ErrorCode::BadInput, "skyRadiance must be finite and not negative");
  return vec3(radiance);
}

uint32_t takeTextureIndex(uint32_t texture, uint32_t textureCount, uint32_t material) {
  if (texture != RADIVOX_NO_TEXTURE && texture >= textureCount) {
    refuse("materials", material,
           " names texture " + std::to_string(texture) + " of " + std::to_string(textureCount) +
               "; write RADIVOX_NO_TEXTURE where there is none");
  }
  return texture;
}

shared::Material takeMaterial(const RadivoxMaterial& given, uint32_t index, uint32_t textureCount) {
  constexpr float kMaxAlbedo = 0.999f;
  shared::Material material{};
  if (!isLight(vec3(given.albedo))) refuse("materials", index, ".albedo must be finite and not negative");
  if (!isLight(vec3(given.emission))) refuse("materials", index, ".emission must be finite and not negative");
  material.albedo = glm::min(vec3(given.albedo), glm::vec3(kMaxAlbedo));
  material.alpha = given.alpha;
  material.emission = vec3(given.emission);
  material.alphaCutoff = given.alphaCutoff;
  material.baseTexture = takeTextureIndex(given.albedoTexture, textureCount, index);
  material.emissiveTexture = takeTextureIndex(given.emissionTexture, textureCount, index);
  if ((given.flags & RADIVOX_MATERIAL_DOUBLE_SIDED) != 0) material.flags |= shared::kMaterialDoubleSided;
  if ((given.flags & RADIVOX_MATERIAL_ALPHA_MASK) != 0) material.flags |= shared::kMaterialAlphaMask;
  if (material.emission != glm::vec3(0.f)) material.flags |= shared::kMaterialEmissive;
  return material;
}

scene::TextureImage takeTexture(const RadivoxTexture& given, uint32_t index) {
  constexpr uint32_t kMaxSide = 16384;
  scene::TextureImage texture;
  if (given.rgba == nullptr || given.width == 0 || given.height == 0 || given.width > kMaxSide || given.height > kMaxSide) {
    refuse("textures", index, " needs rgba and sides from 1 to " + std::to_string(kMaxSide));
  }
  if (given.wrapU > RADIVOX_WRAP_MIRROR || given.wrapV > RADIVOX_WRAP_MIRROR) refuse("textures", index, ": no such RadivoxWrap");
  texture.name = "texture " + std::to_string(index);
  texture.width = given.width;
  texture.height = given.height;
  texture.rgba.assign(given.rgba, given.rgba + size_t{4} * given.width * given.height);
  texture.wrapU = given.wrapU;
  texture.wrapV = given.wrapV;
  texture.nearest = given.nearest != VK_FALSE;
  texture.srgb = given.srgb != VK_FALSE;
  return texture;
}

scene::Scene takeScene(const RadivoxSceneInfo& info) {
  scene::Scene scene;
  scene.name = "the host's scene";
  if (info.vertexCount > 0) c::require(info.vertices, "info->vertices");
  if (info.triangleCount > 0) c::require(info.indices, "info->indices");
  if (info.textureCount > 0) c::require(info.textures, "info->textures");
  if (info.materialCount == 0) throw Error(ErrorCode::BadInput, "info->materialCount is 0; give at least one material");
  c::require(info.materials, "info->materials");
  scene.vertices.reserve(info.vertexCount);
  for (uint32_t i = 0; i < info.vertexCount; ++i) {
    const RadivoxVertex& given = info.vertices[i];
    const glm::vec2 uv(given.uv[0], given.uv[1]);
    if (!isFinite(vec3(given.position)) || !isFinite(vec3(given.normal)) || !isFinite(glm::vec3(uv, 0.f))) {
      refuse("vertices", i, " is not finite");
    }
    scene.vertices.push_back({vec3(given.position), vec3(given.normal), uv, uv});
  }
  if (info.triangleCount > 0) scene.indices.assign(info.indices, info.indices + size_t{3} * info.triangleCount);
  for (uint32_t i = 0; i < scene.indices.size(); ++i) {
    if (scene.indices[i] >= info.vertexCount) {
      refuse("indices", i, " is " + std::to_string(scene.indices[i]) + ", and there are " + std::to_string(info.vertexCount) + " vertices");
    }
  }
  scene.triangleMaterials.resize(info.triangleCount);
  if (info.triangleMaterials != nullptr)
    scene.triangleMaterials.assign(info.triangleMaterials, info.triangleMaterials + info.triangleCount);
  for (uint32_t i = 0; i < info.triangleCount; ++i) {
    if (scene.triangleMaterials[i] >= info.materialCount) {
      refuse("triangleMaterials", i,
             " is " + std::to_string(scene.triangleMaterials[i]) + ", and there are " + std::to_string(info.materialCount) + " materials");
    }
  }
  for (uint32_t i = 0; i < info.materialCount; ++i) {
    scene.materials.push_back(takeMaterial(info.materials[i], i, info.textureCount));
    scene.materialNames.push_back("material " + std::to_string(i));
  }
  for (uint32_t i = 0; i < info.textureCount; ++i) scene.textures.push_back(takeTexture(info.textures[i], i));
  scene.lights = takeLights(info.lights, info.lightCount);
  scene.skyRadiance = takeSky(info.skyRadiance);
  return scene;
}

}  // namespace

namespace radivox::c {

scene::CameraDescription takeCamera(const RadivoxCamera* given) {
  const RadivoxCamera taken = takeStruct(given, "camera");
  scene::CameraDescription camera;
  camera.name = "the host's camera";
  camera.position = vec3(taken.position);
  camera.orientation = glm::quat(taken.orientation[3], taken.orientation[0], taken.orientation[1], taken.orientation[2]);
  camera.orthographic = taken.orthographic != VK_FALSE;
  camera.yfov = taken.verticalAngle;
  camera.ymag = taken.halfHeight;
  camera.znear = taken.nearPlane;
  camera.zfar = taken.farPlane;
  const float length = glm::length(camera.orientation);
  if (!isFinite(camera.position)) throw Error(ErrorCode::BadInput, "camera->position is not finite");
  if (!(length > 1e-3f) || !std::isfinite(length))
    throw Error(ErrorCode::BadInput, "camera->orientation is no quaternion; write 0, 0, 0, 1");
  if (!(camera.znear > 0)) throw Error(ErrorCode::BadInput, "camera->nearPlane must be above 0");
  if (camera.orthographic ? !(camera.ymag > 0 && camera.zfar > camera.znear) : !(camera.yfov > 0 && camera.yfov < 3.14159f)) {
    throw Error(ErrorCode::BadInput, camera.orthographic ? "camera->halfHeight must be above 0, farPlane above nearPlane"
                                                         : "camera->verticalAngle must lie between 0 and pi");
  }
  return camera;
}

}  // namespace radivox::c

RadivoxResult radivoxCreateScene(const RadivoxSceneInfo* info, RadivoxScene** scene) {
  return guarded([&] {
    c::require(scene, "scene");
    *scene = new RadivoxScene{std::make_shared<scene::Scene>(takeScene(c::takeStruct(info, "info")))};
  });
}

RadivoxResult radivoxLoadScene(const char* file, RadivoxScene** scene) {
  return guarded([&] {
    c::require(scene, "scene");
    *scene = new RadivoxScene{std::make_shared<scene::Scene>(scene::loadScene(c::requireText(file, "file")))};
  });
}

void radivoxDestroyScene(RadivoxScene* scene) { delete scene; }

uint32_t radivoxCameraCount(const RadivoxScene* scene) {
  return scene == nullptr ? 0 : static_cast<uint32_t>(scene->scene->cameras.size());
}

RadivoxResult radivoxGetCamera(const RadivoxScene* scene, uint32_t index, RadivoxCamera* camera) {
  return guarded([&] {
    const auto& cameras = c::require(scene, "scene").scene->cameras;
    if (index >= cameras.size()) {
      throw Error(ErrorCode::BadInput, "camera " + std::to_string(index) + " of " + std::to_string(cameras.size()));
    }
    const scene::CameraDescription& from = cameras[index];
    RadivoxCamera to{};
    to.orthographic = from.orthographic ? VK_TRUE : VK_FALSE;
    give(from.position, to.position);
    for (int i = 0; i < 3; ++i) to.orientation[i] = (&from.orientation.x)[i];
    to.orientation[3] = from.orientation.w;
    to.verticalAngle = from.yfov;
    to.halfHeight = from.ymag;
    to.nearPlane = from.znear;
    to.farPlane = from.zfar;
    c::giveStruct(camera, to, "camera");
  });
}

uint32_t radivoxLightCount(const RadivoxScene* scene) { return scene == nullptr ? 0 : static_cast<uint32_t>(scene->scene->lights.size()); }

RadivoxResult radivoxGetLight(const RadivoxScene* scene, uint32_t index, RadivoxLight* light) {
  return guarded([&] {
    const auto& lights = c::require(scene, "scene").scene->lights;
    c::require(light, "light");
    if (index >= lights.size()) throw Error(ErrorCode::BadInput, "light " + std::to_string(index) + " of " + std::to_string(lights.size()));
    const scene::PunctualLight& from = lights[index];
    light->type = from.type;
    give(from.position, light->position);
    give(from.direction, light->direction);
    give(from.intensity, light->intensity);
    light->range = from.range;
    light->innerConeAngle = from.innerConeAngle;
    light->outerConeAngle = from.outerConeAngle;
  });
}

RadivoxResult radivoxSetSceneLights(RadivoxScene* scene, const RadivoxLight* lights, uint32_t lightCount, const float skyRadiance[3]) {
  return guarded([&] {
    c::require(scene, "scene");
    c::require(skyRadiance, "skyRadiance");
    std::vector<scene::PunctualLight> taken = takeLights(lights, lightCount);
    const glm::vec3 sky = takeSky({skyRadiance[0], skyRadiance[1], skyRadiance[2]});
    scene->scene->lights = std::move(taken);
    scene->scene->skyRadiance = sky;
  });
}

RadivoxResult radivoxMoveVertices(RadivoxScene* scene, uint32_t firstVertex, uint32_t vertexCount, const float matrix[16]) {
  return guarded([&] {
    c::require(scene, "scene");
    c::require(matrix, "matrix");
    scene::moveVertices(*scene->scene, firstVertex, vertexCount, glm::make_mat4(matrix));
  });
}

uint32_t radivoxObjectCount(const RadivoxScene* scene) {
  return scene == nullptr ? 0 : static_cast<uint32_t>(scene->scene->objects.size());
}

RadivoxResult radivoxGetObject(const RadivoxScene* scene, uint32_t index, const char** name, uint32_t* firstVertex, uint32_t* vertexCount) {
  return guarded([&] {
    c::require(scene, "scene");
    const std::vector<scene::Object>& objects = scene->scene->objects;
    if (index >= objects.size())
      throw Error(ErrorCode::BadInput, "index " + std::to_string(index) + ": the scene has " + std::to_string(objects.size()) +
                                           " objects; see radivoxObjectCount");
    if (name != nullptr) *name = objects[index].name.c_str();
    if (firstVertex != nullptr) *firstVertex = objects[index].firstVertex;
    if (vertexCount != nullptr) *vertexCount = objects[index].vertexCount;
  });
}
