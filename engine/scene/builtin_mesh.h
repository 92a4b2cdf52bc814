// Building blocks of the built-in scenes. Internal to engine/scene.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>

#include "engine/scene/builtin.h"
#include "engine/scene/geometry.h"

namespace radivox::scene {

/// key=value of builtin:NAME?…; every key must be asked for.
class BuiltinParameters {
 public:
  BuiltinParameters(std::string scene, const std::map<std::string, std::string>& values) : scene_(std::move(scene)), values_(values) {}
  /// Throws BadInput when the text is no number or outside [min, max].
  double number(const std::string& name, double fallback, double min, double max);
  uint32_t whole(const std::string& name, uint32_t fallback, uint32_t min, uint32_t max);
  /// Throws BadInput with the nearest name for a key that nobody asked for.
  void checkAllKnown() const;

 private:
  std::string scene_;
  const std::map<std::string, std::string>& values_;
  std::vector<std::string> known_;
};

class MeshBuilder {
 public:
  explicit MeshBuilder(std::string name);

  uint32_t addMaterial(const std::string& name, const glm::vec3& albedo, const glm::vec3& emission = glm::vec3(0.f), uint32_t flags = 0);

  /// Fronts are counter-clockwise.
  void addTriangle(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, uint32_t material);
  void addQuad(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d, uint32_t material);
  /// With normals of its own.
  void addTriangle(const glm::dvec3 (&corners)[3], const glm::dvec3 (&normals)[3], uint32_t material);
  /// columns × rows cells of a surface over [0, 1]²; the front is where ∂u × ∂v points. Vertices are shared; normals are the surface's own
  /// (from central differences) when `smooth`, else each cell is flat.
  using Surface = std::function<glm::dvec3(double u, double v)>;
  void addSurface(const Surface& surface, uint32_t columns, uint32_t rows, uint32_t material, bool smooth);
  /// An axis-aligned box seen from outside, turned about the vertical axis through its centre by `turn` radians.
  void addBlock(const glm::dvec3& centre, const glm::dvec3& size, double turn, uint32_t material);
  /// The boundary between air and solid cells of a rectilinear grid, seen from the air. Outside the grid is solid if `solidOutside`.
  /// Neighbours share whole edges, so closed air is watertight. `material` gets the face's centre and its normal (towards the air).
  void addCellBoundary(const std::vector<double>& xs, const std::vector<double>& ys, const std::vector<double>& zs, bool solidOutside,
                       const std::function<bool(const glm::dvec3& centre)>& isAir,
                       const std::function<uint32_t(const glm::dvec3& centre, const glm::dvec3& normal)>& material);

  void addSun(const glm::dvec3& direction, const glm::vec3& irradiance);
  void addPointLight(const glm::dvec3& position, const glm::vec3& intensity);
  void addCamera(const std::string& name, const glm::dvec3& position, const glm::dvec3& target, double yfov);
  void setSky(const glm::vec3& radiance) { scene_.skyRadiance = radiance; }
  /// Triangles so far; while counting only, nothing is stored and surfaces are not evaluated.
  size_t triangleCount() const { return triangleCount_; }
  void startCounting() { countOnly_ = true; }
  void stopCounting();

  /// Triangles sorted by material; everything scaled, then moved (irradiances stay: intensities grow with the scale squared).
  Scene finish(double scale, const glm::dvec3& offset);

 private:
  uint32_t addVertex(const glm::dvec3& position, const glm::dvec3& normal);
  bool countTriangles(size_t count);  ///< false: only counting
  void sortByMaterial();
  Scene scene_;
  Assembly assembly_;
  size_t triangleCount_ = 0;
  bool countOnly_ = false;
  std::vector<glm::dvec3> lightPositions_, cameraPositions_;
};

/// A ball made of the six faces of a cube, cells × cells each: triangles of like size, no poles, watertight. `radius` by unit direction.
void addBall(MeshBuilder& mesh, const glm::dvec3& centre, const std::function<double(const glm::dvec3& direction)>& radius, uint32_t cells,
             bool inward, uint32_t material);

/// lo, …, hi in `parts` equal steps.
std::vector<double> evenly(double lo, double hi, uint32_t parts);

// One function a scene, in builtin_rooms.cpp, builtin_shapes.cpp and builtin_atrium.cpp.
void buildCornell(MeshBuilder& mesh, BuiltinParameters& parameters, bool pointLight);
void buildFurnace(MeshBuilder& mesh, BuiltinParameters& parameters);
void buildTwoRooms(MeshBuilder& mesh, BuiltinParameters& parameters);
void buildBox(MeshBuilder& mesh, BuiltinParameters& parameters);
void buildThinWall(MeshBuilder& mesh, BuiltinParameters& parameters);
void buildPlane(MeshBuilder& mesh, BuiltinParameters& parameters);
void buildSphere(MeshBuilder& mesh, BuiltinParameters& parameters);
void buildRamp(MeshBuilder& mesh, BuiltinParameters& parameters);
void buildStaircase(MeshBuilder& mesh, BuiltinParameters& parameters);
void buildAtrium(MeshBuilder& mesh, BuiltinParameters& parameters);

}  // namespace radivox::scene
