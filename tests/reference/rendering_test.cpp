// Pictures in the making: the same bits however the work is cut, variances that mean what they say, stopping, checkpoints, cameras.
#include <cstring>

#include "engine/error.h"
#include "modules/reference/path_tracer.h"
#include "tests/oracles/light_oracle.h"
#include "tests/reference/reference_fixture.h"

namespace radivox::reference_test {
namespace {

using reference::Images;
using reference::PathTracer;
using reference::Rendering;
using reference::Settings;

void expectSameBits(const Images& a, const Images& b) {
  EXPECT_EQ(a.samples, b.samples);
  for (const std::string& name : Images::names()) {
    const reference::Estimate &left = a.find(name), &right = b.find(name);
    ASSERT_EQ(left.mean.data.size(), right.mean.data.size());
    EXPECT_EQ(std::memcmp(left.mean.data.data(), right.mean.data.data(), left.mean.data.size() * 4), 0) << name;
    EXPECT_EQ(std::memcmp(left.variance.data.data(), right.variance.data.data(), left.variance.data.size() * 4), 0) << name;
  }
}

std::string messageOf(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::BadInput);
    return e.what();
  }
  return "no error";
}

class ReferenceRendering : public testing::Test {
 protected:
  scene::Scene scene = scene::loadScene("builtin:cornell");
  PathTracer tracer{scene};
  Settings settings{.width = 40, .height = 30, .bounces = 2, .spp = 32};
};

TEST_F(ReferenceRendering, SameBitsForAnyNumberOfThreads) {
  // Coplanar and overlapping triangles too: the atrium has them.
  const scene::Scene atrium = scene::loadScene("builtin:atrium?triangles=5000");
  Images first;
  for (const uint32_t threads : {1u, 2u, 5u}) {
    settings.threads = threads;
    const Images images = PathTracer(atrium).render(atrium.cameras[0], settings);
    if (threads == 1) first = images;
    expectSameBits(first, images);
  }
  std::vector<reference::ProbePoint> points;
  for (int i = 0; i < 50; ++i) points.push_back({{0.05f * static_cast<float>(i), 1.f, 0.f}, {0.f, 1.f, 0.f}});
  const auto one = PathTracer(atrium).probe(points, {.spp = 32, .threads = 1});
  const auto three = PathTracer(atrium).probe(points, {.spp = 32, .threads = 3});
  EXPECT_EQ(std::memcmp(one.data(), three.data(), one.size() * sizeof(one[0])), 0);
}

TEST_F(ReferenceRendering, ResumedIsAsUninterrupted) {
  const scene::CameraDescription& camera = scene.cameras[0];
  const Images whole = tracer.render(camera, settings);
  Rendering before(tracer, camera, settings);
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(before.advance());
  const std::string state = before.checkpoint();

  const PathTracer again(scene);
  Rendering after(again, camera, settings);
  after.resume(state, "file");
  EXPECT_EQ(after.passes(), 3u);
  EXPECT_DOUBLE_EQ(after.seconds(), before.seconds());
  // A pass that is given up halfway leaves nothing behind.
  int asked = 0;
  EXPECT_FALSE(after.advance({{}, [&] { return ++asked > 2; }}));
  EXPECT_EQ(after.checkpoint(), state);
  while (!after.isDone()) after.advance();
  expectSameBits(whole, after.images());

  // More samples than first asked for: as if asked for from the start, with the passes of the first.
  settings.spp = 64;
  settings.samplesPerPass = 8;
  const Images longer = tracer.render(camera, settings);
  settings.samplesPerPass = 0;
  Rendering extended(tracer, camera, settings);
  extended.resume(state, "file");
  while (!extended.isDone()) extended.advance();
  expectSameBits(longer, extended.images());
}

TEST_F(ReferenceRendering, CheckpointsOfSomethingElseAreRefused) {
  Rendering rendering(tracer, scene.cameras[0], settings);
  rendering.advance();
  const std::string state = rendering.checkpoint();
  const auto resume = [&](const PathTracer& with, const scene::CameraDescription& camera, const Settings& how, const std::string& from) {
    return messageOf([&] { Rendering(with, camera, how).resume(from, "a.ckpt"); });
  };
  EXPECT_EQ(resume(tracer, scene.cameras[0], settings, state), "no error");
  const auto changed = [&](auto change) {
    Settings other = settings;
    change(other);
    return resume(tracer, scene.cameras[0], other, state);
  };
  EXPECT_NE(changed([](Settings& s) { s.width = 41; }).find("width 40, not 41"), std::string::npos);
  EXPECT_NE(changed([](Settings& s) { s.height = 31; }).find("height 30, not 31"), std::string::npos);
  EXPECT_NE(changed([](Settings& s) { s.bounces = scene::kAllBounces; }).find("bounces 2, not all"), std::string::npos);
  EXPECT_NE(changed([](Settings& s) { s.seed = 4; }).find("seed 0, not 4"), std::string::npos);
  EXPECT_NE(changed([](Settings& s) { s.samplesPerPass = 4; }).find("samplesPerPass 8, not 4"), std::string::npos);
  scene::CameraDescription camera = scene.cameras[0];
  camera.position.x += 0.1f;
  EXPECT_NE(resume(tracer, camera, settings, state).find("another camera"), std::string::npos);
  scene::Scene other = scene;
  other.skyRadiance = glm::vec3(0.1f);
  EXPECT_NE(resume(PathTracer(other), scene.cameras[0], settings, state).find("another scene"), std::string::npos);
  EXPECT_NE(resume(tracer, scene.cameras[0], settings, state.substr(0, state.size() - 1)).find("damaged"), std::string::npos);
  std::string flipped = state;
  flipped[state.size() / 2] = static_cast<char>(flipped[state.size() / 2] ^ 1);
  EXPECT_NE(resume(tracer, scene.cameras[0], settings, flipped).find("a.ckpt: damaged"), std::string::npos);
  EXPECT_NE(resume(tracer, scene.cameras[0], settings, "hello").find("not a checkpoint"), std::string::npos);
  EXPECT_NE(resume(tracer, scene.cameras[0], settings, "").find("not a checkpoint"), std::string::npos);
}

