#include "engine/scene/builtin_mesh.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>

#include "engine/error.h"
#include "engine/params/params.h"
#include "engine/text.h"

namespace radivox::scene {

double BuiltinParameters::number(const std::string& name, double fallback, double min, double max) {
  known_.push_back(name);
  const auto found = values_.find(name);
  if (found == values_.end()) return fallback;
  double value = 0;
  const std::string& text = found->second;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !(value >= min && value <= max)) {
    throw Error(ErrorCode::BadInput, "builtin:" + scene_ + ": " + name + "=" + text + " should be a number from " + printNumber(min) +
                                         " to " + printNumber(max));
  }
  return value;
}

uint32_t BuiltinParameters::whole(const std::string& name, uint32_t fallback, uint32_t min, uint32_t max) {
  const double value = number(name, fallback, min, max);
  if (value != std::floor(value)) throw Error(ErrorCode::BadInput, "builtin:" + scene_ + ": " + name + " should be a whole number");
  return static_cast<uint32_t>(value);
}

void BuiltinParameters::checkAllKnown() const {
  for (const auto& [name, value] : values_) {
    if (std::find(known_.begin(), known_.end(), name) != known_.end()) continue;
    const std::string nearest = params::nearestName(name, known_);
    std::string list;
    for (const auto& k : known_) list += (list.empty() ? "" : ", ") + k;
    throw Error(ErrorCode::BadInput, "builtin:" + scene_ + ": no parameter \"" + name + "\"" +
                                         (nearest.empty() ? "" : "; did you mean \"" + nearest + "\"?") +
                                         (nearest.empty() ? "; there are: " : " There are: ") + list);
  }
}

std::vector<double> evenly(double lo, double hi, uint32_t parts) {
  std::vector<double> out;
  for (uint32_t i = 0; i < parts; ++i) out.push_back(lo + (hi - lo) * i / parts);
  out.push_back(hi);
  return out;
}

MeshBuilder::MeshBuilder(std::string name) { scene_.name = std::move(name); }

uint32_t MeshBuilder::addMaterial(const std::string& name, const glm::vec3& albedo, const glm::vec3& emission, uint32_t flags) {
  shared::Material material{};
  material.albedo = glm::clamp(albedo, glm::vec3(0.f), glm::vec3(0.999f));
  material.alpha = 1.f;
  material.emission = emission;
  material.alphaCutoff = 0.5f;
  material.baseTexture = shared::kNoTexture;
  material.emissiveTexture = shared::kNoTexture;
  material.flags = flags | (emission != glm::vec3(0.f) ? shared::kMaterialEmissive : 0u);
  scene_.materials.push_back(material);
  scene_.materialNames.push_back(name);
  return static_cast<uint32_t>(scene_.materials.size() - 1);
}

uint32_t MeshBuilder::addVertex(const glm::dvec3& position, const glm::dvec3& normal) {
  shared::Vertex vertex{};
  vertex.normal = glm::vec3(normal);
  assembly_.positions.push_back(position);
  assembly_.vertices.push_back(vertex);
  return static_cast<uint32_t>(assembly_.positions.size() - 1);
}

void MeshBuilder::addTriangle(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, uint32_t material) {
  if (!countTriangles(1)) return;
  const glm::dvec3 normal = glm::normalize(glm::cross(b - a, c - a));
  for (const glm::dvec3& p : {a, b, c}) assembly_.indices.push_back(addVertex(p, normal));
  assembly_.triangleMaterials.push_back(material);
}

void MeshBuilder::addTriangle(const glm::dvec3 (&corners)[3], const glm::dvec3 (&normals)[3], uint32_t material) {
  if (!countTriangles(1)) return;
  for (int k = 0; k < 3; ++k) assembly_.indices.push_back(addVertex(corners[k], normals[k]));
  assembly_.triangleMaterials.push_back(material);
}

bool MeshBuilder::countTriangles(size_t count) {
  triangleCount_ += count;
  return !countOnly_;
}

void MeshBuilder::stopCounting() {
  countOnly_ = false;
  triangleCount_ = assembly_.triangleMaterials.size();
}

void MeshBuilder::addQuad(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d, uint32_t material) {
  if (!countTriangles(2)) return;
  const glm::dvec3 normal = glm::normalize(glm::cross(c - a, d - b));
  const uint32_t i = addVertex(a, normal);
  addVertex(b, normal);
  addVertex(c, normal);
  addVertex(d, normal);
  for (const uint32_t k : {0u, 1u, 2u, 0u, 2u, 3u}) assembly_.indices.push_back(i + k);
  assembly_.triangleMaterials.insert(assembly_.triangleMaterials.end(), 2, material);
}

