// Skies as images: orientation, means over directions, suns, files.
#include "engine/scene/sky.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <random>

#include "engine/error.h"
#include "shaders/shared/sky.h"
#include "tests/gpu/expect_error.h"

namespace radivox {
namespace {

using scene::makeSky;
using scene::Sky;
using scene::Suns;

constexpr double kPi = 3.14159265358979323846;

/// Radiance by direction, at the middles of texels.
image::Image paint(uint32_t width, const std::function<glm::vec3(const glm::dvec3&)>& radiance) {
  Sky frame;
  frame.width = width;
  frame.height = width / 2;
  image::Image image{width, width / 2, 3, {}};
  for (uint32_t y = 0; y < image.height; ++y) {
    for (uint32_t x = 0; x < width; ++x) {
      const glm::vec3 value = radiance(frame.direction((x + 0.5) / width, (y + 0.5) / image.height));
      image.data.insert(image.data.end(), {value.x, value.y, value.z});
    }
  }
  return image;
}

/// sr of each bin, by the middles of many cells.
std::vector<double> binSolidAngles() {
  std::vector<double> angles(shared::kSkyBinCount);
  Sky frame;
  constexpr int kColumns = 2048, kRows = 1024;
  for (int y = 0; y < kRows; ++y) {
    const double angle = (std::cos(kPi * y / kRows) - std::cos(kPi * (y + 1) / kRows)) * 2 * kPi / kColumns;
    for (int x = 0; x < kColumns; ++x)
      angles[shared::skyBin(glm::vec3(frame.direction((x + 0.5) / kColumns, (y + 0.5) / kRows)), true)] += angle;
  }
  return angles;
}

class SkyFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / ("radivox_sky_" + std::to_string(std::random_device()()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  void write(const std::string& name, const std::string& bytes) const { std::ofstream(path(name), std::ios::binary) << bytes; }
  static void expectRefused(const std::string& sky, const std::string& part) {
    tests::expectError(tests::catchError([&] { scene::loadSky(sky); }), ErrorCode::BadInput, part);
  }

 private:
  std::filesystem::path folder_;
};

TEST(SkyImage, LooksAlongMinusZInItsMiddle) {
  Sky sky;
  sky.width = 8;
  sky.height = 4;
  const auto expectNear = [](const glm::dvec3& a, const glm::dvec3& b) { EXPECT_LT(glm::distance(a, b), 1e-6); };
  expectNear(sky.direction(0.5, 0.5), {0, 0, -1});
  expectNear(sky.direction(0.75, 0.5), {1, 0, 0});
  expectNear(sky.direction(0.25, 0.5), {-1, 0, 0});
  expectNear(sky.direction(0.3, 0), {0, 1, 0});
  expectNear(sky.direction(0.3, 1), {0, -1, 0});
  // Turned a quarter about +y, what was seen along −z is seen along −x.
  sky.turn = static_cast<float>(kPi / 2);
  expectNear(sky.direction(0.5, 0.5), {-1, 0, 0});
  for (uint32_t y = 0; y < sky.height; ++y) {
    for (uint32_t x = 0; x < sky.width; ++x)
      EXPECT_EQ(sky.texelAt(glm::vec3(sky.direction((x + 0.5) / 8, (y + 0.5) / 4))), glm::uvec2(x, y));
  }
}

TEST(SkyImage, BinsTileTheSphere) {
  const std::vector<double> angles = binSolidAngles();
  double sum = 0;
  for (const double angle : angles) {
    sum += angle;
    EXPECT_GT(angle, 0.07);
    EXPECT_LT(angle, 0.18);
  }
  EXPECT_NEAR(sum, 4 * kPi, 1e-9);
  // Each bin is on the side of the cube that is the bin without an image.
  std::mt19937 random(1);
  std::normal_distribution<float> normal;
  for (int i = 0; i < 10000; ++i) {
    const glm::vec3 d = glm::normalize(glm::vec3(normal(random), normal(random), normal(random)));
    ASSERT_EQ(shared::skyBin(d, true) / (shared::kSkyBinSide * shared::kSkyBinSide), shared::skyBin(d, false));
  }
}

TEST(SkyImage, MeansKeepTheFlux) {
  const std::vector<double> angles = binSolidAngles();
  for (const uint32_t width : {16u, 64u, 500u, 1024u}) {
    const auto even = makeSky(paint(width, [](const glm::dvec3&) { return glm::vec3(0.25f, 1.f, 3.f); }), "even");
    for (const std::vector<glm::vec3>* means : {&even->bins, &even->cells}) {
      for (const glm::vec3& mean : *means) ASSERT_LT(glm::distance(mean, glm::vec3(0.25f, 1.f, 3.f)), 1e-5f);
    }
    const auto slope =
        makeSky(paint(width, [](const glm::dvec3& d) { return glm::vec3(static_cast<float>(2 + d.x + 0.5 * d.y)); }), "slope");
    double flux = 0, texelFlux = 0;
    for (size_t i = 0; i < angles.size(); ++i) flux += angles[i] * static_cast<double>(slope->bins[i].x);
    for (size_t i = 0; i < slope->texels.size(); ++i)
      texelFlux += slope->solidAngle(static_cast<uint32_t>(i / width)) * static_cast<double>(slope->texels[i].x);
    EXPECT_NEAR(flux / texelFlux, 1, 1e-4);
    EXPECT_TRUE(slope->suns.empty());
    EXPECT_TRUE(slope->notes.empty());
  }
}

// What a sun brings onto any plane that it sees is kept.
TEST(SkyImage, SunsBecomeLights) {
  const auto with = scene::loadSky("builtin:clear"), kept = scene::loadSky("builtin:clear?sun=keep");
  ASSERT_EQ(with->suns.size(), 1u);
  EXPECT_TRUE(kept->suns.empty());
  EXPECT_EQ(with->texels, kept->texels) << "the path tracer has the whole image";
  const scene::PunctualLight& sun = with->suns[0];
  EXPECT_EQ(sun.type, shared::kLightDirectional);
  EXPECT_NEAR(std::asin(-sun.direction.y) * 180 / kPi, 40, 0.3);
  EXPECT_NEAR(sun.intensity.y, 8, 0.1);
  EXPECT_NEAR(sun.intensity.x / sun.intensity.y, 8.6 / 8, 0.01);
  ASSERT_EQ(with->notes.size(), 1u);
  EXPECT_NE(with->notes[0].find("a sun"), std::string::npos);
  // All of the image, by its texels; and what the renderer has instead.
  const auto integrate = [&](const std::vector<glm::vec3>& values, uint32_t columns, const glm::dvec3& n) {
    const uint32_t rows = columns / 2;
    double sum = 0;
    for (uint32_t y = 0; y < rows; ++y) {
      const double angle = (std::cos(kPi * y / rows) - std::cos(kPi * (y + 1) / rows)) * 2 * kPi / columns;
      for (uint32_t x = 0; x < columns; ++x)
        sum += std::max(0.0, glm::dot(with->direction((x + 0.5) / columns, (y + 0.5) / rows), n)) * angle *
               static_cast<double>(values[size_t{y} * columns + x].y);
    }
    return sum;
  };
  for (const glm::dvec3 n : {glm::dvec3(0, 1, 0), glm::normalize(glm::dvec3(1, 1, -0.5)), glm::normalize(glm::dvec3(0.5, 0.2, -1))}) {
    const double direct = static_cast<double>(sun.intensity.y) * std::max(0.0, -glm::dot(glm::dvec3(sun.direction), n));
    EXPECT_NEAR((integrate(with->cells, shared::kSkyCellColumns, n) + direct) / integrate(kept->texels, kept->width, n), 1, 0.005);
  }
}

TEST(SkyImage, OnlySmallAndStrongLightsAreSuns) {
  const auto patch = [](double cosine, float radiance) {
    return paint(512, [=](const glm::dvec3& d) { return glm::vec3(d.y > cosine ? radiance : 1.f); });
  };
  EXPECT_EQ(makeSky(patch(std::cos(0.03), 2000.f), "disc")->suns.size(), 1u);
  EXPECT_TRUE(makeSky(patch(std::cos(0.03), 10.f), "dim")->suns.empty());
  EXPECT_TRUE(makeSky(patch(std::cos(0.5), 2000.f), "wide")->suns.empty());
  EXPECT_TRUE(makeSky(paint(64, [](const glm::dvec3&) { return glm::vec3(0.f); }), "black")->suns.empty());
}

TEST(SkyImage, TurnsAndScales) {
  const image::Image image = paint(64, [](const glm::dvec3& d) { return glm::vec3(1 + d.x, 1 + d.y, 1 + d.z); });
  const auto sky = makeSky(image, "sky", 2, 90);
  // What was at +x is at −z, and at twice the radiance.
  EXPECT_NEAR(sky->radiance({0, 0, -1}).x, 4, 0.2);
  EXPECT_NEAR(sky->interpolated({1, 0, 0}).z, 4, 0.1);
  EXPECT_EQ(makeSky(image, "sky", 1, 360)->texelAt({0.3f, 0.4f, 0.5f}), makeSky(image, "sky")->texelAt({0.3f, 0.4f, 0.5f}));
}

TEST_F(SkyFiles, ExrAndHdrHoldTheSame) {
  const image::Image image = paint(16, [](const glm::dvec3& d) { return glm::vec3(d.y > 0 ? 2.f : 0.5f, 1.f, 0.25f); });
  image::writeExr(path("a.exr"), {{"color", image}});
  // Powers of two, which RGBE holds exactly: mantissas over 256, one exponent.
  std::string hdr = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8 +X 16\n";
  for (size_t i = 0; i < image.data.size(); i += 3) {
    for (size_t c = 0; c < 3; ++c) hdr += static_cast<char>(static_cast<unsigned char>(image.data[i + c] / 4.f * 256.f));
    hdr += static_cast<char>(static_cast<unsigned char>(128 + 2));
  }
  write("a.hdr", hdr);
  const auto exr = scene::loadSky(path("a.exr")), read = scene::loadSky(path("a.hdr"));
  EXPECT_EQ(exr->texels, read->texels);
  EXPECT_EQ(exr->width, 16u);
  const auto half = scene::loadSky(path("a.exr") + "?scale=0.5&turn=30");
  EXPECT_EQ(half->texels[0], 0.5f * exr->texels[0]);
  EXPECT_NEAR(half->turn, kPi / 6, 1e-6);
}

TEST_F(SkyFiles, WhatIsNoSkyIsRefused) {
  expectRefused(path("none.exr"), "no such file");
  expectRefused(path("none.hdr"), "no such file");
  expectRefused(path("none.png"), ".exr or .hdr");
  expectRefused("builtin:dusk", "builtin:clear");
  write("text.hdr", "no picture");
  expectRefused(path("text.hdr"), "RGBE");
  write("short.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 30000 +X 60000\n");
  expectRefused(path("short.hdr"), "60000x30000");
  write("broken.exr", "v/1\x01 and no more");
  expectRefused(path("broken.exr"), "broken.exr");
  const auto refuseImage = [this](const image::Image& image, const std::string& part) {
    image::writeExr(path("bad.exr"), {{"color", image}});
    expectRefused(path("bad.exr"), part);
  };
  refuseImage({1, 1, 3, {1, 1, 1}}, "1x1");
  refuseImage({16, 16, 3, std::vector<float>(16 * 16 * 3, 1.f)}, "twice as wide");
  refuseImage({16, 8, 1, std::vector<float>(16 * 8, 1.f)}, "RGB");
  image::Image image = paint(16, [](const glm::dvec3&) { return glm::vec3(1.f); });
  image.at(3, 2, 1) = std::numeric_limits<float>::quiet_NaN();
  refuseImage(image, "texel 3,2 is");
  image.at(3, 2, 1) = std::numeric_limits<float>::infinity();
  refuseImage(image, "texel 3,2 is inf");
  image.at(3, 2, 1) = -1;
  refuseImage(image, "texel 3,2 is -1");
  for (const char* setting : {"scale=-1", "scale=much", "turn=", "scale", "tilt=3", "sun=out"})
    expectRefused(std::string("builtin:clear?") + setting, setting);
}

}  // namespace
}  // namespace radivox
