// radivox view without a display, as a whole.
#include "tests/cli/command.h"
#include <algorithm>

#include "engine/image/image.h"

namespace radivox::test {

class ViewTest : public CommandTest {
 protected:
  const std::vector<std::string> small_ = {"builtin:cornell_point", "--size", "80x60", "--set", "voxelize.resolution=16"};
  std::vector<std::string> with(std::vector<std::string> words) const {
    words.insert(words.end(), small_.begin(), small_.end());
    return words;
  }
};

TEST_F(ViewTest, RefusesInOneLine) {
  expectError(with({"view", "--headless"}), 2, {"--out is missing"});
  expectError(with({"view", "--headless", "--out", "a.gif"}), 2, {"a.gif", ".png"});
  expectError(with({"view", "--headless", "--out", path("a.png"), "--overlay", "clutsers"}), 2, {"clutsers", "did you mean 'clusters'"});
  expectError(with({"view", "--headless", "--out", path("a.png"), "--point", "3"}), 2, {"--point '3'", "X,Y"});
  expectError(with({"view", "--headless", "--out", path("a.png"), "--play", "walk"}), 2, {"--play 'walk'", "--views"});
}

TEST_F(ViewTest, SlowDrawsWhatRenderDraws) {
  ASSERT_EQ(runRadivox(with({"render", "--graph", "clustered_voxel", "--out", path("render.png")})).exitCode, 0);
  const CommandResult view = runRadivox(with({"view", "--headless", "--validate", "--out", path("view.png"), "--stats", path("v.json")}));
  ASSERT_EQ(view.exitCode, 0) << view.err;
  const image::Image a = image::readPng(path("render.png")), b = image::readPng(path("view.png"));
  ASSERT_EQ(b.channels, 4u);
  ASSERT_EQ(a.width * a.height, b.width * b.height);
  for (uint32_t y = 0; y < a.height; ++y) {
    for (uint32_t x = 0; x < a.width; ++x) {
      for (uint32_t c = 0; c < 3; ++c) ASSERT_EQ(a.at(x, y, c), b.at(x, y, c)) << x << "," << y;
    }
  }
}

TEST_F(ViewTest, SlowWalksAPathFrameByFrame) {
  write("v.json", R"({"paths": [{"name": "walk", "keys": [
      {"seconds": 0, "position": [0, 1, 3.4], "orientation": [0, 0, 0, 1]},
      {"seconds": 0.1, "position": [0.5, 1, 3], "orientation": [0, 0.1, 0, 1]}]}]})");
  const CommandResult result = runRadivox(with({"view", "--headless", "--views", path("v.json"), "--play", "walk", "--frames", "3", "--out",
                                                path("f_##.png"), "--out", path("last.exr"), "--stats", path("s.json")}));
  ASSERT_EQ(result.exitCode, 0) << result.err;
  EXPECT_EQ(files(), (std::vector<std::string>{"f_00.png", "f_01.png", "f_02.png", "last.exr", "s.json", "v.json"}));
  EXPECT_NE(image::readPng(path("f_00.png")).data, image::readPng(path("f_02.png")).data);
  expectError(with({"view", "--headless", "--views", path("v.json"), "--play", "wolk", "--out", path("a.png")}), 2, {"wolk", "walk"});
}

#ifdef RADIVOX_WITH_WINDOW
TEST_F(ViewTest, SlowDrawsPanelsAndTruthWithoutADisplay) {
  CommandSetup setup;
  setup.environment = {{"DISPLAY", ""}};
  const CommandResult result = runRadivox({"view", "builtin:cornell_point", "--headless", "--panels", "--truth", "--size", "640x240",
                                           "--set", "voxelize.resolution=32", "--validate", "--out", path("p.png")},
                                          setup);
  ASSERT_EQ(result.exitCode, 0) << result.err;
  const image::Image image = image::readPng(path("p.png"));
  ASSERT_EQ(image.width, 640u);
  // 640 − 384 for two pictures of the same scene: means of the boxes' middles agree.
  const auto mean = [&](uint32_t left) {
    double sum = 0;
    for (uint32_t y = 60; y < 200; ++y) {
      for (uint32_t x = left; x < left + 88; ++x) sum += static_cast<double>(image.at(x, y, 1));
    }
    return sum / (140.0 * 88.0);
  };
  const double picture = mean(20), truth = mean(20 + 128);
  EXPECT_GT(picture, 0.02);
  EXPECT_NEAR(picture / truth, 1.0, 0.1);
  double brightest = 0;
  for (uint32_t x = 262; x < 640; ++x) brightest = std::max(brightest, static_cast<double>(image.at(x, 20, 0)));
  EXPECT_GT(brightest, 0.5) << "no letters on the panels";
}
#endif

}  // namespace radivox::test
