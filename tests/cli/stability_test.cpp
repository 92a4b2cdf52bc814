// radivox stability: the quick cases of every method hold, and the table and page say so.
#include <map>

#include "tests/cli/command.h"

namespace radivox::test {

namespace {

class Stability : public CommandTest {
 protected:
  /// Case → verdict, from the CSV. Every field that may hold commas is quoted.
  std::map<std::string, std::string> verdicts() const {
    std::map<std::string, std::string> found;
    const std::string text = read("out/stability.csv");
    size_t at = text.find('\n') + 1;
    while (at < text.size()) {
      const size_t end = text.find('\n', at);
      std::vector<std::string> fields(1);
      bool quoted = false;
      for (size_t i = at; i < end; ++i) {
        if (text[i] == '"')
          quoted = !quoted;
        else if (text[i] == ',' && !quoted)
          fields.emplace_back();
        else
          fields.back() += text[i];
      }
      EXPECT_EQ(fields.size(), 15u) << text.substr(at, end - at);
      if (fields.size() == 15) found[fields[2]] = fields[12];
      at = end + 1;
    }
    return found;
  }

  std::map<std::string, std::string> runCases(const std::vector<std::string>& words) {
    std::vector<std::string> arguments = {"stability", "--out", path("out"), "--validate"};
    arguments.insert(arguments.end(), words.begin(), words.end());
    const CommandResult result = runRadivox(arguments, {.timeLimitSeconds = 600});
    EXPECT_EQ(result.exitCode, 0) << result.err << result.out;
    EXPECT_EQ(result.err, "");
    const std::string page = read("out/stability.html");
    const auto all = verdicts();
    for (const auto& [name, verdict] : all) {
      EXPECT_NE(verdict, "fail") << name;
      EXPECT_NE(page.find(verdict), std::string::npos);
    }
    return all;
  }
};

TEST_F(Stability, SlowAStiffFurnaceIsExact) {
  const auto all = runCases({"--method", "clustered_voxel", "--case", "faces: furnace, albedo 0.99"});
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all.at("furnace, albedo 0.99"), "pass");
  EXPECT_EQ(all.at("furnace, albedo 0.999"), "pass");
}

TEST_F(Stability, SlowTooManyLampsAreRefused) {
  const auto all = runCases({"--method", "clustered_voxel", "--case", "1e5 lamps"});
  EXPECT_EQ(all.at("1e5 lamps"), "refused");
  EXPECT_NE(read("out/stability.csv").find("of them fit"), std::string::npos);
}

TEST_F(Stability, SlowQuickCasesOfTheFaceReceiver) {
  const auto all = runCases({"--method", "clustered_voxel", "--fast"});
  EXPECT_GT(all.size(), 12u);
  EXPECT_NE(all.at("energy balance, albedo 0.99"), "fail");  // degraded, as stated
  EXPECT_EQ(all.at("energy balance, albedo 0.99, faces by area"), "pass");
  EXPECT_EQ(all.at("lamps of 1 and 1e9 W/sr in rooms apart"), "pass");
}

TEST_F(Stability, SlowQuickCasesOfThePixelReceiver) { EXPECT_GT(runCases({"--method", "clustered_voxel_pixels", "--fast"}).size(), 10u); }

// A method that is wrong is found out: another bounce setting than the cases ask for.
TEST_F(Stability, AMethodThatIsWrongFails) {
  // Direct light under another name: its "indirect" irradiance is that of the lamps.
  write("wrong.json", R"({"nodes": {"shadow_map": {"type": "frame.shadow_map"}, "gbuffer": {"type": "frame.gbuffer"},
    "direct": {"type": "frame.direct"}, "composite": {"type": "frame.composite"}},
    "edges": [["gbuffer.position", "direct.position"], ["gbuffer.normal", "direct.normal"], ["gbuffer.triangle", "direct.triangle"],
      ["shadow_map.depth", "direct.shadow_depth"], ["shadow_map.triangle", "direct.shadow_triangle"],
      ["gbuffer.albedo", "composite.albedo"], ["gbuffer.emission", "composite.emission"], ["direct.irradiance", "composite.irradiance"]],
    "outputs": ["composite.color"],
    "aovs": {"color": "composite.color", "irradiance_indirect": "composite.irradiance_direct", "depth": "gbuffer.position.w"}})");
  const CommandResult result =
      runRadivox({"stability", "--out", path("out"), "--method", path("wrong.json"), "--case", "stiff: furnace, albedo 0.9"});
  EXPECT_EQ(result.exitCode, 1) << result.err;
  EXPECT_NE(result.err.find("stability cases fail"), std::string::npos) << result.err;
  EXPECT_EQ(verdicts().at("furnace, albedo 0.9"), "fail");
}

TEST_F(Stability, WrongUseIsRefused) {
  expectError({"stability"}, 2, {"--out"});
  expectError({"stability", "--out", "/proc/nothing"}, 2, {"/proc/nothing"});
  expectError({"stability", "--out", path("out"), "--method", "clustered_voxl"}, 2, {"clustered_voxel"});
  expectError({"stability", "--out", path("out"), "--method", "direct"}, 2, {"irradiance_indirect"});
  expectError({"stability", "--out", path("out"), "--case", "no such case"}, 2, {"no such case"});
  expectError({"stability", "--out", path("out"), "--time-limit", "soon"}, 2, {"--time-limit", "soon"});
}

}  // namespace

}  // namespace radivox::test
