// radivox compare through the binary: figures on stdout and in JSON, error pictures, layers, halves, one-line errors.
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "engine/image/compare.h"
#include "engine/image/flip.h"
#include "tests/cli/command.h"

namespace radivox::test {

namespace {

using nlohmann::json;

class CompareCommand : public CommandTest {
 protected:
  static image::Image waves(uint32_t width, uint32_t height, float phase) {
    image::Image result{width, height, 3, {}};
    for (uint32_t i = 0; i < width * height * 3; ++i) result.data.push_back(1.f + 0.5f * std::sin(0.37f * static_cast<float>(i) + phase));
    return result;
  }
  void exr(const std::string& name, const std::vector<image::Layer>& layers) const { image::writeExr(path(name), layers); }
  json compare(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "compare");
    arguments.insert(arguments.end(), {"--json", path("result.json")});
    const CommandResult result = runRadivox(arguments);
    EXPECT_EQ(result.exitCode, 0) << result.err;
    EXPECT_EQ(result.err, "");
    return result.exitCode == 0 ? json::parse(read("result.json")) : json();
  }
};

TEST_F(CompareCommand, FiguresAreThoseOfTheLibraryAndOfThePrintout) {
  const image::Image r = waves(20, 12, 0.f), t = waves(20, 12, 0.2f);
  exr("r.exr", {{"color", r}});
  exr("t.exr", {{"color", t}, {"albedo", t}});
  const json result = compare({path("r.exr"), path("t.exr")});
  const image::Comparison c = image::compare(image::truthOf(r), t);
  EXPECT_DOUBLE_EQ(result.at("bias").get<double>(), c.bias);
  EXPECT_DOUBLE_EQ(result.at("rmse").get<double>(), c.rmse);
  EXPECT_DOUBLE_EQ(result.at("relmse").get<double>(), c.relMse);
  EXPECT_DOUBLE_EQ(result.at("psnr").get<double>(), c.psnr);
  EXPECT_DOUBLE_EQ(result.at("psnr_4x4").get<double>(), c.psnrBlocks);
  const auto exposure = static_cast<float>(c.exposure);
  const image::FlipMap ldr = image::flip(image::scaled(r, exposure), image::scaled(t, exposure));
  EXPECT_DOUBLE_EQ(result.at("flip").at("mean").get<double>(), ldr.mean);
  EXPECT_DOUBLE_EQ(result.at("flip").at("percentile_99").get<double>(), ldr.percentile);
  EXPECT_DOUBLE_EQ(result.at("hdr_flip").at("mean").get<double>(), image::hdrFlip(r, t).mean);
  EXPECT_EQ(result.count("uncertainty"), 0u);
  const CommandResult printed = runRadivox({"compare", path("r.exr"), path("t.exr")});
  for (const char* name : {"bias", "rmse", "relmse", "psnr", "psnr_4x4", "flip", "hdr_flip", "99th percentile"}) {
    EXPECT_NE(printed.out.find(name), std::string::npos) << name;
  }
  char rmse[32];
  std::snprintf(rmse, sizeof rmse, "%.6g", c.rmse);
  EXPECT_NE(printed.out.find(rmse), std::string::npos) << printed.out;
}

TEST_F(CompareCommand, APictureEqualsItself) {
  exr("r.exr", {{"color", waves(9, 9, 0.f)}});
  const json result = compare({path("r.exr"), path("r.exr"), "--out", path("e.png")});
  EXPECT_EQ(result.at("bias"), 1.0);
  EXPECT_EQ(result.at("rmse"), 0.0);
  EXPECT_TRUE(result.at("psnr").is_null()) << "infinite, which JSON lacks";
  EXPECT_EQ(result.at("flip").at("mean"), 0.0);
  EXPECT_EQ(result.at("hdr_flip").at("mean"), 0.0);
  EXPECT_EQ(image::meanOf(image::readPng(path("e.png"))), 0.0) << "no error is black";
}

TEST_F(CompareCommand, HalvesGiveTheNoiseFloor) {
  const image::Image a = waves(20, 12, 0.f), b = waves(20, 12, 0.1f), t = waves(20, 12, 0.5f);
  exr("a.exr", {{"color", a}});
  exr("b.exr", {{"color", b}});
  exr("t.exr", {{"color", t}});
  const json result = compare({path("a.exr") + "," + path("b.exr"), path("t.exr"), "--weights", "1,3"});
  const image::Comparison c = image::compare(image::truthOf(a, b, 0.25), t);
  EXPECT_EQ(result.at("reference").size(), 2u);
  EXPECT_DOUBLE_EQ(result.at("mse").get<double>(), c.mse);
  EXPECT_DOUBLE_EQ(result.at("uncertainty").at("floor_rmse").get<double>(), c.uncertainty->floorRmse);
  EXPECT_DOUBLE_EQ(result.at("uncertainty").at("rmse_95")[1].get<double>(), c.uncertainty->rmseHigh);
  EXPECT_DOUBLE_EQ(result.at("uncertainty").at("psnr_halves").get<double>(), c.uncertainty->psnrHalves);
}

TEST_F(CompareCommand, LayersAreChosenAndSkyIsLeftOutOfIrradiance) {
  const image::Image r = waves(8, 8, 0.f);
  image::Image t = r, albedo = waves(8, 8, 0.f);
  for (uint32_t c = 0; c < 3; ++c) {
    albedo.at(3, 2, c) = 0.f;
    t.at(3, 2, c) += 100.f;  // where nothing reflects
    t.at(5, 5, c) += 1.f;
  }
  exr("r.exr", {{"color", r}, {"irradiance_indirect", r}, {"albedo", albedo}});
  exr("t.exr", {{"color", t}, {"irradiance_indirect", t}});
  exr("only.exr", {{"color", t}});  // what `render --aov irradiance_indirect` writes
  const json color = compare({path("r.exr"), path("t.exr")});
  EXPECT_EQ(color.at("pixels_left_out"), 0);
  EXPECT_GT(color.at("rmse").get<double>(), 10.0);
  for (const char* test : {"t.exr", "only.exr"}) {
    const json result = compare({path("r.exr"), path(test), "--layer", "irradiance_indirect"});
    EXPECT_EQ(result.at("pixels_left_out"), 1);
    EXPECT_NEAR(result.at("rmse").get<double>(), 1.0 / 8.0, 1e-6) << "one of 64 pixels is off by 1";
  }
  expectError({"compare", path("r.exr"), path("t.exr"), "--layer", "depth"}, 2, {"r.exr", "'depth'", "irradiance_indirect"});
}

TEST_F(CompareCommand, ErrorPicturesShowWhereTheErrorIs) {
  image::Image r = waves(40, 40, 0.f), t = r;
  for (uint32_t y = 10; y < 14; ++y) {
    for (uint32_t x = 30; x < 34; ++x) t.at(x, y, 1) = 0.f;
  }
  exr("r.exr", {{"color", r}});
  exr("t.exr", {{"color", t}});
  compare({path("r.exr"), path("t.exr"), "--out", path("e.exr")});
  for (const image::Layer& layer : image::readExr(path("e.exr"))) {
    EXPECT_EQ(layer.image.width, 40u);
    if (layer.name == "difference") {
      EXPECT_EQ(layer.image.at(31, 11, 1), -r.at(31, 11, 1));
      EXPECT_EQ(layer.image.at(5, 5, 1), 0.f);
    } else if (layer.name == "flip" || layer.name == "hdr_flip") {
      ASSERT_EQ(layer.image.channels, 1u);
      EXPECT_GT(layer.image.at(31, 11, 0), 0.2f) << layer.name;
      EXPECT_LT(layer.image.at(5, 30, 0), 1e-3f) << layer.name;
    } else {
      EXPECT_EQ(layer.name, "color");
    }
  }
  compare({path("r.exr"), path("t.exr"), "--out", path("e.png")});
  const image::Image heat = image::readPng(path("e.png"));
  EXPECT_GT(heat.at(31, 11, 0), 0.1f);
  EXPECT_LT(heat.at(5, 30, 0), 0.01f);
}

TEST_F(CompareCommand, ScreenPicturesAreComparedAsTheyAre) {
  const image::Image dark{8, 8, 3, std::vector<float>(192, 0.2f)}, bright{8, 8, 3, std::vector<float>(192, 0.25f)};
  image::writePng(path("a.png"), dark);
  image::writePng(path("b.png"), bright);
  const json result = compare({path("a.png"), path("b.png")});
  EXPECT_EQ(result.at("exposure"), 1.0);
  EXPECT_EQ(result.count("hdr_flip"), 0u) << "a screen has no exposures left";
  EXPECT_NEAR(result.at("flip").at("mean").get<double>(), image::flip(image::readPng(path("a.png")), image::readPng(path("b.png"))).mean,
              1e-12);
  exr("a.exr", {{"color", dark}});
  expectError({"compare", path("a.exr"), path("b.png")}, 2, {"a.exr", "b.png", "one kind"});
}

TEST_F(CompareCommand, WhatCannotBeComparedIsNamed) {
  exr("r.exr", {{"color", waves(8, 6, 0.f)}});
  exr("large.exr", {{"color", waves(9, 6, 0.f)}});
  image::Image bad = waves(8, 6, 0.f);
  bad.at(7, 3, 1) = std::nanf("");
  exr("bad.exr", {{"color", bad}});
  expectError({"compare", path("r.exr"), path("large.exr")}, 2, {"r.exr", "8x6", "large.exr", "9x6"});
  expectError({"compare", path("r.exr"), path("bad.exr")}, 2, {"bad.exr", "(7, 3), channel 1", "not a number"});
  expectError({"compare", path("bad.exr"), path("r.exr")}, 2, {"bad.exr", "(7, 3)"});
  expectError({"compare", path("r.exr") + "," + path("bad.exr"), path("r.exr")}, 2, {"bad.exr", "(7, 3)"});
  expectError({"compare", path("r.exr") + "," + path("large.exr"), path("r.exr")}, 2, {"large.exr", "9x6"});
  bad.at(7, 3, 1) = std::numeric_limits<float>::infinity();
  exr("bad.exr", {{"color", bad}});
  expectError({"compare", path("r.exr"), path("bad.exr")}, 2, {"bad.exr", "(7, 3)", "infinite"});
  expectError({"compare", path("none.exr"), path("r.exr")}, 2, {"none.exr", "no such file"});
  expectError({"compare", path("r.exr"), path("r.jpg")}, 2, {"r.jpg", ".exr"});
  expectError({"compare", path("r.exr")}, 2, {"TEST"});
  expectError({"compare"}, 2, {"REF"});
  expectError({"compare", "a.exr,b.exr,c.exr", path("r.exr")}, 2, {"a.exr,b.exr,c.exr", "two"});
  expectError({"compare", path("r.exr"), path("r.exr"), "--weights", "1,2"}, 2, {"--weights", "A.exr,B.exr"});
  for (const char* weights : {"1", "0,1", "1,x", "1,2,3", "-1,2", "inf,1"}) {
    expectError({"compare", path("r.exr") + "," + path("r.exr"), path("r.exr"), "--weights", weights}, 2, {"--weights", "256,512"});
  }
  expectError({"compare", path("r.exr"), path("r.exr"), "--out", path("e.jpg")}, 2, {"e.jpg", ".png"});
  expectError({"compare", path("r.exr"), path("r.exr"), "--json", path("no/e.json")}, 2, {"does not exist"});
  expectError({"compare", path("r.exr"), path("r.exr"), "--jsn", path("e.json")}, 2, {"'--jsn'", "'--json'"});
}

}  // namespace

}  // namespace radivox::test
