#include "samples/report/gnuplot.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>

#include "engine/error.h"
#include "engine/image/image.h"

namespace radivox::report {

namespace {

/// The exit code; −1 where it could not be started. Its messages go to `log`.
int startGnuplot(const std::string& folder, const char* argument, const char* log) {
  const pid_t child = ::fork();
  if (child == 0) {
    if (!folder.empty() && ::chdir(folder.c_str()) != 0) ::_exit(125);
    const int file = ::open(log, O_WRONLY | O_CREAT | O_TRUNC, 0666);
    if (file >= 0) {
      ::dup2(file, STDOUT_FILENO);
      ::dup2(file, STDERR_FILENO);
    }
    ::execlp("gnuplot", "gnuplot", argument, static_cast<char*>(nullptr));
    ::_exit(127);
  }
  if (child < 0) return -1;
  int status = 0;
  while (::waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) return -1;
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

std::string slurp(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

void replaceAll(std::string& text, const std::string& from, const std::string& to) {
  for (size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) text.replace(at, from.size(), to);
}

}  // namespace

void checkGnuplot() {
  if (startGnuplot("", "--version", "/dev/null") == 0) return;
  throw Error(ErrorCode::Unsupported, "gnuplot, which draws the plots, is not installed; install the package gnuplot-nox");
}

std::string runGnuplot(const std::string& folder, const std::string& name, int width, int height, const std::string& script) {
  std::error_code ignored;
  std::filesystem::remove(folder + "/" + name + ".svg", ignored);
  const std::string size = std::to_string(width) + "," + std::to_string(height);
  image::writeFileAtomically(folder + "/" + name + ".gp", "set terminal svg size " + size +
                                                              " dynamic font 'sans-serif,13' noenhanced rounded background '#ffffff'\n" +
                                                              "set output '" + name + ".svg'\nset encoding utf8\n" + script);
  const int code = startGnuplot(folder, (name + ".gp").c_str(), (name + ".log").c_str());
  std::string svg = slurp(folder + "/" + name + ".svg");
  const size_t begin = svg.find("<svg");
  if (code != 0 || begin == std::string::npos || svg.find("</svg>") == std::string::npos) {
    std::filesystem::remove(folder + "/" + name + ".svg", ignored);  // half of one
    throw Error(ErrorCode::Unsupported,
                "gnuplot could not draw '" + folder + "/" + name + ".gp'; its messages are in " + name + ".log beside it");
  }
  std::filesystem::remove(folder + "/" + name + ".log", ignored);
  svg.erase(0, begin);
  // In one page, marks, patterns and filters of one plot must not be those of another.
  std::set<std::string> ids;
  for (size_t at = svg.find(" id="); at != std::string::npos; at = svg.find(" id=", at + 1)) {
    const size_t first = at + 5, last = svg.find(svg[at + 4], first);
    if (last != std::string::npos) ids.insert(svg.substr(first, last - first));
  }
  for (const std::string& id : ids) {
    const std::string own = name + "_" + id;
    for (const char quote : {'\'', '"'}) {
      replaceAll(svg, std::string(" id=") + quote + id + quote, std::string(" id=") + quote + own + quote);
      replaceAll(svg, std::string("href=") + quote + "#" + id + quote, std::string("href=") + quote + "#" + own + quote);
    }
    replaceAll(svg, "url(#" + id + ")", "url(#" + own + ")");
  }
  return svg;
}

}  // namespace radivox::report
