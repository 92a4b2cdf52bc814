// The viewer's parts that need no device: camera, lights, files, settings.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/error.h"
#include "samples/viewer/error_map.h"
#include "samples/viewer/headless.h"
#include "samples/viewer/lamps.h"
#include "samples/viewer/settings.h"
#include "samples/viewer/truth.h"
#include "samples/viewer/views_file.h"
#include "samples/viewer/walk.h"
#include "tests/cli/command.h"

namespace radivox::viewer {

namespace {

glm::vec3 forwardOf(const scene::CameraDescription& camera) { return camera.orientation * glm::vec3(0, 0, -1); }

void expectNear(const glm::vec3& a, const glm::vec3& b, float tolerance = 1e-5f) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

std::string errorOf(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::BadInput);
    return error.what();
  }
  ADD_FAILURE() << "nothing was thrown";
  return {};
}

}  // namespace

TEST(Walk, MovesAlongWhereItLooks) {
  Walk walk({}, 3.f);
  walk.move({0, 0, 1}, 2.f);
  expectNear(walk.camera().position, {0, 0, -6});
  walk.turn(1.5707963f, 0.f);  // to the right
  expectNear(forwardOf(walk.camera()), {1, 0, 0});
  walk.move({0, 0, 1}, 1.f);
  walk.move({1, 0, 0}, 1.f);
  walk.move({0, 1, 0}, 1.f);
  expectNear(walk.camera().position, {3, 3, -3});
}

TEST(Walk, StaysUprightAndStopsAtTheZenith) {
  Walk walk;
  for (int i = 0; i < 50; ++i) walk.turn(0.37f, 0.2f);
  EXPECT_GT(forwardOf(walk.camera()).y, 0.999f);
  const glm::vec3 right = walk.camera().orientation * glm::vec3(1, 0, 0);
  EXPECT_NEAR(right.y, 0.f, 1e-5f);
}

TEST(Walk, TakesOverACameraAsItIs) {
  scene::CameraDescription camera;
  camera.position = {1, 2, 3};
  camera.orientation = glm::normalize(glm::angleAxis(0.7f, glm::vec3(0, 1, 0)) * glm::angleAxis(-0.4f, glm::vec3(1, 0, 0)));
  Walk walk(camera);
  EXPECT_TRUE(walk.camera() == camera);
  const glm::vec3 before = forwardOf(camera);
  walk.turn(0.f, 0.f);
  expectNear(forwardOf(walk.camera()), before);
}

TEST(Lamps, MoveByTimeAlone) {
  Lamps lamps;
  lamps.lamps.resize(3);
  lamps.lamps[0].light.type = shared::kLightPoint;
  lamps.lamps[0].light.intensity = {1, 2, 3};
  lamps.lamps[0].motion = Motion::Circle;
  lamps.lamps[0].period = 4.f;
  lamps.lamps[0].reach = 2.f;
  lamps.lamps[1].light.direction = {1, 0, 0};
  lamps.lamps[1].motion = Motion::Circle;
  lamps.lamps[2].on = false;
  lamps.lamps[2].light.intensity = {1, 1, 1};
  EXPECT_TRUE(lamps.isMoving());
  expectNear(lamps.at(0).lights[0].position, {0, 0, 0});
  expectNear(lamps.at(1).lights[0].position, {-2, 0, 2});
  expectNear(lamps.at(2).lights[0].position, {-4, 0, 0});
  EXPECT_TRUE(lamps.at(1) == lamps.at(1));
  EXPECT_FALSE(lamps.at(1) == lamps.at(2));
  expectNear(lamps.at(1).lights[1].direction, {0, 0, -1});
  expectNear(lamps.at(0).lights[2].intensity, {0, 0, 0});
}

TEST(Lamps, SwingAndPulse) {
  Lamps lamps;
  lamps.lamps.resize(2);
  lamps.lamps[0].light.direction = glm::normalize(glm::vec3(1, -1, 0));
  lamps.lamps[0].motion = Motion::Swing;
  lamps.lamps[1].light.type = shared::kLightSpot;
  lamps.lamps[1].light.intensity = {4, 0, 0};
  lamps.lamps[1].motion = Motion::Pulse;
  for (const double t : {0.3, 1.0, 2.9}) EXPECT_NEAR(glm::length(lamps.at(t).lights[0].direction), 1.f, 1e-5f);
  EXPECT_NE(lamps.at(1).lights[0].direction.y, lamps.at(3).lights[0].direction.y);
  EXPECT_NEAR(lamps.at(1).lights[1].intensity.x, 8.f, 1e-4f);
  EXPECT_NEAR(lamps.at(3).lights[1].intensity.x, 0.f, 1e-4f);
}

class ViewsFileTest : public test::CommandTest {};

