// Projection, camera lookup, the default view.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/constants.hpp>

#include "engine/scene/builtin.h"
#include "engine/scene/geometry.h"
#include "tests/gpu/expect_error.h"

namespace radivox::tests {
namespace {

using scene::CameraDescription;
using scene::makeCamera;

glm::dvec3 project(const shared::Camera& camera, const glm::dvec3& p) {
  const glm::dvec4 clip = glm::dmat4(camera.viewProjection) * glm::dvec4(p, 1.0);
  return glm::dvec3(clip) / clip.w;
}

CameraDescription lookAt(const glm::dvec3& from, const glm::dvec3& to) {
  CameraDescription camera;
  camera.position = glm::vec3(from);
  camera.orientation = scene::orientationFrom(to - from, {0, 1, 0});
  camera.yfov = 1.f;
  camera.znear = 0.01f;
  return camera;
}

TEST(CameraTest, ReversedInfiniteDepthAndYDown) {
  const shared::Camera camera = makeCamera(lookAt({0, 0, 5}, {0, 0, 0}), 200, 100);
  EXPECT_LT(glm::length(camera.forward - glm::vec3(0, 0, -1)), 1e-6f);
  const glm::dvec3 centre = project(camera, {0, 0, 0});
  EXPECT_NEAR(centre.x, 0, 1e-7);
  EXPECT_NEAR(centre.y, 0, 1e-7);
  EXPECT_NEAR(centre.z, 0.01 / 5, 1e-8);                    // near / distance
  EXPECT_NEAR(project(camera, {0, 0, 4.99}).z, 1.0, 1e-5);  // at the near plane
  EXPECT_GT(project(camera, {0, 0, -1e6}).z, 0.0);
  EXPECT_LT(project(camera, {0, 0, -1e6}).z, 1e-7);
  EXPECT_GT(project(camera, {1, 0, 0}).x, 0);  // right is right
  EXPECT_LT(project(camera, {0, 1, 0}).y, 0);  // up is −y
  const double top = 5 * std::tan(0.5);        // half the vertical field of view
  EXPECT_NEAR(project(camera, {0, top, 0}).y, -1, 1e-6);
  EXPECT_NEAR(project(camera, {2 * top, 0, 0}).x, 1, 1e-6);  // the aspect widens x
  EXPECT_NEAR(camera.pixelAngle, 2 * std::tan(0.5) / 100, 1e-8);
  EXPECT_EQ(camera.width, 200u);
  EXPECT_EQ(camera.height, 100u);
  EXPECT_EQ(camera.orthographic, 0u);
}

TEST(CameraTest, VerticalFieldOfViewHoldsAtAnyAspect) {
  const CameraDescription d = lookAt({1, 2, 3}, {4, 0, -2});
  for (const uint32_t width : {10u, 100u, 1000u}) EXPECT_EQ(makeCamera(d, width, 100).pixelAngle, makeCamera(d, 100, 100).pixelAngle);
}

TEST(CameraTest, InverseUndoesTheProjection) {
  for (const bool orthographic : {false, true}) {
    CameraDescription d = lookAt({10, -3, 7}, {-2, 5, 1});
    d.orthographic = orthographic;
    d.ymag = 3;
    d.zfar = 50;
    const shared::Camera camera = makeCamera(d, 640, 360);
    for (const glm::dvec3 p : {glm::dvec3(-2, 5, 1), glm::dvec3(0, 0, 0), glm::dvec3(3, 1, 2)}) {
      const glm::dvec4 back = glm::dmat4(camera.inverseViewProjection) * glm::dvec4(project(camera, p), 1.0);
      EXPECT_LT(glm::length(glm::dvec3(back) / back.w - p), 2e-4);
    }
  }
}

TEST(CameraTest, Orthographic) {
  CameraDescription d = lookAt({0, 0, 5}, {0, 0, 0});
  d.orthographic = true;
  d.ymag = 2;
  d.znear = 1;
  d.zfar = 11;
  const shared::Camera camera = makeCamera(d, 300, 100);
  EXPECT_EQ(camera.orthographic, 1u);
  EXPECT_NEAR(project(camera, {0, 0, 4}).z, 1, 1e-6);
  EXPECT_NEAR(project(camera, {0, 0, -6}).z, 0, 1e-6);
  EXPECT_NEAR(project(camera, {0, 2, 0}).y, -1, 1e-6);
  EXPECT_NEAR(project(camera, {6, 0, 0}).x, 1, 1e-6);
  EXPECT_NEAR(camera.pixelAngle, 4.0 / 100, 1e-7);
}

TEST(CameraTest, OrientationForAnyDirection) {
  for (const glm::dvec3 forward :
       {glm::dvec3(0, 1, 0), glm::dvec3(0, -1, 0), glm::dvec3(1, 0, 0), glm::dvec3(0.3, -0.99, 1e-12), glm::dvec3(0, 0, 2)}) {
    const glm::quat q = scene::orientationFrom(forward, {0, 1, 0});
    EXPECT_LT(glm::length(glm::dvec3(q * glm::vec3(0, 0, -1)) - glm::normalize(forward)), 1e-6);
    EXPECT_GE((q * glm::vec3(0, 1, 0)).y, -1e-6f);  // never upside down
    EXPECT_NEAR(glm::length(q), 1, 1e-6);
  }
}

TEST(CameraTest, DefaultViewHoldsTheWholeScene) {
  scene::Scene s = scene::makeBuiltin("two_rooms");
  const CameraDescription d = scene::makeDefaultCamera(s);
  for (const auto& [width, height] : {std::pair(640u, 360u), std::pair(300u, 300u)}) {
    const shared::Camera camera = makeCamera(d, width, height);
    for (const auto& vertex : s.vertices) {
      const glm::dvec3 p = project(camera, glm::dvec3(vertex.position));
      EXPECT_LE(std::abs(p.x), 1);
      EXPECT_LE(std::abs(p.y), 1);
      EXPECT_GT(p.z, 0);
      EXPECT_LT(p.z, 1);
    }
  }
}

TEST(CameraTest, LookupByNameOrIndex) {
  const scene::Scene s = scene::makeBuiltin("two_rooms");
  EXPECT_EQ(&scene::findCamera(s, "lit room"), &s.cameras[1]);
  EXPECT_EQ(&scene::findCamera(s, "0"), &s.cameras[0]);
  for (const char* wrong : {"2", "-1", "lit rom", "", "99999999999999999999", "1.0"}) {
    const Error error = catchError([&] { scene::findCamera(s, wrong); });
    expectError(error, ErrorCode::BadInput, "0 \"dark room\", 1 \"lit room\"");
  }
  expectError(catchError([&] { scene::findCamera(s, "lit rom"); }), ErrorCode::BadInput, "Did you mean \"lit room\"?");
}

}  // namespace
}  // namespace radivox::tests
