// What lies in the file is what lies in the GPU's buffers, voxel by voxel: read back with the libraries' own readers and derived again here
// from the definitions in docs/vdb.md.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <set>

#include "shaders/shared/id_colour.h"
#include "shaders/shared/visibility_row.h"
#include "tests/oracles/gpu_fixture.h"
#include "tests/vdb/vdb_run.h"

namespace radivox::test {
namespace {

namespace fs = std::filesystem;
using openvdb::Coord;

constexpr const char* kFaces[] = {"_pos_x", "_neg_x", "_pos_y", "_neg_y", "_pos_z", "_neg_z"};

openvdb::Vec3f toVdb(const glm::vec3& v) { return {v.x, v.y, v.z}; }

/// Everything that the grids are made of, as the GPU left it.
struct Truth {
  std::vector<uint32_t> voxels, mask, first, labels, valid, fragments, visible;
  std::vector<std::set<uint32_t>> seen;  ///< clusters by face
  std::vector<shared::Face> faces;
  std::vector<shared::ClusterPlace> clusters;
  std::vector<glm::vec3> normals, direct, error;
  std::vector<glm::vec4> indirect;
  std::vector<float> misses;

  explicit Truth(const VdbRun& run) {
    const size_t v = run.count("voxels"), f = run.count("faces"), c = run.count("clusters");
    voxels = run.buffer<uint32_t>("index.voxels", v);
    mask = run.buffer<uint32_t>("faces.mask", v);
    first = run.buffer<uint32_t>("faces.first", v + 1);
    faces = run.buffer<shared::Face>("surface.faces", f);
    labels = run.buffer<uint32_t>("cluster.labels", f);
    clusters = run.buffer<shared::ClusterPlace>("members.places", c);
    fragments = run.buffer<uint32_t>("fragments.count", v);
    normals = run.buffer<glm::vec3>("fragments.normal", v);
    direct = run.buffer<glm::vec3>("inject.face_irradiance", f);
    indirect = run.buffer<glm::vec4>("gather.irradiance", f);
    error = run.buffer<glm::vec3>("gather.error", f);
    valid = run.buffer<uint32_t>("gather.valid", (f + 31) / 32);
    const auto chunks = run.executor->findGrown("visibility.entries");
    const auto starts = run.buffer<uint32_t>("visibility.row_start", chunks.size() * (shared::kRowsPerChunk + 1));
    std::vector<uint32_t> words;
    for (uint32_t s = 0; s < f; ++s) {
      const size_t slot = s + s / shared::kRowsPerChunk;
      if (s % shared::kRowsPerChunk == 0) {
        const gpu::Buffer& chunk = *chunks[s / shared::kRowsPerChunk];
        words = gpu::downloadAs<uint32_t>(oracles::sharedDevice(), chunk, chunk.bytes() / 4);
      }
      std::set<uint32_t> distinct;
      uint32_t rays = 0, missed = 0;
      shared::forEachRowEntry(words.data(), starts[slot], starts[slot + 1], static_cast<uint32_t>(c + f), [&](uint32_t id, uint32_t hits) {
        rays += hits;
        if (id >= shared::kMissBase) {
          missed += id < shared::kAbsorbed ? hits : 0;
        } else {
          distinct.insert(id < c ? id : labels.at(id - c));
        }
      });
      seen.push_back(distinct);
      misses.push_back(static_cast<float>(missed) / static_cast<float>(rays));
    }
  }

