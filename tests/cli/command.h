// Runs the built radivox binary as a person would: arguments, environment, exit code, stdout, stderr.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace radivox::test {

struct CommandResult {
  int exitCode = -1;  ///< −signal where a signal ended it
  std::string out, err;
};

struct CommandSetup {
  std::map<std::string, std::string> environment;  ///< added to ours
  std::filesystem::path folder;                    ///< to run in; empty: ours
  int signalAfterMs = 0;                           ///< when to send `signal`; 0: never
  int signal = 0;
  uint64_t largestFile = 0;    ///< bytes: writing more fails, as on a full disk; 0: no limit
  int timeLimitSeconds = 120;  ///< the process is ended then
};

CommandResult runRadivox(const std::vector<std::string>& arguments, const CommandSetup& setup = {});

/// A folder of its own for each test.
class CommandTest : public testing::Test {
 protected:
  void SetUp() override;
  void TearDown() override;
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  void write(const std::string& name, const std::string& text) const;
  std::string read(const std::string& name) const;
  std::vector<std::string> files() const;  ///< names in the folder, hidden ones too

  /// The command fails with `code` and exactly one line on stderr, which starts with "radivox: " and holds every one of `words`; nothing
  /// new is left in the folder.
  void expectError(const std::vector<std::string>& arguments, int code, const std::vector<std::string>& words,
                   const CommandSetup& setup = {}) const;

  std::filesystem::path folder_;
};

}  // namespace radivox::test
