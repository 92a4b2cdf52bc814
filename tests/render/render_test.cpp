// End to end: whole renders against answers known in closed form, and what must hold of every render.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "engine/scene/builtin.h"
#include "shaders/shared/cluster_member.h"
#include "shaders/shared/visibility_row.h"
#include "shaders/shared/voxel_codec.h"
#include "tests/oracles/gpu_fixture.h"
#include "tests/oracles/pipeline.h"

namespace radivox {
namespace {

using oracles::Pipeline;
using oracles::PipelineOptions;

class Render : public oracles::GpuTest {};

PipelineOptions small(uint32_t resolution) {
  PipelineOptions options;
  options.settings = {{"voxelize.resolution", std::to_string(resolution)}, {"visibility.rays", "64"}};
  // Shadow maps as small as the pictures are: the tests run on CPUs.
  options.lights = {.shadowResolution = 512, .pointShadowResolution = 128, .emitterSamples = 8, .emitterShadowResolution = 64};
  return options;
}

const char* const kSceneNodes[] = {"voxelize", "index", "faces", "surface", "cluster", "members", "visibility", "transfer"};
const char* const kLightNodes[] = {"shadow_map", "inject", "bounce"};
const char* const kViewNodes[] = {"gbuffer", "direct", "mark", "gather", "filter", "shade"};

TEST_F(Render, SecondFrameRunsNothingButEveryFrameNodes) {
  Pipeline p(oracles::sharedDevice(), scene::makeBuiltin("cornell_point"), small(20));
  p.run();
  const auto before = p.executor->stats();
  p.run();
  const auto after = p.executor->stats();
  for (size_t i = 0; i < before.nodes.size(); ++i) {
    EXPECT_EQ(before.nodes[i].runCount, 1u) << before.nodes[i].name;
    EXPECT_EQ(after.nodes[i].runCount, 1u) << after.nodes[i].name << " ran again with nothing changed";
  }
}

TEST_F(Render, CameraMoveGathersOnlyNewlyNeededFaces) {
  scene::Scene s = scene::makeBuiltin("cornell_point");
  Pipeline p(oracles::sharedDevice(), s, small(20));
  p.run();
  const double first = p.figure("gather", "gathered_faces");
  EXPECT_GT(first, 0);
  EXPECT_EQ(first, p.figure("mark", "needed_faces"));
  const auto validBefore = p.buffer<uint32_t>("gather.valid");
  // A small turn: most of what is seen has been seen before.
  scene::CameraDescription camera = s.cameras.front();
  camera.orientation = glm::normalize(camera.orientation * glm::angleAxis(0.05f, glm::vec3(0, 1, 0)));
  p.setCamera(camera);
  p.run();
  for (const char* node : kSceneNodes) EXPECT_EQ(p.runCount(node), 1u) << node;
  for (const char* node : kLightNodes) EXPECT_EQ(p.runCount(node), 1u) << node;
  for (const char* node : kViewNodes) EXPECT_EQ(p.runCount(node), 2u) << node;
  const double second = p.figure("gather", "gathered_faces");
  const auto needed = p.buffer<uint32_t>("mark.needed");
  double fresh = 0;
  for (size_t i = 0; i < needed.size(); ++i) fresh += std::popcount(needed[i] & ~validBefore[i]);
  EXPECT_EQ(second, fresh);
  EXPECT_LT(second, 0.5 * first);
}

TEST_F(Render, SlowGatherIsTheMeanOfItsRowAndKnowsItsSpread) {
  PipelineOptions options = small(20);
  options.aovs = {"color", "error"};
  options.outputs = {"composite.color",      "shade.error",        "gather.irradiance",        "gather.error",         "gather.valid",
                     "visibility.row_start", "visibility.entries", "bounce.cluster_radiosity", "bounce.face_radiosity"};
  Pipeline p(oracles::sharedDevice(), scene::makeBuiltin("cornell_point"), options);
  p.run();
  const size_t faceCount = p.count("faces"), clusterCount = p.count("clusters");
  ASSERT_LE(faceCount, shared::kRowsPerChunk) << "one chunk of rows";
  const auto irradiance = p.buffer<glm::vec4>("gather.irradiance", faceCount);
  const auto error = p.buffer<glm::vec3>("gather.error", faceCount);
  const auto valid = p.buffer<uint32_t>("gather.valid"), starts = p.buffer<uint32_t>("visibility.row_start");
  const auto clusters = p.buffer<glm::vec3>("bounce.cluster_radiosity", clusterCount),
             faces = p.buffer<glm::vec3>("bounce.face_radiosity", faceCount);
  const gpu::Buffer& chunk = *p.executor->findGrown("visibility.entries").at(0);
  const auto words = gpu::downloadAs<uint32_t>(oracles::sharedDevice(), chunk, chunk.bytes() / 4);
  size_t compared = 0;
  for (uint32_t s = 0; s < faceCount; ++s) {
    if (((valid[s >> 5] >> (s & 31)) & 1u) == 0) continue;
    double rays = 0, sum = 0, squares = 0;
    const auto idCount = static_cast<uint32_t>(clusterCount + faceCount);
    shared::forEachRowEntry(words.data(), starts[s], starts[s + 1], idCount, [&](uint32_t id, uint32_t n) {
      const double b = id < clusterCount ? clusters[id].x : id < clusterCount + faceCount ? faces[id - clusterCount].x : 0.f;
      rays += n;
      sum += n * b;
      squares += n * b * b;
    });
    const double mean = sum / rays, spread = std::sqrt(std::max(0.0, squares / rays - mean * mean) / (rays - 1));
    EXPECT_NEAR(irradiance[s].x, mean, 1e-4 * mean + 1e-6);
    EXPECT_NEAR(error[s].x, spread, 1e-2 * spread + 1e-3 * mean + 1e-6);
    ++compared;
  }
  EXPECT_GT(compared, 100u);
  double shown = 0;
  for (const float value : p.picture("shade.error").data) shown += value;
  EXPECT_GT(shown, 0.0);
}

TEST_F(Render, ClustersSendBackTheWeightedMeanOfTheirFaces) {
  PipelineOptions options = small(20);
  options.outputs = {"composite.color", "inject.cluster_radiosity", "inject.face_irradiance", "visibility.weights",
                     "shares.members",  "members.clusters",         "surface.faces",          "cluster.labels"};
  Pipeline p(oracles::sharedDevice(), scene::makeBuiltin("cornell_point"), options);
  p.run();
  const size_t faceCount = p.count("faces"), clusterCount = p.count("clusters");
  const auto faces = p.buffer<shared::Face>("surface.faces", faceCount);
  const auto weights = p.buffer<uint32_t>("visibility.weights", faceCount), labels = p.buffer<uint32_t>("cluster.labels", faceCount);
  const auto irradiance = p.buffer<glm::vec3>("inject.face_irradiance", faceCount);
  const auto radiosity = p.buffer<glm::vec3>("inject.cluster_radiosity", clusterCount);
  const auto clusters = p.buffer<shared::Cluster>("members.clusters", clusterCount + 1);
  const auto members = p.buffer<uint32_t>("shares.members", faceCount);
  std::vector<double> seen(clusterCount), total(clusterCount), sum(clusterCount);
  for (size_t s = 0; s < faceCount; ++s) seen[labels[s]] = std::max(seen[labels[s]], static_cast<double>(weights[s]));
  for (size_t c = 0; c < clusterCount; ++c) {
    for (uint32_t i = clusters[c].firstMember; i < clusters[c + 1].firstMember; ++i) {
      const uint32_t member = members[i], s = shared::memberFace(member);
      ASSERT_LT(s, faceCount);
      ASSERT_EQ(labels[s], c);
      const double share = shared::memberShare(member);
      EXPECT_NEAR(share, seen[c] > 0 ? 255.0 * weights[s] / seen[c] : 0.0, 0.5 + 1e-3);
      const double w = seen[c] > 0 ? share : static_cast<double>(faces[s].area);
      total[c] += w;
      sum[c] += w * static_cast<double>(shared::decodeAlbedo(faces[s].albedo).y * irradiance[s].y);
    }
  }
  size_t lit = 0, unseen = 0;
  for (size_t c = 0; c < clusterCount; ++c) {
    EXPECT_NEAR(radiosity[c].y, sum[c] / total[c], 1e-5 * (1.0 + sum[c] / total[c])) << c;
    lit += sum[c] > 0 ? 1 : 0;
    unseen += seen[c] == 0 ? 1 : 0;
  }
  EXPECT_GT(lit, 20u);
  EXPECT_GT(unseen, 0u) << "the outer sides of the box";
}

TEST_F(Render, SlowLightMoveTracesNothingAgain) {
  scene::Scene s = scene::makeBuiltin("cornell_point");
  Pipeline p(oracles::sharedDevice(), s, small(20));
  p.run();
  const image::Image before = p.picture("composite.color");
  for (auto& light : s.lights) light.position.x += 0.1f;
  p.setLights(s);
  p.run();
  for (const char* node : kSceneNodes) EXPECT_EQ(p.runCount(node), 1u) << node;
  for (const char* node : kLightNodes) EXPECT_EQ(p.runCount(node), 2u) << node;
  EXPECT_EQ(p.runCount("gbuffer"), 1u);
  EXPECT_EQ(p.runCount("mark"), 1u);
  EXPECT_EQ(p.figure("gather", "gathered_faces"), p.figure("mark", "needed_faces"));
  EXPECT_NE(before.data, p.picture("composite.color").data);
  // What a light move leaves equals what a fresh start gives, bit for bit.
  Pipeline fresh(oracles::sharedDevice(), s, small(20));
  fresh.run();
  EXPECT_EQ(fresh.picture("composite.color").data, p.picture("composite.color").data);
}

TEST_F(Render, SlowLazyGatherEqualsGatherAllOnNeededFaces) {
  PipelineOptions lazy = small(20), all = small(20);
  lazy.outputs = all.outputs = {"composite.color", "gather.irradiance", "gather.valid"};
  all.settings.push_back({"gather.lazy", "off"});
  Pipeline a(oracles::sharedDevice(), scene::makeBuiltin("cornell_point"), lazy);
  Pipeline b(oracles::sharedDevice(), scene::makeBuiltin("cornell_point"), all);
  a.run();
  b.run();
  const auto valid = a.buffer<uint32_t>("gather.valid");
  const auto some = a.buffer<glm::vec4>("gather.irradiance");
  const auto every = b.buffer<glm::vec4>("gather.irradiance");
  EXPECT_LT(a.figure("gather", "gathered_faces"), b.figure("gather", "gathered_faces"));
  EXPECT_EQ(b.figure("gather", "gathered_faces"), static_cast<double>(b.count("faces")));
  for (size_t s = 0; s < a.count("faces"); ++s)
    if ((valid[s / 32] >> (s % 32)) & 1u) {
      ASSERT_EQ(some[s], every[s]) << "face " << s;
    }
  EXPECT_EQ(a.picture("composite.color").data, b.picture("composite.color").data);
}

TEST_F(Render, SlowSameBitsTwice) {
  for (const char* name : {"cornell", "two_rooms"}) {
    PipelineOptions options = small(20);
    options.outputs = {"composite.color",    "surface.faces",     "cluster.labels",         "visibility.row_start",
                       "transfer.row_start", "transfer.sky",      "inject.face_irradiance", "bounce.face_radiosity",
                       "gather.irradiance",  "filter.irradiance", "voxelize.occupancy",     "index.voxels",
                       "shares.members"};
    Pipeline a(oracles::sharedDevice(), scene::makeBuiltin(name), options);
    Pipeline b(oracles::sharedDevice(), scene::makeBuiltin(name), options);
    a.run();
    b.run();
    for (const std::string& output : options.outputs) {
      if (output == "composite.color") continue;
      EXPECT_EQ(a.buffer<uint32_t>(output), b.buffer<uint32_t>(output)) << name << " " << output;
    }
    for (const char* grown : {"visibility.entries", "transfer.entries"}) {
      const auto x = a.executor->findGrown(grown), y = b.executor->findGrown(grown);
      ASSERT_EQ(x.size(), y.size());
      for (size_t i = 0; i < x.size(); ++i)
        EXPECT_EQ(gpu::download(oracles::sharedDevice(), *x[i]), gpu::download(oracles::sharedDevice(), *y[i]))
            << name << " " << grown << i;
    }
    EXPECT_EQ(a.picture("composite.color").data, b.picture("composite.color").data) << name;
  }
}

// Every wall of a closed box emits πL_e = 1 − ρ and reflects ρ, so E = 1 everywhere inside: ρ of it has been reflected before.
TEST_F(Render, FurnaceIsExactAtEveryFace) {
  for (const double albedo : {0.0, 0.5, 0.9, 0.99}) {
    PipelineOptions options = small(12);
    options.settings.push_back({"gather.lazy", "off"});
    options.settings.push_back({"bounce.residual", "1e-7"});
    options.outputs = {"composite.color", "gather.irradiance", "bounce.face_radiosity", "surface.faces", "index.voxels", "voxelize.grid"};
    Pipeline p(oracles::sharedDevice(), scene::makeBuiltin("furnace", {{"albedo", std::to_string(albedo)}}), options);
    p.run();
    const auto grid = p.buffer<shared::Grid>("voxelize.grid", 1)[0];
    const auto faces = p.buffer<shared::Face>("surface.faces", p.count("faces"));
    const auto voxels = p.buffer<uint32_t>("index.voxels", p.count("voxels"));
    const auto irradiance = p.buffer<glm::vec4>("gather.irradiance");
    // ρ as the faces hold it, in 16 bits.
    const double kept = static_cast<double>(shared::decodeAlbedoChannel(shared::encodeAlbedoChannel(static_cast<float>(albedo))));
    const double expected = kept * (1.0 - albedo) / (1.0 - kept);
    const glm::vec3 middle = glm::vec3(grid.size) * 0.5f;
    size_t inside = 0, wrong = 0;
    double worst = 0;
    for (size_t s = 0; s < faces.size(); ++s) {
      const uint32_t f = faces[s].key & 7u;
      const glm::vec3 at = glm::vec3(shared::unpackVoxel(voxels[faces[s].key >> 3])) + shared::decodePosition(faces[s].position);
      if (glm::dot(shared::faceVector(f), middle - at) < 0.f) continue;  // the box's outer side
      ++inside;
      const double error = std::abs(double{irradiance[s].x} - expected);
      worst = std::max(worst, error);
      // Towards albedo 1 the answer is 1 / (1 − ρ) times as sensitive as the 24 bits of a float.
      wrong += error > std::max(1e-5, 2e-7 / (1.0 - albedo));
    }
    EXPECT_GT(inside, 6u * 9 * 9);
    EXPECT_EQ(wrong, 0u) << "albedo " << albedo << ", of " << inside << " faces, worst " << worst;
  }
}

TEST_F(Render, PixelReceiverIsExactInAFurnace) {
  PipelineOptions options = small(16);
  options.graph = "clustered_voxel_pixels";
  options.outputs = {"composite.color", "gather_pixels.irradiance"};
  Pipeline p(oracles::sharedDevice(), scene::makeBuiltin("furnace", {{"albedo", "0.5"}}), options);
  p.run();
  const image::Image irradiance = p.picture4("gather_pixels.irradiance");
  for (size_t i = 0; i < irradiance.data.size(); i += 4) {
    ASSERT_NEAR(irradiance.data[i], 0.5f, 1e-3f) << "pixel " << i / 4;
    ASSERT_EQ(irradiance.data[i + 3], 0.f) << "a ray left the closed box from pixel " << i / 4;
  }
}

/// Median of what two pictures differ by where the second is lit, as a share of it, and the ratio of their sums.
std::pair<double, double> difference(const image::Image& a, const image::Image& b) {
  std::vector<double> shares;
  double sumA = 0, sumB = 0;
  for (size_t i = 0; i < a.data.size(); ++i) {
    if (b.data[i] > 0.f) shares.push_back(std::abs(double{a.data[i]} - double{b.data[i]}) / double{b.data[i]});
    sumA += a.data[i];
    sumB += b.data[i];
  }
  std::sort(shares.begin(), shares.end());
  return {shares.empty() ? 0 : shares[shares.size() / 2], sumA / sumB};
}

// What the filter's wider passes take away is noise: few rays come nearer to many, the light of all pixels stays, and many rays hardly change. By light of
// surfaces, of a sky, of a sky's image and of emitters that rays find, each of which has a filter of its own.
TEST_F(Render, SlowSmoothingTakesNoiseAndLeavesLight) {
  struct Case {
    const char* name;
    scene::Scene scene;
    const char* port;
    uint32_t emitterSamples;
  };
  scene::Scene sky = scene::makeBuiltin("atrium"), image = scene::loadScene("builtin:atrium", "builtin:clear");
  sky.lights.clear();
  sky.skyRadiance = glm::vec3(1.f);
  for (const Case& c : {Case{"surfaces", scene::makeBuiltin("cornell_point"), "gather_pixels.irradiance", 32},
                        Case{"a sky", sky, "composite.color", 32}, Case{"a sky's image", image, "gather_pixels.sky", 32},
                        Case{"emitters", scene::makeBuiltin("cornell"), "gather_pixels.emitted", 0}}) {
    SCOPED_TRACE(c.name);
    const auto picture = [&](uint32_t rays, uint32_t smooth) {
      PipelineOptions options = small(32);
      options.graph = "clustered_voxel_pixels";
      options.width = 128;
      options.height = 96;
      options.lights.emitterSamples = c.emitterSamples;
      options.settings.insert(options.settings.end(),
                              {{"gather_pixels.rays", std::to_string(rays)}, {"gather_pixels.smooth", std::to_string(smooth)}});
      options.outputs = {"composite.color", c.port};
      Pipeline p(oracles::sharedDevice(), c.scene, options);
      p.run();
      return p.picture(c.port);
    };
    const image::Image truth = picture(256, 0);
    const auto raw = difference(picture(4, 0), truth), smooth = difference(picture(4, 3), truth),
               sharp = difference(picture(256, 3), truth);
    std::printf("%s: median error of 4 rays %.4f, smoothed %.4f (sums %.4f, %.4f of the truth), of 256 rays smoothed %.4f\n", c.name,
                raw.first, smooth.first, raw.second, smooth.second, sharp.first);
    EXPECT_LT(smooth.first, 0.93 * raw.first);
    EXPECT_NEAR(smooth.second, raw.second, 3e-3);
    EXPECT_LT(sharp.first, 0.1 * raw.first);
  }
}

// A lamp a centimetre below a ceiling, voxels of nine: the ceiling right behind it is no part of the face that shines.
TEST_F(Render, SlowALampCloseToAWallShinesInFull) {
  const auto render = [&](uint32_t emitterSamples) {
    PipelineOptions options = small(64);
    options.graph = "clustered_voxel_pixels";
    options.lights.emitterSamples = emitterSamples;
    Pipeline p(oracles::sharedDevice(), scene::makeBuiltin("cornell"), options);
    p.run();
    return p.picture("composite.color");
  };
  EXPECT_NEAR(difference(render(0), render(64)).second, 1.0, 0.04);
}

// The paper's 18 points lie all about the voxel: below a plane they are in its shadow, so it finds part of the light, and never more than there is.
TEST_F(Render, PaperPointsInjectPartOfTheCosine) {
  scene::Scene s = scene::makeBuiltin("plane");
  s.lights.clear();
  scene::PunctualLight sun;
  sun.direction = glm::normalize(glm::vec3(0.62f, -1.f, 0.19f));
  sun.intensity = glm::vec3(10.f);
  s.lights.push_back(sun);
  PipelineOptions options = small(24);
  options.settings.push_back({"inject.method", "points"});
  options.outputs = {"composite.color", "surface.faces", "inject.face_irradiance"};
  Pipeline p(oracles::sharedDevice(), s, options);
  p.run();
  const auto faces = p.buffer<shared::Face>("surface.faces", p.count("faces"));
  const auto irradiance = p.buffer<glm::vec3>("inject.face_irradiance");
  const float cosine = -sun.direction.y;
  size_t lit = 0;
  for (size_t i = 0; i < faces.size(); ++i) {
    const bool isTop = (faces[i].key & 7u) == 2u;
    EXPECT_LE(irradiance[i].x, isTop ? 10.01f * cosine : 0.f);
    lit += isTop && irradiance[i].x > 3.f * cosine;
  }
  EXPECT_GT(lit, faces.size() / 3);
}

TEST_F(Render, SunOnAPlaneInjectsItsCosine) {
  scene::Scene s = scene::makeBuiltin("plane");
  s.lights.clear();
  scene::PunctualLight sun;
  sun.type = shared::kLightDirectional;
  sun.direction = glm::normalize(glm::vec3(0.62f, -1.f, 0.19f));
  sun.intensity = glm::vec3(10.f, 5.f, 1.f);
  s.lights.push_back(sun);
  PipelineOptions options = small(32);
  options.lights.shadowResolution = 2048;
  options.outputs = {"composite.color", "surface.faces", "inject.face_irradiance", "voxelize.grid"};
  Pipeline p(oracles::sharedDevice(), s, options);
  p.run();
  const auto grid = p.buffer<shared::Grid>("voxelize.grid", 1)[0];
  const auto faces = p.buffer<shared::Face>("surface.faces", p.count("faces"));
  const auto irradiance = p.buffer<glm::vec3>("inject.face_irradiance");
  const double cosine = -double{sun.direction.y};
  double flux = 0, area = 0, worst = 0;
  for (size_t i = 0; i < faces.size(); ++i) {
    const uint32_t f = faces[i].key & 7u;
    if (f == 3u) {
      EXPECT_EQ(irradiance[i].x, 0.f) << "light on the underside";
    }
    if (f != 2u) continue;
    flux += double{faces[i].area} * grid.h * grid.h * irradiance[i].x;
    area += double{faces[i].area} * grid.h * grid.h;
    if (faces[i].area > 0.99f) worst = std::max(worst, std::abs(double{irradiance[i].x} / (10.0 * cosine) - 1.0));
    EXPECT_NEAR(irradiance[i].y, 0.5 * irradiance[i].x, 1e-4 * irradiance[i].x);
  }
  EXPECT_NEAR(flux / area, 10.0 * cosine, 0.002 * 10.0 * cosine);
  EXPECT_LT(worst, 0.04);  // a voxel holds some thousand texels here; their count is what it is
  EXPECT_EQ(p.figure("inject", "lost_texels"), 0.0);
}

TEST_F(Render, SlowPointLightInABoxLosesNoFlux) {
  scene::Scene s = scene::makeBuiltin("box");
  s.lights.clear();
  scene::PunctualLight lamp;
  lamp.type = shared::kLightPoint;
  const scene::Traits traits = s.traits();
  lamp.position = glm::mix(traits.boundsMin, traits.boundsMax, glm::vec3(0.4f, 0.55f, 0.7f));
  lamp.intensity = glm::vec3(3.f);
  s.lights.push_back(lamp);
  for (const uint32_t resolution : {16u, 27u}) {
    PipelineOptions options = small(resolution);
    options.lights.pointShadowResolution = 512;
    options.outputs = {"composite.color", "surface.faces", "inject.face_irradiance", "voxelize.grid"};
    Pipeline p(oracles::sharedDevice(), s, options);
    p.run();
    const auto grid = p.buffer<shared::Grid>("voxelize.grid", 1)[0];
    const auto faces = p.buffer<shared::Face>("surface.faces", p.count("faces"));
    const auto irradiance = p.buffer<glm::vec3>("inject.face_irradiance");
    double flux = 0;
    for (size_t i = 0; i < faces.size(); ++i) flux += double{faces[i].area} * grid.h * grid.h * irradiance[i].x;
    EXPECT_NEAR(flux, 12.566370614 * 3.0, 0.002 * 37.7) << "N = " << resolution;  // all walls are axis-aligned: each texel counts once
  }
}

// Light from 1e9 down to 1e-6 W/sr: fixed-point sums follow the lights' range.
TEST_F(Render, SlowIrradianceScalesWithTheLight) {
  std::vector<float> first;
  for (const float scale : {1.f, 1e9f, 1e-6f}) {
    scene::Scene s = scene::makeBuiltin("cornell_point");
    for (auto& light : s.lights) light.intensity *= scale;
    Pipeline p(oracles::sharedDevice(), s, small(16));
    p.run();
    const image::Image picture = p.picture("composite.color");
    if (first.empty()) first = picture.data;
    double worst = 0;
    for (size_t i = 0; i < first.size(); ++i)
      worst = std::max(worst, std::abs(double{picture.data[i]} / scale - first[i]) / (1e-3 + first[i]));
    EXPECT_LT(worst, 1e-3) << scale;
  }
}

TEST_F(Render, ThinWallKeepsItsDarkSideDark) {
  PipelineOptions options = small(32);
  options.settings.push_back({"gather.lazy", "off"});
  options.outputs = {"composite.color", "surface.faces", "inject.face_irradiance", "index.voxels", "voxelize.grid"};
  const scene::Scene s = scene::makeBuiltin("thin_wall");
  ASSERT_EQ(s.lights.size(), 1u);
  Pipeline p(oracles::sharedDevice(), s, options);
  p.run();
  const auto faces = p.buffer<shared::Face>("surface.faces", p.count("faces"));
  const auto irradiance = p.buffer<glm::vec3>("inject.face_irradiance");
  double lit = 0, dark = 0;
  for (size_t i = 0; i < faces.size(); ++i) {
    const uint32_t f = faces[i].key & 7u;
    glm::vec3 axis(0.f);
    axis[static_cast<int>(f >> 1)] = (f & 1u) != 0u ? -1.f : 1.f;
    const bool facesLight = glm::dot(axis, s.lights[0].direction) < 0.f;
    (facesLight ? lit : dark) += double{faces[i].area} * irradiance[i].x;
  }
  EXPECT_GT(lit, 0);
  EXPECT_EQ(dark, 0);
}

TEST_F(Render, NoLightIsBlackAndEmptyIsSky) {
  scene::Scene dark = scene::makeBuiltin("cornell_point");
  dark.lights.clear();
  Pipeline p(oracles::sharedDevice(), dark, small(16));
  p.run();
  for (float v : p.picture("composite.color").data) ASSERT_EQ(v, 0.f);

  scene::Scene empty = scene::makeBuiltin("empty");
  empty.skyRadiance = glm::vec3(0.25f, 0.5f, 1.f);
  Pipeline q(oracles::sharedDevice(), empty, small(16));
  q.run();
  const image::Image sky = q.picture("composite.color");
  EXPECT_EQ(sky.at(5, 5, 0), 0.25f);
  EXPECT_EQ(sky.at(5, 5, 2), 1.f);
}

TEST_F(Render, ZeroBouncesLeaveTheMethodOut) {
  PipelineOptions options = small(16);
  options.bounces = 0;
  Pipeline p(oracles::sharedDevice(), scene::makeBuiltin("cornell_point"), options);
  p.run();
  EXPECT_EQ(p.executor->findBuffer("voxelize.occupancy"), nullptr);
  EXPECT_GT(image::meanOf(p.picture("composite.color")), 0.0);
}

}  // namespace
}  // namespace radivox