  bool isValid(uint32_t s) const { return ((valid[s / 32] >> (s % 32)) & 1) != 0; }
  uint32_t largestFace(size_t v) const {
    uint32_t best = first[v];
    for (uint32_t s = first[v]; s < first[v + 1]; ++s) best = faces[s].area > faces[best].area ? s : best;
    return best;
  }
  Coord coordOf(size_t v) const {
    const glm::uvec3 p = shared::unpackVoxel(voxels[v]);
    return {static_cast<int>(p.x), static_cast<int>(p.y), static_cast<int>(p.z)};
  }
};

template <class GridType>
using Expected = std::map<Coord, typename GridType::ValueType>;

double distance(float a, float b) { return std::abs(static_cast<double>(a) - static_cast<double>(b)); }
double distance(int32_t a, int32_t b) { return std::abs(static_cast<double>(a) - b); }
double distance(const openvdb::Vec3f& a, const openvdb::Vec3f& b) { return static_cast<double>((a - b).length()); }

/// The same active voxels and the same values, up to `tolerance`.
template <class GridType>
void expectGrid(const std::vector<openvdb::GridBase::Ptr>& grids, const std::string& name, const Expected<GridType>& expected,
                double tolerance = 0.0) {
  SCOPED_TRACE(name);
  const openvdb::GridBase::Ptr base = findGrid(grids, name);
  ASSERT_NE(base, nullptr);
  const auto grid = openvdb::gridPtrCast<GridType>(base);
  ASSERT_NE(grid, nullptr) << "is a grid of " << base->valueType();
  ASSERT_EQ(grid->activeVoxelCount(), expected.size());
  const auto accessor = grid->getConstAccessor();
  size_t wrong = 0;
  for (const auto& [at, want] : expected) {
    typename GridType::ValueType have;
    if (!accessor.probeValue(at, have) || distance(have, want) > tolerance) ++wrong;
  }
  EXPECT_EQ(wrong, 0u) << "of " << expected.size() << " voxels";
}

/// A family by face: six grids.
template <class GridType, class ValueOf>
void expectFaces(const std::vector<openvdb::GridBase::Ptr>& grids, const Truth& truth, const std::string& family, ValueOf valueOf) {
  Expected<GridType> byFace[6];
  for (size_t v = 0; v < truth.voxels.size(); ++v) {
    for (uint32_t s = truth.first[v]; s < truth.first[v + 1]; ++s) {
      const bool lazy = family == "indirect" || family == "error";
      if (lazy && !truth.isValid(s)) continue;
      byFace[truth.faces[s].key & 7][truth.coordOf(v)] = valueOf(s);
    }
  }
  for (int f = 0; f < 6; ++f) expectGrid<GridType>(grids, family + kFaces[f], byFace[f]);
}

/// The voxel's mean over its faces by area.
template <class ValueOf>
void expectMean(const std::vector<openvdb::GridBase::Ptr>& grids, const Truth& truth, const std::string& family, ValueOf valueOf) {
  Expected<openvdb::Vec3fGrid> expected;
  double largest = 0;
  for (size_t v = 0; v < truth.voxels.size(); ++v) {
    glm::dvec3 sum(0.0);
    double area = 0;
    for (uint32_t s = truth.first[v]; s < truth.first[v + 1]; ++s) {
      if ((family == "indirect" || family == "error") && !truth.isValid(s)) continue;
      sum += static_cast<double>(truth.faces[s].area) * glm::dvec3(valueOf(s));
      area += static_cast<double>(truth.faces[s].area);
    }
    if (area > 0) expected[truth.coordOf(v)] = toVdb(glm::vec3(sum / area));
    if (area > 0) largest = std::max(largest, glm::length(sum / area));
  }
  expectGrid<openvdb::Vec3fGrid>(grids, family, expected, 1e-5 * largest);
}

void expectSameAsBuffers(const VdbRun& run, const std::vector<openvdb::GridBase::Ptr>& grids) {
  const Truth t(run);
  Expected<openvdb::FloatGrid> occupancy, area, lit, misses;
  Expected<openvdb::Int32Grid> fragments, id, visible;
  Expected<openvdb::Vec3fGrid> normal, color, clusterNormal;
  for (size_t v = 0; v < t.voxels.size(); ++v) {
    const Coord at = t.coordOf(v);
    occupancy[at] = 1.f;
    fragments[at] = static_cast<int32_t>(t.fragments[v]);
    normal[at] = toVdb(t.normals[v]);
    if (t.mask[v] == 0) continue;
    double whole = 0, litArea = 0, missed = 0;
    std::set<uint32_t> seen;
    for (uint32_t s = t.first[v]; s < t.first[v + 1]; ++s) {
      const auto a = static_cast<double>(t.faces[s].area);
      whole += a;
      litArea += t.direct[s] != glm::vec3(0.f) ? a : 0.0;
      missed += a * static_cast<double>(t.misses[s]);
      seen.insert(t.seen[s].begin(), t.seen[s].end());
    }
    const uint32_t cluster = t.labels[t.largestFace(v)];
    area[at] = static_cast<float>(whole);
    lit[at] = static_cast<float>(litArea / whole);
    misses[at] = static_cast<float>(missed / whole);
    visible[at] = static_cast<int32_t>(seen.size());
    id[at] = static_cast<int32_t>(cluster);
    color[at] = toVdb(shared::colourOfId(cluster));
    clusterNormal[at] = toVdb(t.clusters[cluster].normal);
  }
  expectGrid<openvdb::FloatGrid>(grids, "occupancy", occupancy);
  expectGrid<openvdb::Int32Grid>(grids, "fragment_count", fragments);
  expectGrid<openvdb::Vec3fGrid>(grids, "mean_normal", normal);
  expectGrid<openvdb::FloatGrid>(grids, "area", area, 1e-5);
  expectGrid<openvdb::FloatGrid>(grids, "lit", lit, 1e-5);
  expectGrid<openvdb::FloatGrid>(grids, "misses", misses, 1e-5);
  expectGrid<openvdb::Int32Grid>(grids, "visible_clusters", visible);
  expectGrid<openvdb::Int32Grid>(grids, "cluster_id", id);
  expectGrid<openvdb::Vec3fGrid>(grids, "cluster_color", color);
  expectGrid<openvdb::Vec3fGrid>(grids, "cluster_normal", clusterNormal);

  const auto normalOf = [&](uint32_t s) { return shared::decodeNormal(t.faces[s].normal); };
  const auto albedoOf = [&](uint32_t s) { return shared::decodeAlbedo(t.faces[s].albedo); };
  using openvdb::FloatGrid, openvdb::Int32Grid, openvdb::Vec3fGrid;
  expectFaces<Vec3fGrid>(grids, t, "mean_normal", [&](uint32_t s) { return toVdb(normalOf(s)); });
  expectFaces<Vec3fGrid>(grids, t, "albedo", [&](uint32_t s) { return toVdb(albedoOf(s)); });
  expectFaces<FloatGrid>(grids, t, "area", [&](uint32_t s) { return t.faces[s].area; });
  expectFaces<Int32Grid>(grids, t, "cluster_id", [&](uint32_t s) { return static_cast<int32_t>(t.labels[s]); });
  expectFaces<Vec3fGrid>(grids, t, "cluster_color", [&](uint32_t s) { return toVdb(shared::colourOfId(t.labels[s])); });
  expectFaces<Vec3fGrid>(grids, t, "cluster_normal", [&](uint32_t s) { return toVdb(t.clusters[t.labels[s]].normal); });
  expectFaces<FloatGrid>(grids, t, "lit", [&](uint32_t s) { return t.direct[s] != glm::vec3(0.f) ? 1.f : 0.f; });
  expectFaces<Vec3fGrid>(grids, t, "direct", [&](uint32_t s) { return toVdb(t.direct[s]); });
  expectFaces<Vec3fGrid>(grids, t, "indirect", [&](uint32_t s) { return toVdb(glm::vec3(t.indirect[s])); });
  expectFaces<Vec3fGrid>(grids, t, "error", [&](uint32_t s) { return toVdb(t.error[s]); });
  expectFaces<Int32Grid>(grids, t, "visible_clusters", [&](uint32_t s) { return static_cast<int32_t>(t.seen[s].size()); });
  expectFaces<FloatGrid>(grids, t, "misses", [&](uint32_t s) { return t.misses[s]; });
  expectMean(grids, t, "albedo", albedoOf);
  expectMean(grids, t, "direct", [&](uint32_t s) { return t.direct[s]; });
  expectMean(grids, t, "indirect", [&](uint32_t s) { return glm::vec3(t.indirect[s]); });
  expectMean(grids, t, "error", [&](uint32_t s) { return t.error[s]; });
  EXPECT_EQ(grids.size(), 2u + 12u * 7u) << "grids that nobody looked at";
}

class VdbTest : public oracles::GpuTest {
 protected:
  void SetUp() override {
    GpuTest::SetUp();
    std::string pattern = (fs::temp_directory_path() / "radivox_vdb_XXXXXX").string();
    ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
  }
  void TearDown() override {
    fs::remove_all(folder_);
    GpuTest::TearDown();
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  static std::string read(const std::string& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  }
  fs::path folder_;
};

TEST_F(VdbTest, EveryVoxelOfEveryGridIsThatOfTheBuffersSlow) {
  for (const char* file : {"a.vdb", "a.nvdb"}) {
    SCOPED_TRACE(file);
    const VdbRun run(device(), scene::loadScene("builtin:cornell"), {.file = path(file)});
    expectSameAsBuffers(run, readGrids(path(file)));
    EXPECT_EQ(fs::file_size(path(file)), run.sink().summary().fileBytes);
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 2) << "something is left beside the files";
}

TEST_F(VdbTest, SoItIsWithManyChunksOfRowsSlow) {
  const VdbRun run(device(), scene::loadScene("builtin:atrium?triangles=20000"), {.file = path("a.vdb"), .resolution = "48"});
  ASSERT_GT(run.count("faces"), shared::kRowsPerChunk);
  expectSameAsBuffers(run, readGrids(path("a.vdb")));
}

TEST_F(VdbTest, FacesThatTheViewDoesNotNeedAreNotThereSlow) {
  const VdbRun run(device(), scene::loadScene("builtin:cornell"), {.file = path("a.vdb"), .allFaces = false, .width = 8, .height = 8});
  const auto grids = readGrids(path("a.vdb"));
  expectSameAsBuffers(run, grids);
  EXPECT_LT(findGrid(grids, "indirect")->activeVoxelCount(), findGrid(grids, "direct")->activeVoxelCount());
  EXPECT_GT(findGrid(grids, "indirect")->activeVoxelCount(), 0u);
}

TEST_F(VdbTest, TheSameSceneGivesTheSameBytesAndAnotherOneAnotherTagSlow) {
  constexpr const char* kGrids = "occupancy,cluster_id,direct_faces";
  for (const char* extension : {".vdb", ".nvdb"}) {
    const scene::Scene scene = scene::loadScene("builtin:cornell");
    VdbRun(device(), scene, {.file = path(std::string("a") + extension), .grids = kGrids});
    VdbRun(device(), scene, {.file = path(std::string("b") + extension), .grids = kGrids});
    EXPECT_EQ(read(path(std::string("a") + extension)), read(path(std::string("b") + extension))) << extension;
  }
  VdbRun(device(), scene::loadScene("builtin:cornell"), {.file = path("c.vdb"), .grids = kGrids, .resolution = "21"});
  openvdb::io::File a(path("a.vdb")), c(path("c.vdb"));
  a.open();
  c.open();
  EXPECT_EQ(a.getUniqueTag().size(), 36u);
  EXPECT_NE(a.getUniqueTag(), c.getUniqueTag()) << "programs compare tags to see whether a file has changed";
}

TEST_F(VdbTest, SlowOnlyWhatAGridNeedsIsComputed) {
  const scene::Scene scene = scene::loadScene("builtin:cornell");
  const VdbRun occupancy(device(), scene, {.file = path("a.vdb"), .grids = "occupancy"});
  for (const char* node : {"faces", "surface", "cluster", "visibility", "inject", "bounce", "gather", "gbuffer", "shadow_map"})
    EXPECT_FALSE(occupancy.ran(node)) << node;
  EXPECT_EQ(readGrids(path("a.vdb")).size(), 1u);
  const VdbRun direct(device(), scene, {.file = path("b.vdb"), .grids = "direct_faces,lit"});
  for (const char* node : {"visibility", "transfer", "bounce", "gather", "gbuffer"}) EXPECT_FALSE(direct.ran(node)) << node;
  EXPECT_TRUE(direct.ran("inject"));
}

TEST_F(VdbTest, RaysNeedNoLightAndLightIsTheSameWithAndWithoutThemSlow) {
  const scene::Scene scene = scene::loadScene("builtin:cornell");
  const VdbRun rays(device(), scene, {.file = path("a.vdb"), .grids = "misses"});
  EXPECT_TRUE(rays.ran("visibility"));
  for (const char* node : {"inject", "bounce", "gather"}) EXPECT_FALSE(rays.ran(node)) << node;
  const VdbRun with(device(), scene, {.file = path("b.vdb"), .grids = "direct,misses,indirect"});
  const VdbRun without(device(), scene, {.file = path("c.vdb"), .grids = "direct"});
  EXPECT_TRUE(with.ran("visibility"));
  EXPECT_FALSE(without.ran("visibility"));
  const size_t faces = with.count("faces");
  EXPECT_EQ(with.buffer<glm::vec3>("inject.face_irradiance", faces), without.buffer<glm::vec3>("inject.face_irradiance", faces));
}

TEST_F(VdbTest, SlowPlaceNamesClassesAndMetadata) {
  scene::Scene scene = scene::loadScene("builtin:cornell");
  scene.origin = {1e6, -2e6, 0.25};
  const VdbRun run(device(), scene, {.file = path("a.vdb"), .grids = "occupancy,mean_normal,cluster_id,direct"});
  VdbRun(device(), scene, {.file = path("z.vdb"), .grids = "mean_normal,mean_normal_faces", .up = "z"});
  const auto grid = run.buffer<shared::Grid>("voxelize.grid", 1).front();
  const glm::dvec3 at = scene.origin + glm::dvec3(grid.origin) + static_cast<double>(grid.h) * glm::dvec3(3.5, 4.5, 5.5);
  for (const auto& one : readGrids(path("a.vdb"))) {
    const openvdb::Vec3d p = one->transform().indexToWorld(openvdb::Vec3d(3, 4, 5));
    EXPECT_NEAR(p.x(), at.x, 1e-9) << one->getName();
    EXPECT_NEAR(p.y(), at.y, 1e-9);
    EXPECT_NEAR(p.z(), at.z, 1e-9);
    EXPECT_EQ(one->metaValue<std::string>("radivox_scene"), "a scene");
    EXPECT_EQ(one->metaValue<int32_t>("radivox_resolution"), 20);
    EXPECT_FALSE(one->metaValue<std::string>("radivox_unit").empty());
    EXPECT_FALSE(one->metaValue<std::string>("radivox_meaning").empty());
    EXPECT_FALSE(one->metaValue<std::string>("radivox_version").empty());
    EXPECT_TRUE(one->hasUniformVoxels());
  }
  const auto grids = readGrids(path("a.vdb"));
  EXPECT_EQ(findGrid(grids, "occupancy")->getGridClass(), openvdb::GRID_FOG_VOLUME);
  EXPECT_EQ(findGrid(grids, "cluster_id")->getGridClass(), openvdb::GRID_UNKNOWN);
  EXPECT_EQ(findGrid(grids, "mean_normal")->getVectorType(), openvdb::VEC_COVARIANT_NORMALIZE);
  EXPECT_EQ(findGrid(grids, "direct")->getVectorType(), openvdb::VEC_INVARIANT);
  openvdb::io::File file(path("a.vdb"));
  file.open();
  EXPECT_EQ(file.getMetadata()->metaValue<int32_t>("radivox_resolution"), 20);
  EXPECT_NE(file.compression() & openvdb::io::COMPRESS_ACTIVE_MASK, 0u);
  // Blender's turn of glTF: (x, y, z) → (x, −z, y), places and directions alike.
  const auto turned = readGrids(path("z.vdb"));
  const openvdb::Vec3d p = turned.front()->transform().indexToWorld(openvdb::Vec3d(3, 4, 5));
  EXPECT_NEAR(p.x(), at.x, 1e-9);
  EXPECT_NEAR(p.y(), -at.z, 1e-9);
  EXPECT_NEAR(p.z(), at.y, 1e-9);
  const auto floor = openvdb::gridPtrCast<openvdb::Vec3fGrid>(findGrid(turned, "mean_normal_pos_y"));
  for (auto value = floor->cbeginValueOn(); value; ++value) ASSERT_GT(value->z(), 0.f) << "what faced +y faces up";
}

TEST_F(VdbTest, AViewerDumpsTheSameFromItsOwnExecutorSlow) {
  const VdbRun run(device(), scene::loadScene("builtin:cornell"), {.file = path("a.vdb"), .grids = "default"});
  const vdb::DumpSummary summary =
      vdb::dumpFrame(device(), run.graph, *run.executor, run.traits, {.file = path("b.vdb"), .grids = "default", .scene = "a scene"});
  EXPECT_EQ(read(path("a.vdb")), read(path("b.vdb")));
  EXPECT_TRUE(summary.leftOut.empty());
  // A frame that has no rays: groups leave out what is not there, names do not.
  const VdbRun less(device(), scene::loadScene("builtin:cornell"), {.file = path("c.vdb"), .grids = "albedo"});
  const vdb::DumpSummary some = vdb::dumpFrame(device(), less.graph, *less.executor, less.traits, {.file = path("d.vdb")});
  EXPECT_FALSE(some.leftOut.empty());
  EXPECT_NE(findGrid(readGrids(path("d.vdb")), "albedo"), nullptr);
  try {
    vdb::dumpFrame(device(), less.graph, *less.executor, less.traits, {.file = path("e.vdb"), .grids = "indirect"});
    ADD_FAILURE();
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("grid indirect"), std::string::npos) << e.what();
  }
  EXPECT_FALSE(fs::exists(path("e.vdb")));
}

TEST_F(VdbTest, RunsAgainOnlyWhenSomethingChanged) {
  VdbRun run(device(), scene::loadScene("builtin:cornell"), {.file = path("a.vdb"), .grids = "occupancy,direct"});
  fs::remove(path("a.vdb"));
  run.executor->run();
  EXPECT_FALSE(fs::exists(path("a.vdb"))) << "nothing changed";
  for (auto& light : run.scene.lights) light.intensity *= 2.f;
  run.gpuScene->setLights(run.scene);
  run.gpuScene->importInto(*run.executor);
  run.executor->run();
  EXPECT_TRUE(fs::exists(path("a.vdb")));
}

TEST_F(VdbTest, AnInterruptedDumpLeavesNothingSlow) {
  VdbRun run(device(), scene::loadScene("builtin:cornell"),
             {.file = path("a.vdb"), .grids = "occupancy,area,area_faces,mean_normal_faces"});
  fs::remove(path("a.vdb"));
  run.gpuScene->touchGeometry();
  run.gpuScene->importInto(*run.executor);
  bool writing = false;
  const auto cancelled = [&writing] { return writing; };
  EXPECT_THROW(
      run.executor->run([&writing](std::string_view node, double done) { writing = writing || (node == "dump" && done > 0.5); }, cancelled),
      Error);
  EXPECT_FALSE(fs::exists(path("a.vdb")));
  run.executor->run();
  EXPECT_EQ(readGrids(path("a.vdb")).size(), 14u) << "and the next run is whole";
}

}  // namespace
}  // namespace radivox::test
