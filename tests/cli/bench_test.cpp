// radivox bench through the binary: what it prints and writes, and that voxel rays and Embree's meet the same surfaces.
#include <nlohmann/json.hpp>

#include "tests/cli/command.h"

namespace radivox::test {

namespace {

using nlohmann::json;

class BenchCommand : public CommandTest {};

TEST_F(BenchCommand, VoxelRaysMeetWhatEmbreeMeets) {
  const CommandResult result = runRadivox({"bench", "builtin:cornell", "--rays", "20000", "--runs", "3", "--set", "voxelize.resolution=24",
                                           "--set", "visibility.rays=4", "--out", path("bench.json")});
  ASSERT_EQ(result.exitCode, 0) << result.err;
  EXPECT_EQ(result.err, "");
  const json figures = json::parse(read("bench.json"));
  EXPECT_NE(result.out.find("device     " + figures.at("device").get<std::string>() + "\n"), std::string::npos) << result.out;
  EXPECT_EQ(figures.at("runs"), 3);
  // A chunk of faces is the least: all of them here.
  EXPECT_EQ(figures.at("rays"), 4 * figures.at("counts").at("faces").get<uint64_t>());
  ASSERT_EQ(figures.at("casts").size(), 3u);
  for (const auto& [name, cast] : figures.at("casts").items()) {
    EXPECT_NE(result.out.find("| " + name + ": "), std::string::npos) << result.out;
    const double speed = cast.at("mrays_per_second").get<double>();
    EXPECT_GT(speed, 0.0) << name;
#ifdef RADIVOX_WITH_REFERENCE
    double best = 0;
    for (const auto& way : cast.at("embree_ways")) best = std::max(best, way.get<double>());
    EXPECT_EQ(cast.at("embree_mrays_per_second"), best);
    EXPECT_EQ(cast.at("embree_ways").at(cast.at("embree_way").get<std::string>()), best);
    EXPECT_DOUBLE_EQ(cast.at("ratio").get<double>(), speed / best);
    const json& agreement = cast.at("agreement");
    const json& error = agreement.at("distance_error_voxels");
    EXPECT_LE(error.at("median"), error.at("p90"));
    EXPECT_LE(error.at("p90"), error.at("p99"));
    EXPECT_GT(agreement.at("hit_or_miss").get<double>(), 0.97) << name;
#endif
  }
#ifdef RADIVOX_WITH_REFERENCE
  // Planes stop rays in the voxel of the surface; the first occupied voxel may lie well in front of it.
  for (const char* name : {"planes", "walk"}) {
    const json& agreement = figures.at("casts").at(name).at("agreement");
    EXPECT_GT(agreement.at("hit_or_miss").get<double>(), 0.99) << name;
    EXPECT_GT(agreement.at("within_one_voxel").get<double>(), 0.94) << name;
  }
#endif
}

TEST_F(BenchCommand, WhatItCannotMeasureIsOneLine) {
  expectError({"bench", "builtin:cornell", "--out", path("bench.txt")}, 2, {"bench.txt", ".json"});
  expectError({"bench", "builtin:cornell", "--rays", "0"}, 2, {"--rays"});
  expectError({"bench", "builtin:cornell", "--graph", "direct"}, 2, {"direct", "clustered_voxel.visibility"});
}

}  // namespace

}  // namespace radivox::test
