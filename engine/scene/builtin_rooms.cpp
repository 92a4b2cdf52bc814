// Built-in scenes with walls around.
#include <glm/gtc/constants.hpp>

#include "engine/scene/builtin_mesh.h"

namespace radivox::scene {

namespace {

constexpr glm::vec3 kWhite(0.73f, 0.72f, 0.69f);

glm::vec3 grey(double albedo) { return glm::vec3(static_cast<float>(albedo)); }

}  // namespace

void buildCornell(MeshBuilder& mesh, BuiltinParameters&, bool pointLight) {
  constexpr double kSide = 5.5;
  const uint32_t white = mesh.addMaterial("white", kWhite);
  const uint32_t red = mesh.addMaterial("red", {0.62f, 0.06f, 0.05f});
  const uint32_t green = mesh.addMaterial("green", {0.12f, 0.46f, 0.10f});
  const glm::dvec3 p[8] = {{0, 0, 0},     {kSide, 0, 0},     {kSide, kSide, 0},     {0, kSide, 0},
                           {0, 0, kSide}, {kSide, 0, kSide}, {kSide, kSide, kSide}, {0, kSide, kSide}};
  mesh.addQuad(p[4], p[5], p[1], p[0], white);  // floor
  mesh.addQuad(p[3], p[2], p[6], p[7], white);  // ceiling
  mesh.addQuad(p[0], p[1], p[2], p[3], white);  // back
  mesh.addQuad(p[4], p[0], p[3], p[7], red);    // left
  mesh.addQuad(p[1], p[5], p[6], p[2], green);  // right
  mesh.addBlock({3.65, 0.8, 3.65}, {1.6, 1.6, 1.6}, -0.29, white);
  mesh.addBlock({1.9, 1.6, 2.05}, {1.6, 3.2, 1.6}, 0.32, white);
  if (pointLight) {
    mesh.addPointLight({2.75, 4.9, 2.75}, {12.f, 8.5f, 2.8f});
  } else {
    const uint32_t lamp = mesh.addMaterial("lamp", glm::vec3(0.f), {17.f, 12.f, 4.f});
    constexpr double kHeight = kSide - 0.01;
    mesh.addQuad({2.1, kHeight, 2.2}, {3.4, kHeight, 2.2}, {3.4, kHeight, 3.3}, {2.1, kHeight, 3.3}, lamp);
  }
  mesh.addCamera("front", {2.75, 2.75, 13.5}, {2.75, 2.75, 0}, 0.69);
}

void buildFurnace(MeshBuilder& mesh, BuiltinParameters& parameters) {
  const double albedo = parameters.number("albedo", 0.5, 0, 0.999);
  const uint32_t parts = parameters.whole("subdivisions", 1, 1, 512);
  const uint32_t wall = mesh.addMaterial("wall", grey(albedo), grey((1.0 - albedo) / glm::pi<double>()));
  const auto lines = evenly(-1, 1, parts);
  mesh.addCellBoundary(
      lines, lines, lines, true, [](const glm::dvec3&) { return true; }, [&](const glm::dvec3&, const glm::dvec3&) { return wall; });
  mesh.addCamera("inside", {0.2, 0.1, 0.6}, {-0.3, -0.2, -1}, 1.2);
}

void buildBox(MeshBuilder& mesh, BuiltinParameters& parameters) {
  const double albedo = parameters.number("albedo", 0.5, 0, 0.999);
  const uint32_t parts = parameters.whole("subdivisions", 1, 1, 512);
  const uint32_t wall = mesh.addMaterial("wall", grey(albedo));
  const auto lines = evenly(0, 1, parts);
  mesh.addCellBoundary(
      lines, lines, lines, true, [](const glm::dvec3&) { return true; }, [&](const glm::dvec3&, const glm::dvec3&) { return wall; });
  mesh.addPointLight({0.5, 0.5, 0.5}, glm::vec3(1.f));
  mesh.addCamera("inside", {0.5, 0.5, 0.95}, {0.5, 0.5, 0}, 1.3);
}

void buildTwoRooms(MeshBuilder& mesh, BuiltinParameters& parameters) {
  constexpr double kHeight = 3, kDepth = 4, kWall = 4, kThickness = 0.2, kEnd = 8.2, kDoorHeight = 2.1;
  const double door = parameters.number("door", 1, 0, 3);
  const uint32_t plaster = mesh.addMaterial("plaster", {0.7f, 0.68f, 0.65f});
  const uint32_t floor = mesh.addMaterial("floor", {0.45f, 0.3f, 0.2f});
  const uint32_t accent = mesh.addMaterial("accent", {0.25f, 0.4f, 0.65f});
  std::vector<double> zs = {0, kDepth};
  if (door > 0) zs = {0, (kDepth - door) / 2, (kDepth + door) / 2, kDepth};
  const auto isAir = [&](const glm::dvec3& c) {
    const bool inWall = c.x > kWall && c.x < kWall + kThickness;
    return !inWall || (door > 0 && c.y < kDoorHeight && std::abs(c.z - kDepth / 2) < door / 2);
  };
  const auto material = [&](const glm::dvec3& c, const glm::dvec3& n) {
    if (n.y > 0.5) return floor;
    return c.x > kEnd - 1e-6 ? accent : plaster;
  };
  mesh.addCellBoundary({0, kWall, kWall + kThickness, kEnd}, {0, kDoorHeight, kHeight}, zs, true, isAir, material);
  mesh.addPointLight({1.6, 2.4, 1.2}, glm::vec3(10.f, 9.f, 8.f));
  mesh.addCamera("dark room", {kEnd - 0.3, 1.6, 0.4}, {kWall, 1.2, 2.4}, 1.0);
  mesh.addCamera("lit room", {0.3, 1.6, kDepth - 0.4}, {kWall, 1.2, 1.8}, 1.0);
}

void buildThinWall(MeshBuilder& mesh, BuiltinParameters& parameters) {
  const uint32_t sheet =
      mesh.addMaterial("sheet", grey(parameters.number("albedo", 0.5, 0, 0.999)), glm::vec3(0.f), shared::kMaterialDoubleSided);
  mesh.addQuad({-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, sheet);
  mesh.addSun({0, 0, -1}, glm::vec3(1.f));
  mesh.addCamera("lit side", {1.5, 0.5, 4}, {0, 0, 0}, 0.7);
  mesh.addCamera("dark side", {1.5, 0.5, -4}, {0, 0, 0}, 0.7);
}

}  // namespace radivox::scene
