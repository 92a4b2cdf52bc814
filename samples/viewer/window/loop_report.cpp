#include "samples/viewer/window/loop_report.h"

#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>

namespace radivox::viewer {

namespace {

/// How long the process has lived, by the kernel's count; 0 where that cannot be read.
double processAgeMs() {
  std::ifstream file("/proc/self/stat");
  const std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  const size_t name = text.rfind(')');
  if (name == std::string::npos) return 0;
  std::istringstream fields(text.substr(name + 1));
  std::string field;
  constexpr int kStartField = 20;  // the 22nd of all, the first after the name is the third
  for (int i = 0; i < kStartField; ++i) fields >> field;
  timespec now{};
  ::clock_gettime(CLOCK_BOOTTIME, &now);
  const double ticks = std::strtod(field.c_str(), nullptr) / static_cast<double>(::sysconf(_SC_CLK_TCK));
  return std::max((static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec) - ticks) * 1e3, 0.0);
}

}  // namespace

LoopReport::LoopReport() : startMs_(processAgeMs()), made_(Clock::now()) {}

double LoopReport::sinceStart() const { return startMs_ + std::chrono::duration<double, std::milli>(Clock::now() - made_).count(); }

void LoopReport::enter() {
  entered_ = Clock::now();
  inside_ = true;
  ++turns_;
}

void LoopReport::leave() {
  if (inside_) longestGapMs_ = std::max(longestGapMs_, std::chrono::duration<double, std::milli>(Clock::now() - entered_).count());
  inside_ = false;
}

void LoopReport::drew(const App& app) {
  ++frames_;
  if (firstFrameMs_ == 0) firstFrameMs_ = sinceStart();
  if (firstPictureMs_ == 0 && app.picture) firstPictureMs_ = sinceStart();
  if (firstFullMs_ == 0 && app.picture && !app.picture->preview) firstFullMs_ = sinceStart();
}

void LoopReport::write(const std::string& path, App& app, Presenter& presenter) const {
  const Worker::Status status = app.worker().status();
  const nlohmann::ordered_json json = {{"longest_gap_ms", longestGapMs_},
                                       {"turns", turns_},
                                       {"frames", frames_},
                                       {"presented", presenter.presentedCount()},
                                       {"recoveries", presenter.recoveryCount()},
                                       {"first_frame_ms", firstFrameMs_},
                                       {"first_picture_ms", firstPictureMs_},
                                       {"first_full_picture_ms", firstFullMs_},
                                       {"previews", status.previewCount},
                                       {"pictures", status.pictureCount},
                                       {"messages", app.messages}};
  image::writeFileAtomically(path, json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
}

}  // namespace radivox::viewer
