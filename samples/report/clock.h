// How long the report may work, and whether it was told to stop.
#pragma once

#include <chrono>
#include <functional>
#include <string_view>

#include "samples/cli/interrupt.h"

namespace radivox::report {

class Clock {
 public:
  /// 0: no limit.
  explicit Clock(double limitSeconds) : limit_(limitSeconds) {}
  double elapsed() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }
  bool hasLimit() const { return limit_ > 0; }
  double limit() const { return limit_; }
  double left() const { return limit_ - elapsed(); }  ///< only with a limit
  bool isOver() const { return hasLimit() && left() <= 0; }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  double limit_;
};

using Progress = std::function<void(std::string_view what, double fraction)>;

}  // namespace radivox::report
