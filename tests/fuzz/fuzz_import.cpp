// libFuzzer target: bytes that claim to be a glTF file. They load, or are refused in one line; anything else is a finding.
#include <sys/mman.h>
#include <unistd.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "engine/error.h"
#include "engine/scene/gltf.h"

namespace {

[[noreturn]] void reportFinding(const std::string& what) {
  std::fprintf(stderr, "finding: %s\n", what.c_str());
  std::abort();
}

void checkScene(const radivox::scene::Scene& scene) {
  for (const uint32_t index : scene.indices) {
    if (index >= scene.vertices.size()) reportFinding("an index is out of range");
  }
  for (const uint32_t material : scene.triangleMaterials) {
    if (material >= scene.materials.size()) reportFinding("a material is out of range");
  }
  for (const auto& v : scene.vertices) {
    const float sum = v.position.x + v.position.y + v.position.z + v.normal.x + v.normal.y + v.normal.z + v.uvBase.x + v.uvBase.y;
    if (!std::isfinite(sum)) reportFinding("a vertex is not finite");
  }
  for (const auto& m : scene.materials) {
    const float sum = m.albedo.x + m.albedo.y + m.albedo.z + m.alpha + m.emission.x + m.emission.y + m.emission.z + m.alphaCutoff;
    if (!std::isfinite(sum)) reportFinding("a material is not finite");
  }
  for (const auto& camera : scene.cameras) {
    if (!std::isfinite(camera.position.x + camera.position.y + camera.position.z + camera.zfar + camera.znear + camera.orientation.w))
      reportFinding("a camera is not finite");
  }
  for (const auto& light : scene.lights) {
    if (!std::isfinite(light.position.x + light.direction.x + light.intensity.x + light.range)) reportFinding("a light is not finite");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const int file = memfd_create("fuzz", 0);
  static const std::string path = "/proc/self/fd/" + std::to_string(file);
  if (ftruncate(file, 0) != 0 || pwrite(file, data, size, 0) != static_cast<ssize_t>(size)) reportFinding("no memory for the file");
  try {
    checkScene(radivox::scene::importGltf(path));
  } catch (const radivox::Error& error) {
    const std::string text = error.what();
    if (text.find('\n') != std::string::npos) reportFinding("an error of several lines: " + text);
    if (text.rfind(path, 0) != 0) reportFinding("an error that does not name the file: " + text);
  }
  return 0;
}
