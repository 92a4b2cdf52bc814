#include "engine/scene/atrium_parts.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

namespace radivox::scene {

namespace {

constexpr double kPi = glm::pi<double>();

/// The same few values everywhere: a hash of two integers.
uint32_t hashPlace(uint32_t x, uint32_t y) {
  uint32_t h = x * 0x9e3779b1u ^ (y + 0x7f4a7c15u) * 0x85ebca6bu;
  h = (h ^ h >> 15) * 0x2c1b3c6du;
  h = (h ^ h >> 12) * 0x297a2d39u;
  return h ^ h >> 15;
}

}  // namespace

void addFrameBox(MeshBuilder& mesh, const WallFrame& f, const glm::dvec3& lo, const glm::dvec3& hi, uint32_t material) {
  mesh.addQuad(f.at(lo.x, lo.y, hi.z), f.at(hi.x, lo.y, hi.z), f.at(hi.x, hi.y, hi.z), f.at(lo.x, hi.y, hi.z), material);
  mesh.addQuad(f.at(hi.x, lo.y, lo.z), f.at(lo.x, lo.y, lo.z), f.at(lo.x, hi.y, lo.z), f.at(hi.x, hi.y, lo.z), material);
  mesh.addQuad(f.at(hi.x, lo.y, hi.z), f.at(hi.x, lo.y, lo.z), f.at(hi.x, hi.y, lo.z), f.at(hi.x, hi.y, hi.z), material);
  mesh.addQuad(f.at(lo.x, lo.y, lo.z), f.at(lo.x, lo.y, hi.z), f.at(lo.x, hi.y, hi.z), f.at(lo.x, hi.y, lo.z), material);
  mesh.addQuad(f.at(lo.x, hi.y, hi.z), f.at(hi.x, hi.y, hi.z), f.at(hi.x, hi.y, lo.z), f.at(lo.x, hi.y, lo.z), material);
  mesh.addQuad(f.at(lo.x, lo.y, lo.z), f.at(hi.x, lo.y, lo.z), f.at(hi.x, lo.y, hi.z), f.at(lo.x, lo.y, hi.z), material);
}

void addArchPanel(MeshBuilder& mesh, const WallFrame& f, double s0, double s1, double spring, double top, double radius, double thickness,
                  const AtriumDetail& detail, uint32_t material) {
  const uint32_t n = detail.segments(16, 4);
  const double centre = 0.5 * (s0 + s1), half = 0.5 * thickness;
  std::vector<glm::dvec2> line;  // lower border of the wall: pier, arch, pier
  line.emplace_back(s0, spring);
  for (uint32_t i = 0; i <= n; ++i) {
    const double a = kPi * (1.0 - static_cast<double>(i) / n);
    // Ends exactly at the springing, whatever the sine of π is.
    line.emplace_back(centre + radius * std::cos(a), i == 0 || i == n ? spring : spring + radius * std::sin(a));
  }
  line.emplace_back(s1, spring);
  for (size_t i = 0; i + 1 < line.size(); ++i) {
    const glm::dvec2 a = line[i], b = line[i + 1];
    mesh.addQuad(f.at(a.x, a.y, half), f.at(b.x, b.y, half), f.at(b.x, top, half), f.at(a.x, top, half), material);
    mesh.addQuad(f.at(b.x, b.y, -half), f.at(a.x, a.y, -half), f.at(a.x, top, -half), f.at(b.x, top, -half), material);
  }
  for (const auto& [a, b] : {std::pair(s0, centre - radius), std::pair(centre + radius, s1)}) {
    mesh.addQuad(f.at(a, spring, -half), f.at(b, spring, -half), f.at(b, spring, half), f.at(a, spring, half), material);
  }
  const auto soffit = [&](double u, double v) {
    const double a = kPi * (1.0 - u);
    return f.at(centre + radius * std::cos(a), spring + radius * std::sin(a), thickness * (v - 0.5));
  };
  mesh.addSurface(soffit, n, 1, material, true);
}

void addArchivolt(MeshBuilder& mesh, const WallFrame& f, double centre, double spring, double radius, double wallFace,
                  const AtriumDetail& detail, uint32_t material) {
  constexpr double kWidth = 0.2, kRaise = 0.06;
  const uint32_t n = detail.segments(16, 4);
  const auto ring = [&](double u, double r, double d) {
    const double a = kPi * (1.0 - u);
    return f.at(centre + r * std::cos(a), spring + r * std::sin(a), d);
  };
  const double front = wallFace + kRaise;
  mesh.addSurface([&](double u, double v) { return ring(u, radius + kWidth * v, front); }, n, 1, material, true);
  mesh.addSurface([&](double u, double v) { return ring(u, radius, wallFace + kRaise * v); }, n, 1, material, true);
  mesh.addSurface([&](double u, double v) { return ring(u, radius + kWidth, front - kRaise * v); }, n, 1, material, true);
}

void addLathe(MeshBuilder& mesh, const glm::dvec3& foot, const Profile& profile, uint32_t around, uint32_t along, uint32_t material) {
  const auto surface = [&](double u, double v) {
    const glm::dvec2 p = profile(v);
    // The seam closes exactly.
    const double a = u >= 1.0 ? 0.0 : 2.0 * kPi * u;
    return foot + glm::dvec3(p.x * std::sin(a), p.y, p.x * std::cos(a));
  };
  mesh.addSurface(surface, around, along, material, true);
}

void addColumn(MeshBuilder& mesh, const glm::dvec3& foot, double height, double radius, const AtriumDetail& detail, uint32_t shaft,
               uint32_t trim) {
  const double plinth = 0.45 * radius, abacus = 0.5 * radius, side = 2.9 * radius;
  if (!detail.roundColumns) {
    mesh.addBlock(foot + glm::dvec3(0, height / 2, 0), {2 * radius, height, 2 * radius}, 0, shaft);
    return;
  }
  mesh.addBlock(foot + glm::dvec3(0, plinth / 2, 0), {side, plinth, side}, 0, trim);
  mesh.addBlock(foot + glm::dvec3(0, height - abacus / 2, 0), {side, abacus, side}, 0, trim);
  const uint32_t around = detail.segments(18, 6);
  const double base = 0.55 * radius, capital = 1.0 * radius;
  const double shaftLow = plinth + base, shaftHigh = height - abacus - capital;
  // Base: a torus that ends at the shaft.
  addLathe(
      mesh, foot,
      [&](double t) {
        const double a = kPi * (t - 0.5);
        return glm::dvec2(radius * (1.0 + 0.38 * std::cos(a)), plinth + base * (0.5 + 0.5 * std::sin(a)));
      },
      around, detail.segments(5, 2), trim);
  addLathe(
      mesh, foot,
      [&](double t) {
        const double taper = 1.0 - 0.16 * t * t;
        return glm::dvec2(radius * taper, shaftLow + (shaftHigh - shaftLow) * t);
      },
      around, detail.segments(5, 1), shaft);
  // Capital: a necking ring, then a bell that opens to the abacus.
  addLathe(
      mesh, foot,
      [&](double t) {
        const double bell = 0.835 + 0.5 * t * t * (1.6 - 0.6 * t);
        const double ring = 0.1 * std::exp(-std::pow((t - 0.12) / 0.07, 2));
        return glm::dvec2(radius * (bell + ring), shaftHigh + capital * t);
      },
      around, detail.segments(7, 2), trim);
}

void addBaluster(MeshBuilder& mesh, const glm::dvec3& foot, double height, double radius, const AtriumDetail& detail, uint32_t material) {
  addLathe(
      mesh, foot,
      [&](double t) {
        const double belly = 0.45 + 0.55 * std::pow(std::sin(kPi * std::pow(t, 0.62)), 2);
        const double ends = 0.45 * (std::exp(-t * t / 0.004) + std::exp(-(1 - t) * (1 - t) / 0.004));
        return glm::dvec2(radius * std::min(1.0, belly + ends), height * t);
      },
      detail.segments(8, 4), detail.segments(7, 2), material);
}

void addUrn(MeshBuilder& mesh, const glm::dvec3& foot, const AtriumDetail& detail, uint32_t stone, uint32_t leaves) {
  const uint32_t around = detail.segments(16, 6);
  mesh.addBlock(foot + glm::dvec3(0, 0.2, 0), {0.7, 0.4, 0.7}, 0, stone);
  addLathe(
      mesh, foot + glm::dvec3(0, 0.4, 0),
      [&](double t) {
        const double bowl = 0.1 + 0.36 * std::pow(std::max(0.0, t - 0.18) / 0.82, 0.55);
        const double base = 0.16 * std::exp(-t * t / 0.006);
        return glm::dvec2(std::max(bowl, base + 0.1), 0.75 * t);
      },
      around, detail.segments(9, 3), stone);
  // A clipped shrub: a ball with bumps.
  const auto bumpy = [](const glm::dvec3& d) {
    return 0.52 * (1.0 + 0.05 * std::sin(7 * d.x + 1) * std::cos(8 * d.y) + 0.04 * std::cos(11 * d.z + 6 * d.y) +
                   0.02 * std::sin(17 * d.x - 13 * d.z));
  };
  addBall(mesh, foot + glm::dvec3(0, 1.45, 0), bumpy, detail.segments(7, 3), false, leaves);
}

void addFountain(MeshBuilder& mesh, const glm::dvec3& foot, const AtriumDetail& detail, uint32_t stone, uint32_t water) {
  const uint32_t around = detail.segments(32, 8);
  const auto line = [](glm::dvec2 a, glm::dvec2 b) { return [a, b](double t) { return a + (b - a) * t; }; };
  // Basin: outside, rim, inside; water; then a stem with a bowl.
  addLathe(mesh, foot, line({2.0, 0.0}, {1.97, 0.5}), around, 1, stone);
  addLathe(
      mesh, foot,
      [](double t) {
        const double a = kPi * t;
        return glm::dvec2(1.85 + 0.12 * std::cos(a), 0.5 + 0.12 * std::sin(a));
      },
      around, detail.segments(6, 2), stone);
  addLathe(mesh, foot, line({1.73, 0.5}, {1.73, 0.0}), around, 1, stone);
  addLathe(mesh, foot, line({1.73, 0.42}, {0.001, 0.42}), around, detail.segments(2, 1), water);
  addLathe(
      mesh, foot, [](double t) { return glm::dvec2(0.16 + 0.16 * std::pow(2 * t - 1, 2), 0.3 + 1.0 * t); }, around, detail.segments(8, 2),
      stone);
  addLathe(
      mesh, foot, [](double t) { return glm::dvec2(0.3 + 0.65 * std::sqrt(t), 1.28 + 0.3 * t * t); }, around, detail.segments(6, 2), stone);
  addLathe(mesh, foot, line({0.95, 1.58}, {0.88, 1.58}), around, 1, stone);
  addLathe(
      mesh, foot, [](double t) { return glm::dvec2(0.88 - 0.6 * t, 1.58 - 0.18 * t); }, around, detail.segments(3, 1), stone);
  addLathe(mesh, foot, line({0.72, 1.53}, {0.001, 1.53}), around, 1, water);
}

void addVault(MeshBuilder& mesh, const glm::dvec2& lo, const glm::dvec2& hi, double spring, double rise, const AtriumDetail& detail,
              uint32_t material) {
  if (!detail.vaults) {
    const double y = spring + rise;
    mesh.addQuad({lo.x, y, lo.y}, {hi.x, y, lo.y}, {hi.x, y, hi.y}, {lo.x, y, hi.y}, material);
    return;
  }
  const uint32_t n = 2 * detail.segments(4, 2);
  const glm::dvec2 centre = 0.5 * (lo + hi), half = 0.5 * (hi - lo);
  // Equal angles, so that the barrels are evenly cut and meet along grid diagonals.
  const auto coordinate = [&](uint32_t i) { return i == n / 2 ? 0.0 : std::sin(kPi * (static_cast<double>(i) / n - 0.5)); };
  struct Point {
    double x, z;
  };
  const auto heightOf = [](double c) { return std::sqrt(std::max(0.0, 1.0 - c * c)); };
  const auto place = [&](const Point& p) {
    const double y = spring + rise * std::max(heightOf(p.x), heightOf(p.z));
    return glm::dvec3(centre.x + half.x * p.x, y, centre.y + half.y * p.z);
  };
  // Of the barrel that rules at `inside`: along x where |z| is the smaller.
  const auto normalAt = [&](const Point& p, const Point& inside) {
    const bool alongX = std::abs(inside.z) < std::abs(inside.x);
    const double c = alongX ? p.z : p.x;
    const glm::dvec3 down(alongX ? 0.0 : -c / half.x, -heightOf(c) / rise, alongX ? -c / half.y : 0.0);
    return glm::normalize(down);
  };
  const auto triangle = [&](const Point& a, const Point& b, const Point& c) {
    const Point inside{(a.x + b.x + c.x) / 3, (a.z + b.z + c.z) / 3};
    const glm::dvec3 corners[3] = {place(a), place(b), place(c)};
    const glm::dvec3 normals[3] = {normalAt(a, inside), normalAt(b, inside), normalAt(c, inside)};
    mesh.addTriangle(corners, normals, material);
  };
  for (uint32_t j = 0; j < n; ++j) {
    for (uint32_t i = 0; i < n; ++i) {
      const Point a{coordinate(i), coordinate(j)}, b{coordinate(i + 1), coordinate(j)}, c{coordinate(i + 1), coordinate(j + 1)},
          d{coordinate(i), coordinate(j + 1)};
      if ((i < n / 2) == (j < n / 2)) {
        triangle(a, b, c);
        triangle(a, c, d);
      } else {
        triangle(a, b, d);
        triangle(b, c, d);
      }
    }
  }
}

void addCurtain(MeshBuilder& mesh, const WallFrame& f, double s0, double s1, double bottom, double top, double d, double folds,
                double depth, const AtriumDetail& detail, uint32_t material) {
  const auto sheet = [&](double u, double v) {
    const double drop = 1.0 - v;  // 0 at the rod
    const double fold = std::sin(2 * kPi * folds * u) + 0.35 * std::sin(2 * kPi * (folds * 0.53) * u + 1.0);
    const double hem = 0.04 * std::sin(2 * kPi * folds * u + 0.7) * drop;
    return f.at(s0 + (s1 - s0) * u, bottom + (top - bottom) * v + hem, d + depth * fold * (0.35 + 0.65 * drop));
  };
  mesh.addSurface(sheet, detail.segments(7 * folds, 6), detail.segments(8, 2), material, true);
}

void addPaving(MeshBuilder& mesh, const glm::dvec2& lo, const glm::dvec2& hi, double y, double slab, const AtriumDetail& detail,
               const std::vector<uint32_t>& materials) {
  const auto count = [&](double length) { return std::max(1u, static_cast<uint32_t>(std::lround(length / slab))); };
  const uint32_t columns = count(hi.x - lo.x), rows = count(hi.y - lo.y), parts = detail.segments(1, 1);
  const auto xs = evenly(lo.x, hi.x, columns), zs = evenly(lo.y, hi.y, rows);
  for (uint32_t j = 0; j < rows; ++j) {
    for (uint32_t i = 0; i < columns; ++i) {
      const uint32_t material = materials[hashPlace(i, j) % materials.size()];
      const auto point = [&](double u, double v) {
        return glm::dvec3(xs[i] + (xs[i + 1] - xs[i]) * u, y, zs[j + 1] + (zs[j] - zs[j + 1]) * v);
      };
      mesh.addSurface(point, parts, parts, material, true);
    }
  }
}

}  // namespace radivox::scene
