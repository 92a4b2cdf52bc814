#include "modules/reference/scene_from_buffers.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "engine/scene/sky.h"
#include "shaders/shared/sky.h"

namespace radivox::reference {

namespace {

template <class T>
std::vector<T> readItems(graph::RecordContext& context, std::string_view port, size_t count) {
  std::vector<T> items(count);
  if (count == 0) return items;
  const std::vector<std::byte> raw = context.readBuffer(port, 0, count * sizeof(T));
  std::memcpy(items.data(), raw.data(), raw.size());
  return items;
}

}  // namespace

scene::Scene readScene(graph::RecordContext& context) {
  scene::Scene scene;
  const auto info = readItems<shared::SceneInfo>(context, "scene.info", 1).front();
  scene.vertices = readItems<shared::Vertex>(context, "scene.vertices", context.count("vertices"));
  scene.indices = readItems<uint32_t>(context, "scene.indices", 3 * context.count("triangles"));
  scene.triangleMaterials = readItems<uint32_t>(context, "scene.triangle_materials", context.count("triangles"));
  scene.materials = readItems<shared::Material>(context, "scene.materials", context.count("materials"));
  scene.skyRadiance = info.skyRadiance;
  if (info.skyWidth > 0) {
    auto sky = std::make_shared<scene::Sky>();
    sky->width = info.skyWidth;
    sky->height = info.skyHeight;
    sky->turn = info.skyTurn;
    const auto values = readItems<glm::vec3>(context, "scene.sky", context.count("sky_texels"));
    sky->texels.assign(values.begin() + shared::kSkyFirstTexel, values.end());
    scene.sky = std::move(sky);
  }
  for (const shared::Light& light : readItems<shared::Light>(context, "scene.lights", info.lightCount)) {
    if (light.type == shared::kLightEmitterSample) continue;  // the emissive triangles themselves are sampled here
    if (light.triangle == shared::kSkySun) continue;          // and the sky's texels
    scene::PunctualLight out;
    out.type = light.type;
    out.position = light.position;
    out.direction = light.direction;
    out.intensity = light.intensity;
    out.range = light.range;
    out.innerConeAngle = std::acos(std::clamp(light.cosInner, -1.f, 1.f));
    out.outerConeAngle = std::acos(std::clamp(light.cosOuter, -1.f, 1.f));
    scene.lights.push_back(out);
  }
  for (const shared::Texture& texture : readItems<shared::Texture>(context, "scene.textures", context.traits().textureCount)) {
    scene::TextureImage image;
    image.width = texture.width;
    image.height = texture.height;
    image.wrapU = texture.wrapU;
    image.wrapV = texture.wrapV;
    image.nearest = (texture.flags & shared::kTextureNearest) != 0u;
    image.srgb = (texture.flags & shared::kTextureSrgb) != 0u;
    scene.textures.push_back(std::move(image));
  }
  return scene;
}

scene::CameraDescription describeCamera(const shared::Camera& camera) {
  scene::CameraDescription out;
  // Clip space has x right and y down; column k of the inverse is where it moves the eye's ray (perspective) or point (orthographic).
  const glm::dvec3 right = glm::normalize(glm::dvec3(camera.inverseViewProjection[0]));
  const glm::dvec3 up = -glm::normalize(glm::dvec3(camera.inverseViewProjection[1]));
  const double halfHeight = 0.5 * static_cast<double>(camera.pixelAngle) * camera.height;
  out.position = camera.position;
  out.orientation = glm::quat(glm::quat_cast(glm::dmat3(right, up, -glm::dvec3(camera.forward))));
  out.orthographic = camera.orthographic != 0u;
  if (out.orthographic) {
    // Depth is 1 at the near end and 0 at the far one.
    const glm::dmat4 m(camera.viewProjection);
    const double range = 1.0 / glm::length(glm::dvec3(m[0][2], m[1][2], m[2][2]));
    const double depthAtEye = (m * glm::dvec4(glm::dvec3(camera.position), 1.0)).z;
    out.ymag = static_cast<float>(halfHeight);
    out.zfar = static_cast<float>(depthAtEye * range);
    out.znear = static_cast<float>(depthAtEye * range - range);
  } else {
    out.yfov = static_cast<float>(2.0 * std::atan(halfHeight));
    out.znear = 1.f / camera.inverseViewProjection[2][3];
  }
  return out;
}

scene::CameraDescription readCamera(graph::RecordContext& context, uint32_t& width, uint32_t& height) {
  const auto camera = readItems<shared::Camera>(context, "view.camera", 1).front();
  width = camera.width;
  height = camera.height;
  return describeCamera(camera);
}

}  // namespace radivox::reference
