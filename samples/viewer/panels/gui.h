// Dear ImGui without a window system: input goes in through ImGuiIO (a GLFW backend or a test writes it), plain frames come out.
#pragma once

#include "samples/viewer/app.h"
#include "samples/viewer/window/panel_frame.h"

struct ImGuiContext;

namespace radivox::viewer {

class Gui {
 public:
  Gui();
  ~Gui();
  Gui(const Gui&) = delete;
  Gui& operator=(const Gui&) = delete;

  /// One frame of panels over pictures. Sets the app's area, pointer, and what keys and the mouse ask for. The display's size, the time
  /// since the last frame and the input are in ImGuiIO.
  PanelFrame draw(App& app);
  /// A key went down, by its ASCII code in capitals. Not by ImGuiIO: a key that is up again before the next frame counts, too.
  void press(int key, bool control) { pressed_.push_back({key, control}); }
  /// Of the frame drawn last.
  const Controls& controls() const { return controls_; }
  bool wantsToQuit() const { return quit_; }

 private:
  struct Press {
    int key;
    bool control;
  };
  void takeKeys(App& app);
  PanelFrame takeFrame(const App& app) const;
  ImGuiContext* context_;
  std::shared_ptr<const Pixels> font_;
  Controls controls_;
  std::vector<Press> pressed_;
  bool quit_ = false;
  bool looking_ = false;  ///< a drag that began on the picture
};

}  // namespace radivox::viewer
