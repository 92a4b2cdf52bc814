// glTF nodes → flattened scene: transforms, instances, lights, cameras. Files are read in gltf_document.cpp, meshes in gltf_mesh.cpp.
// Indices and types in tinygltf's model have been checked (gltf_check.h); -1 and empty lists mean "not there".
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <glm/gtc/constants.hpp>
#include <new>

#include "engine/error.h"
#include "engine/scene/geometry.h"
#include "engine/scene/gltf.h"
#include "engine/scene/gltf_mesh.h"
#include "engine/scene/sky.h"
#include "engine/text.h"

namespace radivox::scene {

namespace {

using gltf::Document;
using gltf::placeOf;
using gltf::Warnings;

constexpr size_t kNoNode = static_cast<size_t>(-1);

struct PlacedNode {
  size_t node;
  glm::dmat4 toWorld;
};

glm::dmat4 localTransform(const Document& document, size_t index, Warnings& warnings) {
  const tinygltf::Node& node = document.model().nodes[index];
  if (!node.matrix.empty()) {
    glm::dmat4 out(1.0);
    for (glm::length_t i = 0; i < 16; ++i) out[i / 4][i % 4] = node.matrix[static_cast<size_t>(i)];
    if (out[0][3] != 0 || out[1][3] != 0 || out[2][3] != 0 || out[3][3] != 1)
      document.fail(placeOf("nodes", index) + ".matrix", "is no affine transform (its last row is not 0 0 0 1); correct it");
    return out;
  }
  const auto valuesOr = [](const std::vector<double>& values, std::vector<double> fallback) { return values.empty() ? fallback : values; };
  const auto t = valuesOr(node.translation, {0, 0, 0}), r = valuesOr(node.rotation, {0, 0, 0, 1}), s = valuesOr(node.scale, {1, 1, 1});
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
  const auto& nodes = document.model().nodes;
  const size_t count = nodes.size();
  std::vector<size_t> parents(count, kNoNode);
  for (size_t i = 0; i < count; ++i) {
    for (size_t k = 0; k < nodes[i].children.size(); ++k) {
      const auto child = static_cast<size_t>(nodes[i].children[k]);
      if (parents[child] != kNoNode) {
        document.fail(
            placeOf("nodes", i) + placeOf(".children", k),
            placeOf("nodes", child) + " is also a child of " + placeOf("nodes", parents[child]) + "; a node has one parent, duplicate it");
      }
      parents[child] = i;
    }
  }
  // Chains of parents that never end are cycles: 0 unseen, 1 on the chain being walked, 2 known to end.
  std::vector<uint8_t> state(count, 0);
  for (size_t i = 0; i < count; ++i) {
    size_t at = i;
    for (; at != kNoNode && state[at] == 0; at = parents[at]) state[at] = 1;
    if (at != kNoNode && state[at] == 1) document.fail(placeOf("nodes", at), "is its own ancestor; break the cycle of children");
    for (at = i; at != kNoNode && state[at] == 1; at = parents[at]) state[at] = 2;
  }
  return parents;
}

/// The glTF scene to show: the default one, the only one, or nothing (then all roots).
const tinygltf::Scene* findScene(const Document& document) {
  const tinygltf::Model& model = document.model();
  if (model.defaultScene >= 0) return &model.scenes[static_cast<size_t>(model.defaultScene)];
  return model.scenes.size() == 1 ? &model.scenes[0] : nullptr;
}

/// Nodes of the scene with their world transforms, parents before children, in file order.
std::vector<PlacedNode> placeNodes(const Document& document, const tinygltf::Scene* scene, Warnings& warnings) {
  const std::vector<size_t> parents = readParents(document);
  std::vector<PlacedNode> stack, placed;
  const auto pushRoot = [&](size_t index) { stack.push_back({index, glm::dmat4(1.0)}); };
  if (scene != nullptr) {
    std::vector<bool> listed(parents.size(), false);
    const std::string sceneName = placeOf("scenes", static_cast<size_t>(scene - document.model().scenes.data()));
    for (size_t k = scene->nodes.size(); k-- > 0;) {
      const auto index = static_cast<size_t>(scene->nodes[k]);
      const std::string place = sceneName + placeOf(".nodes", k);
      if (parents[index] != kNoNode) document.fail(place, placeOf("nodes", index) + " is a child of another node; scenes list roots only");
      if (listed[index]) document.fail(place, placeOf("nodes", index) + " is listed twice; remove one");
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
    current.toWorld = current.toWorld * localTransform(document, current.node, warnings);
    for (glm::length_t c = 0; c < 4; ++c) {
      for (glm::length_t r = 0; r < 4; ++r) {
        if (!std::isfinite(current.toWorld[c][r]))
          document.fail(placeOf("nodes", current.node), "its world transform overflows; correct the transforms of its ancestors");
      }
    }
    placed.push_back(current);
    const auto& children = document.model().nodes[current.node].children;
    for (size_t k = children.size(); k-- > 0;) stack.push_back({static_cast<size_t>(children[k]), current.toWorld});
  }
  return placed;
}

/// Lights and cameras before Scene::origin is known.
struct Placed {
  glm::dvec3 position;
  glm::dvec3 forward, up;
};

Placed placeAlongMinusZ(const Document& document, const PlacedNode& node, Warnings& warnings) {
  const glm::dmat4& m = node.toWorld;
  Placed out{glm::dvec3(m[3]), -glm::dvec3(m[2]), glm::dvec3(m[1])};
  for (glm::length_t i = 0; i < 3; ++i) {
    if (std::abs(out.position[i]) > 1e15) document.fail(placeOf("nodes", node.node), "it stands beyond 1e15 m; correct its transform");
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

std::optional<PunctualLight> readLight(const Document& document, size_t index, const Placed& placed, Warnings& warnings) {
  const tinygltf::Light& source = document.model().lights[index];
  const std::string place = placeOf("extensions.KHR_lights_punctual.lights", index);
  PunctualLight light;
  light.type = source.type == "point" ? shared::kLightPoint : source.type == "spot" ? shared::kLightSpot : shared::kLightDirectional;
  for (glm::length_t i = 0; i < 3; ++i) {
    const double value = (source.color.empty() ? 1.0 : source.color[static_cast<size_t>(i)]) * source.intensity;
    if (value < 0) document.fail(place, "its colour or intensity is negative; correct it");
    if (value > 1e18) document.fail(place, "its intensity is beyond 1e18; correct it");
    light.intensity[i] = static_cast<float>(value);
  }
  light.range = static_cast<float>(source.range);
  light.direction = glm::vec3(placed.forward);
  if (light.type == shared::kLightSpot) {
    double inner = source.spot.innerConeAngle;
    const double outer = source.spot.outerConeAngle;
    if (!(outer > 0) || outer > glm::half_pi<double>() * 1.0001 || inner < 0)
      document.fail(place, "its cone angles should be 0 <= inner < outer <= pi/2; correct them");
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

CameraDescription readCamera(const Document& document, size_t index, const Placed& placed) {
  const tinygltf::Camera& source = document.model().cameras[index];
  const std::string place = placeOf("cameras", index) + "." + source.type;
  CameraDescription camera;
  camera.orientation = orientationFrom(placed.forward, placed.up);
  if (source.type == "perspective") {
    const double yfov = source.perspective.yfov;
    if (!(yfov > 1e-4 && yfov < 3.1))
      document.fail(place + ".yfov", "is " + std::to_string(yfov) + " rad, should be above 0 and below 3.1");
    camera.yfov = static_cast<float>(yfov);
    camera.znear = static_cast<float>(source.perspective.znear);
  } else {
    const double ymag = std::abs(source.orthographic.ymag);
    if (!(ymag > 0)) document.fail(place + ".ymag", "should not be 0");
    camera.orthographic = true;
    camera.ymag = static_cast<float>(ymag);
    camera.znear = static_cast<float>(source.orthographic.znear);
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

/// extras may be anything, so the types are looked at here.
void readSky(const Document& document, const tinygltf::Scene* gltfScene, Scene& scene) {
  if (gltfScene == nullptr || !gltfScene->extras.Has("radivox") || !gltfScene->extras.Get("radivox").Has("skyRadiance")) return;
  const tinygltf::Value& sky = gltfScene->extras.Get("radivox").Get("skyRadiance");
  for (glm::length_t i = 0; i < 3; ++i) {
    if (sky.ArrayLen() != 3 || !sky.Get(i).IsNumber() || sky.Get(i).GetNumberAsDouble() < 0) {
      document.fail(placeOf("scenes", static_cast<size_t>(gltfScene - document.model().scenes.data())) + ".extras.radivox.skyRadiance",
                    "should be three numbers, 0 or more; correct it");
    }
    scene.skyRadiance[i] = static_cast<float>(sky.Get(i).GetNumberAsDouble());
  }
}

/// {"uri": …, "scale": …, "turn": …, "sun": "keep"}: what --sky says, beside the file.
void readSkyImage(const Document& document, const tinygltf::Scene* gltfScene, Scene& scene) {
  if (gltfScene == nullptr || !gltfScene->extras.Has("radivox") || !gltfScene->extras.Get("radivox").Has("sky")) return;
  const tinygltf::Value& sky = gltfScene->extras.Get("radivox").Get("sky");
  const std::string place = placeOf("scenes", static_cast<size_t>(gltfScene - document.model().scenes.data())) + ".extras.radivox.sky";
  const auto isText = [&sky](const char* key) { return sky.Get(key).IsString() && !sky.Get(key).Get<std::string>().empty(); };
  const auto isNumber = [&sky](const char* key) { return !sky.Has(key) || sky.Get(key).IsNumber(); };
  if (!sky.IsObject() || !sky.Has("uri") || !isText("uri") || !isNumber("scale") || !isNumber("turn") || (sky.Has("sun") && !isText("sun")))
    document.fail(place,
                  "should be {\"uri\": \"FILE.exr\"} with, as one likes, numbers \"scale\" and \"turn\" and \"sun\": \"keep\"; correct it");
  const std::string uri = sky.Get("uri").Get<std::string>();
  const bool builtin = uri.rfind("builtin:", 0) == 0;
  if (!builtin && (uri.find(':') != std::string::npos || uri.front() == '/'))
    document.fail(place + ".uri", "is not a file beside this one; put it there and name it");
  std::string spec = builtin ? uri : (std::filesystem::path(document.path()).parent_path() / uri).string();
  spec += "?sun=" + (sky.Has("sun") ? sky.Get("sun").Get<std::string>() : "light");
  for (const char* key : {"scale", "turn"}) {
    if (sky.Has(key)) spec += "&" + std::string(key) + "=" + printNumber(sky.Get(key).GetNumberAsDouble(), 9);
  }
  try {
    scene.sky = loadSky(spec);
  } catch (const Error& error) {
    throw Error(error.code(), document.path() + ": " + place + ": " + error.what());
  }
  scene.warnings.insert(scene.warnings.end(), scene.sky->notes.begin(), scene.sky->notes.end());
}

bool primitivesLackMaterial(const Document& document) {
  for (const tinygltf::Mesh& mesh : document.model().meshes) {
    for (const tinygltf::Primitive& primitive : mesh.primitives) {
      if (primitive.material < 0) return true;
    }
  }
  return false;
}

/// Room for all instances. Throws OutOfMemory when 32-bit indices cannot number them, before anything is multiplied.
Assembly reserveFor(const Document& document, const std::vector<PlacedNode>& nodes, gltf::MeshReader& meshes) {
  uint64_t vertexTotal = 0, indexTotal = 0;
  for (const PlacedNode& placed : nodes) {
    const tinygltf::Node& node = document.model().nodes[placed.node];
    if (node.mesh < 0) continue;
    for (const gltf::Primitive& primitive : meshes.mesh(node)) {
      if (primitive.indices.empty()) continue;
      vertexTotal += primitive.normals.empty() ? primitive.indices.size() : primitive.positions.size();
      indexTotal += primitive.indices.size();
    }
    if (vertexTotal > 0xffffffffull || indexTotal > 0xffffffffull) {
      throw Error(ErrorCode::OutOfMemory, document.path() + ": " + placeOf("nodes", placed.node) + ": with this instance the scene has " +
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

/// The ways of a skin's joints to the world at rest; none when the scene lacks a joint.
std::vector<glm::dmat4> readJoints(const Document& document, size_t index, const std::vector<const glm::dmat4*>& toWorld,
                                   Warnings& warnings) {
  const tinygltf::Skin& skin = document.model().skins[index];
  const std::string place = placeOf("skins", index) + ".inverseBindMatrices";
  gltf::FloatData inverse;
  if (skin.inverseBindMatrices >= 0) {
    inverse = document.readFloats(skin.inverseBindMatrices, "MAT4", place);
    if (inverse.count() < skin.joints.size()) {
      document.fail(place, "has " + std::to_string(inverse.count()) + " matrices for " + std::to_string(skin.joints.size()) +
                               " joints; export the file again");
    }
  }
  std::vector<glm::dmat4> joints;
  for (size_t j = 0; j < skin.joints.size(); ++j) {
    const glm::dmat4* node = toWorld[static_cast<size_t>(skin.joints[j])];
    if (node == nullptr) {
      warnings.add("skins whose joints are not in the scene are left out, their meshes keep the bind pose");
      return {};
    }
    glm::dmat4 toJoint(1.0);
    for (glm::length_t i = 0; inverse.components > 0 && i < 16; ++i)
      toJoint[i / 4][i % 4] = inverse.values[j * 16 + static_cast<size_t>(i)];
    joints.push_back(*node * toJoint);
  }
  return joints;
}

std::vector<std::vector<glm::dmat4>> readSkins(const Document& document, const std::vector<PlacedNode>& nodes, Warnings& warnings) {
  std::vector<const glm::dmat4*> toWorld(document.model().nodes.size(), nullptr);
  for (const PlacedNode& node : nodes) toWorld[node.node] = &node.toWorld;
  std::vector<std::vector<glm::dmat4>> skins(document.model().skins.size());
  for (size_t i = 0; i < skins.size(); ++i) skins[i] = readJoints(document, i, toWorld, warnings);
  return skins;
}

Scene importChecked(const std::string& path) {
  const Document document(path);
  const tinygltf::Model& model = document.model();
  Scene scene;
  scene.name = path;
  Warnings warnings = document.warnings;
  const auto coordinates = gltf::readMaterials(document, primitivesLackMaterial(document), scene, warnings);
  gltf::MeshReader meshes(document, coordinates, scene, warnings);
  const tinygltf::Scene* gltfScene = findScene(document);
  readSky(document, gltfScene, scene);
  readSkyImage(document, gltfScene, scene);

  const std::vector<PlacedNode> placedNodes = placeNodes(document, gltfScene, warnings);
  Assembly assembly = reserveFor(document, placedNodes, meshes);
  const auto skins = readSkins(document, placedNodes, warnings);
  const std::vector<glm::dmat4> noJoints;
  std::vector<glm::dvec3> lightPositions, cameraPositions;
  const auto firstName = [](const std::string& name, const std::string& other, const std::string& last) {
    return !name.empty() ? name : !other.empty() ? other : last;
  };
  for (const PlacedNode& placedNode : placedNodes) {
    const tinygltf::Node& node = model.nodes[placedNode.node];
    if (node.mesh >= 0) {
      const auto& joints = node.skin < 0 ? noJoints : skins[static_cast<size_t>(node.skin)];
      const std::string place = placeOf("nodes", placedNode.node);
      const std::string name = firstName(node.name, model.meshes[static_cast<size_t>(node.mesh)].name, place);
      size_t part = 0;
      for (const gltf::Primitive& primitive : meshes.mesh(node)) {
        gltf::appendInstance(document, primitive, placedNode.toWorld, joints, place, part == 0 ? name : name + "." + std::to_string(part),
                             assembly, warnings);
        ++part;
      }
    }
    if (const auto* extension = gltf::findExtension(node.extensions, "KHR_lights_punctual")) {
      const auto index = static_cast<size_t>(extension->Get("light").GetNumberAsInt());
      const Placed placed = placeAlongMinusZ(document, placedNode, warnings);
      if (auto light = readLight(document, index, placed, warnings)) {
        light->name = firstName(node.name, model.lights[index].name, "light " + std::to_string(scene.lights.size()));
        scene.lights.push_back(*light);
        lightPositions.push_back(placed.position);
      }
    }
    if (node.camera >= 0) {
      const Placed placed = placeAlongMinusZ(document, placedNode, warnings);
      const auto index = static_cast<size_t>(node.camera);
      scene.cameras.push_back(readCamera(document, index, placed));
      scene.cameras.back().name = firstName(node.name, model.cameras[index].name, "camera " + std::to_string(scene.cameras.size() - 1));
      cameraPositions.push_back(placed.position);
    }
  }
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
    scene.warnings.push_back(kNoLightWarning);
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
