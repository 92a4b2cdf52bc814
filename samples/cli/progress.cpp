#include "samples/cli/progress.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <string>

namespace radivox::cli {

namespace {

constexpr int kWidth = 30;
constexpr auto kInterval = std::chrono::milliseconds(50);

}  // namespace

ProgressBar::ProgressBar() : terminal_(::isatty(STDERR_FILENO) == 1) {}

ProgressBar::~ProgressBar() {
  if (shown_) std::fputs("\r\033[K", stderr);
}

void ProgressBar::show(std::string_view what, double fraction) {
  const auto now = std::chrono::steady_clock::now();
  if (!terminal_ || (shown_ && now - last_ < kInterval)) return;
  last_ = now;
  shown_ = true;
  const double clamped = std::clamp(fraction, 0.0, 1.0);
  const auto filled = static_cast<size_t>(clamped * kWidth);
  const std::string bar = std::string(filled, '#') + std::string(kWidth - filled, '.');
  std::fprintf(stderr, "\r\033[K[%s] %3d %% %.*s", bar.c_str(), static_cast<int>(clamped * 100.0), static_cast<int>(what.size()),
               what.data());
  std::fflush(stderr);
}

}  // namespace radivox::cli
