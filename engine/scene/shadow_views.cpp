// Projections of shadow views, and their place in the layers.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/scene/geometry.h"
#include "engine/scene/light_setup.h"

namespace radivox::scene {

namespace {

/// Beyond this half angle one flat view of a spot light wastes too many texels on its rim.
constexpr double kMaxSingleViewAngle = 1.0472;
/// Blockers nearer to a light than this share of the scene's diagonal cast no shadow.
constexpr double kNearShare = 1e-4;

struct Axes {
  glm::dvec3 right, up;
};

/// A frame around `forward` that depends on nothing else.
Axes axesAround(const glm::dvec3& forward) {
  const glm::dvec3 a = glm::abs(forward);
  // The world axis that is farthest from the view; ties go to the first.
  const glm::dvec3 hint = a.y <= a.x && a.y <= a.z ? glm::dvec3(0, 1, 0) : a.x <= a.z ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 0, 1);
  const glm::dvec3 right = glm::normalize(glm::cross(forward, hint));
  return {right, glm::cross(right, forward)};
}

shared::ShadowView makeView(const glm::dmat4& projection, const glm::dvec3& position, const glm::dvec3& forward, const Axes& axes) {
  const glm::dmat3 frame(axes.right, axes.up, -forward);
  glm::dmat4 view(glm::transpose(frame));
  view[3] = glm::dvec4(-(glm::transpose(frame) * position), 1.0);
  glm::dmat4 viewInverse(frame);
  viewInverse[3] = glm::dvec4(position, 1.0);
  shared::ShadowView out{};
  out.viewProjection = glm::mat4(projection * view);
  out.inverseViewProjection = glm::mat4(viewInverse * glm::inverse(projection));
  out.origin = glm::vec3(position);
  return out;
}

glm::dvec3 unitAxis(int axis, double sign) {
  glm::dvec3 v(0.0);
  v[axis] = sign;
  return v;
}

}  // namespace

shared::ShadowView makePerspectiveView(const glm::dvec3& position, const glm::dvec3& forward, const glm::dvec3& up, double tangent,
                                       double znear, uint32_t resolution) {
  glm::dmat4 projection(0.0);
  projection[0][0] = 1.0 / tangent;
  projection[1][1] = -1.0 / tangent;
  projection[2][3] = -1.0;
  projection[3][2] = znear;
  shared::ShadowView view = makeView(projection, position, forward, {glm::cross(forward, up), up});
  view.texelFlux = static_cast<float>(std::pow(2.0 * tangent / resolution, 2));
  view.resolution = resolution;
  return view;
}

shared::ShadowView makeParallelView(const Scene& scene, const glm::dvec3& direction, uint32_t resolution) {
  const Axes axes = axesAround(direction);
  glm::dvec3 min(std::numeric_limits<double>::max()), max(std::numeric_limits<double>::lowest());
  for (const shared::Vertex& vertex : scene.vertices) {
    const glm::dvec3 p(vertex.position);
    const glm::dvec3 q(glm::dot(p, axes.right), glm::dot(p, axes.up), glm::dot(p, direction));
    min = glm::min(min, q);
    max = glm::max(max, q);
  }
  const glm::dvec3 centre = (min + max) * 0.5, extent = max - min;
  const double diagonal = glm::length(extent);
  // Texels are square; the outermost half texels are margin, so that what lies on the bounds is inside the map.
  double side = std::max({extent.x, extent.y, 1e-6 * diagonal});
  side *= static_cast<double>(resolution) / (resolution - 1.0);
  const double depthMargin = 1e-3 * diagonal;
  const double range = extent.z + 2 * depthMargin;
  glm::dmat4 projection(1.0);
  projection[0][0] = 2.0 / side;
  projection[1][1] = -2.0 / side;
  projection[2][2] = 1.0 / range;
  projection[3][2] = 1.0;
  const glm::dvec3 eye = axes.right * centre.x + axes.up * centre.y + direction * (min.z - depthMargin);
  shared::ShadowView view = makeView(projection, eye, direction, axes);
  view.texelFlux = static_cast<float>(std::pow(side / resolution, 2));
  view.resolution = resolution;
  return view;
}

