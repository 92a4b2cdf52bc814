// What GLFW's callbacks write.
#pragma once

struct GLFWwindow;

namespace radivox::viewer {

class App;
class Gui;

struct Events {
  App* app = nullptr;  ///< opens what is dropped onto the window
  Gui* gui = nullptr;  ///< takes keys
  bool any = true;     ///< something came in
};

/// Installs the callbacks; `events` outlives the window's use. The backend of Dear ImGui is installed after them, and calls them in turn.
void watch(GLFWwindow* window, Events& events);

}  // namespace radivox::viewer
