// radivox moves through the binary.
#include "tests/cli/command.h"

namespace radivox::test {

namespace {

class MovesCommand : public CommandTest {};

TEST_F(MovesCommand, SlowPicturesAfterAMoveAreThoseFromScratch) {
  const CommandResult result =
      runRadivox({"moves", "builtin:cornell_point", "--size", "32x24", "--shares", "0,40", "--set", "voxelize.resolution=24"});
  ASSERT_EQ(result.exitCode, 0) << result.err;
  EXPECT_EQ(result.err, "");
  EXPECT_EQ(result.out.find("| no |"), std::string::npos) << result.out;
  // Light and camera change no ray of a face, light none of a pixel; where nothing moves, no face's ray is traced; then something does, and they are.
  EXPECT_NE(result.out.find("\n| lights | 0.0 % | 0.0 % | 0.0 % |"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("\n| camera | 0.0 % | 0.0 % | 100.0 % |"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("\n| 0.0 % | 0.0 % | 0.0 % |"), std::string::npos) << result.out;
  size_t rows = 0;
  for (size_t at = result.out.find("| yes |"); at != std::string::npos; at = result.out.find("| yes |", at + 1)) ++rows;
  EXPECT_EQ(rows, 4u) << result.out;
  const size_t end = result.out.rfind("| yes |"), start = result.out.rfind('\n', end);
  EXPECT_EQ(result.out.substr(start, end - start).find("| 0.0 % |"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("\n| visibility | "), std::string::npos) << result.out;
}

TEST_F(MovesCommand, WhatItCannotDoIsOneLine) {
  expectError({"moves"}, 2, {"SCENE is missing"});
  expectError({"moves", "builtin:cornell", "--shares", "half"}, 2, {"--shares", "half"});
  expectError({"moves", "builtin:cornell", "--shares", "1,,2"}, 2, {"--shares"});
  expectError({"moves", "builtin:cornell", "--shares", "101"}, 2, {"--shares", "100"});
  expectError({"moves", "builtin:cornell", "--graph", "direct"}, 2, {"direct", "clustered_voxel.visibility"});
}

}  // namespace

}  // namespace radivox::test
