#include "samples/report/content_key.h"

#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>

#include "engine/scene/sky.h"

namespace radivox::report {

namespace {

uint64_t mix(uint64_t x) {
  // Any odd constants and shifts that leave no bit unmoved.
  x ^= x >> 32;
  x *= 0xd6e8feb86659fd93u;
  x ^= x >> 29;
  x *= 0xa5cb9243f0aec77du;
  return x ^ (x >> 32);
}

}  // namespace

ContentKey& ContentKey::add(const void* bytes, size_t count) {
  const auto* from = static_cast<const unsigned char*>(bytes);
  while (count > 0) {
    const size_t step = count < 8 ? count : 8;
    uint64_t word = 0;
    std::memcpy(&word, from, step);
    high_ = mix(high_ ^ word) + 0x9e3779b97f4a7c15u;
    low_ = mix(low_ + word + high_) ^ step;
    from += step;
    count -= step;
  }
  return *this;
}

ContentKey& ContentKey::add(std::string_view text) { return add(text.size()).add(text.data(), text.size()); }

ContentKey& ContentKey::add(const scene::CameraDescription& c) {
  const float values[] = {c.position.x,    c.position.y, c.position.z, c.orientation.x, c.orientation.y, c.orientation.z,
                          c.orientation.w, c.yfov,       c.ymag,       c.znear,         c.zfar,          c.orthographic ? 1.f : 0.f};
  return add(values, sizeof values);
}

ContentKey& ContentKey::add(const scene::Scene& scene) {
  add(&scene.origin, sizeof scene.origin);
  addArray(scene.vertices);
  addArray(scene.indices);
  addArray(scene.triangleMaterials);
  addArray(scene.materials);
  add(scene.textures.size());
  for (const scene::TextureImage& texture : scene.textures) {
    const uint32_t words[] = {texture.width,         texture.height, texture.wrapU, texture.wrapV, texture.nearest ? 1u : 0u,
                              texture.srgb ? 1u : 0u};
    add(words, sizeof words);
    addArray(texture.rgba);
  }
  add(scene.lights.size());
  for (const scene::PunctualLight& light : scene.lights) {
    const float values[] = {light.position.x,  light.position.y,  light.position.z,     light.direction.x,
                            light.direction.y, light.direction.z, light.intensity.x,    light.intensity.y,
                            light.intensity.z, light.range,       light.innerConeAngle, light.outerConeAngle};
    add(light.type).add(values, sizeof values);
  }
  if (scene.sky) {
    const scene::Sky& sky = *scene.sky;
    add(sky.width).add(&sky.turn, sizeof sky.turn).add(sky.suns.size());
    addArray(sky.texels);
  }
  return add(&scene.skyRadiance, sizeof scene.skyRadiance);
}

std::string ContentKey::print() const {
  char text[40];
  std::snprintf(text, sizeof text, "%016llx%016llx", static_cast<unsigned long long>(mix(high_ ^ low_)),
                static_cast<unsigned long long>(low_));
  return text;
}

std::string programKey() {
  std::ifstream file("/proc/self/exe", std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  return ContentKey().add(bytes).print();
}

}  // namespace radivox::report
