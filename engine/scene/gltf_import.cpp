// glTF nodes → flattened scene: transforms, instances, lights, cameras. Files are read in gltf_document.cpp, meshes in gltf_mesh.cpp.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <glm/gtc/constants.hpp>
#include <new>

#include "engine/error.h"
#include "engine/scene/geometry.h"
#include "engine/scene/gltf.h"
#include "engine/scene/gltf_mesh.h"

namespace radivox::scene {

namespace {

using gltf::Document;
using gltf::Value;
using gltf::Warnings;

constexpr size_t kNoNode = static_cast<size_t>(-1);

struct PlacedNode {
  size_t node;
  glm::dmat4 toWorld;
};

glm::dmat4 localTransform(const Value& node, Warnings& warnings) {
  if (node.has("matrix")) {
    const auto m = node.numbersOr<16>("matrix", {});
    glm::dmat4 out(1.0);
    for (glm::length_t i = 0; i < 16; ++i) out[i / 4][i % 4] = m[static_cast<size_t>(i)];
    if (out[0][3] != 0 || out[1][3] != 0 || out[2][3] != 0 || out[3][3] != 1)
      node.at("matrix").fail("is no affine transform (its last row is not 0 0 0 1); correct it");
    return out;
  }
  const auto t = node.numbersOr<3>("translation", {0, 0, 0});
  const auto r = node.numbersOr<4>("rotation", {0, 0, 0, 1});
  const auto s = node.numbersOr<3>("scale", {1, 1, 1});
  glm::dquat rotation(r[3], r[0], r[1], r[2]);
  if (glm::length(rotation) > 1e-12) {
    rotation = glm::normalize(rotation);
  } else {
    warnings.add("rotations of length 0 are taken as none");
    rotation = glm::dquat(1, 0, 0, 0);
  }
  glm::dmat4 out = glm::dmat4(glm::mat3_cast(rotation));
  for (glm::length_t i = 0; i < 3; ++i) out[i] *= s[static_cast<size_t>(i)];
  out[3] = glm::dvec4(t[0], t[1], t[2], 1.0);
  return out;
}

/// Parent of each node. Throws when a node has two, or is its own ancestor.
std::vector<size_t> readParents(const Document& document) {
  const size_t count = document.count("nodes");
  std::vector<size_t> parents(count, kNoNode);
  for (size_t i = 0; i < count; ++i) {
    const auto children = document.entry("nodes", i).findArray("children");
    for (size_t k = 0; children && k < children->size(); ++k) {
      const Value child = (*children)[k];
      const uint64_t index = child.whole();
      if (index >= count)
        child.fail("is " + std::to_string(index) + ", but the file has " + std::to_string(count) + " nodes; export the file again");
      if (parents[index] != kNoNode) {
        child.fail("nodes[" + std::to_string(index) + "] is also a child of nodes[" + std::to_string(parents[index]) +
                   "]; a node has one parent, duplicate it");
      }
      parents[index] = i;
    }
  }
  // Chains of parents that never end are cycles: 0 unseen, 1 on the chain being walked, 2 known to end.
  std::vector<uint8_t> state(count, 0);
  for (size_t i = 0; i < count; ++i) {
    size_t at = i;
    for (; at != kNoNode && state[at] == 0; at = parents[at]) state[at] = 1;
    if (at != kNoNode && state[at] == 1) document.entry("nodes", at).fail("is its own ancestor; break the cycle of children");
    for (at = i; at != kNoNode && state[at] == 1; at = parents[at]) state[at] = 2;
  }
  return parents;
}

/// The glTF scene to show: the default one, the only one, or nothing (then all roots).
std::optional<Value> findScene(const Document& document) {
  const size_t count = document.count("scenes");
  if (const auto index = document.root().indexOr("scene", count, "scenes")) return document.entry("scenes", *index);
  if (count == 1) return document.entry("scenes", 0);
  return std::nullopt;
}

/// Nodes of the scene with their world transforms, parents before children, in file order.
std::vector<PlacedNode> placeNodes(const Document& document, const std::optional<Value>& scene, Warnings& warnings) {
  const std::vector<size_t> parents = readParents(document);
  std::vector<PlacedNode> stack, placed;
  const auto pushRoot = [&](size_t index) { stack.push_back({index, glm::dmat4(1.0)}); };
  if (scene) {
    std::vector<bool> listed(parents.size(), false);
    const auto nodes = scene->findArray("nodes");
    for (size_t k = nodes ? nodes->size() : 0; k-- > 0;) {
      const Value root = (*nodes)[k];
      const uint64_t index = root.whole();
      if (index >= parents.size())
        root.fail("is " + std::to_string(index) + ", but the file has " + std::to_string(parents.size()) + " nodes; export the file again");
      if (parents[index] != kNoNode) root.fail("nodes[" + std::to_string(index) + "] is a child of another node; scenes list roots only");
      if (listed[index]) root.fail("nodes[" + std::to_string(index) + "] is listed twice; remove one");
      listed[index] = true;
      pushRoot(index);
    }
  } else {
    for (size_t i = parents.size(); i-- > 0;) {
      if (parents[i] == kNoNode) pushRoot(i);
    }
  }
  while (!stack.empty()) {
    PlacedNode current = stack.back();
    stack.pop_back();
    const Value node = document.entry("nodes", current.node);
    current.toWorld = current.toWorld * localTransform(node, warnings);
    for (glm::length_t c = 0; c < 4; ++c) {
      for (glm::length_t r = 0; r < 4; ++r) {
        if (!std::isfinite(current.toWorld[c][r])) node.fail("its world transform overflows; correct the transforms of its ancestors");
      }
    }
    placed.push_back(current);
    const auto children = node.findArray("children");
    for (size_t k = children ? children->size() : 0; k-- > 0;) stack.push_back({(*children)[k].whole(), current.toWorld});
  }
  return placed;
}

/// Lights and cameras before Scene::origin is known.
struct Placed {
  glm::dvec3 position;
  glm::dvec3 forward, up;
};

Placed placeAlongMinusZ(const glm::dmat4& m, const Value& node, Warnings& warnings) {
  Placed out{glm::dvec3(m[3]), -glm::dvec3(m[2]), glm::dvec3(m[1])};
  for (glm::length_t i = 0; i < 3; ++i) {
    if (std::abs(out.position[i]) > 1e15) node.fail("it stands beyond 1e15 m; correct its transform");
  }
  if (!(glm::length(out.forward) > 0)) {
    warnings.add("lights and cameras scaled to nothing look along -z");
    out.forward = glm::dvec3(0, 0, -1);
  }
  out.forward = glm::normalize(out.forward);
  if (!(glm::length(out.up) > 0)) out.up = glm::dvec3(0, 1, 0);
  out.up = glm::normalize(out.up);
  return out;
}

std::optional<PunctualLight> readLight(const Value& json, const Placed& placed, Warnings& warnings) {
  PunctualLight light;
  const std::string type = json.at("type").text();
  if (type == "directional")
    light.type = shared::kLightDirectional;
  else if (type == "point")
    light.type = shared::kLightPoint;
  else if (type == "spot")
    light.type = shared::kLightSpot;
  else
    json.at("type").fail("is \"" + type + "\", should be directional, point or spot");
  const auto color = json.numbersOr<3>("color", {1, 1, 1});
  const double intensity = json.numberOr("intensity", 1);
  for (glm::length_t i = 0; i < 3; ++i) {
    const double value = color[static_cast<size_t>(i)] * intensity;
    if (value < 0) json.fail("its colour or intensity is negative; correct it");
    if (value > 1e18) json.fail("its intensity is beyond 1e18; correct it");
    light.intensity[i] = static_cast<float>(value);
  }
  const double range = json.numberOr("range", 0);
  if (range < 0 || (json.has("range") && range == 0)) json.at("range").fail("should be above 0; remove it for no limit");
  light.range = static_cast<float>(range);
  light.direction = glm::vec3(placed.forward);
  if (light.type == shared::kLightSpot) {
    double inner = 0, outer = glm::quarter_pi<double>();
    if (const auto spot = json.findObject("spot")) {
      inner = spot->numberOr("innerConeAngle", 0);
      outer = spot->numberOr("outerConeAngle", outer);
    }
    if (!(outer > 0) || outer > glm::half_pi<double>() * 1.0001 || inner < 0)
      json.fail("its cone angles should be 0 <= inner < outer <= pi/2; correct them");
    if (inner >= outer) {
      warnings.add("spot lights whose inner cone is not inside the outer one get a hard edge");
      inner = outer * 0.999;
    }
    light.outerConeAngle = static_cast<float>(std::min(outer, glm::half_pi<double>()));
    light.innerConeAngle = static_cast<float>(inner);
  }
  if (light.intensity == glm::vec3(0.f)) {
    warnings.add("lights of intensity 0 are left out");
    return std::nullopt;
  }
  return light;
}

CameraDescription readCamera(const Value& json, const Placed& placed) {
  CameraDescription camera;
  camera.orientation = orientationFrom(placed.forward, placed.up);
  const std::string type = json.at("type").text();
  if (type == "perspective") {
    const Value perspective = json.at("perspective");
    const double yfov = perspective.at("yfov").number();
    if (!(yfov > 1e-4 && yfov < 3.1)) perspective.at("yfov").fail("is " + std::to_string(yfov) + " rad, should be above 0 and below 3.1");
    camera.yfov = static_cast<float>(yfov);
    camera.znear = static_cast<float>(perspective.numberOr("znear", 0));
  } else if (type == "orthographic") {
    const Value orthographic = json.at("orthographic");
    const double ymag = orthographic.at("ymag").number();
    if (!(std::abs(ymag) > 0)) orthographic.at("ymag").fail("should not be 0");
    camera.orthographic = true;
    camera.ymag = static_cast<float>(std::abs(ymag));
    camera.znear = static_cast<float>(orthographic.numberOr("znear", 0));
  } else {
    json.at("type").fail("is \"" + type + "\", should be perspective or orthographic");
  }
  return camera;
}

/// A file's near plane is kept where it is small against the scene; a large one would cut walls that rays still see. The far plane
/// of an orthographic camera always covers the scene.
void fitDepthRange(CameraDescription& camera, const Traits& traits) {
  double diagonal = glm::length(glm::dvec3(traits.boundsMax) - glm::dvec3(traits.boundsMin));
  if (!(diagonal > 0)) diagonal = 2;  // an empty scene
  const auto largest = static_cast<float>(diagonal * 1e-3);
  if (!(camera.znear > 0) || camera.znear > largest) camera.znear = largest;
  const glm::vec3 centre = (traits.boundsMin + traits.boundsMax) * 0.5f;
  camera.zfar = camera.znear + static_cast<float>(glm::length(glm::dvec3(centre) - glm::dvec3(camera.position)) + diagonal);
}

void readSky(const std::optional<Value>& gltfScene, Scene& scene) {
  if (!gltfScene) return;
  const auto extras = gltfScene->find("extras");
  if (!extras || !extras->json().is_object()) return;  // extras may be anything
  const auto ours = extras->find("radivox");
  if (!ours) return;
  const auto sky = ours->numbersOr<3>("skyRadiance", {0, 0, 0});
  for (glm::length_t i = 0; i < 3; ++i) {
    if (sky[static_cast<size_t>(i)] < 0) ours->at("skyRadiance").fail("is negative; correct it");
    scene.skyRadiance[i] = static_cast<float>(sky[static_cast<size_t>(i)]);
  }
}

bool primitivesLackMaterial(const Document& document) {
  for (size_t m = 0; m < document.count("meshes"); ++m) {
    const Value primitives = document.entry("meshes", m).at("primitives");
    for (size_t p = 0; p < primitives.size(); ++p) {
      if (!primitives[p].has("material")) return true;
    }
  }
  return false;
}

/// Room for all instances. Throws OutOfMemory when 32-bit indices cannot number them, before anything is multiplied.
Assembly reserveFor(const Document& document, const std::vector<PlacedNode>& nodes, gltf::MeshReader& meshes) {
  uint64_t vertexTotal = 0, indexTotal = 0;
  for (const PlacedNode& placed : nodes) {
    const Value node = document.entry("nodes", placed.node);
    const auto mesh = node.indexOr("mesh", document.count("meshes"), "meshes");
    if (!mesh) continue;
    for (const gltf::Primitive& primitive : meshes.mesh(*mesh)) {
      if (primitive.indices.empty()) continue;
      vertexTotal += primitive.normals.empty() ? primitive.indices.size() : primitive.positions.size();
      indexTotal += primitive.indices.size();
    }
    if (vertexTotal > 0xffffffffull || indexTotal > 0xffffffffull) {
      throw Error(ErrorCode::OutOfMemory, document.path() + ": " + node.place() + ": with this instance the scene has " +
                                              std::to_string(indexTotal / 3) +
                                              " triangles, more than 32-bit indices hold; simplify it or remove instances");
    }
  }
  Assembly assembly;
  assembly.positions.reserve(vertexTotal);
  assembly.vertices.reserve(vertexTotal);
  assembly.indices.reserve(indexTotal);
  assembly.triangleMaterials.reserve(indexTotal / 3);
  return assembly;
}

Scene importChecked(const std::string& path) {
  const Document document(path);
  Scene scene;
  scene.name = path;
  Warnings warnings;
  const auto coordinates = gltf::readMaterials(document, primitivesLackMaterial(document), scene, warnings);
  gltf::MeshReader meshes(document, coordinates, warnings);
  const auto gltfScene = findScene(document);
  readSky(gltfScene, scene);

  const auto lightList = document.root().findExtension("KHR_lights_punctual");
  const auto lights = lightList ? lightList->findArray("lights") : std::nullopt;
  if (document.count("skins") > 0) warnings.add("skins are left out, skinned meshes keep their bind pose");
  if (document.count("animations") > 0) warnings.add("animations are left out");

  const std::vector<PlacedNode> placedNodes = placeNodes(document, gltfScene, warnings);
  Assembly assembly = reserveFor(document, placedNodes, meshes);
  std::vector<glm::dvec3> lightPositions, cameraPositions;
  for (const PlacedNode& placedNode : placedNodes) {
    const Value node = document.entry("nodes", placedNode.node);
    if (const auto mesh = node.indexOr("mesh", document.count("meshes"), "meshes")) {
      for (const gltf::Primitive& primitive : meshes.mesh(*mesh))
        gltf::appendInstance(primitive, placedNode.toWorld, node, assembly, warnings);
    }
    if (const auto extension = node.findExtension("KHR_lights_punctual")) {
      const size_t index = extension->index("light", lights ? lights->size() : 0, "lights");
      const Placed placed = placeAlongMinusZ(placedNode.toWorld, node, warnings);
      if (auto light = readLight((*lights)[index], placed, warnings)) {
        light->name = node.textOr("name", (*lights)[index].textOr("name", "light " + std::to_string(scene.lights.size())));
        scene.lights.push_back(*light);
        lightPositions.push_back(placed.position);
      }
    }
    if (const auto index = node.indexOr("camera", document.count("cameras"), "cameras")) {
      const Value json = document.entry("cameras", *index);
      const Placed placed = placeAlongMinusZ(placedNode.toWorld, node, warnings);
      scene.cameras.push_back(readCamera(json, placed));
      scene.cameras.back().name = node.textOr("name", json.textOr("name", "camera " + std::to_string(scene.cameras.size() - 1)));
      cameraPositions.push_back(placed.position);
    }
  }
  scene.warnings = document.warnings;
  warnings.appendTo(scene.warnings);
  finishGeometry(std::move(assembly), scene);
  for (size_t i = 0; i < scene.lights.size(); ++i) scene.lights[i].position = glm::vec3(lightPositions[i] - scene.origin);
  const Traits traits = scene.traits();
  for (size_t i = 0; i < scene.cameras.size(); ++i) {
    scene.cameras[i].position = glm::vec3(cameraPositions[i] - scene.origin);
    fitDepthRange(scene.cameras[i], traits);
  }
  if (scene.cameras.empty()) scene.cameras.push_back(makeDefaultCamera(scene));
  if (scene.triangleCount() == 0)
    scene.warnings.push_back("the scene has no triangles");
  else if (!traits.lit())
    scene.warnings.push_back("the scene has no light: no lights, no emissive surface, no sky");
  return scene;
}

}  // namespace

Scene importGltf(const std::string& path) {
  try {
    return importChecked(path);
  } catch (const std::bad_alloc&) {
    throw Error(ErrorCode::OutOfMemory, path + ": does not fit into memory; simplify the scene");
  } catch (const std::length_error&) {
    throw Error(ErrorCode::OutOfMemory, path + ": does not fit into memory; simplify the scene");
  }
}

}  // namespace radivox::scene
