// The node of modules/README.md, loaded from its own library: as it is printed there, it works.
#include <algorithm>
#include <cmath>
#include <fstream>

#include "engine/image/image.h"
#include "tests/cli/command.h"

namespace radivox::test {

namespace {

const char* const kLibrary = RADIVOX_BINARY_DIR "/tests/first_node/build/contours.so";
const char* const kGraph = RADIVOX_BINARY_DIR "/tests/first_node/source/contours.json";

class FirstNode : public CommandTest {};

TEST_F(FirstNode, DrawsStripesOfEqualDistance) {
  const CommandResult result = runRadivox({"render", "builtin:cornell", "--validate", "--module", kLibrary, "--graph", kGraph, "--set",
                                           "contours.spacing=2", "--size", "40x30", "--aov", "color,depth", "--out", path("a.exr")});
  ASSERT_EQ(result.exitCode, 0) << result.err;
  EXPECT_EQ(result.err, "");
  image::Image color, depth;
  for (image::Layer& layer : image::readExr(path("a.exr"))) (layer.name == "color" ? color : depth) = std::move(layer.image);
  ASSERT_EQ(depth.data.size(), 40u * 30u);
  size_t bright = 0, dark = 0;
  for (size_t i = 0; i < depth.data.size(); ++i) {
    const float turn = depth.data[i] / 2.f - std::floor(depth.data[i] / 2.f);
    // At the edge of a stripe a last bit decides.
    if (std::min({turn, std::abs(turn - 0.5f), 1.f - turn}) < 1e-4f) continue;
    const float expected = depth.data[i] <= 0.f ? 0.f : turn < 0.5f ? 1.f : 0.25f;
    ASSERT_EQ(color.data[3 * i], expected) << i << " at " << depth.data[i];
    bright += expected == 1.f ? 1 : 0;
    dark += expected == 0.25f ? 1 : 0;
  }
  EXPECT_GT(bright, 100u);
  EXPECT_GT(dark, 100u);
}

TEST_F(FirstNode, IsListedWithItsLibraryAndParameters) {
  const CommandResult info = runRadivox({"info", "--module", kLibrary});
  ASSERT_EQ(info.exitCode, 0) << info.err;
  EXPECT_NE(info.out.find("example.contours"), std::string::npos);
  EXPECT_NE(info.out.find("contours.so"), std::string::npos);
  EXPECT_NE(info.out.find("spacing = 1  (0.01 to 100)"), std::string::npos);
}

TEST_F(FirstNode, ItsParametersAreCheckedLikeAnyOther) {
  expectError({"render", "builtin:cornell", "--module", kLibrary, "--graph", kGraph, "--set", "contours.spacing=0", "--out", path("a.exr")},
              2, {"contours.spacing", "0.01"});
  expectError({"render", "builtin:cornell", "--graph", kGraph, "--out", path("a.exr")}, 2, {"example.contours"});
  expectError({"render", "builtin:cornell", "--module", kLibrary, "--module", kLibrary, "--graph", kGraph, "--out", path("a.exr")}, 2,
              {"example.contours", "contours.so"});
}

}  // namespace

}  // namespace radivox::test
