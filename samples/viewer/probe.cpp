#include "samples/viewer/probe.h"

#include <algorithm>

#include "modules/clustered_voxel/visibility/directions.h"
#include "shaders/clustered_voxel/visibility/visibility.h"
#include "shaders/shared/visibility_row.h"

namespace radivox::viewer {

namespace {

using shared::kMissBase;
constexpr const char* kVisibility = "clustered_voxel.visibility";

/// As viewer/rays.comp writes them.
struct RayEnd {
  glm::vec3 direction;
  float time;  ///< voxels
  uint32_t hit, cluster;
};
static_assert(sizeof(RayEnd) == 24);

template <class T>
T readOne(gpu::Device& device, const gpu::Buffer& buffer, uint64_t index) {
  const std::vector<std::byte> raw = gpu::download(device, buffer, index * sizeof(T), sizeof(T));
  T value;
  std::memcpy(&value, raw.data(), sizeof(T));
  return value;
}

std::string paramOf(const Ports& ports, const char* name) {
  for (const params::Param& param : ports.node(kVisibility)->params().all()) {
    if (param.name == name) return param.get();
  }
  return {};
}

glm::vec3 toWorld(const shared::Grid& grid, const glm::vec3& p) { return grid.origin + p * grid.h; }

}  // namespace

PointedFace FaceProbe::read(const Ports& ports, uint32_t face) {
  PointedFace pointed;
  pointed.id = face;
  grid_ = readOne<shared::Grid>(device_, *ports.buffer("clustered_voxel.voxelize", "grid"), 0);
  const auto data = readOne<shared::Face>(device_, *ports.buffer("clustered_voxel.surface", "faces"), face);
  pointed.voxel = shared::unpackVoxel(readOne<uint32_t>(device_, *ports.buffer("clustered_voxel.index", "voxels"), data.key >> 3));
  pointed.direction = data.key & 7u;
  pointed.area = data.area * grid_.h * grid_.h;
  pointed.position = toWorld(grid_, shared::facePosition(data, pointed.voxel));
  pointed.normal = shared::decodeNormal(data.normal);
  pointed.albedo = shared::decodeAlbedo(data.albedo);
  pointed.cluster = readOne<uint32_t>(device_, *ports.buffer("clustered_voxel.cluster", "labels"), face);
  if (const gpu::Buffer* direct = ports.buffer("clustered_voxel.inject", "face_irradiance"))
    pointed.direct = readOne<glm::vec3>(device_, *direct, face);
  const gpu::Buffer* valid = ports.buffer("clustered_voxel.gather", "valid");
  const gpu::Buffer* indirect = ports.buffer("clustered_voxel.gather", "irradiance");
  if (valid != nullptr && indirect != nullptr && (readOne<uint32_t>(device_, *valid, face / 32) >> face % 32 & 1u) != 0)
    pointed.indirect = glm::vec3(readOne<glm::vec4>(device_, *indirect, face));
  readRow(ports, pointed);
  if (isRetraceable(ports)) {
    traceRays(ports, pointed);
  } else {
    pointToClusters(ports, pointed);
  }
  return pointed;
}

/// viewer/rays.comp walks voxels as visibility's default does; the paper's lines and rays that meet triangles it does not know.
bool FaceProbe::isRetraceable(const Ports& ports) {
  const std::string triangles = paramOf(ports, "triangles");
  const bool meetsTriangles = !triangles.empty() && std::stod(triangles) > 0 && !ports.grown("clustered_voxel.triangles", "ids").empty();
  return paramOf(ports, "traversal") == "dda" && !meetsTriangles;
}

void FaceProbe::pointToClusters(const Ports& ports, PointedFace& pointed) {
  const std::vector<shared::ClusterPlace> clusters =
      gpu::downloadAs<shared::ClusterPlace>(device_, *ports.buffer("clustered_voxel.members", "places"), ports.count("clusters"));
  for (const auto& [cluster, rays] : pointed.clusters) {
    PointedFace::Ray ray;
    ray.end = toWorld(grid_, clusters.at(cluster).position);
    ray.cluster = cluster;
    pointed.rays.push_back(ray);
  }
}

void FaceProbe::readRow(const Ports& ports, PointedFace& pointed) {
  const uint32_t face = pointed.id, chunk = face / shared::kRowsPerChunk;
  const gpu::Buffer& rowStart = *ports.buffer(kVisibility, "row_start");
  const uint64_t slot = uint64_t{face} + chunk;
  const auto begin = readOne<uint32_t>(device_, rowStart, slot), end = readOne<uint32_t>(device_, rowStart, slot + 1);
  const std::vector<const gpu::Buffer*> chunks = ports.grown(kVisibility, "entries");
  if (chunk >= chunks.size() || begin >= end) return;
  const uint32_t firstWord = begin / 32, endWord = (end + 31) / 32 + shared::kRowPadding;
  const std::vector<std::byte> raw = gpu::download(device_, *chunks[chunk], uint64_t{firstWord} * 4, uint64_t{endWord - firstWord} * 4);
  std::vector<uint32_t> words(endWord - firstWord);
  std::memcpy(words.data(), raw.data(), raw.size());
  const auto clusterCount = static_cast<uint32_t>(ports.count("clusters"));
  const auto idCount = static_cast<uint32_t>(clusterCount + ports.count("faces"));
  shared::forEachRowEntry(words.data(), begin - firstWord * 32, end - firstWord * 32, idCount, [&](uint32_t id, uint32_t rays) {
    pointed.rayCount += rays;
    if (id == shared::kAbsorbed) {
      pointed.absorbed += rays;
    } else if (id >= kMissBase) {
      pointed.misses += rays;
    } else if (id < clusterCount) {
      pointed.clusters[id] += rays;
    } else {
      pointed.faces[id - clusterCount] += rays;
    }
  });
}

void FaceProbe::traceRays(const Ports& ports, PointedFace& pointed) {
  const std::string key = paramOf(ports, "rays") + " " + paramOf(ports, "hit") + " " + paramOf(ports, "frame");
  if (key != pipelineKey_) {
    rayCount_ = static_cast<uint32_t>(std::stoul(paramOf(ports, "rays")));
    const uint32_t hit = paramOf(ports, "hit") == "voxel" ? 1 : 0, frame = paramOf(ports, "frame") == "axis" ? 1 : 0;
    pipeline_ =
        gpu::Pipeline(device_, gpu::ComputePipelineInfo{.shader = "viewer/rays.comp",
                                                        .bindings = std::vector<gpu::BindingType>(12, gpu::BindingType::StorageBuffer),
                                                        .pushConstantBytes = 12,
                                                        .constants = {{1, hit}, {2, frame}}});
    const std::vector<uint32_t> directions = clustered_voxel::makeDirections(rayCount_);
    directions_ = gpu::Buffer(device_, "viewer.directions", directions.size() * 4);
    gpu::upload(device_, directions_, directions);
    ends_ = gpu::Buffer(device_, "viewer.ray_ends", uint64_t{rayCount_} * sizeof(RayEnd));
    pipelineKey_ = key;
  }
  struct {
    uint32_t face, rayCount, voxelCount;
  } push{pointed.id, rayCount_, static_cast<uint32_t>(ports.count("voxels"))};
  pool_.reset();
  device_.submitAndWait([&](VkCommandBuffer handle) {
    gpu::Commands commands(device_, handle, pool_);
    commands.barrier();
    commands.bind(pipeline_,
                  {*ports.buffer("clustered_voxel.voxelize", "grid"), *ports.buffer("clustered_voxel.voxelize", "occupancy"),
                   *ports.buffer("clustered_voxel.index", "rank"), *ports.buffer("clustered_voxel.index", "voxels"),
                   *ports.buffer("clustered_voxel.index", "distance"), *ports.grown(kVisibility, "planes").at(0),
                   *ports.buffer("clustered_voxel.faces", "first"), *ports.buffer("clustered_voxel.surface", "faces"),
                   *ports.buffer(kVisibility, "plane_extras"), directions_, *ports.buffer("clustered_voxel.cluster", "labels"), ends_});
    commands.push(push);
    commands.dispatchItems(rayCount_, 64);
    commands.barrier();
  });
  for (const RayEnd& end : gpu::downloadAs<RayEnd>(device_, ends_, rayCount_)) {
    PointedFace::Ray ray;
    ray.end = pointed.position + end.direction * (end.time * grid_.h);
    if (end.hit < shared::kNone - 1u) {
      ray.hit = end.hit;
      ray.cluster = end.cluster;
    }
    pointed.rays.push_back(ray);
  }
}

}  // namespace radivox::viewer
