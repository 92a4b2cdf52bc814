// The panels by hand: widgets are found by their labels under the mouse, and pressed and dragged by Dear ImGui's own input.
#ifdef RADIVOX_WITH_WINDOW
#include <gtest/gtest.h>
#include <imgui.h>
#include <imgui_internal.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <functional>
#include <thread>
#include <variant>

#include "engine/image/image.h"
#include "samples/viewer/panels/gui.h"
#include "tests/cli/command.h"

#ifdef RADIVOX_WITH_VDB
#include "modules/vdb/inspect.h"
#endif

namespace radivox::viewer {

namespace {

constexpr float kWidth = 800, kHeight = 700, kArea = kWidth - 390;

/// What Dear ImGui makes a widget's id of: labels and numbers, from its window inwards.
using Place = std::vector<std::variant<std::string, int>>;

ImGuiID idOf(const Place& place, ImGuiID seed) {
  for (const auto& step : place) {
    const int* number = std::get_if<int>(&step);
    seed = number != nullptr ? ImHashData(number, sizeof(int), seed) : ImHashStr(std::get<std::string>(step).c_str(), 0, seed);
  }
  return seed;
}

class PanelsTest : public test::CommandTest {
 protected:
  void SetUp() override {
    CommandTest::SetUp();
    before_ = std::filesystem::current_path();
    std::filesystem::current_path(folder_);
    cli::Options options;
    options.scene = "builtin:cornell_point";
    options.sets = {"voxelize.resolution=12", "visibility.rays=16", "lights.point_shadow_resolution=64"};
    ViewOptions view;
    view.views = path("v.json");
    app_ = std::make_unique<App>(view, options, [] {});
    gui_ = std::make_unique<Gui>();
    ImGuiIO& io = ImGui::GetIO();
    io.DisplaySize = {kWidth, kHeight};
    io.DeltaTime = 1.f / 60;
    ASSERT_TRUE(turnUntil([&] { return isFull(); }));
  }
  void TearDown() override {
    gui_.reset();
    app_.reset();
    std::filesystem::current_path(before_);
    CommandTest::TearDown();
  }

