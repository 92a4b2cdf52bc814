// Gathered irradiance of voxel faces, and the standard error that they tell of themselves, against path-traced irradiance at the same points.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "engine/scene/builtin.h"
#include "modules/reference/path_tracer.h"
#include "shaders/clustered_voxel/visibility/visibility.h"
#include "tests/oracles/gpu_fixture.h"
#include "tests/oracles/pipeline.h"

namespace radivox {
namespace {

struct Coverage {
  double share = 0;      ///< of the faces whose 95 % band holds the truth
  double meanError = 0;  ///< Σ |E − truth| / Σ truth
  double bias = 0;       ///< Σ E / Σ truth
  double meanBand = 0;   ///< Σ 1.96 σ / Σ truth
  size_t faces = 0;
};

/// Over every `step`-th face that the picture shows.
Coverage coverFaces(const scene::Scene& scene, uint32_t resolution, uint32_t step, uint32_t spp) {
  oracles::PipelineOptions options;
  options.width = 160;
  options.height = 90;
  options.aovs = {"color", "error"};
  options.settings = {{"voxelize.resolution", std::to_string(resolution)}};
  options.outputs = {"composite.color", "shade.error",   "gather.irradiance", "gather.error",
                     "mark.shown",      "surface.faces", "index.voxels",      "voxelize.grid"};
  oracles::Pipeline p(oracles::sharedDevice(), scene, options);
  p.run();
  const size_t faceCount = p.count("faces");
  const auto irradiance = p.buffer<glm::vec4>("gather.irradiance", faceCount);
  const auto error = p.buffer<glm::vec3>("gather.error", faceCount);
  const auto shown = p.buffer<uint32_t>("mark.shown");
  const auto faces = p.buffer<shared::Face>("surface.faces", faceCount);
  const auto voxels = p.buffer<uint32_t>("index.voxels", p.count("voxels"));
  const shared::Grid grid = p.buffer<shared::Grid>("voxelize.grid", 1)[0];
  std::vector<uint32_t> list;
  std::vector<reference::ProbePoint> points;
  uint32_t seen = 0;
  for (uint32_t s = 0; s < faceCount; ++s) {
    if (((shown[s >> 5] >> (s & 31)) & 1u) == 0 || faces[s].area < 0.1f || seen++ % step != 0) continue;
    const glm::vec3 n = shared::decodeNormal(faces[s].normal);
    const glm::vec3 x = shared::liftedOrigin(shared::facePosition(faces[s], shared::unpackVoxel(voxels[faces[s].key >> 3])), n);
    list.push_back(s);
    points.push_back({grid.origin + x * grid.h, n});
  }
  const reference::PathTracer tracer(scene);
  const auto truth = tracer.probe(points, {.spp = spp});
  Coverage result;
  result.faces = list.size();
  double sum = 0;
  for (size_t i = 0; i < list.size(); ++i) {
    const double e = irradiance[list[i]].y, t = truth[i].indirect.y;
    const double band = 1.96 * std::hypot(error[list[i]].y, truth[i].indirectError.y);
    sum += t;
    result.share += std::abs(e - t) <= band ? 1 : 0;
    result.meanError += std::abs(e - t);
    result.bias += e;
    result.meanBand += 1.96 * error[list[i]].y;
  }
  result.share /= static_cast<double>(list.size());
  result.meanError /= sum;
  result.bias /= sum;
  result.meanBand /= sum;
  return result;
}

void print(const char* name, const Coverage& c) {
  std::printf("[ figures  ] %s: %zu faces, %.1f %% within their 95 %% band (mean half-width %.1f %%); mean error %.1f %%, bias %.3f\n",
              name, c.faces, 100 * c.share, 100 * c.meanBand, 100 * c.meanError, c.bias);
}

class FaceErrorTest : public oracles::GpuTest {};

TEST_F(FaceErrorTest, SlowCornellFacesKnowTheirError) {
  for (const char* name : {"cornell", "cornell_point"}) {
    const Coverage c = coverFaces(scene::makeBuiltin(name), 48, 3, 512);
    print(name, c);
    ASSERT_GT(c.faces, 300u);
    EXPECT_GT(c.share, 0.9) << name;
    EXPECT_NEAR(c.bias, 1.0, 0.03) << name;
  }
}

TEST_F(FaceErrorTest, SlowSponzaFacesKnowTheirSamplingError) {
  if (oracles::sharedFolder().empty()) GTEST_SKIP() << "no ../shared";
  const Coverage c = coverFaces(scene::loadScene(oracles::sharedFolder() + "/scenes/sponza.glb"), 64, 11, 256);
  print("sponza", c);
  ASSERT_GT(c.faces, 300u);
  // The band is of sampling alone. What voxels leave out is more than that here: faces whose mean point lies in another surface, and near ledges.
  EXPECT_GT(c.share, 0.6);
}

}  // namespace
}  // namespace radivox
