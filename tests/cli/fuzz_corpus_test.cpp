// What fuzzing graphs and presets found, and the seeds it began with (tests/fuzz): each gives a plan, or is refused in one line.
#include <fstream>
#include <iterator>

#include "tests/cli/command.h"

namespace radivox::test {

namespace {

class FuzzCorpus : public CommandTest {};

TEST_F(FuzzCorpus, GraphsGiveAPlanOrAreRefused) {
  size_t count = 0, planned = 0;
  for (const auto& entry : std::filesystem::directory_iterator(std::string(RADIVOX_SOURCE_DIR) + "/tests/fuzz/graph")) {
    std::ifstream file(entry.path(), std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
    const std::string line = "\n===\n";
    const size_t split = text.find(line);
    write("graph.json", text.substr(0, split));
    std::vector<std::string> words = {"graph", "builtin:cornell", "--size", "64x48", "--graph", path("graph.json")};
    if (split != std::string::npos) {
      write("preset.json", text.substr(split + line.size()));
      words.insert(words.end(), {"--preset", path("preset.json")});
    }
    const CommandResult result = runRadivox(words);
    ++count;
    if (result.exitCode == 0) {
      ++planned;
      EXPECT_NE(result.out.find("plan: "), std::string::npos) << entry.path();
    } else {
      EXPECT_TRUE(result.exitCode == 2 || result.exitCode == 4) << entry.path() << ": " << result.exitCode << " " << result.err;
      EXPECT_EQ(result.err.rfind("radivox: ", 0), 0u) << entry.path();
      EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << entry.path() << ": " << result.err;
    }
  }
  EXPECT_GE(count, 7u);
#ifdef RADIVOX_WITH_REFERENCE
  EXPECT_GE(planned, 3u);
#else
  EXPECT_GE(planned, 2u);  // one is the path tracer's
#endif
}

}  // namespace

}  // namespace radivox::test
