// Scenes and checks that the path tracer's tests share.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

#include "engine/scene/builtin_mesh.h"
#include "modules/reference/path_tracer.h"

namespace radivox::reference_test {

/// |value − exact| ≤ 3 standard errors (and float's own rounding), with an error small enough for that to mean something.
inline void expectWithin(double value, double standardError, double exact, const std::string& what, double largestError = 0.01) {
  EXPECT_LE(std::abs(value - exact), 3 * standardError + 1e-5 * std::abs(exact))
      << what << ": " << value << " ± " << standardError << ", exact " << exact;
  EXPECT_LE(standardError, largestError * std::abs(exact)) << what << ": too noisy to tell";
}

struct Mean {
  double value = 0, standardError = 0;
};
/// Over all pixels of one channel; pixels are independent.
inline Mean meanOf(const reference::Estimate& estimate, uint32_t channel = 0) {
  Mean mean;
  const size_t pixelCount = size_t{estimate.mean.width} * estimate.mean.height;
  for (size_t i = 0; i < pixelCount; ++i) {
    mean.value += static_cast<double>(estimate.mean.data[3 * i + channel]);
    mean.standardError += static_cast<double>(estimate.variance.data[3 * i + channel]);
  }
  mean.value /= static_cast<double>(pixelCount);
  mean.standardError = std::sqrt(mean.standardError) / static_cast<double>(pixelCount);
  return mean;
}

inline reference::ProbeValue probe(const scene::Scene& scene, const glm::dvec3& p, const glm::dvec3& n, uint32_t bounces, uint32_t spp) {
  const reference::PathTracer tracer(scene);
  const reference::ProbePoint point{glm::vec3(p - scene.origin), glm::vec3(n)};
  return tracer.probe({&point, 1}, {.bounces = bounces, .spp = spp}).front();
}

/// Looks along `forward` at a square of side 2 · half in front of `position`: with a square picture, exactly at it.
inline scene::CameraDescription lookAtSquare(const scene::Scene& scene, const glm::dvec3& position, const glm::dvec3& forward,
                                             const glm::dvec3& up, double half) {
  scene::CameraDescription camera;
  camera.position = glm::vec3(position - scene.origin);
  camera.orientation = scene::orientationFrom(forward, up);
  camera.orthographic = true;
  camera.ymag = static_cast<float>(half);
  camera.znear = 1e-3f;
  camera.zfar = 100.f;
  return camera;
}

/// [0, 1]³ seen from inside; materials of the faces −x +x −y +y −z +z.
inline void addCube(scene::MeshBuilder& mesh, const std::array<uint32_t, 6>& materials) {
  for (int axis = 0; axis < 3; ++axis) {
    for (int end = 0; end < 2; ++end) {
      const auto at = [&](double u, double v) {
        glm::dvec3 p;
        p[axis] = end;
        p[(axis + 1) % 3] = u;
        p[(axis + 2) % 3] = v;
        return p;
      };
      const uint32_t material = materials[static_cast<size_t>(2 * axis + end)];
      if (end == 0) mesh.addQuad(at(0, 0), at(1, 0), at(1, 1), at(0, 1), material);  // fronts inside
      if (end == 1) mesh.addQuad(at(0, 0), at(0, 1), at(1, 1), at(1, 0), material);
    }
  }
}

}  // namespace radivox::reference_test
