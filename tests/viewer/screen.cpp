#include "tests/viewer/screen.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <thread>

namespace radivox::test {

namespace {

bool isInstalled(const std::string& program) { return std::system(("command -v " + program + " >/dev/null 2>&1").c_str()) == 0; }

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

}  // namespace

Screen::Screen(const std::filesystem::path& folder) : folder_(folder) {
  for (const char* program : {"Xvfb", "xdotool"}) {
    if (!isInstalled(program)) fault_ = std::string(program) + " is not installed";
  }
  if (!fault_.empty()) return;
  std::filesystem::create_directories(folder_);
  int ends[2];
  if (::pipe(ends) != 0) return;
  const std::string descriptor = std::to_string(ends[1]), place = folder_.string();
  process_ = ::fork();
  if (process_ == 0) {
    ::close(ends[0]);
    const int nothing = ::open("/dev/null", O_WRONLY);
    ::dup2(nothing, STDERR_FILENO);
    ::execlp("Xvfb", "Xvfb", "-displayfd", descriptor.c_str(), "-screen", "0", "1024x768x24", "-fbdir", place.c_str(), "-nolisten", "tcp",
             "-noreset", static_cast<char*>(nullptr));
    ::_exit(126);
  }
  ::close(ends[1]);
  // The whole line: the server ends when its last byte finds nobody.
  std::string line;
  pollfd ready{ends[0], POLLIN, 0};
  char letter = 0;
  while (line.find('\n') == std::string::npos && ::poll(&ready, 1, 20000) == 1 && ::read(ends[0], &letter, 1) == 1) line += letter;
  if (line.find('\n') != std::string::npos) {
    display_ = ":" + std::to_string(std::atoi(line.c_str()));
  } else {
    fault_ = "Xvfb did not start";
  }
  ::close(ends[0]);
}

Screen::~Screen() {
  if (process_ <= 0) return;
  ::kill(process_, SIGTERM);
  ::waitpid(process_, nullptr, 0);
}

viewer::Pixels Screen::shot() const {
  std::ifstream file(folder_ / "Xvfb_screen0", std::ios::binary);
  const std::vector<unsigned char> bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  // An XWD file: big-endian words, then a colour map, then rows of B, G, R, x.
  const auto word = [&](size_t i) {
    return static_cast<uint32_t>(bytes[4 * i]) << 24 | static_cast<uint32_t>(bytes[4 * i + 1]) << 16 |
           static_cast<uint32_t>(bytes[4 * i + 2]) << 8 | bytes[4 * i + 3];
  };
  viewer::Pixels pixels;
  if (bytes.size() < 100) return pixels;
  const size_t first = word(0) + size_t{word(19)} * 12, rowBytes = word(12);
  pixels.width = word(4);
  pixels.height = word(5);
  if (bytes.size() < first + rowBytes * pixels.height) return {};
  for (uint32_t y = 0; y < pixels.height; ++y) {
    for (uint32_t x = 0; x < pixels.width; ++x) {
      const unsigned char* texel = &bytes[first + y * rowBytes + size_t{x} * 4];
      pixels.rgba.insert(pixels.rgba.end(), {texel[2], texel[1], texel[0], 255});
    }
  }
  return pixels;
}

bool Screen::act(const std::string& words) const {
  return std::system(("DISPLAY=" + display_ + " timeout 20 xdotool " + words + " >/dev/null 2>&1").c_str()) == 0;
}

bool Screen::wait(double seconds, const std::function<bool(const viewer::Pixels&)>& holds) const {
  const double end = now() + seconds;
  while (now() < end) {
    const viewer::Pixels pixels = shot();
    if (pixels.width > 0 && holds(pixels)) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return false;
}

std::string Screen::title() const {
  FILE* pipe = ::popen(("DISPLAY=" + display_ + " timeout 20 xdotool search --name radivox getwindowname 2>/dev/null").c_str(), "r");
  if (pipe == nullptr) return "";
  std::array<char, 256> line{};
  const bool has = std::fgets(line.data(), line.size(), pipe) != nullptr;
  ::pclose(pipe);
  std::string title = has ? line.data() : "";
  if (!title.empty() && title.back() == '\n') title.pop_back();
  return title;
}

viewer::Pixels Screen::settle(uint32_t width, uint32_t height, const std::function<bool(const viewer::Pixels&)>& holds,
                              double seconds) const {
  constexpr double kStillSeconds = 1.0;
  const double end = now() + seconds;
  viewer::Pixels last = shot();
  double since = now();
  while (now() < end && now() - since < kStillSeconds) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    const std::string name = title();
    viewer::Pixels next = shot();
    const bool isWorking = name.empty() || name.find(", ") != std::string::npos;
    // The status line at the top counts on.
    if (isWorking || next.width == 0 || last.width == 0 || (holds && !holds(next)) ||
        shareThatDiffers(last, next, 0, 24, width, height - 24) > 0) {
      since = now();
    }
    last = std::move(next);
  }
  return last;
}

glm::vec3 meanOf(const viewer::Pixels& pixels, uint32_t left, uint32_t top, uint32_t width, uint32_t height) {
  glm::dvec3 sum(0.0);
  for (uint32_t y = top; y < top + height; ++y) {
    for (uint32_t x = left; x < left + width; ++x) {
      const uint8_t* p = &pixels.rgba[(size_t{y} * pixels.width + x) * 4];
      sum += glm::dvec3(p[0], p[1], p[2]);
    }
  }
  return glm::vec3(sum / (static_cast<double>(width) * height));
}

double shareThatDiffers(const viewer::Pixels& a, const viewer::Pixels& b, uint32_t left, uint32_t top, uint32_t width, uint32_t height) {
  uint32_t count = 0;
  for (uint32_t y = top; y < top + height; ++y) {
    for (uint32_t x = left; x < left + width; ++x) {
      const size_t at = (size_t{y} * a.width + x) * 4;
      bool differs = false;
      for (size_t c = 0; c < 3; ++c) differs = differs || std::abs(int{a.rgba[at + c]} - int{b.rgba[at + c]}) > 2;
      count += differs ? 1 : 0;
    }
  }
  return count / (static_cast<double>(width) * height);
}

}  // namespace radivox::test
