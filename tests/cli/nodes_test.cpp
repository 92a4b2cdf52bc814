// radivox nodes, and docs/nodes.md, which it writes.
#include <fstream>
#include <iterator>
#include <sstream>

#include "tests/cli/command.h"

namespace radivox::test {

namespace {

class Nodes : public CommandTest {};

TEST_F(Nodes, TheDocumentIsWhatTheCommandPrints) {
  std::ifstream file(RADIVOX_SOURCE_DIR "/docs/nodes.md", std::ios::binary);
  const std::string document((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  const CommandResult list = runRadivox({"nodes"});
  ASSERT_EQ(list.exitCode, 0) << list.err;
  std::istringstream lines(document);
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("## ", 0) != 0 || line == "## lights") continue;
    const std::string module = line.substr(3);
    if (("\n" + list.out).find("\n" + module + ".") == std::string::npos) GTEST_SKIP() << "this build has no module " << module;
  }
  const CommandResult printed = runRadivox({"nodes", "--format", "markdown"});
  ASSERT_EQ(printed.exitCode, 0) << printed.err;
  EXPECT_TRUE(printed.out == document) << "docs/nodes.md is not what its nodes say now: radivox nodes --format markdown > docs/nodes.md";
  EXPECT_NE(document.find("### frame.gbuffer"), std::string::npos);
  EXPECT_NE(document.find("| `resolution` | 128 | 8 to "), std::string::npos) << "parameters";
}

TEST_F(Nodes, OfOtherLibrariesAreThereToo) {
  const CommandResult result = runRadivox({"nodes", "--module", RADIVOX_BINARY_DIR "/tests/first_node/build/contours.so"});
  ASSERT_EQ(result.exitCode, 0) << result.err;
  EXPECT_NE(result.out.find("example.contours (" RADIVOX_BINARY_DIR), std::string::npos) << result.out;
  expectError({"nodes", "--format", "html"}, 2, {"html", "markdown"});
}

}  // namespace

}  // namespace radivox::test
