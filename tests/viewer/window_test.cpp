// The window, on a screen that nobody sees: keys, mouse, resize, unmapping, losses, and how long its events ever waited.
#ifdef RADIVOX_WITH_WINDOW
#define GLFW_INCLUDE_VULKAN
#include <GLFW/glfw3.h>
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "engine/image/image.h"
#include "samples/viewer/panels/gui.h"
#include "samples/viewer/window/events.h"
#include "samples/viewer/window/presenter.h"
#include "tests/cli/command.h"
#include "tests/viewer/screen.h"

namespace radivox::test {

namespace {

/// Two triangles over the whole frame, in the texture's colour.
viewer::PanelFrame plainFrame(uint32_t width, uint32_t height, std::array<uint8_t, 3> colour) {
  viewer::PanelFrame frame;
  frame.width = width;
  frame.height = height;
  const auto w = static_cast<float>(width), h = static_cast<float>(height);
  for (const glm::vec2 corner : {glm::vec2(0, 0), glm::vec2(1, 0), glm::vec2(1, 1), glm::vec2(0, 1)})
    frame.vertices.push_back({corner * glm::vec2(w, h), corner, 0xffffffffu});
  frame.indices = {0, 1, 2, 0, 2, 3};
  frame.draws.push_back({{{0, 0}, {width, height}}, viewer::kPictureTexture, 0, 6, 0});
  viewer::Pixels pixels{2, 2, {}};
  for (int i = 0; i < 4; ++i) pixels.rgba.insert(pixels.rgba.end(), {colour[0], colour[1], colour[2], 255});
  frame.textures[viewer::kPictureTexture] = std::make_shared<viewer::Pixels>(std::move(pixels));
  return frame;
}

}  // namespace

class WindowTest : public CommandTest {};

TEST_F(WindowTest, SlowAloneAnswersKeysAndMouseAndNeverWaits) {
  Screen screen(path("screen"));
  if (!screen.fault().empty()) GTEST_SKIP() << screen.fault();
  constexpr uint32_t kWidth = 760, kHeight = 420, kArea = kWidth - 390;
  CommandResult result;
  CommandSetup setup;
  setup.environment = {{"DISPLAY", screen.display()}, {"HOME", path("")}};
  setup.folder = folder_;
  setup.timeLimitSeconds = 600;
  std::thread viewer([&] {
    result = runRadivox({"view", "builtin:cornell_point", "--size", "760x420", "--set", "voxelize.resolution=16", "--set",
                         "lights.point_shadow_resolution=256", "--validate", "--views", "v.json", "--stats", "stats.json"},
                        setup);
  });
  struct Join {
    std::thread& thread;
    Screen& screen;
    ~Join() {
      if (!thread.joinable()) return;
      screen.act("key ctrl+q");
      thread.join();
    }
  } join{viewer, screen};
  if (!screen.wait(120, [](const auto& p) { return glm::length(meanOf(p, 0, 60, kArea, kHeight - 60)) > 20.f; })) {
    screen.act("key ctrl+q");
    viewer.join();
    FAIL() << "no picture: " << result.exitCode << " " << result.err;
  }
  ASSERT_TRUE(screen.act("mousemove 180 210"));
  const viewer::Pixels first = screen.settle(kArea, kHeight);
  const auto differs = [&](const viewer::Pixels& a, const viewer::Pixels& b) { return shareThatDiffers(a, b, 0, 60, kArea, kHeight - 60); };

  ASSERT_TRUE(screen.act("keydown w") && screen.act("sleep 0.4") && screen.act("keyup w"));
  const viewer::Pixels walked = screen.settle(kArea, kHeight, [&](const auto& p) { return differs(first, p) > 0.2; });
  EXPECT_GT(differs(first, walked), 0.2);

  screen.act("key 3");
  const viewer::Pixels clusters = screen.settle(kArea, kHeight, [&](const auto& p) { return differs(walked, p) > 0.5; });
  EXPECT_GT(differs(walked, clusters), 0.5);
  screen.act("key 1");
  EXPECT_TRUE(screen.wait(60, [&](const auto& p) { return differs(walked, p) == 0.0; })) << "overlays leave no trace";

  ASSERT_TRUE(screen.act("mousedown 1") && screen.act("mousemove_relative 60 0") && screen.act("sleep 0.3") && screen.act("mouseup 1"));
  const viewer::Pixels turned = screen.settle(kArea, kHeight, [&](const auto& p) { return differs(walked, p) > 0.2; });
  EXPECT_GT(differs(walked, turned), 0.2);

  screen.act("key h");  // the picture takes the whole window
  const auto isWide = [&](const viewer::Pixels& p) {
    return shareThatDiffers(turned, p, kArea + 20, 60, kWidth - kArea - 40, kHeight - 60) > 0.5;
  };
  EXPECT_TRUE(isWide(screen.settle(kWidth, kHeight, isWide)));
  screen.act("key m");  // a bookmark
  EXPECT_TRUE(screen.wait(60, [&](const auto&) { return std::filesystem::exists(path("v.json")); }));

#ifdef RADIVOX_WITH_VDB
  screen.act("key v");  // the voxels
  EXPECT_TRUE(screen.wait(60, [&](const auto&) { return std::filesystem::exists(path("radivox_1.vdb")); }));
#endif
  screen.act("key p");  // screenshots
  EXPECT_TRUE(screen.wait(60, [&](const auto&) { return std::filesystem::exists(path("radivox_1.exr")); }));

  // Back to the middle of the box, which fills the window however far the walk went.
  ASSERT_TRUE(screen.act("mousedown 1") && screen.act("mousemove_relative -- -60 0") && screen.act("sleep 0.3") && screen.act("mouseup 1"));
  ASSERT_TRUE(screen.act("search --name radivox windowsize 500 300"));
  const auto isSmall = [](const viewer::Pixels& p) {
    return glm::length(meanOf(p, 100, 60, 300, 200)) > 10.f && glm::length(meanOf(p, 520, 0, 100, 300)) == 0.f;
  };
  const viewer::Pixels small = screen.settle(500, 300, isSmall);
  EXPECT_TRUE(isSmall(small));
  ASSERT_TRUE(screen.act("search --name radivox windowunmap"));
  screen.act("sleep 0.5");
  ASSERT_TRUE(screen.act("search --name radivox windowmap"));
  screen.act("mousemove 200 150");
  EXPECT_TRUE(screen.act("search --sync --onlyvisible --name radivox windowfocus --sync")) << "which a window manager would do";
  screen.act("key 3");
  EXPECT_TRUE(screen.wait(60, [&](const auto& p) { return shareThatDiffers(small, p, 100, 60, 300, 200) > 0.5; })) << "shown again";

  screen.act("mousemove 100 100");
  screen.act("key ctrl+q");
  viewer.join();
  EXPECT_EQ(result.exitCode, 0) << result.err;
  EXPECT_EQ(result.err, "");
#ifdef RADIVOX_WITH_VDB
  const CommandResult voxels = runRadivox({"vdb", "--print", path("radivox_1.vdb")});
  EXPECT_EQ(voxels.exitCode, 0) << voxels.err;
  EXPECT_NE(voxels.out.find("30 grids"), std::string::npos) << voxels.out;
#endif
  EXPECT_EQ(image::readPng(path("radivox_1.png")).width, kWidth) << "the picture as it is shown, without panels";
  EXPECT_GE(image::readExr(path("radivox_1.exr")).size(), 8u);
  const auto stats = nlohmann::json::parse(read("stats.json"));
  EXPECT_LT(stats["longest_gap_ms"].get<double>(), 100.0);
  EXPECT_GT(stats["presented"].get<int>(), 10);
  EXPECT_EQ(stats["recoveries"].get<int>(), 0);
  EXPECT_GE(stats["previews"].get<int>(), 1);
}

TEST_F(WindowTest, SlowSurvivesLostSurfacesAndDevices) {
  Screen screen(path("screen"));
  if (!screen.fault().empty()) GTEST_SKIP() << screen.fault();
  ::setenv("DISPLAY", screen.display().c_str(), 1);
  ASSERT_EQ(glfwInit(), GLFW_TRUE);
  glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
  GLFWwindow* window = glfwCreateWindow(200, 100, "presenter", nullptr, nullptr);
  ASSERT_NE(window, nullptr);
  viewer::PresenterOptions options;
  options.device.validation = true;
  options.device.onMessage = [](const std::string& message) { ADD_FAILURE() << message; };
  uint32_t count = 0;
  const char** extensions = glfwGetRequiredInstanceExtensions(&count);
  options.device.instanceExtensions.assign(extensions, extensions + count);
  options.device.deviceExtensions = {VK_KHR_SWAPCHAIN_EXTENSION_NAME};
  options.makeSurface = [window](VkInstance instance) {
    VkSurfaceKHR surface = VK_NULL_HANDLE;
    gpu::check(glfwCreateWindowSurface(instance, window, nullptr, &surface), "glfwCreateWindowSurface");
    return surface;
  };
  options.wake = [] {};
  {
    viewer::Presenter presenter(std::move(options));
    const auto shows = [&](uint32_t width, uint32_t height, std::array<uint8_t, 3> colour) {
      presenter.show(plainFrame(width, height, colour));
      return screen.wait(20, [&](const viewer::Pixels& p) {
        glfwPollEvents();
        presenter.rethrowFailure();
        const glm::vec3 mean = meanOf(p, 10, 10, width - 20, height - 20);
        return glm::length(mean - glm::vec3(colour[0], colour[1], colour[2])) < 1.f;
      });
    };
    // A frame is on the screen before the loss that is injected behind it has been dealt with.
    const auto hasRecovered = [&](uint64_t times) {
      return screen.wait(20, [&](const auto&) { return presenter.recoveryCount() >= times; }) && presenter.recoveryCount() == times;
    };
    EXPECT_TRUE(shows(200, 100, {250, 20, 30}));
    presenter.injectResult(VK_ERROR_OUT_OF_DATE_KHR);
    EXPECT_TRUE(shows(200, 100, {20, 250, 30}));
    EXPECT_EQ(presenter.recoveryCount(), 0u);
    presenter.injectResult(VK_ERROR_SURFACE_LOST_KHR);
    EXPECT_TRUE(shows(200, 100, {20, 30, 250}));
    EXPECT_TRUE(hasRecovered(1));
    presenter.injectResult(VK_ERROR_DEVICE_LOST);
    EXPECT_TRUE(shows(200, 100, {200, 200, 30}));
    EXPECT_TRUE(hasRecovered(2));
    glfwSetWindowSize(window, 300, 150);
    EXPECT_TRUE(screen.wait(20, [&](const auto&) {
      glfwPollEvents();
      int width = 0, height = 0;
      glfwGetFramebufferSize(window, &width, &height);
      return width == 300 && height == 150;
    }));
    EXPECT_TRUE(shows(300, 150, {30, 200, 200}));
  }
  glfwDestroyWindow(window);
  glfwTerminate();
}

TEST_F(WindowTest, SlowOpensFilesDroppedOntoIt) {
  Screen screen(path("screen"));
  if (!screen.fault().empty()) GTEST_SKIP() << screen.fault();
  ASSERT_EQ(runRadivox({"scene", "box", "--out", path("box.glb")}).exitCode, 0);
  ::setenv("DISPLAY", screen.display().c_str(), 1);
  ASSERT_EQ(glfwInit(), GLFW_TRUE);
  glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
  GLFWwindow* window = glfwCreateWindow(200, 100, "dropped onto", nullptr, nullptr);
  ASSERT_NE(window, nullptr);
  {
    cli::Options options;
    options.scene = "builtin:cornell_point";
    options.sets = {"voxelize.resolution=8", "visibility.rays=8", "lights.point_shadow_resolution=64"};
    viewer::App app({}, options, [] {});
    app.areaWidth = 64;
    app.areaHeight = 48;
    viewer::Gui gui;
    viewer::Events events{&app, &gui, false};
    viewer::watch(window, events);
    // What GLFW calls when a file manager lets go; it gives back what is installed when another takes its place.
    const GLFWdropfun drop = glfwSetDropCallback(window, nullptr);
    ASSERT_NE(drop, nullptr);
    const std::string scene = path("box.glb"), views = path("none.json");
    std::array<const char*, 2> files = {scene.c_str(), views.c_str()};
    drop(window, static_cast<int>(files.size()), files.data());
    EXPECT_TRUE(events.any);
    EXPECT_EQ(app.scene, scene);
    ASSERT_FALSE(app.messages.empty());
    EXPECT_NE(app.messages.back().find("none.json"), std::string::npos) << app.messages.back();
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    const auto shows = [&] { return app.picture && !app.picture->preview && app.picture->view.scene == scene; };
    while (!shows() && std::chrono::steady_clock::now() < end) {
      app.turn(0.02, {});
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    EXPECT_TRUE(shows()) << app.status.error;
  }
  glfwDestroyWindow(window);
  glfwTerminate();
}

TEST_F(WindowTest, SaysWhatIsMissingWithoutADisplay) {
  CommandSetup setup;
  setup.environment = {{"DISPLAY", ":9871"}, {"WAYLAND_DISPLAY", ""}};
  expectError({"view", "builtin:cornell"}, 3, {"no window", "--headless"}, setup);
}

}  // namespace radivox::test
#endif
