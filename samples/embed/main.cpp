// A host with a device, a renderer and frames of its own, and global illumination inside: embed SCENE OUT.exr|.png [WIDTHxHEIGHT [FOG.so]]
#include <cstdio>
#include <exception>
#include <string>

#include "engine/image/image.h"
#include "gi.h"

namespace {

std::vector<HostVertex> takeVertices(const radivox::scene::Scene& scene) {
  std::vector<HostVertex> vertices;
  for (size_t i = 0; i < scene.indices.size(); ++i) {
    const auto& vertex = scene.vertices[scene.indices[i]];
    const auto& material = scene.materials[scene.triangleMaterials[i / 3]];
    vertices.push_back({vertex.position, vertex.normal, material.albedo, material.emission});
  }
  return vertices;
}

HostView lookThrough(const radivox::scene::CameraDescription& camera, const Host& host) {
  const radivox::shared::Camera view = radivox::scene::makeCamera(camera, host.width, host.height);
  return {view.viewProjection, view.inverseViewProjection, view.position, view.forward, {host.width, host.height}};
}

/// Radivox leaves its picture in GENERAL, with everything before seen by everything after.
void copyPicture(VkCommandBuffer commands, VkImage picture, VkBuffer to, const Host& host) {
  VkBufferImageCopy region{};
  region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
  region.imageExtent = {host.width, host.height, 1};
  vkCmdCopyImageToBuffer(commands, picture, VK_IMAGE_LAYOUT_GENERAL, to, 1, &region);
  const VkMemoryBarrier2 toHost{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2, nullptr,
                                VK_PIPELINE_STAGE_2_COPY_BIT,       VK_ACCESS_2_TRANSFER_WRITE_BIT,
                                VK_PIPELINE_STAGE_2_HOST_BIT,       VK_ACCESS_2_HOST_READ_BIT};
  VkDependencyInfo dependency{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
  dependency.memoryBarrierCount = 1;
  dependency.pMemoryBarriers = &toHost;
  vkCmdPipelineBarrier2(commands, &dependency);
}

void writePicture(const char* path, const HostBuffer& pixels, const Host& host) {
  radivox::image::Image image{host.width, host.height, 3, {}};
  const auto* rgba = static_cast<const float*>(pixels.mapped);
  for (size_t i = 0; i < size_t{host.width} * host.height; ++i) image.data.insert(image.data.end(), rgba + 4 * i, rgba + 4 * i + 3);
  if (std::string(path).ends_with(".png")) {
    return radivox::image::writePng(path, radivox::image::scaled(image, radivox::image::exposureOf(image)));
  }
  radivox::image::writeExr(path, {{"color", image}});
}

int run(int argc, char** argv) {
  uint32_t width = 320, height = 180;
  if (argc < 3 || (argc > 3 && std::sscanf(argv[3], "%ux%u", &width, &height) != 2)) {
    std::fprintf(stderr, "embed SCENE OUT.exr|.png [WIDTHxHEIGHT [FOG.so]]\n");
    return 2;
  }
  radivox::scene::Scene scene = radivox::scene::loadScene(argv[1]);
  std::unique_ptr<radivox::gpu::DeviceRequirements> requirements;
  DeviceWishes wishes;
  Host host(width, height, [&](VkPhysicalDevice physicalDevice) {
    requirements = std::make_unique<radivox::gpu::DeviceRequirements>(physicalDevice);
    if (!requirements->missing().empty()) throw std::runtime_error("the device lacks " + requirements->missing().front());
    return wishes = {requirements->chain(), requirements->extensions(), requirements->queueFamily()};
  });
  HostGBuffer gbuffer(host, takeVertices(scene));
  Gi gi(host, gbuffer, scene, wishes, argc > 4 ? argv[4] : "");
  const HostBuffer pixels = host.makeBuffer(VkDeviceSize{width} * height * 16, VK_BUFFER_USAGE_TRANSFER_DST_BIT);

  // The camera walks to its place, and the first light swings home: the last frame is the scene as it is.
  const radivox::scene::CameraDescription home = scene.cameras[0];
  const std::vector<radivox::scene::PunctualLight> lights = scene.lights;
  constexpr int kFrames = 5;
  int recorded = 0;
  for (int frame = 0; frame < kFrames; ++frame) {
    const float away = static_cast<float>(kFrames - 1 - frame) * 0.05f;
    radivox::scene::CameraDescription camera = home;
    camera.position.x += away;
    gi.moveCamera(camera);
    if (!lights.empty() && frame % 2 == 0) {
      scene.lights[0].position = lights[0].position + glm::vec3(away, 0.f, 0.f);
      gi.moveLights(scene);
    }
    VkCommandBuffer commands = host.beginCommands();
    gbuffer.draw(commands, lookThrough(camera, host));
    const bool isRecorded = gi.record(commands);
    if (!isRecorded) {
      host.submitAndWait();
      gi.runNow();
      commands = host.beginCommands();
    }
    copyPicture(commands, gi.picture(), pixels.buffer, host);
    host.submitAndWait();
    if (isRecorded) gi.finished();
    recorded += isRecorded ? 1 : 0;
  }
  writePicture(argv[2], pixels, host);
  std::printf("%d of %d frames in the host's own command buffer\n", recorded, kFrames);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "embed: %s\n", e.what());
    return 1;
  }
}