TEST_F(ReferenceRendering, VariancesAreThoseOfTheMeans) {
  // Two halves and another seed: differences over their errors have unit variance. With stratified samples a variance from single
  // samples would be too large; from passes it is not.
  settings.spp = 256;
  Rendering rendering(tracer, scene.cameras[0], settings);
  while (!rendering.isDone()) rendering.advance();
  settings.seed = 1;
  const Images other = tracer.render(scene.cameras[0], settings);
  const Images whole = rendering.images(), a = rendering.half(0), b = rendering.half(1);
  EXPECT_EQ(a.samples, 128u);
  EXPECT_EQ(a.samples + b.samples, whole.samples);
  EXPECT_NEAR(a.seconds + b.seconds, whole.seconds, 1e-9);
  const auto spread = [](const reference::Estimate& l, const reference::Estimate& r) {
    double squares = 0, variances = 0;
    for (size_t i = 0; i < l.mean.data.size(); ++i) {
      squares += std::pow(static_cast<double>(l.mean.data[i] - r.mean.data[i]), 2);
      variances += static_cast<double>(l.variance.data[i] + r.variance.data[i]);
    }
    return squares / variances;
  };
  // Not color: the few pixels on the lamp's edge would be all that counts.
  for (const char* name : {"direct", "indirect", "irradiance_direct", "irradiance_indirect"}) {
    EXPECT_NEAR(spread(a.find(name), b.find(name)), 1.0, 0.15) << name;
    EXPECT_NEAR(spread(whole.find(name), other.find(name)), 1.0, 0.15) << name;
  }
  for (size_t i = 0; i < whole.color.mean.data.size(); ++i) {
    EXPECT_NEAR(whole.color.mean.data[i], 0.5f * (a.color.mean.data[i] + b.color.mean.data[i]), 1e-4f * whole.color.mean.data[i] + 1e-6f);
  }
  EXPECT_NE(messageOf([&] { rendering.half(2); }), "no error");
}

TEST_F(ReferenceRendering, PartsAddUp) {
  const Images images = tracer.render(scene.cameras[0], settings);
  bool sawLamp = false;
  for (size_t i = 0; i < images.color.mean.data.size(); ++i) {
    const float emission = images.color.mean.data[i] - images.direct.mean.data[i] - images.indirect.mean.data[i];
    EXPECT_GT(emission, -1e-4f);
    sawLamp = sawLamp || emission > 10.f;
  }
  EXPECT_TRUE(sawLamp);
  EXPECT_EQ(&images.find("irradiance_direct"), &images.irradianceDirect);
  EXPECT_NE(messageOf([&] { images.find("colour"); }).find("\"color\""), std::string::npos);
}

// Also where a pixel holds two albedos, or surface and nothing.
TEST_F(ReferenceRendering, IrradianceTimesAlbedoIsTheLightReflected) {
  settings.spp = 16;
  scene.cameras[0].yfov *= 1.5f;  // beyond the box there is nothing
  const Images images = tracer.render(scene.cameras[0], settings);
  size_t edges = 0;
  for (size_t i = 0; i < images.albedo.mean.data.size(); ++i) {
    const float albedo = images.albedo.mean.data[i] / 3.14159265f;
    EXPECT_NEAR(images.irradianceDirect.mean.data[i] * albedo, images.direct.mean.data[i], 1e-5f * images.direct.mean.data[i]);
    EXPECT_NEAR(images.irradianceIndirect.mean.data[i] * albedo, images.indirect.mean.data[i], 1e-5f * images.indirect.mean.data[i]);
    if (images.albedo.variance.data[i] > 0.f) ++edges;
  }
  EXPECT_GT(edges, 30u);
}

