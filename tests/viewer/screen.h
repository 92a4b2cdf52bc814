// A screen that nobody sees: Xvfb with a frame buffer in a file, and xdotool for hands.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "samples/viewer/picture.h"

namespace radivox::test {

class Screen {
 public:
  /// 1024 × 768. `fault()` says why there is none (Xvfb or xdotool is not installed).
  explicit Screen(const std::filesystem::path& folder);
  ~Screen();
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;

  const std::string& fault() const { return fault_; }
  const std::string& display() const { return display_; }  ///< ":7"
  /// What is on it now; RGBA, a = 255.
  viewer::Pixels shot() const;
  /// Runs xdotool; false where it fails.
  bool act(const std::string& words) const;
  /// Waits until `holds` of a shot; false after `seconds`.
  bool wait(double seconds, const std::function<bool(const viewer::Pixels&)>& holds) const;
  /// Of the first window whose name contains "radivox"; empty: none.
  std::string title() const;
  /// Waits until `holds` of a shot, the window's title says that nothing is under way, and the rectangle has been still for a second.
  /// Returns the last shot; `seconds` is for a machine that does much else besides.
  viewer::Pixels settle(uint32_t width, uint32_t height, const std::function<bool(const viewer::Pixels&)>& holds = nullptr,
                        double seconds = 120) const;

 private:
  std::filesystem::path folder_;
  std::string display_, fault_;
  int process_ = -1;
};

/// Mean of R, G, B over a rectangle.
glm::vec3 meanOf(const viewer::Pixels& pixels, uint32_t left, uint32_t top, uint32_t width, uint32_t height);
/// Share of the pixels of a rectangle that differ by more than 2 of 255.
double shareThatDiffers(const viewer::Pixels& a, const viewer::Pixels& b, uint32_t left, uint32_t top, uint32_t width, uint32_t height);

}  // namespace radivox::test
