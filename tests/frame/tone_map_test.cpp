// Tone map: the exact percentile, the sRGB curve, and pixels that are not numbers.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "engine/image/image.h"
#include "modules/frame/tone_map.h"
#include "tests/oracles/gpu_fixture.h"
#include "tests/oracles/node_harness.h"

namespace radivox {
namespace {

struct Shown {
  std::vector<glm::vec3> display;  ///< as stored, [0, 1]
  float exposure = 0;
  double notFinite = 0;
};

Shown toneMap(gpu::Device& device, uint32_t width, uint32_t height, const std::vector<glm::vec4>& pixels,
              const std::vector<std::pair<std::string, std::string>>& settings = {}) {
  oracles::NodeHarness harness(device);
  harness.setCount("width", width);
  harness.setCount("height", height);
  harness.importImage("in.color", {.width = width, .height = height}, pixels);
  harness.add<frame::ToneMap>("tone_map");
  harness.connect("in.color", "tone_map.color");
  harness.output("tone_map.display");
  harness.output("tone_map.exposure");
  for (const auto& [name, value] : settings) harness.set("tone_map." + name, value);
  harness.run();
  Shown shown;
  shown.exposure = harness.download<float>("tone_map.exposure", 1)[0];
  EXPECT_EQ(static_cast<float>(harness.figure("tone_map", "exposure")), shown.exposure);
  shown.notFinite = harness.figure("tone_map", "not_finite_pixels");
  const auto bytes = harness.downloadImage<uint8_t>("tone_map.display");
  for (size_t i = 0; i < pixels.size(); ++i) shown.display.push_back(glm::vec3(bytes[4 * i], bytes[4 * i + 1], bytes[4 * i + 2]) / 255.f);
  return shown;
}

image::Image asImage(uint32_t width, uint32_t height, const std::vector<glm::vec4>& pixels) {
  image::Image image{width, height, 3, {}};
  for (const glm::vec4& p : pixels) image.data.insert(image.data.end(), {p.x, p.y, p.z});
  return image;
}

double srgb(double x) {
  x = std::clamp(x, 0.0, 1.0);
  return x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055;
}

std::vector<glm::vec4> makeNoise(size_t count, uint32_t seed, float octaves) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal(0.f, octaves);
  std::vector<glm::vec4> pixels;
  for (size_t i = 0; i < count; ++i) {
    const float r = normal(random), g = normal(random), b = normal(random);
    pixels.emplace_back(std::exp2(r), std::exp2(g), std::exp2(b), 1.f);
  }
  return pixels;
}

class ToneMapTest : public oracles::GpuTest {};

TEST_F(ToneMapTest, ExposureIsTheExactPercentile) {
  struct Case {
    uint32_t width, height;
    float octaves;
  };
  for (const Case& c : {Case{1, 1, 1.f}, Case{2, 1, 1.f}, Case{10, 10, 3.f}, Case{101, 1, 0.001f}, Case{67, 43, 8.f}, Case{160, 90, 2.f}}) {
    const auto pixels = makeNoise(size_t{c.width} * c.height, c.width, c.octaves);
    const float expected = image::exposureOf(asImage(c.width, c.height, pixels));
    EXPECT_NEAR(toneMap(device(), c.width, c.height, pixels).exposure / expected, 1.0, 1e-6) << c.width << "x" << c.height;
  }
}

TEST_F(ToneMapTest, FlatAndBlackImages) {
  EXPECT_NEAR(toneMap(device(), 9, 7, std::vector<glm::vec4>(63, glm::vec4(2.f, 2.f, 2.f, 1.f))).exposure, 0.5, 1e-6);
  const Shown black = toneMap(device(), 9, 7, std::vector<glm::vec4>(63, glm::vec4(0.f)));
  EXPECT_EQ(black.exposure, 1.f);
  for (const glm::vec3& p : black.display) EXPECT_EQ(p, glm::vec3(0.f));
}

TEST_F(ToneMapTest, DisplayIsEncodedSrgb) {
  const auto pixels = makeNoise(64 * 48, 3, 3.f);
  const Shown shown = toneMap(device(), 64, 48, pixels);
  for (size_t i = 0; i < pixels.size(); ++i)
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(shown.display[i][k], srgb(double{pixels[i][k]} * double{shown.exposure}), 0.51 / 255) << i << ", " << k;
}

TEST_F(ToneMapTest, WhatIsNotANumberIsBlackAndCounted) {
  auto pixels = makeNoise(40 * 30, 5, 1.f);
  auto clean = asImage(40, 30, pixels);
  constexpr float kInf = std::numeric_limits<float>::infinity();
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  pixels[17] = {kNaN, 1.f, 1.f, 1.f};
  pixels[399] = {1.f, kInf, 1.f, 1.f};
  pixels[400] = {1.f, 1.f, -kInf, 1.f};
  clean.data.clear();
  for (size_t i = 0; i < pixels.size(); ++i)
    if (i != 17 && i != 399 && i != 400) clean.data.insert(clean.data.end(), {pixels[i].x, pixels[i].y, pixels[i].z});
  clean.width = 1197;
  clean.height = 1;
  const Shown shown = toneMap(device(), 40, 30, pixels);
  EXPECT_EQ(shown.notFinite, 3);
  EXPECT_NEAR(shown.exposure / image::exposureOf(clean), 1.0, 1e-6);
  for (const size_t i : {size_t{17}, size_t{399}, size_t{400}}) EXPECT_EQ(shown.display[i], glm::vec3(0.f));
}

TEST_F(ToneMapTest, ManualExposureAndCompensation) {
  const auto pixels = makeNoise(64, 9, 2.f);
  EXPECT_EQ(toneMap(device(), 8, 8, pixels, {{"exposure", "manual"}, {"ev", "-3"}}).exposure, 0.125f);
  const float automatic = toneMap(device(), 8, 8, pixels).exposure;
  EXPECT_FLOAT_EQ(toneMap(device(), 8, 8, pixels, {{"ev", "2"}}).exposure, 4.f * automatic);
}

TEST_F(ToneMapTest, FilmicRisesFromBlackTowardsWhite) {
  std::vector<glm::vec4> ramp;
  for (int i = 0; i < 256; ++i) ramp.emplace_back(glm::vec3(static_cast<float>(i * i) / 1024.f), 1.f);
  const Shown shown = toneMap(device(), 256, 1, ramp, {{"exposure", "manual"}, {"operator", "filmic"}});
  EXPECT_EQ(shown.display[0], glm::vec3(0.f));
  for (size_t i = 1; i < 256; ++i) EXPECT_GE(shown.display[i].x, shown.display[i - 1].x);
  EXPECT_NEAR(shown.display[32].x, srgb(4.2 / 5.55), 0.51 / 255);  // 1 → 0.757
  EXPECT_GT(shown.display[255].x, 0.98f);
}

}  // namespace
}  // namespace radivox