uint32_t viewCountOf(const shared::Light& light) {
  switch (light.type) {
    case shared::kLightDirectional:
      return 1;
    case shared::kLightPoint:
      return 6;
    case shared::kLightSpot:
      return std::acos(static_cast<double>(light.cosOuter)) <= kMaxSingleViewAngle ? 1 : 5;
    default:
      return 5;
  }
}

uint32_t viewResolutionOf(const shared::Light& light, const ViewResolutions& resolutions, uint32_t view) {
  switch (light.type) {
    case shared::kLightDirectional:
      return resolutions.directional;
    case shared::kLightPoint:
      return resolutions.point;
    case shared::kLightSpot:
      return viewCountOf(light) == 1 ? resolutions.spot : resolutions.point;
    // Sides of an emitter sample: half of each lies behind the emitter, the other half gets little by the cosine.
    default:
      return view == 0 ? resolutions.emitter : std::max(resolutions.emitter / 2, 1u);
  }
}

void appendViews(const Scene& scene, const Traits& traits, const ViewResolutions& resolutions, uint32_t lightIndex, shared::Light& light,
                 std::vector<shared::ShadowView>& views) {
  light.firstShadowView = static_cast<uint32_t>(views.size());
  light.shadowViewCount = viewCountOf(light);
  const double znear = kNearShare * glm::length(glm::dvec3(traits.boundsMax) - glm::dvec3(traits.boundsMin));
  const glm::dvec3 position(light.position), direction(glm::normalize(glm::dvec3(light.direction)));
  const Axes axes = axesAround(direction);
  for (uint32_t i = 0; i < light.shadowViewCount; ++i) {
    const uint32_t resolution = viewResolutionOf(light, resolutions, i);
    if (light.type == shared::kLightDirectional) {
      views.push_back(makeParallelView(scene, direction, resolution));
    } else if (light.type == shared::kLightPoint) {
      const int axis = static_cast<int>(i / 2);
      views.push_back(
          makePerspectiveView(position, unitAxis(axis, i % 2 == 0 ? 1.0 : -1.0), unitAxis((axis + 1) % 3, 1.0), 1.0, znear, resolution));
    } else if (light.shadowViewCount == 1) {
      const double outer = std::acos(static_cast<double>(light.cosOuter));
      views.push_back(makePerspectiveView(position, direction, axes.up, std::tan(outer), znear, resolution));
    } else {
      // A cube along the axis without its back; all in one frame, so that faces meet edge to edge.
      const glm::dvec3 faces[5] = {direction, axes.right, -axes.right, axes.up, -axes.up};
      const glm::dvec3 ups[5] = {axes.up, axes.up, axes.up, direction, direction};
      views.push_back(makePerspectiveView(position, faces[i], ups[i], 1.0, znear, resolution));
    }
    views.back().light = lightIndex;
  }
}

uint32_t packTiles(std::vector<shared::ShadowView>& views, uint32_t side) {
  std::vector<uint32_t> order(views.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return views[a].resolution > views[b].resolution; });
  uint32_t layer = 0, x = 0, y = 0, rowHeight = 0;
  for (const uint32_t i : order) {
    const uint32_t size = views[i].resolution;
    if (x + size > side) {
      x = 0;
      y += rowHeight;
      rowHeight = 0;
    }
    if (y + size > side) {
      ++layer;
      x = y = rowHeight = 0;
    }
    views[i].layer = layer;
    views[i].offsetX = x;
    views[i].offsetY = y;
    x += size;
    rowHeight = std::max(rowHeight, size);
  }
  return layer + 1;
}

uint32_t chooseLayerSide(const std::vector<shared::ShadowView>& views, uint32_t maxSide) {
  uint64_t texels = 0;
  uint32_t largest = 1;
  for (const shared::ShadowView& view : views) {
    texels += static_cast<uint64_t>(view.resolution) * view.resolution;
    largest = std::max(largest, view.resolution);
  }
  constexpr uint64_t kUsualSide = 2048;
  uint64_t side = 1;
  while (side < kUsualSide && side * side < texels) side *= 2;
  return std::max(largest, static_cast<uint32_t>(std::min<uint64_t>(side, maxSide)));
}

}  // namespace radivox::scene
