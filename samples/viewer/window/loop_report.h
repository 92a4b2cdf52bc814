// How responsive the window was: times since the process began, and the longest that the event loop stayed away from its events.
#pragma once

#include <chrono>
#include <string>

#include "samples/viewer/app.h"
#include "samples/viewer/window/presenter.h"

namespace radivox::viewer {

class LoopReport {
 public:
  LoopReport();
  void enter();  ///< events have been taken
  void leave();  ///< and the next are waited for
  void drew(const App& app);
  void write(const std::string& path, App& app, Presenter& presenter) const;
  double longestGapMs() const { return longestGapMs_; }

 private:
  using Clock = std::chrono::steady_clock;
  double sinceStart() const;
  double startMs_ = 0;  ///< from the process's beginning to this object's
  Clock::time_point made_, entered_;
  bool inside_ = false;
  double longestGapMs_ = 0, firstFrameMs_ = 0, firstPictureMs_ = 0, firstFullMs_ = 0;
  uint64_t turns_ = 0, frames_ = 0;
};

}  // namespace radivox::viewer
