// FLIP against its published figures, and against what its definition says of simple images.
#include "engine/image/flip.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>

#include "engine/error.h"

namespace fs = std::filesystem;
namespace image = radivox::image;

namespace {

image::Image filled(uint32_t width, uint32_t height, std::array<float, 3> value) {
  image::Image result{width, height, 3, {}};
  for (uint32_t i = 0; i < width * height; ++i) result.data.insert(result.data.end(), value.begin(), value.end());
  return result;
}

image::Image noise(uint32_t width, uint32_t height, uint32_t seed, float most = 1.f) {
  std::mt19937 random(seed);
  image::Image result{width, height, 3, std::vector<float>(static_cast<size_t>(width) * height * 3)};
  for (float& value : result.data) value = most * static_cast<float>(random() >> 8) / 16777216.f;
  return result;
}

image::Image transposed(const image::Image& in) {
  image::Image result{in.height, in.width, in.channels, std::vector<float>(in.data.size())};
  for (uint32_t y = 0; y < in.height; ++y) {
    for (uint32_t x = 0; x < in.width; ++x) {
      for (uint32_t c = 0; c < in.channels; ++c) result.at(y, x, c) = in.at(x, y, c);
    }
  }
  return result;
}

std::string errorOf(const image::Image& a, const image::Image& b, double pixelsPerDegree = image::kFlipPixelsPerDegree) {
  std::string first;
  for (const bool hdr : {false, true}) {
    try {
      hdr ? image::hdrFlip(a, b, pixelsPerDegree).mean : image::flip(a, b, pixelsPerDegree).mean;
      ADD_FAILURE() << "no error";
    } catch (const radivox::Error& e) {
      EXPECT_EQ(static_cast<int>(e.code()), static_cast<int>(radivox::ErrorCode::BadInput));
      if (hdr) {
        EXPECT_EQ(first, e.what());
      }
      first = e.what();
    }
  }
  return first;
}

TEST(Flip, PublishedFiguresToTheLastDigit) {
  const char* shared = std::getenv("RADIVOX_SHARED");
  const fs::path folder = fs::path(shared != nullptr ? shared : RADIVOX_SOURCE_DIR "/../shared") / "truth" / "flip";
  if (!fs::exists(folder / "expected.json")) GTEST_SKIP() << "no " << folder;
  const nlohmann::json expected = nlohmann::json::parse(std::ifstream(folder / "expected.json"));
  const auto color = [&folder](const std::string& name) {
    for (image::Layer& layer : image::readExr((folder / name).string())) {
      if (layer.name == "color") return std::move(layer.image);
    }
    return image::Image{};
  };
  for (const std::string name : {"one_bounce", "noise"}) {
    const image::FlipMap ldr = image::flip(image::readPng((folder / "ldr_reference.png").string()),
                                           image::readPng((folder / ("ldr_test_" + name + ".png")).string()));
    EXPECT_NEAR(ldr.mean, expected.at("ldr").at(name).get<double>(), 2e-5) << name;
    const image::HdrFlipMap hdr = image::hdrFlip(color("hdr_reference.exr"), color("hdr_test_" + name + ".exr"));
    EXPECT_NEAR(hdr.mean, expected.at("hdr").at(name).get<double>(), 2e-5) << name;
    EXPECT_NEAR(hdr.startExposure, expected.at("hdr").at("start_exposure").get<double>(), 1e-4);
    EXPECT_NEAR(hdr.stopExposure, expected.at("hdr").at("stop_exposure").get<double>(), 1e-4);
    EXPECT_EQ(hdr.exposureCount, expected.at("hdr").at("exposure_count").get<uint32_t>());
    std::printf("%-10s LDR %.6f  HDR %.6f, exposures %.4f to %.4f\n", name.c_str(), ldr.mean, hdr.mean, hdr.startExposure,
                hdr.stopExposure);
  }
}

TEST(Flip, EqualImagesDifferNowhere) {
  for (const uint32_t width : {1u, 7u, 33u}) {
    const image::Image a = noise(width, 19, 1);
    EXPECT_EQ(image::flip(a, a).mean, 0.0);
    EXPECT_EQ(image::hdrFlip(a, a).mean, 0.0);
  }
  // What is brighter than the screen can show looks like white.
  EXPECT_EQ(image::flip(filled(9, 9, {1.f, 1.f, 1.f}), filled(9, 9, {7.f, 1.f, 2.f})).mean, 0.0);
  EXPECT_GT(image::hdrFlip(filled(9, 9, {1.f, 1.f, 1.f}), filled(9, 9, {7.f, 1.f, 2.f})).mean, 0.05);
}

TEST(Flip, GreenAgainstBlueIsAsFarAsColoursGo) {
  // Uniform images have no features, and smoothing leaves them: the colour difference alone is left, and this pair defines its 1.
  const image::FlipMap map = image::flip(filled(24, 16, {0.f, 1.f, 0.f}), filled(24, 16, {0.f, 0.f, 1.f}));
  for (const float value : map.error.data) EXPECT_NEAR(value, 1.f, 1e-6f);
  EXPECT_NEAR(map.percentile, 1.0, 1e-6);
}

TEST(Flip, UniformGreysFollowTheFormula) {
  // Greys differ in lightness L* alone: e = ΔL^0.7, mapped to 0.95·e/(0.4·e_max) below the knee.
  const double largest = [] {
    // Hunt-adjusted CIELAB of the screen's green and blue, by hand from the standard's tables: XYZ of the primaries under D65.
    const auto lab = [](double x, double y, double z) {
      const auto f = [](double t) { return t > 216.0 / 24389 ? std::cbrt(t) : (24389.0 / 27 * t + 16) / 116; };
      const double l = 116 * f(y) - 16;
      return std::array<double, 3>{l, 0.01 * l * 500 * (f(x) - f(y)), 0.01 * l * 200 * (f(y) - f(z))};
    };
    const double wx = 0.95045593, wz = 1.08905775;
    const auto green = lab(0.35757608 / wx, 0.71515216, 0.11919203 / wz), blue = lab(0.18043748 / wx, 0.07217500, 0.95030408 / wz);
    return std::pow(std::abs(green[0] - blue[0]) + std::hypot(green[1] - blue[1], green[2] - blue[2]), 0.7);
  }();
  const auto lightness = [](double y) { return 116 * std::cbrt(y) - 16; };
  for (const auto& [a, b] : {std::pair<float, float>{0.2f, 0.25f}, {0.5f, 0.1f}, {1.f, 0.9f}}) {
    const double e = std::pow(std::abs(lightness(static_cast<double>(a)) - lightness(static_cast<double>(b))), 0.7);
    ASSERT_LT(e, 0.4 * largest);
    EXPECT_NEAR(image::flip(filled(11, 8, {a, a, a}), filled(11, 8, {b, b, b})).mean, 0.95 * e / (0.4 * largest), 1e-4);
  }
}

TEST(Flip, NeitherOrderNorTranspositionMatters) {
  const image::Image a = noise(37, 21, 2), b = noise(37, 21, 3);
  const image::FlipMap forward = image::flip(a, b), backward = image::flip(b, a);
  EXPECT_GT(forward.mean, 0.1);
  EXPECT_LE(*std::max_element(forward.error.data.begin(), forward.error.data.end()), 1.f);
  EXPECT_EQ(forward.error.data, backward.error.data);
  const image::Image turned = transposed(image::flip(transposed(a), transposed(b)).error);
  for (size_t i = 0; i < turned.data.size(); ++i) EXPECT_NEAR(turned.data[i], forward.error.data[i], 1e-6f);
  double sum = 0;
  for (const float value : forward.error.data) sum += static_cast<double>(value);
  EXPECT_NEAR(forward.mean, sum / static_cast<double>(forward.error.data.size()), 1e-6);
}

TEST(Flip, ADifferenceIsSeenWhereItIs) {
  // Detail of one pixel in the middle: nothing beyond the reach of the widest filter, ceil(3 σ) = 10 pixels at 67 pixels per degree.
  image::Image a = filled(63, 63, {0.5f, 0.5f, 0.5f}), b = a;
  for (uint32_t c = 0; c < 3; ++c) b.at(31, 31, c) = 0.f;
  const image::FlipMap map = image::flip(a, b);
  EXPECT_EQ(*std::max_element(map.error.data.begin(), map.error.data.end()), map.error.at(31, 31, 0));
  EXPECT_GT(map.error.at(31, 31, 0), 0.1f);
  EXPECT_GT(map.error.at(31, 29, 0), 0.01f);
  for (uint32_t y = 0; y < 63; ++y) {
    for (uint32_t x = 0; x < 63; ++x) {
      if (std::max(std::abs(static_cast<int>(x) - 31), std::abs(static_cast<int>(y) - 31)) > 10) {
        // The filters' taps add up to 1 only as far as doubles do.
        EXPECT_LT(map.error.at(x, y, 0), 1e-3f);
      }
      EXPECT_NEAR(map.error.at(x, y, 0), map.error.at(62 - x, y, 0), 1e-6f);
      EXPECT_NEAR(map.error.at(x, y, 0), map.error.at(x, 62 - y, 0), 1e-6f);
    }
  }
  // From twice the distance the same detail is smaller.
  EXPECT_LT(image::flip(a, b, 2 * image::kFlipPixelsPerDegree).error.at(31, 31, 0), map.error.at(31, 31, 0));
}

TEST(Flip, HdrLooksTheSameInAnyUnit) {
  // Exposures follow the reference: a common factor only moves them, by its log2.
  const image::Image a = noise(25, 17, 4, 30.f), b = noise(25, 17, 5, 30.f);
  const image::HdrFlipMap one = image::hdrFlip(a, b), eight = image::hdrFlip(image::scaled(a, 8.f), image::scaled(b, 8.f));
  EXPECT_NEAR(one.mean, eight.mean, 1e-6);
  EXPECT_NEAR(one.startExposure - eight.startExposure, 3.0, 1e-5);
  EXPECT_NEAR(one.stopExposure - eight.stopExposure, 3.0, 1e-5);
  EXPECT_EQ(one.exposureCount, std::max(2u, static_cast<uint32_t>(std::ceil(one.stopExposure - one.startExposure))));
  // The largest over exposures is no less than at any of them; a black reference has exposures too.
  const image::HdrFlipMap black = image::hdrFlip(filled(8, 8, {0.f, 0.f, 0.f}), filled(8, 8, {0.f, 0.f, 0.f}));
  EXPECT_EQ(black.mean, 0.0);
  EXPECT_TRUE(std::isfinite(black.startExposure));
}

TEST(Flip, ImagesThatCannotBeComparedAreNamed) {
  const image::Image good = noise(8, 6, 6);
  EXPECT_NE(errorOf(good, noise(8, 7, 6)).find("8x7"), std::string::npos);
  EXPECT_NE(errorOf(good, image::Image{8, 6, 1, std::vector<float>(48)}).find("1 channel"), std::string::npos);
  EXPECT_NE(errorOf(image::Image{}, image::Image{}).find("empty"), std::string::npos);
  image::Image bad = good;
  bad.at(5, 4, 1) = std::nanf("");
  EXPECT_NE(errorOf(good, bad).find("(5, 4), channel 1"), std::string::npos);
  bad.at(5, 4, 1) = std::numeric_limits<float>::infinity();
  EXPECT_NE(errorOf(bad, good).find("infinite"), std::string::npos);
  for (const double pixels : {0.0, -1.0, std::nan(""), 1e9}) EXPECT_NE(errorOf(good, good, pixels).find("per degree"), std::string::npos);
}

}  // namespace