  void draw() {
    gui_->draw(*app_);
    app_->turn(0.02, gui_->controls());
  }
  bool turnUntil(const std::function<bool()>& holds) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(180);
    while (std::chrono::steady_clock::now() < end) {
      draw();
      if (holds()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return false;
  }
  bool isFull() const {
    const View now = app_->view();
    return app_->picture && !app_->picture->preview && wantsSameLight(app_->picture->view, now) &&
           app_->picture->view.camera == now.camera && app_->picture->view.overlay == now.overlay && !now.moving &&
           !app_->picture->view.moving;
  }

  /// Moves the mouse over the panels until it is over the widget.
  bool pointAt(const Place& place) {
    ImGuiIO& io = ImGui::GetIO();
    for (const float column : {30.f, 200.f}) {
      for (float y = 8; y < kHeight; y += 6) {
        io.MousePos = {kArea + column, y};
        draw();
        const ImGuiContext& context = *ImGui::GetCurrentContext();
        if (context.HoveredId != 0 && context.HoveredId == idOf(place, context.HoveredWindow->ID)) return true;
      }
    }
    return false;
  }
  void press(bool down) {
    ImGui::GetIO().MouseDown[0] = down;
    draw();
  }
  bool click(const Place& place) {
    if (!pointAt(place)) return false;
    press(true);
    press(false);
    return true;
  }
  bool drag(const Place& place, float pixels) {
    if (!pointAt(place)) return false;
    press(true);
    for (int i = 0; i < 10; ++i) {
      ImGui::GetIO().MousePos.x += pixels / 10;
      draw();
    }
    press(false);
    return true;
  }
  bool openTab(const std::string& name) {
    ImGui::GetIO().MousePos = {kArea + 100, kHeight - 10};
    draw();
    for (float x = 10; x < 380; x += 10) {
      ImGui::GetIO().MousePos = {kArea + x, 18};
      draw();
      const ImGuiContext& context = *ImGui::GetCurrentContext();
      if (context.HoveredId == 0 || context.HoveredId != idOf({"panels", name}, context.HoveredWindow->ID)) continue;
      press(true);
      press(false);
      return true;
    }
    return false;
  }
  std::vector<uint8_t> fullPicture() {
    EXPECT_TRUE(turnUntil([&] { return isFull(); }));
    return app_->picture->pixels->rgba;
  }

  std::filesystem::path before_;
  std::unique_ptr<App> app_;
  std::unique_ptr<Gui> gui_;
};

}  // namespace

TEST_F(PanelsTest, SlowButtonsWriteWhatIsSeen) {
  EXPECT_FALSE(pointAt({"no such widget"}));
  ASSERT_TRUE(click({"P screenshot (.png and .exr)"}));
  ASSERT_TRUE(turnUntil([&] { return std::filesystem::exists("radivox_1.png") && std::filesystem::exists("radivox_1.exr"); }));
  EXPECT_EQ(image::readPng("radivox_1.png").width, app_->areaWidth);
  EXPECT_GE(image::readExr("radivox_1.exr").size(), 8u);
#ifdef RADIVOX_WITH_VDB
  const uint64_t voxels = app_->picture->report->stats.counts.at("voxels");
  ASSERT_TRUE(click({"V voxels (.vdb)"}));
  ASSERT_TRUE(turnUntil([&] { return std::filesystem::exists("radivox_1.vdb"); }));
  const std::string text = vdb::printFile("radivox_1.vdb");
  // All but the two of a node that only they need, and it says so.
  EXPECT_NE(text.find("30 grids"), std::string::npos) << text;
  ASSERT_TRUE(turnUntil([&] { return app_->messages.back().rfind("radivox_1.vdb", 0) == 0; }));
  EXPECT_NE(app_->messages.back().find("without fragment_count, mean_normal, "), std::string::npos) << app_->messages.back();
  for (const char* grid :
       {"occupancy", "albedo", "area", "cluster_id", "cluster_color", "cluster_normal", "lit", "direct", "visible_clusters", "misses"}) {
    const size_t at = text.find("\n  " + std::string(grid) + ": ");
    ASSERT_NE(at, std::string::npos) << grid;
    const std::string line = text.substr(at + 1, text.find('\n', at + 1) - at - 1);
    EXPECT_NE(line.find(" " + std::to_string(voxels) + " active voxels"), std::string::npos) << line;
  }
  for (const char* grid : {"indirect", "error", "indirect_pos_y"}) {  // where the view gathered
    const size_t at = text.find("\n  " + std::string(grid) + ": ");
    ASSERT_NE(at, std::string::npos) << grid;
    EXPECT_EQ(text.substr(at + 1, text.find('\n', at + 1) - at - 1).find(" 0 active voxels"), std::string::npos) << grid;
  }
#else
  EXPECT_FALSE(pointAt({"V voxels (.vdb)"})) << "this build writes none";
#endif
}

TEST_F(PanelsTest, SlowOverlaysFreezeAndTruthAreClicked) {
  const std::vector<uint8_t> first = fullPicture();
  ASSERT_TRUE(click({"3 clusters"}));
  EXPECT_EQ(app_->overlay, Overlay::Clusters);
  EXPECT_NE(fullPicture(), first);
  ASSERT_TRUE(click({"1 picture"}));
  EXPECT_EQ(fullPicture(), first);
  ASSERT_TRUE(click({"F freeze"}));
  EXPECT_TRUE(app_->frozen);
  app_->lamps.lamps.at(0).light.position.x += 0.5f;
  const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(500);
  while (std::chrono::steady_clock::now() < end) draw();
  EXPECT_EQ(app_->picture->pixels->rgba, first) << "nothing runs";
  ASSERT_TRUE(click({"F freeze"}));
  EXPECT_NE(fullPicture(), first);
  if (!Truth::isAvailable()) return;
  ASSERT_TRUE(click({"T path-traced truth"}));
  ASSERT_TRUE(turnUntil([&] { return app_->truthPicture && app_->truthPicture->samples >= 2; }));
}

TEST_F(PanelsTest, SlowMethodsPresetsAndParametersAreChosen) {
  ASSERT_TRUE(openTab("Method"));
  const std::vector<uint8_t> first = fullPicture();
  ASSERT_TRUE(click({"indirect bounces"}) && click({"0"}));
  EXPECT_EQ(app_->settings.bounces(), "0");
  EXPECT_NE(fullPicture(), first);
  ASSERT_TRUE(click({"indirect bounces"}) && click({"all"}));
  EXPECT_EQ(fullPicture(), first);
  ASSERT_TRUE(click({"method"}) && click({"direct"}));
  EXPECT_EQ(app_->settings.graph(), "direct");
  EXPECT_NE(fullPicture(), first);
  ASSERT_TRUE(click({"sides##gbuffer"}) && click({"gltf"}));
  const std::vector<std::string> values = app_->settings.values();
  EXPECT_NE(std::find(values.begin(), values.end(), "gbuffer.sides=gltf"), values.end());
  fullPicture();
  ASSERT_TRUE(click({"preset"}) && click({"paper_64"}));
  EXPECT_EQ(app_->settings.preset(), "paper_64");
  EXPECT_EQ(app_->settings.bounces(), "1");
}

TEST_F(PanelsTest, SlowLightsAreMovedColouredAndAnimated) {
  ASSERT_TRUE(openTab("Lights"));
  const scene::PunctualLight start = app_->lamps.lamps.at(0).light;
  std::vector<uint8_t> seen = fullPicture();
  const auto changes = [&](const char* what) {
    const std::vector<uint8_t> now = fullPicture();
    EXPECT_NE(now, seen) << what;
    seen = now;
  };
  // A person's first lamp: of number 0, x of its position.
  ASSERT_TRUE(drag({0, "position, m", 0, ""}, 60));
  EXPECT_GT(app_->lamps.lamps[0].light.position.x, start.position.x);
  EXPECT_EQ(app_->lamps.lamps[0].light.position.y, start.position.y);
  changes("moved");
  ASSERT_TRUE(drag({0, "colour", "##X"}, -60));
  const glm::vec3 intensity = app_->lamps.lamps[0].light.intensity;
  EXPECT_LT(intensity.x / intensity.y, start.intensity.x / start.intensity.y);
  changes("coloured");
  const float exposure = app_->picture->exposure;  // adapts to the scene's light
  ASSERT_TRUE(drag({0, "W/sr"}, -40));
  EXPECT_LT(app_->lamps.lamps[0].light.intensity.y, intensity.y);
  ASSERT_TRUE(turnUntil([&] { return isFull() && app_->picture->exposure > exposure; })) << "dimmed";
  seen = fullPicture();
  ASSERT_TRUE(click({0, "on"}));
  changes("off");
  ASSERT_TRUE(click({0, "on"}));
  changes("on");

  ASSERT_TRUE(click({"add a spot light here"}));
  ASSERT_EQ(app_->lamps.lamps.size(), 2u);
  changes("added");
  const glm::vec3 direction = app_->lamps.lamps[1].light.direction;
  ASSERT_TRUE(drag({1, "comes from, degrees up"}, 30));
  EXPECT_NE(app_->lamps.lamps[1].light.direction, direction);
  changes("turned");
  ASSERT_TRUE(click({"remove the last"}));
  EXPECT_EQ(app_->lamps.lamps.size(), 1u);
  changes("removed");

  ASSERT_TRUE(click({0, "moves"}));
  ASSERT_TRUE(click({static_cast<int>(Motion::Circle), motionNames()[static_cast<size_t>(Motion::Circle)]}));
  EXPECT_EQ(app_->lamps.lamps[0].motion, Motion::Circle);
  EXPECT_TRUE(app_->isAnimating());
  const double before = app_->time();
  ASSERT_TRUE(turnUntil([&] { return app_->time() > before + 0.5; }));
  ASSERT_TRUE(click({"L animate"}));
  EXPECT_FALSE(app_->animate);
  changes("animated");
  ASSERT_TRUE(click({"as in the scene"}));
  EXPECT_EQ(app_->lamps.lamps[0].motion, Motion::Still);
  ASSERT_TRUE(click({"keep with the views"}));
  const ViewsFile kept = readViews(path("v.json"), true);
  ASSERT_TRUE(kept.lamps.has_value());
  EXPECT_EQ(kept.lamps->lamps.at(0).light.position, start.position);
}

}  // namespace radivox::viewer
#endif
