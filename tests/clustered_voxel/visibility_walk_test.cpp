// The parts of clustered_voxel.visibility one by one: leaps over empty space, clearance, directions.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "modules/clustered_voxel/visibility/directions.h"
#include "shaders/clustered_voxel/visibility/visibility.h"
#include "shaders/shared/clearance.h"
#include "tests/clustered_voxel/visibility_run.h"
#include "tests/oracles/gpu_fixture.h"

namespace radivox {
namespace {

using glm::ivec3;
using glm::vec3;
using oracle::VoxelStructures;

class VisibilityWalkTest : public oracles::GpuTest {};

struct TestRay {
  vec3 origin, direction;
};
struct TestStop {
  ivec3 voxel;
  float time;
  uint32_t entered;
};

/// Rays from inside, from borders, from outside; along axes, in planes of voxel borders, nearly so, through corners.
std::vector<TestRay> awkwardRays(const glm::uvec3& size, uint32_t count) {
  std::mt19937 random(11);
  const auto unit = [&] { return static_cast<float>(random() >> 8) * (1.f / 16777216.f); };
  std::vector<TestRay> rays(count);
  for (TestRay& ray : rays) {
    for (int k = 0; k < 3; ++k) {
      const float n = static_cast<float>(size[k]);
      switch (random() % 6) {
        case 0:
          ray.origin[k] = std::floor(unit() * (n + 1.f));
          break;  // on a border
        case 1:
          ray.origin[k] = unit() * 3.f * n - n;
          break;  // perhaps outside
        case 2:
          ray.origin[k] = std::floor(unit() * n) + 0.5f;
          break;  // middle: diagonals meet edges
        default:
          ray.origin[k] = unit() * n;
      }
      switch (random() % 6) {
        case 0:
          ray.direction[k] = 0.f;
          break;
        case 1:
          ray.direction[k] = (unit() - 0.5f) * 4e-6f;
          break;
        case 2:
          ray.direction[k] = random() % 2 == 0 ? 1.f : -1.f;
          break;  // equal components: ties
        default:
          ray.direction[k] = 2.f * unit() - 1.f;
      }
    }
    if (glm::length(ray.direction) < 1e-3f) ray.direction[static_cast<int>(random() % 3)] = 1.f;
    ray.direction /= glm::length(ray.direction);
  }
  return rays;
}

TestStop expectedStop(const VoxelStructures& s, const TestRay& ray, bool facesOnly) {
  TestStop stop{ivec3(-1), 0.f, 0};
  ivec3 start;
  float time = 0.f;
  if (!oracle::enterGrid(s.grid.size, ray.origin, ray.direction, start, time)) return stop;
  stop.entered = 1;
  oracle::walkVoxels(s.grid.size, ray.origin, ray.direction, start, [&](const oracle::VoxelVisit& visit) {
    stop.voxel = visit.voxel;
    stop.time = visit.voxel == start ? time : visit.entry;
    const uint32_t voxel = s.voxelIndex(visit.voxel);
    const bool stops = voxel != shared::kNone && (!facesOnly || s.mask[voxel] != 0);
    if (!stops) {
      stop.voxel = ivec3(-1);  // left the grid, unless another voxel follows
      stop.time = visit.exit;
    }
    return !stops;
  });
  return stop;
}

TEST_F(VisibilityWalkTest, LeapingEqualsStepping) {
  for (const uint32_t n : {7u, 33u, 90u}) {
    const VoxelStructures s = oracle::buildVoxelStructures(oracle::randomSoup(n, 40), n);
    oracle::VisibilityRun clearance(device(), s, {.rays = 1}, oracle::runLabels(s.faces.size(), 7));
    clearance.harness.run();
    const gpu::Buffer& clearanceBuffer = *clearance.harness.executor().findGrown("visibility.clearance").at(0);
    const std::vector<TestRay> rays = awkwardRays(s.grid.size, 20000);
    const auto make = [&](const char* name, const auto& data) {
      gpu::Buffer buffer(device(), name, data.size() * sizeof(data[0]));
      gpu::upload(device(), buffer, data);
      return buffer;
    };
    const gpu::Buffer grid = make("grid", std::vector<shared::Grid>{s.grid}), occupancy = make("occupancy", s.occupancy),
                      rank = make("rank", s.rank), distance = make("distance", s.distance), rayBuffer = make("rays", rays);
    const gpu::Buffer stops(device(), "stops", rays.size() * sizeof(TestStop));
    for (const uint32_t skip : {0u, 1u, 2u}) {
      std::vector<gpu::BindingType> types(10, gpu::BindingType::StorageBuffer);
      const gpu::Pipeline pipeline(
          device(),
          gpu::ComputePipelineInfo{
              .shader = "clustered_voxel/visibility/test_walk.comp", .bindings = types, .pushConstantBytes = 4, .constants = {{0, skip}}});
      run([&](gpu::Commands& commands) {
        commands.bind(pipeline, {grid, occupancy, rank, distance, grid, grid, grid, clearanceBuffer, rayBuffer, stops});
        commands.push(static_cast<uint32_t>(rays.size()));
        commands.dispatchItems(rays.size(), 64);
        commands.barrier();
      });
      const auto found = gpu::downloadAs<TestStop>(device(), stops, rays.size());
      size_t wrong = 0, outside = 0, stopped = 0;
      for (size_t i = 0; i < rays.size(); ++i) {
        const TestStop expected = expectedStop(s, rays[i], skip == 2);
        const bool leaves = expected.entered == 1 && expected.voxel == ivec3(-1);
        outside += expected.entered == 0 ? 1 : 0;
        stopped += expected.entered == 1 && !leaves ? 1 : 0;
        bool same = found[i].entered == expected.entered;
        if (expected.entered == 1) {
          const bool inside = s.isInside(found[i].voxel);
          // A leap out of the grid ends somewhere outside.
          same = same && inside == !leaves && (leaves || (found[i].voxel == expected.voxel && found[i].time == expected.time));
        }
        if (!same && wrong++ < 3) {
          ADD_FAILURE() << "n " << n << " skip " << skip << " ray " << i << " origin " << rays[i].origin.x << " " << rays[i].origin.y << " "
                        << rays[i].origin.z << " direction " << rays[i].direction.x << " " << rays[i].direction.y << " "
                        << rays[i].direction.z << ": voxel " << found[i].voxel.x << " " << found[i].voxel.y << " " << found[i].voxel.z
                        << " time " << found[i].time << " instead of " << expected.voxel.x << " " << expected.voxel.y << " "
                        << expected.voxel.z << " time " << expected.time;
        }
      }
      EXPECT_EQ(wrong, 0u);
      EXPECT_GT(outside, 100u);
      EXPECT_GT(stopped, 1000u);
    }
  }
}

TEST_F(VisibilityWalkTest, ClearanceBoxesAreEmptyAndGoOnUntilSomethingIsInTheWay) {
  for (const uint32_t n : {5u, 21u, 70u}) {
    const VoxelStructures s = oracle::buildVoxelStructures(oracle::randomSoup(n, 6), n);
    oracle::VisibilityRun run(device(), s, {.rays = 1}, oracle::runLabels(s.faces.size(), 7));
    run.harness.run();
    const auto words = run.harness.downloadGrown<uint32_t>("visibility.clearance").at(0);
    EXPECT_TRUE(run.harness.executor().findGrown("visibility.clearance_work").empty());
    const ivec3 size(s.grid.size);
    const auto isFree = [&](const ivec3& at) {
      const uint32_t voxel = s.isInside(at) ? s.voxelIndex(at) : shared::kNone;
      return s.isInside(at) && (voxel == shared::kNone || s.mask[voxel] == 0);
    };
    const auto isFreeBox = [&](const ivec3& low, const ivec3& high) {
      for (int z = low.z; z <= high.z; ++z)
        for (int y = low.y; y <= high.y; ++y)
          for (int x = low.x; x <= high.x; ++x)
            if (!isFree({x, y, z})) return false;
      return true;
    };
    const int step = n > 32 ? 3 : 1;  // every voxel of small grids, some of large ones
    uint64_t longest = 0;
    for (int z = -1; z <= size.z; z += step) {
      for (int y = -1; y <= size.y; y += step) {
        for (int x = -1; x <= size.x; x += step) {
          const ivec3 at(x, y, z);
          const uint32_t word = words.at(shared::clearanceIndex(glm::uvec3(at + 1), s.grid.size));
          ASSERT_EQ(word & shared::kClearanceOpen, isFree(at) ? shared::kClearanceOpen : 0u) << x << " " << y << " " << z;
          if (!isFree(at)) {
            ASSERT_EQ(word, s.isInside(at) ? s.voxelIndex(at) + 1 : 0u) << x << " " << y << " " << z;
            continue;
          }
          ivec3 low = at, high = at;
          for (uint32_t f = 0; f < shared::kFaceCount; ++f) {
            const auto reach = static_cast<int>((word >> (shared::kClearanceBits * f)) & shared::kMostClearance);
            (f % 2 == 0 ? high : low)[static_cast<int>(f / 2)] += f % 2 == 0 ? reach : -reach;
            longest = std::max<uint64_t>(longest, static_cast<uint64_t>(reach));
          }
          ASSERT_TRUE(isFreeBox(low, high)) << x << " " << y << " " << z;
          for (int k = 0; k < 3; ++k) {
            ivec3 beyondLow = low, beyondHigh = high;
            beyondLow[k] = beyondHigh[k] = high[k] + 1;
            ASSERT_TRUE(high[k] - at[k] == static_cast<int>(shared::kMostClearance) || !isFreeBox(beyondLow, beyondHigh))
                << x << " " << y << " " << z;
            beyondLow[k] = beyondHigh[k] = low[k] - 1;
            ASSERT_TRUE(at[k] - low[k] == static_cast<int>(shared::kMostClearance) || !isFreeBox(beyondLow, beyondHigh))
                << x << " " << y << " " << z;
          }
        }
      }
    }
    EXPECT_EQ(longest, n > 32 ? shared::kMostClearance : longest);
  }
}

TEST(Directions, EverySetIsCosineDistributed) {
  for (const uint32_t rays : {1u, 2u, 16u, 128u, 256u}) {
    const std::vector<uint32_t> codes = clustered_voxel::makeDirections(rays);
    ASSERT_EQ(codes.size(), size_t{rays} * shared::kShiftCount);
    for (uint32_t set = 0; set < shared::kShiftCount; ++set) {
      std::vector<uint32_t> strata(rays, 0);
      glm::dvec3 mean(0.0);
      for (uint32_t ray = 0; ray < rays; ++ray) {
        const vec3 d = shared::decodeDirection(codes[set * rays + ray]);
        EXPECT_NEAR(glm::length(d), 1.f, 1e-5f);
        EXPECT_GT(d.z, 0.f);
        mean += glm::dvec3(d) / static_cast<double>(rays);
        // cos² θ is uniform: each of `rays` bands of it holds one direction (up to the rounding of the packed word).
        const double band = (1.0 - double{d.z} * d.z) * rays;
        const double nearest = std::round(band);
        if (std::abs(band - nearest) < 0.02) continue;
        ++strata.at(static_cast<size_t>(band));
      }
      for (const uint32_t count : strata) EXPECT_LE(count, 1u);
      // E[cos θ] = 2/3; the sideways mean vanishes.
      if (rays >= 128) {
        EXPECT_NEAR(mean.z, 2.0 / 3.0, 0.004);
        EXPECT_NEAR(mean.x, 0.0, 0.01);
        EXPECT_NEAR(mean.y, 0.0, 0.01);
      }
    }
  }
}

TEST(Directions, FramesAreOrthonormal) {
  std::mt19937 random(5);
  for (int i = 0; i < 10000; ++i) {
    vec3 n;
    for (int k = 0; k < 3; ++k) n[k] = static_cast<float>(random() % 2001) / 1000.f - 1.f;
    if (i < 6) n = shared::faceVector(static_cast<uint32_t>(i));
    if (glm::length(n) < 0.1f) continue;
    n = glm::normalize(n);
    const vec3 t = shared::alongNormal({1, 0, 0}, n), b = shared::alongNormal({0, 1, 0}, n), z = shared::alongNormal({0, 0, 1}, n);
    EXPECT_LT(glm::length(z - n), 1e-6f);
    EXPECT_NEAR(glm::length(t), 1.f, 1e-5f);
    EXPECT_NEAR(glm::length(b), 1.f, 1e-5f);
    EXPECT_NEAR(glm::dot(t, b), 0.f, 1e-5f);
    EXPECT_NEAR(glm::dot(t, n), 0.f, 1e-5f);
    EXPECT_NEAR(glm::dot(glm::cross(t, b), n), 1.f, 1e-5f);
  }
}

}  // namespace
}  // namespace radivox