TEST_F(ReferenceRendering, OnePassKnowsNoVariance) {
  settings.spp = 1;
  Rendering rendering(tracer, scene.cameras[0], settings);
  rendering.advance();
  EXPECT_TRUE(rendering.isDone());
  EXPECT_TRUE(std::isinf(rendering.images().color.variance.data[0]));
  EXPECT_TRUE(std::isinf(reference::relativeError(rendering.images().color)));
  EXPECT_NE(messageOf([&] { rendering.half(0); }).find("two passes"), std::string::npos);
}

TEST_F(ReferenceRendering, StopsAtTheTargetOrTheTimeLimit) {
  settings.spp = 4096;
  settings.samplesPerPass = 8;
  settings.targetError = 0.2;
  const Images images = tracer.render(scene.cameras[0], settings);
  EXPECT_LT(images.samples, 4096u);
  EXPECT_LE(reference::relativeError(images.color), 0.2);
  // Half the target takes about four times the samples.
  settings.targetError = 0.1;
  const Images finer = tracer.render(scene.cameras[0], settings);
  EXPECT_NEAR(static_cast<double>(finer.samples) / images.samples, 4.0, 1.5);

  settings.targetError = 0;
  settings.spp = 1u << 20;
  settings.timeLimitSeconds = 0.2;
  const Images timed = tracer.render(scene.cameras[0], settings);
  EXPECT_GT(timed.samples, 0u);
  EXPECT_LT(timed.seconds, 1.0);
}

TEST_F(ReferenceRendering, ProgressAndCancelling) {
  double last = 0;
  tracer.render(scene.cameras[0], settings,
                {[&](double fraction) {
                   EXPECT_GE(fraction, 0.0);
                   EXPECT_LE(fraction, 1.0);
                   last = std::max(last, fraction);
                 },
                 {}});
  EXPECT_GT(last, 0.7);
  EXPECT_EQ(messageOf([&] { tracer.render(scene.cameras[0], settings, {{}, [] { return true; }}); }), "interrupted");
  const reference::ProbePoint point{};
  EXPECT_EQ(messageOf([&] { tracer.probe({&point, 1}, {}, {{}, [] { return true; }}); }), "interrupted");
}

TEST_F(ReferenceRendering, BadSettingsAreRefused) {
  const auto messageWith = [&](auto change) {
    Settings other = settings;
    change(other);
    return messageOf([&] { Rendering(tracer, scene.cameras[0], other); });
  };
  EXPECT_NE(messageWith([](Settings& s) { s.width = 0; }).find("1x1"), std::string::npos);
  EXPECT_NE(messageWith([](Settings& s) { s.spp = 0; }).find("at least 1"), std::string::npos);
  EXPECT_NE(messageWith([](Settings& s) { s.samplesPerPass = 12; }).find("power of two"), std::string::npos);
  const reference::ProbePoint flat{{0.f, 0.f, 0.f}, {0.f, 0.f, 0.f}};
  EXPECT_NE(messageOf([&] { tracer.probe({&flat, 1}, {}); }).find("point 0"), std::string::npos);
  EXPECT_NE(messageOf([&] { tracer.probe({&flat, 1}, {.spp = 1}); }).find("at least 2"), std::string::npos);
}

TEST_F(ReferenceRendering, PixelsAreBoxesOfTheCamerasPicture) {
  // Mean albedo of each pixel by rays from the camera's definition.
  for (const bool orthographic : {false, true}) {
    scene::CameraDescription camera = scene.cameras[0];
    camera.orthographic = orthographic;
    camera.ymag = 3.f;
    camera.orientation = glm::normalize(camera.orientation * glm::quat(0.99f, 0.05f, 0.03f, 0.08f));
    const Images images = tracer.render(camera, {.width = 12, .height = 8, .bounces = 0, .spp = 256});
    const oracles::LightOracle oracle(scene);
    for (uint32_t y = 0; y < 8; ++y) {
      for (uint32_t x = 0; x < 12; ++x) {
        glm::dvec3 exact(0.0);
        for (int k = 0; k < 256; ++k) {
          glm::dvec3 origin, direction;
          oracles::LightOracle::cameraRay(camera, 12, 8, x + (k % 16 + 0.5) / 16, y + (k / 16 + 0.5) / 16, origin, direction);
          const auto hit = oracle.castRay(origin, direction);
          if (hit) exact += glm::dvec3(scene.materials[scene.triangleMaterials[hit->triangle]].albedo) / 256.0;
        }
        for (uint32_t c = 0; c < 3; ++c) EXPECT_NEAR(images.albedo.mean.at(x, y, c), exact[static_cast<glm::length_t>(c)], 0.035);
      }
    }
  }
}

TEST_F(ReferenceRendering, ScenesWithoutAnything) {
  const scene::Scene empty = scene::loadScene("builtin:empty");
  const Images images = PathTracer(empty).render(empty.cameras[0], {.width = 4, .height = 4, .spp = 4});
  for (size_t c = 0; c < 3; ++c) EXPECT_EQ(images.color.mean.data[c], empty.skyRadiance[static_cast<glm::length_t>(c)]);
  EXPECT_EQ(images.albedo.mean.data[0], 0.f);
}

}  // namespace
}  // namespace radivox::reference_test
