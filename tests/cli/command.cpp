#include "tests/cli/command.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <iterator>

namespace radivox::test {

namespace fs = std::filesystem;

namespace {

struct Pipe {
  int read = -1, write = -1;
  Pipe() {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) == 0) {
      read = ends[0];
      write = ends[1];
    }
  }
};

/// Reads what is there; false at the end.
bool drain(int descriptor, std::string& to) {
  char buffer[4096];
  const ssize_t n = ::read(descriptor, buffer, sizeof buffer);
  if (n > 0) to.append(buffer, static_cast<size_t>(n));
  return n > 0;
}

}  // namespace

CommandResult runRadivox(const std::vector<std::string>& arguments, const CommandSetup& setup) {
  const std::string binary = RADIVOX_BINARY_DIR "/bin/radivox";
  std::vector<std::string> words = {binary};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  Pipe out, err;
  const pid_t child = ::fork();
  if (child == 0) {
    ::dup2(out.write, STDOUT_FILENO);
    ::dup2(err.write, STDERR_FILENO);
    for (const auto& [name, value] : setup.environment) ::setenv(name.c_str(), value.c_str(), 1);
    if (!setup.folder.empty() && ::chdir(setup.folder.c_str()) != 0) ::_exit(125);
    if (setup.largestFile > 0) {
      const rlimit limit{setup.largestFile, setup.largestFile};
      if (::setrlimit(RLIMIT_FSIZE, &limit) != 0) ::_exit(124);
    }
    ::execv(binary.c_str(), argv.data());
    ::_exit(126);
  }
  ::close(out.write);
  ::close(err.write);
  CommandResult result;
  if (child < 0) return result;
  const auto start = std::chrono::steady_clock::now();
  bool outOpen = true, errOpen = true, signalled = false;
  while (outOpen || errOpen) {
    pollfd ends[] = {{outOpen ? out.read : -1, POLLIN, 0}, {errOpen ? err.read : -1, POLLIN, 0}};
    ::poll(ends, 2, 10);
    if (ends[0].revents != 0) outOpen = drain(out.read, result.out);
    if (ends[1].revents != 0) errOpen = drain(err.read, result.err);
    const auto elapsed = std::chrono::steady_clock::now() - start;
    const bool due = setup.signalAfterMs > 0 && elapsed > std::chrono::milliseconds(setup.signalAfterMs);
    if (setup.signal != 0 && !signalled && due) {
      signalled = true;
      ::kill(child, setup.signal);
    }
    if (elapsed > std::chrono::seconds(setup.timeLimitSeconds)) ::kill(child, SIGKILL);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  ::close(out.read);
  ::close(err.read);
  result.exitCode = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  return result;
}

void CommandTest::SetUp() {
  std::string pattern = (fs::temp_directory_path() / "radivox_cli_XXXXXX").string();
  ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
  folder_ = pattern;
}

void CommandTest::TearDown() {
  if (!folder_.empty()) fs::remove_all(folder_);
}

void CommandTest::write(const std::string& name, const std::string& text) const { std::ofstream(path(name), std::ios::binary) << text; }

std::string CommandTest::read(const std::string& name) const {
  std::ifstream file(path(name), std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

std::vector<std::string> CommandTest::files() const {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder_)) names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  return names;
}

void CommandTest::expectError(const std::vector<std::string>& arguments, int code, const std::vector<std::string>& words,
                              const CommandSetup& setup) const {
  std::string line;
  for (const std::string& argument : arguments) line += " " + argument;
  SCOPED_TRACE("radivox" + line);
  const std::vector<std::string> before = files();
  const CommandResult result = runRadivox(arguments, setup);
  EXPECT_EQ(result.exitCode, code) << result.err;
  EXPECT_EQ(result.err.rfind("radivox: ", 0), 0u) << result.err;
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  for (const std::string& word : words) EXPECT_NE(result.err.find(word), std::string::npos) << "no '" << word << "' in: " << result.err;
  EXPECT_EQ(files(), before);
}

}  // namespace radivox::test
