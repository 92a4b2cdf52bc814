// radivox reference as a person would use it.
#ifdef RADIVOX_WITH_REFERENCE

#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "engine/image/image.h"
#include "tests/cli/command.h"

namespace radivox::test {

namespace {

class Reference : public CommandTest {
 protected:
  std::vector<std::string> reference(std::vector<std::string> more) const {
    std::vector<std::string> all = {"reference", "builtin:cornell", "--size", "24x16", "--bounces", "2"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  void expectDone(const std::vector<std::string>& arguments) const {
    const CommandResult result = runRadivox(arguments);
    EXPECT_EQ(result.exitCode, 0) << result.err;
    EXPECT_EQ(result.err, "");
    EXPECT_EQ(result.out, "");
  }
};

TEST_F(Reference, LayersAndVariances) {
  expectDone(reference({"--spp", "8", "--out", path("a.exr"), "--out", path("a.png"), "--stats", path("a.json"), "--halves"}));
  EXPECT_EQ(files(), (std::vector<std::string>{"a.exr", "a.json", "a.png", "a_a.exr", "a_a.png", "a_b.exr", "a_b.png"}));
  const auto layers = image::readExr(path("a.exr")), even = image::readExr(path("a_a.exr")), odd = image::readExr(path("a_b.exr"));
  std::map<std::string, image::Image> byName;
  for (const image::Layer& layer : layers) byName[layer.name] = layer.image;
  for (const char* name : {"color", "direct", "indirect", "irradiance_direct", "irradiance_indirect", "albedo"}) {
    ASSERT_EQ(byName.count(name), 1u) << name;
    ASSERT_EQ(byName.count(std::string(name) + "_variance"), 1u) << name;
    EXPECT_EQ(byName[name].width, 24u);
    EXPECT_EQ(byName[name].channels, 3u);
  }
  for (size_t l = 0; l < layers.size(); ++l) {
    if (layers[l].name != "indirect") continue;  // irradiance is a quotient: the mean of the halves only nearly
    for (size_t i = 0; i < layers[l].image.data.size(); ++i)
      EXPECT_NEAR(layers[l].image.data[i], 0.5f * (even[l].image.data[i] + odd[l].image.data[i]), 1e-4f);
    EXPECT_NE(even[l].image.data, odd[l].image.data);
  }
  const auto stats = nlohmann::json::parse(read("a.json"));
  EXPECT_EQ(stats["samples"], 8);
  EXPECT_EQ(stats["bounces"], 2);
  EXPECT_GT(stats["samples_per_second"], 0.0);
  EXPECT_GT(stats["aovs"]["color"]["relative_error"], 0.0);

  expectDone(reference({"--spp", "8", "--aov", "albedo", "--out", path("b.exr")}));
  const auto two = image::readExr(path("b.exr"));
  ASSERT_EQ(two.size(), 2u);
  EXPECT_EQ(two[0].name + " " + two[1].name, "albedo albedo_variance");
}

TEST_F(Reference, SameBytesForSameSeedOnly) {
  expectDone(reference({"--spp", "4", "--seed", "5", "--threads", "1", "--out", path("a.exr")}));
  expectDone(reference({"--spp", "4", "--seed", "5", "--out", path("b.exr")}));
  expectDone(reference({"--spp", "4", "--seed", "6", "--out", path("c.exr")}));
  EXPECT_EQ(read("a.exr"), read("b.exr"));
  EXPECT_NE(read("a.exr"), read("c.exr"));
}

TEST_F(Reference, InterruptedAndResumed) {
  // Far too much to end by itself; the first signal keeps the state.
  CommandSetup setup;
  setup.signalAfterMs = 500;
  setup.signal = SIGINT;
  std::vector<std::string> forever =
      reference({"--spp", "100000000", "--pass", "4", "--out", path("a.exr"), "--checkpoint", path("state")});
  const CommandResult stopped = runRadivox(forever, setup);
  EXPECT_EQ(stopped.exitCode, 130);
  EXPECT_EQ(stopped.err, "radivox: interrupted\n");
  EXPECT_EQ(files(), std::vector<std::string>{"state"});
  // At what pass that was, nobody knows; but going on for one more sample ends at a known one.
  expectDone(reference({"--spp", "1", "--resume", path("state"), "--out", path("b.exr"), "--stats", path("b.json")}));
  const std::string samples = nlohmann::json::parse(read("b.json"))["samples"].dump();
  expectDone(reference({"--spp", samples, "--pass", "4", "--out", path("c.exr")}));
  EXPECT_EQ(read("b.exr"), read("c.exr"));
}

TEST_F(Reference, StopsWhenGoodEnough) {
  expectDone(reference({"--spp", "65536", "--pass", "8", "--target-error", "0.3", "--out", path("a.exr"), "--stats", path("a.json")}));
  const auto stats = nlohmann::json::parse(read("a.json"));
  EXPECT_LT(stats["samples"], 65536);
  EXPECT_LE(stats["aovs"]["color"]["relative_error"], 0.3);
  expectDone(reference({"--spp", "1000000", "--pass", "8", "--time-limit", "0.2", "--out", path("b.exr")}));
}

TEST_F(Reference, IrradianceAtPoints) {
  write("points.csv", "x,y,z,nx,ny,nz\n# the middle of the floor\n0,0,0,0,1,0\n\n0,-1,0,0,2,0\n");
  expectDone({"reference", "builtin:sphere?inward=1&albedo=0.5", "--probe", path("points.csv"), "--spp", "256", "--out", path("e.csv")});
  std::istringstream lines(read("e.csv"));
  std::string header, middle, bottom;
  std::getline(lines, header);
  std::getline(lines, middle);
  std::getline(lines, bottom);
  EXPECT_EQ(header.rfind("x,y,z,nx,ny,nz,direct_r,", 0), 0u);
  EXPECT_NE(header.find(",indirect_error_b"), std::string::npos);
  EXPECT_EQ(middle.rfind("0,0,0,0,1,0,", 0), 0u);
  EXPECT_EQ(bottom.rfind("0,-1,0,0,1,0,1,1,1,", 0), 0u) << bottom << ": I = 1 at distance 1";
}

TEST_F(Reference, WhatIsWrongIsSaidInOneLine) {
  const std::string out = path("a.exr");
  expectError({"reference", "--out", out}, 2, {"SCENE"});
  expectError(reference({}), 2, {"--out"});
  expectError(reference({"--out", path("a.jpg")}), 2, {"a.jpg", ".exr"});
  expectError(reference({"--out", out, "--spp", "0"}), 2, {"--spp", "1"});
  expectError(reference({"--out", out, "--spp", "many"}), 2, {"--spp"});
  expectError(reference({"--out", out, "--seed", "-1"}), 2, {"--seed"});
  expectError(reference({"--out", out, "--pass", "12"}), 2, {"--pass", "power of two"});
  expectError(reference({"--out", out, "--target-error", "0"}), 2, {"--target-error"});
  expectError(reference({"--out", out, "--time-limit", "nan"}), 2, {"--time-limit"});
  expectError(reference({"--out", out, "--sides", "gtlf"}), 2, {"'gltf'"});
  expectError(reference({"--out", out, "--aov", "colour"}), 2, {"AOV", "'color'"});
  expectError(reference({"--out", out, "--aov", "color,color"}), 2, {"twice"});
  expectError(reference({"--out", out, "--camera", "nowhere"}), 2, {"nowhere"});
  expectError(reference({"--out", out, "--resume", path("none")}), 2, {"--resume", "none"});
  expectError(reference({"--out", out, "--checkpoint", path("no/state")}), 2, {"does not exist"});
  expectError(reference({"--out", out, "--checkpoint", out}), 2, {"twice"});
  expectError(reference({"--out", out, "--sppp", "3"}), 2, {"'--sppp'", "'--spp'"});
  write("state", "hello");
  expectError(reference({"--out", out, "--resume", path("state")}), 2, {"state", "not a checkpoint"});
  write("points.csv", "1,2,3,0,1,0\n1,2,3,0,1\n");
  expectError(reference({"--probe", path("points.csv"), "--out", path("e.csv")}), 2, {"points.csv", "line 2", "x,y,z,nx,ny,nz"});
  expectError(reference({"--probe", path("points.csv"), "--out", out}), 2, {".csv"});
  expectError(reference({"--probe", path("points.csv"), "--halves", "--out", path("e.csv")}), 2, {"--halves", "--probe"});
  write("none.csv", "# nothing\n");
  expectError(reference({"--probe", path("none.csv"), "--out", path("e.csv")}), 2, {"no points"});
  EXPECT_NE(runRadivox({"reference", "--help"}).out.find("--target-error"), std::string::npos);
}

}  // namespace

}  // namespace radivox::test

#endif
