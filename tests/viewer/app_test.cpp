// What a person does, without a window: files opened, paths recorded and played, lights moved, truth beside.
#include "samples/viewer/app.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "tests/cli/command.h"

namespace radivox::viewer {

namespace {

cli::Options smallOptions() {
  cli::Options options;
  options.scene = "builtin:cornell_point";
  options.sets = {"voxelize.resolution=12", "visibility.rays=16", "lights.point_shadow_resolution=64"};
  return options;
}

/// Turns until `holds`, at most a minute.
bool turnUntil(App& app, const std::function<bool()>& holds, const Controls& controls = {}) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (std::chrono::steady_clock::now() < end) {
    app.turn(0.02, controls);
    if (holds()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return false;
}

bool isFull(const App& app) {
  return app.picture && !app.picture->preview && app.picture->view.camera == app.view().camera && app.picture->view.scene == app.scene &&
         !app.picture->view.moving;
}

}  // namespace

TEST(AppDivisor, KeepsToTheBudget) {
  EXPECT_EQ(chooseDivisor(50, 1, 80), 1u);
  EXPECT_EQ(chooseDivisor(200, 1, 80), 2u);
  EXPECT_EQ(chooseDivisor(50, 2, 80), 2u);
  EXPECT_EQ(chooseDivisor(10, 2, 80), 1u);
  EXPECT_EQ(chooseDivisor(1e6, 1, 80), 4u);
}

class AppTest : public test::CommandTest {};

TEST_F(AppTest, SlowWalksRecordsAndPlays) {
  ViewOptions view;
  view.views = path("v.json");
  App app(view, smallOptions(), [] {});
  app.areaWidth = 80;
  app.areaHeight = 60;
  ASSERT_TRUE(turnUntil(app, [&] { return isFull(app); }));
  EXPECT_EQ(app.picture->pixels->width, 80u);
  const glm::vec3 start = app.walk.camera().position;
  app.startRecording();
  Controls forward;
  forward.along.z = 1;
  for (int i = 0; i < 10; ++i) app.turn(0.05, forward);
  app.stopRecording();
  const glm::vec3 end = app.walk.camera().position;
  EXPECT_LT(end.z, start.z);
  app.addBookmark();
  const ViewsFile kept = readViews(path("v.json"), true);
  ASSERT_EQ(kept.paths.size(), 1u);
  EXPECT_GE(kept.paths[0].keys.size(), 9u);
  EXPECT_NEAR(kept.paths[0].seconds(), 0.5, 1e-6);
  EXPECT_EQ(kept.bookmarks.at(0).camera.position, end);
  app.jumpTo(app.loaded->cameras.front());
  ASSERT_TRUE(turnUntil(app, [&] { return isFull(app); }));
  app.play(0);
  EXPECT_TRUE(app.isPlaying());
  ASSERT_TRUE(turnUntil(app, [&] { return !app.isPlaying(); }));
  EXPECT_EQ(app.walk.camera().position, end);
  ASSERT_TRUE(turnUntil(app, [&] { return isFull(app); }));
  EXPECT_EQ(app.picture->pixels->width, 80u) << "at rest the picture is whole";
}

TEST_F(AppTest, SlowOpensWhatIsDroppedOntoIt) {
  App app({}, smallOptions(), [] {});
  app.areaWidth = 64;
  app.areaHeight = 48;
  ASSERT_TRUE(turnUntil(app, [&] { return isFull(app); }));
  app.worker().save(path("own.exr"));
  ASSERT_TRUE(turnUntil(app, [&] { return std::filesystem::exists(path("own.exr")); }));
  app.open(path("own.exr"));
  EXPECT_EQ(app.overlay, Overlay::Error);
  ASSERT_TRUE(turnUntil(app, [&] { return app.picture && app.picture->error; }));
  EXPECT_EQ(app.picture->error->rmse, 0.0) << "its own picture";
  app.open(path("none.glb"));
  ASSERT_TRUE(turnUntil(app, [&] { return !app.status.error.empty(); }));
  EXPECT_NE(app.messages.back().find("none.glb"), std::string::npos);
  app.overlay = Overlay::Picture;
  app.open("builtin:box");
  ASSERT_TRUE(turnUntil(app, [&] { return isFull(app); }));
  EXPECT_TRUE(app.status.error.empty());
  EXPECT_EQ(app.loaded->name, scene::loadScene("builtin:box").name);
  ASSERT_FALSE(app.lamps.lamps.empty());
  const std::vector<uint8_t> before = app.picture->pixels->rgba;
  app.lamps.lamps[0].light.intensity = {0, 0, 10};
  ASSERT_TRUE(turnUntil(app, [&] { return isFull(app) && app.picture->pixels->rgba != before; }));
  if (!Truth::isAvailable()) return;
  app.truth = true;
  ASSERT_TRUE(turnUntil(app, [&] { return app.truthPicture && app.truthPicture->samples >= 4; }));
  EXPECT_EQ(app.truthPicture->pixels->width, 32u);
  Controls aside;
  aside.along.x = 1;
  app.turn(0.05, aside);
  ASSERT_TRUE(turnUntil(app, [&] { return app.truthPicture && app.truthPicture->samples < 4; })) << "begins anew";
}

}  // namespace radivox::viewer