TEST_F(ViewsFileTest, ComesBackAsItWas) {
  ViewsFile views;
  views.scene = "builtin:cornell";
  scene::CameraDescription camera;
  camera.position = {1, 2, 3};
  camera.orientation = glm::normalize(glm::quat(0.5f, 0.1f, 0.7f, 0.2f));
  camera.yfov = 0.7f;
  views.bookmarks.push_back({"door", camera});
  CameraPath path{"walk", {{0.0, camera}, {2.0, camera}}};
  path.keys[1].camera.position = {3, 2, 3};
  views.paths.push_back(path);
  Lamps lamps;
  lamps.sky = {0.1f, 0.2f, 0.3f};
  lamps.lamps.resize(1);
  lamps.lamps[0].light.name = "sun";
  lamps.lamps[0].light.intensity = {9, 8, 7};
  lamps.lamps[0].motion = Motion::Swing;
  views.lamps = lamps;
  writeViews(this->path("v.json"), views);
  const ViewsFile again = readViews(this->path("v.json"), true);
  ASSERT_EQ(again.bookmarks.size(), 1u);
  EXPECT_TRUE(again.bookmarks[0].camera == camera);
  EXPECT_EQ(again.bookmarks[0].name, "door");
  EXPECT_EQ(again.scene, "builtin:cornell");
  ASSERT_EQ(again.paths.size(), 1u);
  expectNear(again.paths[0].at(1.0).position, {2, 2, 3});
  expectNear(again.paths[0].at(-1.0).position, {1, 2, 3});
  expectNear(again.paths[0].at(9.0).position, {3, 2, 3});
  ASSERT_TRUE(again.lamps.has_value());
  EXPECT_TRUE(again.lamps->at(0.7) == lamps.at(0.7));
  EXPECT_EQ(again.lamps->sky, lamps.sky);
}

TEST_F(ViewsFileTest, ErrorsNameThePlace) {
  EXPECT_TRUE(readViews(path("none.json"), false).bookmarks.empty());
  EXPECT_NE(errorOf([&] { readViews(path("none.json"), true); }).find("none.json"), std::string::npos);
  const auto refuse = [&](const std::string& text, const std::string& place) {
    write("v.json", text);
    const std::string message = errorOf([&] { readViews(path("v.json"), true); });
    EXPECT_NE(message.find(place), std::string::npos) << message;
  };
  refuse("[1]", "v.json: not a JSON object");
  refuse(R"({"bookmarks": [{"name": "a"}]})", "bookmarks[0]: 'position' is missing");
  refuse(R"({"bookmarks": [{"name": "a", "position": [1, 2], "orientation": [0, 0, 0, 1]}]})", "bookmarks[0].position: not 3 numbers");
  refuse(R"({"bookmarks": [{"name": "a", "position": [1, 2, 3], "orientation": [0, 0, 0, 0]}]})", "orientation: a quaternion of length 0");
  refuse(R"({"paths": [{"name": "p", "keys": []}]})", "paths[0]: a path without keys");
  refuse(R"({"paths": [{"name": "p", "keys": [{"seconds": 1, "position": [0,0,0], "orientation": [0,0,0,1]},
                                              {"seconds": 1, "position": [0,0,0], "orientation": [0,0,0,1]}]}]})",
         "paths[0].keys[1]: seconds must rise");
  refuse(R"({"lights": [{"type": "laser", "intensity": [1, 1, 1]}]})", "lights[0].type: unknown type of light 'laser'");
  refuse(R"({"lights": [{"type": "point", "intensity": [1, -1, 1]}]})", "lights[0]: intensity below 0");
}

TEST(Settings, HoldEveryParameterAndForgetWhatAGraphLacks) {
  cli::Options options;
  options.sets = {"voxelize.resolution=64"};
  Settings settings(options);
  const std::vector<std::string> values = settings.values();
  EXPECT_NE(std::find(values.begin(), values.end(), "voxelize.resolution=64"), values.end());
  EXPECT_NE(std::find(values.begin(), values.end(), "lights.shadow_resolution=2048"), values.end());
  settings.set("bounce.residual", "0.01");
  EXPECT_NE(errorOf([&] { settings.set("bounce.residual", "7"); }).find("bounce.residual"), std::string::npos);
  settings.setBounces("2");
  settings.chooseGraph("direct");
  EXPECT_EQ(settings.bounces(), "2");
  for (const std::string& value : settings.values()) EXPECT_EQ(value.rfind("voxelize.", 0), std::string::npos);
  settings.choosePreset("paper_64");
  EXPECT_EQ(settings.bounces(), "1");
  EXPECT_EQ(settings.graph(), "clustered_voxel");
  const std::vector<std::string> aovs = settings.aovs();
  EXPECT_NE(std::find(aovs.begin(), aovs.end(), "albedo"), aovs.end());
}

TEST(ViewerHeadless, NumbersFrames) {
  EXPECT_EQ(frameName("a/frame_####.png", 7), "a/frame_0007.png");
  EXPECT_EQ(frameName("#.png", 123), "123.png");
  EXPECT_EQ(frameName("one.png", 3), "one.png");
}

TEST(ErrorMap, IsTheRootOfWhatRelMseSums) {
  image::Image reference{2, 1, 3, {1, 1, 1, 0, 0, 0}}, test{2, 1, 3, {1.5f, 1, 1, 0.1f, 0.1f, 0.1f}};
  const image::Image map = relativeErrors(reference, test);
  const double floor = 0.01 * 0.25;  // 0.01·mean²
  EXPECT_NEAR(map.at(0, 0, 0), 0.5 / std::sqrt(1 + floor) / 3, 1e-6);
  EXPECT_NEAR(map.at(1, 0, 0), 0.1 / std::sqrt(floor), 1e-5);
}

TEST(ToneMap, ClampsAndExposes) {
  const image::Image radiance{1, 1, 3, {0.25f, 4.f, -1.f}};
  const image::Image linear = toneMap(radiance, 2.f, false), filmic = toneMap(radiance, 1.f, true);
  EXPECT_FLOAT_EQ(linear.data[0], 0.5f);
  EXPECT_FLOAT_EQ(linear.data[1], 1.f);
  EXPECT_FLOAT_EQ(linear.data[2], 0.f);
  EXPECT_LT(filmic.data[1], 1.f);
}

}  // namespace radivox::viewer