void MeshBuilder::addSurface(const Surface& surface, uint32_t columns, uint32_t rows, uint32_t material, bool smooth) {
  const auto at = [&](uint32_t i, uint32_t j) { return surface(static_cast<double>(i) / columns, static_cast<double>(j) / rows); };
  if (countOnly_) {
    triangleCount_ += size_t{2} * columns * rows;
    return;
  }
  if (!smooth) {
    for (uint32_t j = 0; j < rows; ++j) {
      for (uint32_t i = 0; i < columns; ++i) addQuad(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1), material);
    }
    return;
  }
  triangleCount_ += size_t{2} * columns * rows;
  const auto first = static_cast<uint32_t>(assembly_.positions.size());
  for (uint32_t j = 0; j <= rows; ++j) {
    for (uint32_t i = 0; i <= columns; ++i) {
      const double u = static_cast<double>(i) / columns, v = static_cast<double>(j) / rows;
      const double du = 0.02 / columns, dv = 0.02 / rows;
      const auto normalAt = [&](double vAt) {
        const glm::dvec3 tangentU = surface(std::min(u + du, 1.0), vAt) - surface(std::max(u - du, 0.0), vAt);
        const glm::dvec3 tangentV = surface(u, std::min(vAt + dv, 1.0)) - surface(u, std::max(vAt - dv, 0.0));
        const glm::dvec3 n = glm::cross(tangentU, tangentV);
        const double scale = glm::dot(tangentV, tangentV);
        return glm::length(n) > 1e-6 * scale ? glm::normalize(n) : glm::dvec3(0.0);
      };
      glm::dvec3 normal = normalAt(v);
      if (normal == glm::dvec3(0.0)) normal = normalAt(v < 0.5 ? v + dv : v - dv);  // a pole, where a row shrinks to a point
      addVertex(surface(u, v), normal);
    }
  }
  for (uint32_t j = 0; j < rows; ++j) {
    for (uint32_t i = 0; i < columns; ++i) {
      const uint32_t a = first + j * (columns + 1) + i, d = a + columns + 1;
      for (const uint32_t k : {a, a + 1, d + 1, a, d + 1, d}) assembly_.indices.push_back(k);
      assembly_.triangleMaterials.insert(assembly_.triangleMaterials.end(), 2, material);
    }
  }
}

void MeshBuilder::addBlock(const glm::dvec3& centre, const glm::dvec3& size, double turn, uint32_t material) {
  const double c = std::cos(turn), s = std::sin(turn);
  const auto corner = [&](int x, int y, int z) {
    const glm::dvec3 p = size * 0.5 * glm::dvec3(x, y, z);
    return centre + glm::dvec3(c * p.x + s * p.z, p.y, -s * p.x + c * p.z);
  };
  addQuad(corner(1, -1, 1), corner(1, -1, -1), corner(1, 1, -1), corner(1, 1, 1), material);
  addQuad(corner(-1, -1, -1), corner(-1, -1, 1), corner(-1, 1, 1), corner(-1, 1, -1), material);
  addQuad(corner(-1, 1, 1), corner(1, 1, 1), corner(1, 1, -1), corner(-1, 1, -1), material);
  addQuad(corner(-1, -1, -1), corner(1, -1, -1), corner(1, -1, 1), corner(-1, -1, 1), material);
  addQuad(corner(-1, -1, 1), corner(1, -1, 1), corner(1, 1, 1), corner(-1, 1, 1), material);
  addQuad(corner(1, -1, -1), corner(-1, -1, -1), corner(-1, 1, -1), corner(1, 1, -1), material);
}

