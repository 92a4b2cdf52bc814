// What comes from outside: full disks, other processes, other numbers of threads, another driver.
#include <cstdlib>
#include <thread>

#include "engine/image/image.h"
#include "tests/cli/command.h"

namespace radivox::test {

namespace {

class Sturdy : public CommandTest {
 protected:
  std::vector<std::string> render(const std::string& out, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words = {"render", "builtin:cornell_point",
                                      "--size", "32x24",
                                      "--set",  "voxelize.resolution=16",
                                      "--set",  "visibility.rays=32",
                                      "--set",  "lights.point_shadow_resolution=64",
                                      "--out",  path(out)};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
};

TEST_F(Sturdy, SlowADiskThatIsFullLeavesNoHalfFile) {
  ASSERT_EQ(runRadivox(render("truth.exr")).exitCode, 0);
  const std::string old = read("truth.exr");
  // No cache: it may be too large as well, and is no one's output.
  const CommandSetup full{.environment = {{"RADIVOX_PIPELINE_CACHE", ""}}, .largestFile = 512};
  // The old file stays where a new one does not fit.
  expectError(render("truth.exr"), 2, {"truth.exr", "limit"}, full);
  EXPECT_EQ(read("truth.exr"), old);
  expectError(render("new.exr"), 2, {"new.exr"}, full);
  expectError(render("new.png"), 2, {"new.png"}, full);
  expectError({"scene", "sphere", "--out", path("new.glb")}, 2, {"new.glb"}, full);
  expectError({"compare", path("truth.exr"), path("truth.exr"), "--out", path("new.exr")}, 2, {"new.exr"}, full);
  expectError({"compare", path("truth.exr"), path("truth.exr"), "--json", path("new.json")}, 2, {"new.json"},
              {.environment = {}, .largestFile = 16});
#ifdef RADIVOX_WITH_REFERENCE
  expectError({"reference", "builtin:cornell", "--size", "16x12", "--spp", "4", "--out", path("new.exr")}, 2, {"new.exr"}, full);
  expectError(
      {"reference", "builtin:cornell", "--size", "16x12", "--spp", "4", "--out", path("new.png"), "--checkpoint", path("new.state")}, 2,
      {"new."}, full);
#endif
}

TEST_F(Sturdy, SlowStatisticsThatDoNotFitAreAnErrorAndThePictureStays) {
  const CommandResult result =
      runRadivox(render("a.png", {"--stats", path("a.json")}), {.environment = {{"RADIVOX_PIPELINE_CACHE", ""}}, .largestFile = 4096});
  EXPECT_EQ(result.exitCode, 2) << result.err;
  EXPECT_NE(result.err.find("a.json"), std::string::npos) << result.err;
  EXPECT_EQ(files(), std::vector<std::string>{"a.png"});
  EXPECT_GT(image::readPng(path("a.png")).width, 0u);
}

TEST_F(Sturdy, SlowACacheThatDoesNotFitIsNoError) {
  const CommandResult result =
      runRadivox(render("a.png"), {.environment = {{"RADIVOX_PIPELINE_CACHE", path("cache")}}, .largestFile = 4096});
  EXPECT_EQ(result.exitCode, 0) << result.err;
  for (const std::string& name : files()) EXPECT_TRUE(name == "a.png" || name == "cache") << name;
}

TEST_F(Sturdy, SlowTheStabilityTableOnAFullDisk) {
  const CommandResult result =
      runRadivox({"stability", "--out", path("out"), "--method", "clustered_voxel", "--case", "all triangles in one voxel"},
                 {.environment = {{"RADIVOX_PIPELINE_CACHE", ""}}, .largestFile = 64});
  EXPECT_EQ(result.exitCode, 2) << result.err;
  EXPECT_NE(result.err.find("stability.csv"), std::string::npos) << result.err;
  EXPECT_TRUE(std::filesystem::is_empty(path("out")));
}

TEST_F(Sturdy, SlowTwoProcessesShareTheirCaches) {
  const CommandSetup setup{.environment = {{"RADIVOX_PIPELINE_CACHE", path("cache")}}};
  ASSERT_EQ(runRadivox(render("alone.exr"), setup).exitCode, 0);
  std::filesystem::remove(path("cache"));
  std::vector<CommandResult> results(3);
  std::vector<std::thread> processes;
  for (size_t i = 0; i < results.size(); ++i) {
    processes.emplace_back([&, i] { results[i] = runRadivox(render(std::to_string(i) + ".exr"), setup); });
  }
  for (std::thread& process : processes) process.join();
  for (size_t i = 0; i < results.size(); ++i) {
    EXPECT_EQ(results[i].exitCode, 0) << results[i].err;
    EXPECT_EQ(results[i].err, "");
    EXPECT_EQ(read(std::to_string(i) + ".exr"), read("alone.exr"));
  }
  // Both write one output: it is one of the two whole.
  for (size_t i = 0; i < 2; ++i) processes[i] = std::thread([&, i] { results[i] = runRadivox(render("both.exr"), setup); });
  for (size_t i = 0; i < 2; ++i) processes[i].join();
  EXPECT_EQ(read("both.exr"), read("alone.exr"));
  EXPECT_EQ(files(), (std::vector<std::string>{"0.exr", "1.exr", "2.exr", "alone.exr", "both.exr", "cache"}));
}

TEST_F(Sturdy, SlowOneToEightDriverThreadsGiveTheSameBits) {
  for (int threads = 1; threads <= 8; ++threads) {
    const std::string name = std::to_string(threads) + ".exr";
    const CommandResult result = runRadivox(render(name, {"--aov", "color,irradiance_indirect,face,cluster"}),
                                            {.environment = {{"LP_NUM_THREADS", std::to_string(threads)}}});
    ASSERT_EQ(result.exitCode, 0) << result.err;
    EXPECT_EQ(read(name), read("1.exr")) << threads << " threads";
  }
}

// RADIVOX_OTHER_DRIVER: the manifest (.json) of another driver, as newer-lavapipe.sh unpacks it; its libraries beside it.
TEST_F(Sturdy, SlowAnotherDriverGivesTheSamePicture) {
  const char* manifest = std::getenv("RADIVOX_OTHER_DRIVER");
  if (manifest == nullptr) GTEST_SKIP() << "RADIVOX_OTHER_DRIVER names no driver's manifest";
  std::map<std::string, std::string> other = {{"VK_DRIVER_FILES", manifest}, {"VK_ICD_FILENAMES", manifest}};
  const auto libraries = std::filesystem::path(manifest).parent_path() / "usr/lib/x86_64-linux-gnu";
  if (std::filesystem::exists(libraries)) other["LD_LIBRARY_PATH"] = libraries.string();
  const std::vector<std::string> aovs = {"--aov", "color,face,cluster", "--validate"};
  ASSERT_EQ(runRadivox(render("stock.exr", aovs)).exitCode, 0);
  for (const char* threads : {"1", "8"}) {
    other["LP_NUM_THREADS"] = threads;
    const CommandResult result = runRadivox(render(std::string("other") + threads + ".exr", aovs), {.environment = other});
    ASSERT_EQ(result.exitCode, 0) << result.err;
  }
  EXPECT_EQ(read("other1.exr"), read("other8.exr"));
  const auto stock = image::readExr(path("stock.exr")), newer = image::readExr(path("other8.exr"));
  ASSERT_EQ(stock.size(), newer.size());
  for (size_t i = 0; i < stock.size(); ++i) {
    ASSERT_EQ(stock[i].name, newer[i].name);
    const auto& a = stock[i].image.data;
    const auto& b = newer[i].image.data;
    ASSERT_EQ(a.size(), b.size());
    const bool isInteger = stock[i].name != "color";
    const double mean = image::meanOf(stock[i].image);
    for (size_t k = 0; k < a.size(); ++k) {
      if (isInteger) {
        ASSERT_EQ(a[k], b[k]) << stock[i].name << ", value " << k;
      } else {
        ASSERT_NEAR(a[k], b[k], 1e-5 * std::max(mean, std::abs(double{a[k]}))) << stock[i].name << ", value " << k;
      }
    }
  }
}

}  // namespace

}  // namespace radivox::test
