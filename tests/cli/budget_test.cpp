// radivox render --max-error, --budget-ms: what it promises is held against what radivox compare says of the picture.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/cli/command.h"

namespace radivox::test {

namespace {

class BudgetCommand : public CommandTest {
 protected:
  /// Calibrations are kept beside the pipelines.
  CommandResult command(const std::vector<std::string>& arguments) const {
    return runRadivox(arguments, {.environment = {{"RADIVOX_PIPELINE_CACHE", path("cache/pipelines")}}});
  }
  CommandResult render(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments = {"render",
                                          "builtin:cornell_point",
                                          "--size",
                                          "48x48",
                                          "--bounces",
                                          "2",
                                          "--set",
                                          "visibility.rays=32",
                                          "--calibration-time",
                                          "12",
                                          "--out",
                                          path("picture.exr"),
                                          "--stats",
                                          path("stats.json")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return command(arguments);
  }
};

}  // namespace

TEST_F(BudgetCommand, SlowTheChosenPictureKeepsTheErrorAndIsChosenAgainAtOnce) {
#ifndef RADIVOX_WITH_REFERENCE
  GTEST_SKIP() << "built without the path tracer";
#endif
  const CommandResult first = render({"--max-error", "0.3"});
  ASSERT_EQ(first.exitCode, 0) << first.err;
  EXPECT_EQ(first.out.rfind("settings: default", 0), 0u) << "the graph that --set is meant for: " << first.out;
  // The picture itself, against a reference of its own.
  ASSERT_EQ(command({"reference", "builtin:cornell_point", "--size", "48x48", "--bounces", "2", "--spp", "256", "--halves", "--out",
                     path("truth.exr")})
                .exitCode,
            0);
  ASSERT_EQ(
      command({"compare", path("truth_a.exr") + "," + path("truth_b.exr"), path("picture.exr"), "--json", path("compare.json")}).exitCode,
      0);
  const auto figures = nlohmann::json::parse(read(path("compare.json")));
  EXPECT_LE(figures.at("rmse").get<double>() / figures.at("mean_reference").get<double>(), 0.3 * 1.1) << figures.dump(1);
  const CommandResult second = render({"--max-error", "0.3"});
  ASSERT_EQ(second.exitCode, 0) << second.err;
  EXPECT_NE(second.out.find("(from before: "), std::string::npos) << second.out;
  EXPECT_EQ(second.out.substr(0, second.out.find(':', 12)), first.out.substr(0, first.out.find(':', 12)));
}

TEST_F(BudgetCommand, SlowATimeIsKeptAndWhatNothingKeepsIsRefused) {
#ifndef RADIVOX_WITH_REFERENCE
  GTEST_SKIP() << "built without the path tracer";
#endif
  const CommandResult result = render({"--budget-ms", "100000"});
  ASSERT_EQ(result.exitCode, 0) << result.err;
  EXPECT_NE(result.out.find(" ms ("), std::string::npos) << result.out;
  const CommandResult refused = render({"--budget-ms", "0.001"});
  EXPECT_EQ(refused.exitCode, 3);
  EXPECT_NE(refused.err.find("--budget-ms 0.001: no setting keeps it here; nearest was "), std::string::npos) << refused.err;
  EXPECT_EQ(std::count(refused.err.begin(), refused.err.end(), '\n'), 1) << refused.err;
}

TEST_F(BudgetCommand, NoNumberIsRefusedBeforeAnyWork) {
  const CommandResult result = render({"--max-error", "much"});
  EXPECT_EQ(result.exitCode, 2);
  EXPECT_NE(result.err.find("--max-error 'much'"), std::string::npos) << result.err;
}

}  // namespace radivox::test