void MeshBuilder::addCellBoundary(const std::vector<double>& xs, const std::vector<double>& ys, const std::vector<double>& zs,
                                  bool solidOutside, const std::function<bool(const glm::dvec3& centre)>& isAir,
                                  const std::function<uint32_t(const glm::dvec3& centre, const glm::dvec3& normal)>& material) {
  const std::vector<double>* lines[3] = {&xs, &ys, &zs};
  const glm::ivec3 cells(static_cast<int>(xs.size()) - 1, static_cast<int>(ys.size()) - 1, static_cast<int>(zs.size()) - 1);
  const auto line = [&](int axis, int i) { return (*lines[axis])[static_cast<size_t>(i)]; };
  const auto airAt = [&](const glm::ivec3& cell) {
    glm::dvec3 centre;
    for (int a = 0; a < 3; ++a) {
      if (cell[a] < 0 || cell[a] >= cells[a]) return !solidOutside;
      centre[a] = 0.5 * (line(a, cell[a]) + line(a, cell[a] + 1));
    }
    return isAir(centre);
  };
  glm::ivec3 cell;
  for (cell.z = 0; cell.z <= cells.z; ++cell.z) {
    for (cell.y = 0; cell.y <= cells.y; ++cell.y) {
      for (cell.x = 0; cell.x <= cells.x; ++cell.x) {
        for (int axis = 0; axis < 3; ++axis) {
          const int b = (axis + 1) % 3, c = (axis + 2) % 3;
          if (cell[b] >= cells[b] || cell[c] >= cells[c]) continue;
          glm::ivec3 below = cell;
          --below[axis];
          const bool airAbove = airAt(cell), airBelow = airAt(below);
          if (airAbove == airBelow) continue;
          const auto corner = [&](int i, int j) {
            glm::dvec3 p;
            p[axis] = line(axis, cell[axis]);
            p[b] = line(b, cell[b] + i);
            p[c] = line(c, cell[c] + j);
            return p;
          };
          glm::dvec3 normal(0.0);
          normal[axis] = airAbove ? 1.0 : -1.0;
          const uint32_t m = material((corner(0, 0) + corner(1, 1)) * 0.5, normal);
          if (airAbove)
            addQuad(corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1), m);
          else
            addQuad(corner(0, 0), corner(0, 1), corner(1, 1), corner(1, 0), m);
        }
      }
    }
  }
}

void MeshBuilder::addSun(const glm::dvec3& direction, const glm::vec3& irradiance) {
  PunctualLight light;
  light.name = "sun";
  light.type = shared::kLightDirectional;
  light.direction = glm::vec3(glm::normalize(direction));
  light.intensity = irradiance;
  scene_.lights.push_back(light);
  lightPositions_.emplace_back(0.0);
}

void MeshBuilder::addPointLight(const glm::dvec3& position, const glm::vec3& intensity) {
  PunctualLight light;
  light.name = "lamp";
  light.type = shared::kLightPoint;
  light.intensity = intensity;
  scene_.lights.push_back(light);
  lightPositions_.push_back(position);
}

void MeshBuilder::addCamera(const std::string& name, const glm::dvec3& position, const glm::dvec3& target, double yfov) {
  CameraDescription camera;
  camera.name = name;
  camera.orientation = orientationFrom(target - position, glm::dvec3(0, 1, 0));
  camera.yfov = static_cast<float>(yfov);
  scene_.cameras.push_back(camera);
  cameraPositions_.push_back(position);
}

void MeshBuilder::sortByMaterial() {
  std::vector<uint32_t> order(assembly_.triangleMaterials.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](uint32_t a, uint32_t b) { return assembly_.triangleMaterials[a] < assembly_.triangleMaterials[b]; });
  std::vector<uint32_t> indices, materials;
  indices.reserve(assembly_.indices.size());
  materials.reserve(order.size());
  for (const uint32_t t : order) {
    indices.insert(indices.end(), assembly_.indices.begin() + static_cast<std::ptrdiff_t>(t) * 3,
                   assembly_.indices.begin() + static_cast<std::ptrdiff_t>(t) * 3 + 3);
    materials.push_back(assembly_.triangleMaterials[t]);
  }
  assembly_.indices = std::move(indices);
  assembly_.triangleMaterials = std::move(materials);
}

Scene MeshBuilder::finish(double scale, const glm::dvec3& offset) {
  sortByMaterial();
  for (glm::dvec3& p : assembly_.positions) p = p * scale + offset;
  finishGeometry(std::move(assembly_), scene_);
  if (scene_.materials.empty()) addMaterial("default", glm::vec3(0.5f));
  for (size_t i = 0; i < scene_.lights.size(); ++i) {
    scene_.lights[i].position = glm::vec3(lightPositions_[i] * scale + offset - scene_.origin);
    if (scene_.lights[i].type != shared::kLightDirectional) scene_.lights[i].intensity *= static_cast<float>(scale * scale);
  }
  const Traits traits = scene_.traits();
  const float diagonal = glm::length(traits.boundsMax - traits.boundsMin);
  for (size_t i = 0; i < scene_.cameras.size(); ++i) {
    scene_.cameras[i].position = glm::vec3(cameraPositions_[i] * scale + offset - scene_.origin);
    scene_.cameras[i].znear = diagonal * 1e-3f;
    scene_.cameras[i].zfar = diagonal * 10.f;
  }
  if (scene_.cameras.empty()) scene_.cameras.push_back(makeDefaultCamera(scene_));
  return std::move(scene_);
}

}  // namespace radivox::scene
