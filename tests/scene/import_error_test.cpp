// Every broken file gives one line that names the file, the place and the mend; none crashes.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "engine/scene/gltf.h"
#include "tests/gpu/expect_error.h"
#include "tests/scene/tiny_gltf.h"

namespace radivox::tests {
namespace {

using nlohmann::json;

class ImportErrorTest : public ::testing::Test {
 protected:
  /// The import of `bytes` fails with BadInput that names the file and holds `part`.
  void expectFailure(const std::string& bytes, const std::string& part, const std::string& name = "scene.gltf") {
    const std::string path = folder_.write(name, bytes);
    const Error error = catchError([&] { scene::importGltf(path); });
    expectError(error, ErrorCode::BadInput, part);
    EXPECT_NE(std::string(error.what()).find(path), std::string::npos) << error.what();
  }
  /// A triangle with its JSON bent.
  template <class Bend>
  void expectFailureOf(Bend bend, const std::string& part) {
    TinyGltf file = makeFile();
    bend(file.json);
    expectFailure(file.gltf(), part);
  }
  static TinyGltf makeFile() {
    TinyGltf file;
    const size_t positions = file.addVec3({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    const size_t normals = file.addVec3({{0, 0, 1}, {0, 0, 1}, {0, 0, 1}});
    const size_t indices = file.addIndices({0, 1, 2});
    file.addNode({{"mesh", file.addMesh({{"attributes", {{"POSITION", positions}, {"NORMAL", normals}}}, {"indices", indices}})}});
    return file;
  }
  TempFolder folder_;
};

TEST_F(ImportErrorTest, TheUnbentFileLoads) {
  EXPECT_EQ(scene::importGltf(folder_.write("scene.gltf", makeFile().gltf())).triangleCount(), 1u);
}

TEST_F(ImportErrorTest, SkiesThatAreNone) {
  const auto expectSkyFailure = [this](const json& sky, const std::string& part) {
    expectFailureOf([&sky](json& root) { root["scenes"][0]["extras"]["radivox"]["sky"] = sky; }, "scenes[0].extras.radivox.sky");
    expectFailureOf([&sky](json& root) { root["scenes"][0]["extras"]["radivox"]["sky"] = sky; }, part);
  };
  for (const json& sky :
       {json("builtin:clear"), json{{"scale", 2}}, json{{"uri", 3}}, json{{"uri", ""}}, json{{"uri", "a.exr"}, {"turn", "much"}}})
    expectSkyFailure(sky, "should be {");
  expectSkyFailure({{"uri", "/etc/a.exr"}}, "not a file beside");
  expectSkyFailure({{"uri", "http://host/a.exr"}}, "not a file beside");
  expectSkyFailure({{"uri", "none.exr"}}, "no such file");
  expectSkyFailure({{"uri", "a.png"}}, ".exr or .hdr");
  expectSkyFailure({{"uri", "builtin:clear"}, {"scale", -1}}, "scale=-1");
  expectSkyFailure({{"uri", "builtin:clear"}, {"sun", "out"}}, "sun=out");
}

TEST_F(ImportErrorTest, FilesThatAreNone) {
  expectError(catchError([&] { scene::importGltf(folder_.path("missing.glb")); }), ErrorCode::BadInput, "no such file");
  expectError(catchError([&] { scene::importGltf(folder_.path("")); }), ErrorCode::BadInput, "is a directory");
  expectError(catchError([&] { scene::importGltf("/dev/zero"); }), ErrorCode::BadInput, "not a regular file");
  expectFailure("", "is empty");
  expectFailure("#usda 1.0", "neither GLB");
  expectFailure("   \n", "neither GLB");
  expectFailure("{", "malformed or cut off");
  expectFailure("{\"asset\": 1e999}", "beyond any float");
  expectFailure("{}", "required property \"asset\"");
  expectFailure("{\"asset\": {}}", "asset: required property \"version\"");
  expectFailure("{\"asset\": {\"version\": \"1.0\"}}", "glTF 2.0");
  expectFailure("{\"asset\": [1]}", "asset: should be an object");
  expectFailure("{\"asset\": {\"version\": \"1.0\"}, \"buffers\": {}}", "glTF 2.0");  // version 1 has objects for lists
  expectFailure(std::string(1u << 20, '{'), "malformed");
  std::string nested = "{\"asset\":{\"version\":\"2.0\"},\"extras\":";
  for (int i = 0; i < 100000; ++i) nested += '[';
  expectFailure(nested, "malformed");
}

TEST_F(ImportErrorTest, EveryTruncationOfAGlb) {
  const std::string whole = makeFile().glb();
  for (size_t length = 0; length < whole.size(); ++length) {
    const std::string path = folder_.write("cut.glb", whole.substr(0, length));
    const Error error = catchError([&] { scene::importGltf(path); });
    EXPECT_EQ(static_cast<int>(error.code()), static_cast<int>(ErrorCode::BadInput)) << length << ": " << error.what();
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
  }
}

TEST_F(ImportErrorTest, GlbHeaders) {
  const std::string good = makeFile().glb();
  const auto withWord = [&](size_t at, uint32_t value) {
    std::string out = good;
    for (size_t k = 0; k < 4; ++k) out[at + k] = static_cast<char>(value >> (8 * k));
    return out;
  };
  expectFailure(withWord(4, 1), "GLB version 1");
  expectFailure(withWord(8, 0xffffffffu), "declares 4294967295 bytes");
  expectFailure(withWord(8, 0), "JSON chunk is longer");
  expectFailure(withWord(12, 0xffffffffu), "JSON chunk is longer");
  expectFailure(withWord(12, 0), "longer than the file");  // the JSON is read as a chunk header
  expectFailure(withWord(16, 0x12345678u), "not JSON");
  const size_t binary =
      20 + (static_cast<size_t>(static_cast<uint8_t>(good[12])) | static_cast<size_t>(static_cast<uint8_t>(good[13])) << 8);
  expectFailure(withWord(binary, 0xfffffff0u), "longer than the file");
  expectFailure(withWord(binary + 4, 0x12345678u), "neither a uri nor a GLB binary chunk");
}

/// Flips bytes all over a good file: it loads or throws Error, nothing else.
TEST_F(ImportErrorTest, DamagedBytesNeverCrash) {
  const std::string good = makeFile().glb();
  uint32_t random = 12345;
  size_t failures = 0;
  for (int i = 0; i < 4000; ++i) {
    std::string bad = good;
    for (int k = 0; k < 1 + i % 3; ++k) {
      random = random * 1664525u + 1013904223u;
      bad[(random >> 8) % bad.size()] = static_cast<char>(random >> 24);
    }
    const std::string path = folder_.write("damaged.glb", bad);
    try {
      const scene::Scene s = scene::importGltf(path);
      for (const uint32_t index : s.indices) ASSERT_LT(index, s.vertices.size());
      for (const auto& v : s.vertices)
        ASSERT_TRUE(std::isfinite(v.position.x + v.position.y + v.position.z + v.normal.x + v.normal.y + v.normal.z));
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
      ++failures;
    }
  }
  EXPECT_GT(failures, 1000u);
}

/// Every value of the JSON in turn replaced by things it should not be.
TEST_F(ImportErrorTest, WrongTypesAnywhereNeverCrash) {
  TinyGltf file = makeFile();
  file.json["cameras"] = json::array({{{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}}});
  file.json["materials"] = json::array({{{"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, 1}}}}, {"emissiveFactor", {1, 1, 1}}}});
  file.json["extensions"]["KHR_lights_punctual"]["lights"] =
      json::array({{{"type", "spot"}, {"intensity", 2}, {"spot", {{"outerConeAngle", 1}}}}});
  file.addNode({{"camera", 0}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}, {"rotation", {0, 0, 0, 1}}});
  const json whole = json::parse(file.gltf());
  size_t tried = 0, refused = 0;
  const json flat = whole.flatten();
  for (const auto& [pointer, value] : flat.items()) {
    json::json_pointer place(pointer);
    while (!place.empty()) {  // the leaf, then everything around it
      for (const json& replacement : {json(nullptr), json(-1), json(1e300), json(2.5), json("x"), json::array(), json::object(), json(true),
                                      json(18446744073709551615ull)}) {
        json bent = whole;
        bent[place] = replacement;
        const std::string path = folder_.write("bent.gltf", bent.dump());
        ++tried;
        try {
          scene::importGltf(path);
        } catch (const Error& error) {
          ++refused;
          EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
        }
      }
      place.pop_back();
    }
  }
  EXPECT_GT(tried, 1000u);
  EXPECT_GT(refused, tried / 2);
}

TEST_F(ImportErrorTest, Buffers) {
  const TinyGltf file = makeFile();
  expectFailure(file.gltf("no.bin"), "buffers[0].uri: external buffer \"no.bin\" is missing; put it beside");
  folder_.write("short.bin", file.binary.substr(0, 20));
  expectFailure(file.gltf("short.bin"), "\"short.bin\" has 20 bytes");
  expectFailure(file.gltf("data:application/octet-stream;base64,A"), "broken base64");
  expectFailure(file.gltf("data:application/octet-stream;base64,AA*A"), "broken base64");
  expectFailure(file.gltf("data:text/plain,abc"), "not base64");
  expectFailure(file.gltf("https://example.org/a.bin"), "not a file beside this one");
  expectFailure(file.gltf("%zz"), "no file name");
  std::filesystem::create_directory(folder_.path("folder.bin"));
  expectFailure(file.gltf("folder.bin"), "missing");
}

TEST_F(ImportErrorTest, Accessors) {
  expectFailureOf([](json& j) { j["accessors"][0]["count"] = 4; },
                  "meshes[0].primitives[0].attributes.POSITION: accessors[0]: 4 elements of 12 bytes");
  expectFailureOf([](json& j) { j["accessors"][0]["count"] = 4294967295u; }, "end beyond bufferViews[0]");
  expectFailureOf([](json& j) { j["accessors"][0]["count"] = 18446744073709551615ull; }, "beyond 32 bits");
  expectFailureOf([](json& j) { j["accessors"][0]["byteOffset"] = 18446744073709551612ull; }, "end beyond bufferViews[0]");
  expectFailureOf([](json& j) { j["accessors"][0]["byteOffset"] = -4; }, "accessors[0].byteOffset: is -4, should be a whole number");
  expectFailureOf([](json& j) { j["accessors"][0]["componentType"] = 5130; }, "componentType 5130");
  expectFailureOf([](json& j) { j["accessors"][0]["type"] = "VEC2"; }, "is VEC2, should be VEC3");
  expectFailureOf([](json& j) { j["accessors"][0]["type"] = "MAT4"; }, "type MAT4 has no use");
  expectFailureOf([](json& j) { j["accessors"][0]["bufferView"] = 9; }, "accessors[0].bufferView: is 9, but the file has 3 bufferViews");
  expectFailureOf([](json& j) { j["accessors"][0].erase("bufferView"), j["accessors"][0]["count"] = 4000000000u; }, "has no bufferView");
  expectFailureOf([](json& j) { j["accessors"][2]["componentType"] = 5126; }, "does not hold unsigned integers");
  expectFailureOf([](json& j) { j["accessors"][2]["type"] = "VEC2"; }, "end beyond");
  expectFailureOf([](json& j) { j["accessors"][1]["count"] = 2; }, "NORMAL: has 2 entries, POSITION has 3");
  expectFailureOf([](json& j) { j["bufferViews"][0]["byteLength"] = 18446744073709551615ull; }, "end beyond buffers[0]");
  expectFailureOf([](json& j) { j["bufferViews"][0]["byteOffset"] = 18446744073709551000ull; }, "end beyond buffers[0]");
  expectFailureOf([](json& j) { j["bufferViews"][0]["buffer"] = 1; }, "bufferViews[0].buffer: is 1, but the file has 1 buffers");
  expectFailureOf([](json& j) { j["bufferViews"][0]["byteStride"] = 4; }, "byteStride 4");
  expectFailureOf([](json& j) { j["bufferViews"][0]["byteStride"] = 16; }, "end beyond bufferViews[0]");
  const json sparse = {{"count", 1}, {"indices", {{"bufferView", 2}, {"componentType", 5125}}}, {"values", {{"bufferView", 0}}}};
  expectFailureOf([&](json& j) { j["accessors"][0]["sparse"] = sparse, j["accessors"][0]["sparse"]["count"] = 4; },
                  "sparse.count 4 is above count 3");
  expectFailureOf([&](json& j) { j["accessors"][0]["sparse"] = sparse, j["accessors"][0]["sparse"]["indices"]["componentType"] = 5126; },
                  "no index type");
  expectFailureOf([&](json& j) { j["accessors"][0]["sparse"] = sparse, j["accessors"][0]["sparse"]["values"]["byteOffset"] = 30; },
                  "sparse data ends beyond");
  expectFailureOf(
      [&](json& j) {
        j["accessors"][0]["sparse"] = sparse, j["accessors"][0]["sparse"]["indices"]["bufferView"] = 0,
        j["accessors"][0]["sparse"]["indices"]["byteOffset"] = 12;
      },
      "sparse.indices[0] = 1065353216 is out of range");
}

TEST_F(ImportErrorTest, IndicesOutOfRange) {
  TinyGltf file;
  const size_t positions = file.addVec3({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  const size_t indices = file.addIndices({0, 1, 3});
  file.addNode({{"mesh", file.addMesh({{"attributes", {{"POSITION", positions}}}, {"indices", indices}})}});
  expectFailure(file.gltf(), "meshes[0].primitives[0].indices: accessors[1]: index 2 is 3, but POSITION has 3 vertices");
}

TEST_F(ImportErrorTest, PositionsThatAreNotFinite) {
  for (const float bad : {std::nanf(""), INFINITY, -INFINITY}) {
    TinyGltf file;
    const size_t positions = file.addVec3({{0, 0, 0}, {1, 0, 0}, {0, bad, 0}});
    file.addNode({{"mesh", file.addMesh({{"attributes", {{"POSITION", positions}}}})}});
    expectFailure(file.gltf(), "attributes.POSITION: accessors[0]: vertex 2 is not finite");
  }
  expectFailureOf([](json& j) { j["nodes"][0]["scale"] = {1e300, 1, 1}; }, "nodes[0]: its transform moves vertex 1");
  expectFailureOf([](json& j) { j["nodes"][0]["scale"] = {1e12, 1, 1}; }, "spans");
}

TEST_F(ImportErrorTest, Nodes) {
  expectFailureOf([](json& j) { j["nodes"][0]["children"] = {0}, j["scenes"][0]["nodes"] = json::array(); }, "its own ancestor");
  expectFailureOf(
      [](json& j) {
        j["nodes"].push_back({{"children", {2}}});
        j["nodes"].push_back({{"children", {1}}});
      },
      "its own ancestor");
  expectFailureOf(
      [](json& j) {
        j["nodes"].push_back({{"children", {0}}});
        j["nodes"].push_back({{"children", {0}}});
      },
      "nodes[0] is also a child of nodes[1]");
  expectFailureOf([](json& j) { j["nodes"][0]["children"] = {7}; }, "nodes[0].children[0]: is 7, but the file has 1 nodes");
  expectFailureOf([](json& j) { j["nodes"].push_back({{"children", {0}}}); }, "scenes list roots only");
  expectFailureOf([](json& j) { j["scenes"][0]["nodes"] = {0, 0}; }, "listed twice");
  expectFailureOf([](json& j) { j["scenes"][0]["nodes"] = {3}; }, "scenes[0].nodes[0]: is 3");
  expectFailureOf([](json& j) { j["scene"] = 2; }, "scene: is 2, but the file has 1 scenes");
  expectFailureOf([](json& j) { j["nodes"][0]["mesh"] = 5; }, "nodes[0].mesh: is 5, but the file has 1 meshes");
  expectFailureOf([](json& j) { j["nodes"][0]["translation"] = {1, 2}; }, "nodes[0].translation: has 2 numbers instead of 3");
  expectFailureOf([](json& j) { j["nodes"][0]["matrix"] = {1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}; }, "no affine transform");
  expectFailureOf([](json& j) { j["meshes"][0]["primitives"][0]["mode"] = 7; }, "mode: is 7");
  expectFailureOf([](json& j) { j["meshes"][0]["primitives"][0]["material"] = 0; }, "material: is 0, but the file has 0 materials");
}

TEST_F(ImportErrorTest, LightsAndCameras) {
  const auto light = [](const json& description) {
    return [description](json& j) {
      j["extensions"]["KHR_lights_punctual"]["lights"] = json::array({description});
      j["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0;
    };
  };
  expectFailureOf(light({{"type", "area"}}), "extensions.KHR_lights_punctual.lights[0].type: is \"area\"");
  expectFailureOf(light({{"type", "point"}, {"intensity", -1}}), "negative");
  expectFailureOf(light({{"type", "point"}, {"range", 0}}), "range: should be above 0");
  expectFailureOf(light({{"type", "spot"}, {"spot", {{"outerConeAngle", 2}}}}), "cone angles");
  expectFailureOf([](json& j) { j["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0; }, "the file has 0 lights");
  const auto camera = [](const json& description) {
    return [description](json& j) {
      j["cameras"] = json::array({description});
      j["nodes"][0]["camera"] = 0;
    };
  };
  expectFailureOf(camera({{"type", "fisheye"}}), "cameras[0].type: is \"fisheye\"");
  expectFailureOf(camera({{"type", "perspective"}, {"perspective", {{"yfov", 0}}}}), "yfov: is 0");
  expectFailureOf(camera({{"type", "orthographic"}, {"orthographic", {{"ymag", 0}}}}), "ymag: should not be 0");
}

TEST_F(ImportErrorTest, RequiredExtensions) {
  const auto expectRefused = [&](const char* name) {
    expectFailureOf([&](json& j) { j["extensionsRequired"] = {name}; }, std::string("extensionsRequired[0]: the file requires ") + name);
  };
  for (const char* name : {"EXT_mesh_gpu_instancing", "KHR_texture_basisu", "ACME_thing"}) expectRefused(name);
#ifndef RADIVOX_WITH_DRACO
  expectRefused("KHR_draco_mesh_compression");
  expectFailureOf([](json& j) { j["extensionsRequired"] = {"KHR_draco_mesh_compression"}; }, "export it without mesh compression");
#endif
#ifndef RADIVOX_WITH_MESHOPTIMIZER
  expectRefused("EXT_meshopt_compression");
#endif
}

TEST_F(ImportErrorTest, InstancesBeyondIndices) {
  // One mesh of many indices in many nodes: refused before it is multiplied.
  TinyGltf file;
  const size_t positions = file.addVec3({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  file.json["accessors"].push_back({{"componentType", 5121}, {"type", "SCALAR"}, {"count", 16777215}});  // zeros
  const size_t mesh = file.addMesh({{"attributes", {{"POSITION", positions}, {"NORMAL", positions}}}, {"indices", 1}});
  for (int i = 0; i < 400; ++i) file.addNode({{"mesh", mesh}});
  const std::string path = folder_.write("scene.gltf", file.gltf());
  const Error error = catchError([&] { scene::importGltf(path); });
  expectError(error, ErrorCode::OutOfMemory, "more than 32-bit indices hold");
}

}  // namespace
}  // namespace radivox::tests
