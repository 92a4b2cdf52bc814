#include "engine/params/params.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/text.h"

namespace radivox::params {
namespace {

enum class Method { Auto, Hardware, Compute };

struct Settings {
  uint32_t resolution = 128;
  float angle = 35.f;
  bool sky = true;
  Method method = Method::Compute;
  uint32_t exposure = 0;
  Table table{{number("resolution", &resolution, {8, 1024}, "voxels along the longest side", Invalidates::Plan),
               number("angle", &angle, {0, 90.5}, "degrees", Invalidates::Rerun),
               flag("sky", &sky, "light from the sky", Invalidates::Rerun),
               choice("method", &method, {"auto", "hardware", "compute"}, "how", Invalidates::Plan),
               number("exposure", &exposure, {0, 5000000000.0}, "view only", Invalidates::Frame)}};

  /// The error that a value draws.
  std::string error(const char* name, const char* text) {
    try {
      table.set("voxelize", name, text);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::BadInput);
      return e.what();
    }
    return "";
  }
};

TEST(Params, SetsEachType) {
  Settings s;
  EXPECT_EQ(s.table.set("n", "resolution", "64"), Invalidates::Plan);
  EXPECT_EQ(s.resolution, 64u);
  EXPECT_EQ(s.table.set("n", "angle", "1.25e1"), Invalidates::Rerun);
  EXPECT_EQ(s.angle, 12.5f);
  s.table.set("n", "method", "hardware");
  EXPECT_EQ(s.method, Method::Hardware);
  for (const char* off : {"false", "off", "0"}) {
    s.sky = true;
    s.table.set("n", "sky", off);
    EXPECT_FALSE(s.sky) << off;
  }
  for (const char* on : {"true", "on", "1"}) {
    s.sky = false;
    s.table.set("n", "sky", on);
    EXPECT_TRUE(s.sky) << on;
  }
}

TEST(Params, LimitsAreInclusive) {
  Settings s;
  s.table.set("n", "resolution", "8");
  EXPECT_EQ(s.resolution, 8u);
  s.table.set("n", "resolution", "1024");
  EXPECT_EQ(s.resolution, 1024u);
  EXPECT_EQ(s.error("resolution", "7"), "voxelize.resolution = 7: out of range; give a whole number from 8 to 1024");
  EXPECT_EQ(s.error("resolution", "1025"), "voxelize.resolution = 1025: out of range; give a whole number from 8 to 1024");
  EXPECT_EQ(s.resolution, 1024u) << "a refused value changes nothing";
}

TEST(Params, RangesNeverExceedTheType) {
  Settings s;
  s.table.set("n", "exposure", "4294967295");
  EXPECT_EQ(s.exposure, 4294967295u);
  EXPECT_EQ(s.error("exposure", "4294967296"), "voxelize.exposure = 4294967296: out of range; give a whole number from 0 to 4294967295");
}

TEST(Params, RefusesWhatIsNoValue) {
  Settings s;
  EXPECT_EQ(s.error("resolution", "abc"), "voxelize.resolution = abc: not a number; give a whole number from 8 to 1024");
  EXPECT_EQ(s.error("resolution", ""), "voxelize.resolution = : not a number; give a whole number from 8 to 1024");
  EXPECT_EQ(s.error("resolution", "64x"), "voxelize.resolution = 64x: not a number; give a whole number from 8 to 1024");
  EXPECT_EQ(s.error("resolution", "64.5"), "voxelize.resolution = 64.5: not a whole number; give a whole number from 8 to 1024");
  EXPECT_EQ(s.error("angle", "nan"), "voxelize.angle = nan: not a number; give a number from 0 to 90.5");
  EXPECT_EQ(s.error("angle", "inf"), "voxelize.angle = inf: not finite; give a number from 0 to 90.5");
  EXPECT_EQ(s.error("angle", "-1"), "voxelize.angle = -1: out of range; give a number from 0 to 90.5");
  EXPECT_EQ(s.error("sky", "yes"), "voxelize.sky = yes: not true or false; give true or false");
  EXPECT_EQ(s.error("method", "hardwear"),
            "voxelize.method = hardwear: no such choice (did you mean hardware?); give one of auto, hardware, compute");
  EXPECT_EQ(s.error("method", "1"), "voxelize.method = 1: no such choice; give one of auto, hardware, compute");
}

TEST(Params, UnknownNamesGetTheNearest) {
  Settings s;
  EXPECT_EQ(s.error("resolutoin", "64"), "voxelize.resolutoin: no such parameter; did you mean resolution?");
  EXPECT_EQ(s.error("qqqqqq", "64"), "voxelize.qqqqqq: no such parameter; voxelize has resolution, angle, sky, method, exposure");
  Table none;
  EXPECT_THROW(none.set("index", "x", "1"), Error);
}

TEST(Params, VersionsCountOnlyRealChanges) {
  Settings s;
  EXPECT_EQ(s.table.version(), 0u);
  s.table.set("n", "resolution", "128");  // the same value
  EXPECT_EQ(s.table.version(), 0u);
  s.table.set("n", "angle", "10");
  EXPECT_EQ(s.table.version(), 1u);
  EXPECT_EQ(s.table.planVersion(), 0u);
  s.table.set("n", "resolution", "64");
  EXPECT_EQ(s.table.version(), 2u);
  EXPECT_EQ(s.table.planVersion(), 1u);
  s.table.set("n", "exposure", "3");  // view only: nothing runs again for it
  EXPECT_EQ(s.table.version(), 2u);
  s.error("angle", "abc");
  EXPECT_EQ(s.table.version(), 2u);
}

TEST(Params, PrintsReadBackExactly) {
  Settings s;
  s.table.set("n", "angle", "0.1");
  EXPECT_EQ(s.table.print(), "resolution=128 angle=0.1 sky=true method=compute exposure=0");
  EXPECT_EQ(s.table.all()[1].defaultValue, "35");
  // Any float prints as a text that gives the same float.
  for (const float value : {1.f / 3.f, 16777216.f, 1e-30f, 89.99999f}) {
    float target = 0.f, source = value;
    Table from{{number("x", &source, {0, 1e30}, "", Invalidates::Rerun)}}, to{{number("x", &target, {0, 1e30}, "", Invalidates::Rerun)}};
    to.set("n", "x", from.all()[0].get());
    EXPECT_EQ(target, value);
  }
}

TEST(Params, NearestNameNeedsHalfTheLetters) {
  const std::vector<std::string> names{"voxelize", "visibility", "gather"};
  EXPECT_EQ(nearestName("voxelise", names), "voxelize");
  EXPECT_EQ(nearestName("gatehr", names), "gather");
  EXPECT_EQ(nearestName("xyz", names), "");
  EXPECT_EQ(nearestName("", names), "");
  EXPECT_EQ(nearestName("a", {}), "");
}

TEST(Text, NumbersAsPeopleReadThem) {
  EXPECT_EQ(printNumber(0.5), "0.5");
  EXPECT_EQ(printNumber(1e-6), "1e-06");
  EXPECT_EQ(printNumber(1000000), "1e+06");
  EXPECT_EQ(printNumber(0.1234567), "0.123457");
  EXPECT_EQ(printNumber(0.1234567, 3), "0.123");
  EXPECT_LT(printNumber(-1.2345678901234567e-300, 17).size(), 40u);
}

}  // namespace
}  // namespace radivox::params
