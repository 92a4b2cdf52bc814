// The session: what runs for which change, what previews and overlays show. Named Slow: each makes pipelines of two graphs.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <set>

#include "engine/error.h"
#include "samples/viewer/settings.h"
#include "samples/viewer/worker.h"
#include "tests/cli/command.h"

namespace radivox::viewer {

namespace {

View smallView(const std::string& scene = "builtin:cornell_point") {
  cli::Options options;
  options.sets = {"voxelize.resolution=16", "visibility.rays=64", "lights.point_shadow_resolution=128"};
  Settings settings(options);
  View view;
  view.scene = scene;
  view.graph = settings.graph();
  view.settings = settings.values();
  view.width = 96;
  view.height = 64;
  view.camera = scene::loadScene(scene).cameras.at(0);
  return view;
}

void change(View& view, const std::string& name, const std::string& value) {
  for (std::string& setting : view.settings) {
    if (setting.rfind(name + "=", 0) == 0) setting = name + "=" + value;
  }
}

struct Shown {
  std::vector<Picture> pictures;
  const Picture& last() const { return pictures.back(); }
  std::set<std::string> ran() const {
    std::set<std::string> names;
    for (const graph::NodeStats& node : last().report->stats.nodes) {
      if (node.ranLastFrame) names.insert(node.name);
    }
    return names;
  }
};

Shown show(Session& session, const View& view) {
  Shown shown;
  Hooks hooks;
  hooks.publish = [&](Picture picture) { shown.pictures.push_back(std::move(picture)); };
  EXPECT_TRUE(session.show(view, hooks));
  return shown;
}

std::string bytesOf(const Shown& shown) { return {shown.last().pixels->rgba.begin(), shown.last().pixels->rgba.end()}; }

SessionOptions validated(bool previews) {
  SessionOptions options;
  options.device.validation = true;
  options.device.onMessage = [](const std::string& message) { ADD_FAILURE() << message; };
  options.previews = previews;
  return options;
}

}  // namespace

TEST(SessionSlow, RunsNoMoreThanAChangeNeeds) {
  Session session(validated(false));
  View view = smallView();
  EXPECT_EQ(show(session, view).ran().count("visibility"), 1u);
  const Shown again = show(session, view);
  EXPECT_TRUE(again.ran().empty());

  view.camera.position.z += 0.1f;
  std::set<std::string> ran = show(session, view).ran();
  EXPECT_EQ(ran.count("gbuffer"), 1u);
  EXPECT_EQ(ran.count("gather"), 1u);
  EXPECT_EQ(ran.count("inject") + ran.count("voxelize"), 0u);

  view.lighting = Lighting{session.scene()->lights, session.scene()->skyRadiance};
  ran = show(session, view).ran();
  EXPECT_TRUE(ran.empty()) << "the scene's own lights, named";
  const float before = session.layers().front().image.data[0];
  view.lighting->lights.at(0).intensity *= 2.f;
  ran = show(session, view).ran();
  EXPECT_EQ(ran.count("inject"), 1u);
  EXPECT_EQ(ran.count("bounce"), 1u);
  EXPECT_EQ(ran.count("voxelize") + ran.count("visibility"), 0u);
  EXPECT_NEAR(session.layers().front().image.data[0], 2.f * before, 1e-3f * before);

  change(view, "bounce.residual", "0.01");
  ran = show(session, view).ran();
  EXPECT_EQ(ran.count("bounce"), 1u);
  EXPECT_EQ(ran.count("visibility"), 0u);

  view.width = 48;
  Shown resized = show(session, view);
  EXPECT_EQ(resized.ran().count("gbuffer"), 1u);
  EXPECT_EQ(resized.ran().count("visibility"), 0u);
  EXPECT_EQ(resized.last().pixels->width, 48u);
  EXPECT_EQ(resized.last().pixels->rgba.size(), 48u * 64u * 4u);

  change(view, "voxelize.resolution", "12");
  EXPECT_EQ(show(session, view).ran().count("visibility"), 1u);
  view.lighting->lights.clear();  // another plan: nothing casts shadows
  EXPECT_EQ(show(session, view).ran().count("shadow_map"), 0u);
}

TEST(SessionSlow, PreviewsFirstAndWhileItPrepares) {
  Session session(validated(true));
  const View view = smallView();
  View newest = view;
  std::vector<Picture> pictures;
  Hooks hooks;
  hooks.newest = [&] { return newest; };
  hooks.publish = [&](Picture picture) { pictures.push_back(std::move(picture)); };
  // Somebody walks on while the full picture is prepared.
  hooks.progress = [&](std::string_view what, double) {
    if (what == "cluster") newest.camera.position.x = 0.25f;
  };
  EXPECT_TRUE(session.show(view, hooks));
  ASSERT_EQ(pictures.size(), 4u);
  for (size_t i : {0u, 1u}) {
    EXPECT_TRUE(pictures[i].preview);
    EXPECT_TRUE(pictures[i].view.camera == view.camera);
  }
  const auto makesVoxels = [](const Picture& picture) {
    const auto& nodes = picture.report->stats.nodes;
    return std::any_of(nodes.begin(), nodes.end(), [](const graph::NodeStats& node) { return node.name == "voxelize"; });
  };
  EXPECT_FALSE(makesVoxels(pictures[0])) << "direct light comes first";
  EXPECT_TRUE(makesVoxels(pictures[1]));
  EXPECT_NE(pictures[0].pixels->rgba, pictures[1].pixels->rgba);
  EXPECT_TRUE(pictures[2].preview);
  EXPECT_EQ(pictures[2].view.camera.position.x, 0.25f);
  EXPECT_FALSE(pictures[3].preview);
  EXPECT_TRUE(pictures[3].view.camera == view.camera);
  EXPECT_NE(pictures[1].pixels->rgba, pictures[2].pixels->rgba);
  EXPECT_EQ(pictures[3].pixels->width, 96u);

  // Another light ends the work at once.
  pictures.clear();
  View other = newest;
  change(other, "visibility.rays", "32");
  newest = other;
  change(newest, "visibility.rays", "48");
  EXPECT_FALSE(session.show(other, hooks));
  EXPECT_TRUE(session.show(newest, hooks));
  EXPECT_FALSE(pictures.back().preview);
}

TEST(SessionSlow, OverlaysShowFacesAndWhatTheySee) {
  Session session(validated(false));
  View view = smallView();
  const Shown plain = show(session, view);
  std::set<std::string> distinct = {bytesOf(plain)};
  view.pointer = glm::uvec2(48, 60);  // the floor
  for (uint32_t overlay = 1; overlay < static_cast<uint32_t>(Overlay::Error); ++overlay) {
    view.overlay = static_cast<Overlay>(overlay);
    const Shown shown = show(session, view);
    EXPECT_TRUE(shown.ran().empty()) << overlayNames()[overlay];
    EXPECT_EQ(shown.last().remark, "") << overlayNames()[overlay];
    distinct.insert(bytesOf(shown));
  }
  EXPECT_EQ(distinct.size(), 7u);
  view.overlay = Overlay::Clusters;
  view.blocks = true;
  distinct.insert(bytesOf(show(session, view)));
  EXPECT_EQ(distinct.size(), 8u);

  // The rays drawn are those that the row was counted from.
  view.overlay = Overlay::VisibleClusters;
  view.blocks = false;
  for (const glm::uvec2 pixel : {glm::uvec2(48, 60), glm::uvec2(48, 3), glm::uvec2(22, 32), glm::uvec2(48, 30)}) {
    view.pointer = pixel;
    const std::shared_ptr<const PointedFace> face = show(session, view).last().pointed;
    ASSERT_NE(face, nullptr);
    EXPECT_EQ(face->rayCount, 64u);
    ASSERT_EQ(face->rays.size(), 64u);
    std::map<uint32_t, uint32_t> clusters, rowClusters = face->clusters;
    uint32_t misses = 0;
    for (const PointedFace::Ray& ray : face->rays) {
      ++(ray.hit == ~0u ? misses : clusters[ray.cluster]);
    }
    const Ports ports = session.full()->ports();
    const std::vector<uint32_t> labels =
        gpu::downloadAs<uint32_t>(session.device(), *ports.buffer("clustered_voxel.cluster", "labels"), ports.count("faces"));
    for (const auto& [id, count] : face->faces) rowClusters[labels.at(id)] += count;
    EXPECT_EQ(clusters, rowClusters);
    EXPECT_EQ(misses, face->misses + face->absorbed);
    ASSERT_TRUE(face->direct && face->indirect);
    EXPECT_GT(face->indirect->x, 0.f);
  }
}

TEST(SessionSlow, FreezeRunsNothingAndBlocksFollowTheCamera) {
  Session session(validated(false));
  View view = smallView();
  const Shown before = show(session, view);
  view.frozen = true;
  view.camera.position.x += 0.3f;
  change(view, "bounce.residual", "0.01");
  Shown held = show(session, view);
  EXPECT_EQ(held.last().pixels->rgba, before.last().pixels->rgba);
  view.overlay = Overlay::Voxels;
  held = show(session, view);
  const std::vector<uint8_t> first = held.last().pixels->rgba;
  view.camera.position.x -= 0.2f;
  EXPECT_NE(show(session, view).last().pixels->rgba, first);
  view.frozen = false;
  view.overlay = Overlay::Picture;
  EXPECT_NE(show(session, view).last().pixels->rgba, before.last().pixels->rgba);
}

TEST(SessionSlow, SaysWhatItCannotShowAndGoesOn) {
  Session session(validated(false));
  View view = smallView();
  view.graph = "direct";
  view.settings.clear();
  view.overlay = Overlay::Clusters;
  Shown shown = show(session, view);
  EXPECT_NE(shown.last().remark.find("no voxels"), std::string::npos);
  EXPECT_EQ(shown.last().pixels->width, 96u);
  view.overlay = Overlay::Error;
  view.reference = "/nowhere.exr";
  EXPECT_NE(show(session, view).last().remark.find("/nowhere.exr"), std::string::npos);
  view.scene = "builtin:cornel";
  EXPECT_THROW(session.show(view, {}), Error);
  view.scene = "builtin:cornell_point";
  view.overlay = Overlay::Picture;
  EXPECT_EQ(show(session, view).last().remark, "");
  session.reset();  // as after a lost device
  EXPECT_EQ(show(session, view).last().remark, "");
}

class WorkerSlow : public test::CommandTest {};

TEST_F(WorkerSlow, ShowsTheNewestViewAndSaves) {
  View view = smallView();
  std::atomic<int> wakes{0};
  Worker worker(validated(true), [&] { ++wakes; });
  for (int i = 0; i < 20; ++i) {
    view.camera.position.x = 0.01f * static_cast<float>(i);
    worker.want(view);
  }
  std::optional<Picture> full;
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (!full && std::chrono::steady_clock::now() < deadline) {
    worker.rethrowFailure();
    std::optional<Picture> picture = worker.takePicture();
    if (picture && !picture->preview && picture->view.camera == view.camera) full = std::move(picture);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  ASSERT_TRUE(full.has_value());
  EXPECT_GE(wakes.load(), 1);
  EXPECT_LT(worker.status().pictureCount + worker.status().previewCount, 10u) << "views that were never on the screen were drawn";
  worker.save(path("a.png"));
  worker.save(path("a.exr"));
  worker.save(path("a.gif"));
  std::vector<std::string> lines;
  while (lines.size() < 3 && std::chrono::steady_clock::now() < deadline) {
    for (const std::string& line : worker.status().saved) lines.push_back(line);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_NE(lines[2].find("unknown kind of file"), std::string::npos);
  EXPECT_EQ(image::readPng(path("a.png")).width, 96u);
  const std::vector<image::Layer> layers = image::readExr(path("a.exr"));
  EXPECT_GE(layers.size(), 8u);
}

}  // namespace radivox::viewer
