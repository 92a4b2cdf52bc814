#include "samples/viewer/window/events.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "samples/viewer/panels/gui.h"

namespace radivox::viewer {

namespace {

Events& eventsOf(GLFWwindow* window) { return *static_cast<Events*>(glfwGetWindowUserPointer(window)); }

}  // namespace

void watch(GLFWwindow* window, Events& events) {
  glfwSetWindowUserPointer(window, &events);
  glfwSetKeyCallback(window, [](GLFWwindow* w, int key, int, int action, int mods) {
    eventsOf(w).any = true;
    if (action == GLFW_PRESS) eventsOf(w).gui->press(key, (mods & GLFW_MOD_CONTROL) != 0);
  });
  glfwSetCharCallback(window, [](GLFWwindow* w, unsigned) { eventsOf(w).any = true; });
  glfwSetMouseButtonCallback(window, [](GLFWwindow* w, int, int, int) { eventsOf(w).any = true; });
  glfwSetCursorPosCallback(window, [](GLFWwindow* w, double, double) { eventsOf(w).any = true; });
  glfwSetCursorEnterCallback(window, [](GLFWwindow* w, int) { eventsOf(w).any = true; });
  glfwSetScrollCallback(window, [](GLFWwindow* w, double, double) { eventsOf(w).any = true; });
  glfwSetFramebufferSizeCallback(window, [](GLFWwindow* w, int, int) { eventsOf(w).any = true; });
  glfwSetWindowRefreshCallback(window, [](GLFWwindow* w) { eventsOf(w).any = true; });
  glfwSetWindowIconifyCallback(window, [](GLFWwindow* w, int) { eventsOf(w).any = true; });
  glfwSetDropCallback(window, [](GLFWwindow* w, int count, const char** paths) {
    eventsOf(w).any = true;
    for (int i = 0; i < count; ++i) eventsOf(w).app->open(paths[i]);
  });
}

}  // namespace radivox::viewer
