// What fuzzing the importer found, and the seeds it began with (tests/fuzz): each loads, or is refused in one line.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "engine/error.h"
#include "engine/scene/gltf.h"

namespace radivox::tests {
namespace {

TEST(FuzzCorpusTest, ImportedFilesLoadOrAreRefused) {
  size_t count = 0, loaded = 0;
  for (const auto& entry : std::filesystem::directory_iterator(std::string(RADIVOX_SOURCE_DIR) + "/tests/fuzz/import")) {
    ++count;
    try {
      const scene::Scene s = scene::importGltf(entry.path());
      ++loaded;
      for (const uint32_t index : s.indices) ASSERT_LT(index, s.vertices.size()) << entry.path();
      for (const uint32_t material : s.triangleMaterials) ASSERT_LT(material, s.materials.size()) << entry.path();
      for (const auto& v : s.vertices) {
        const float sum = v.position.x + v.position.y + v.position.z + v.normal.x + v.normal.y + v.normal.z + v.uvBase.x + v.uvBase.y;
        ASSERT_TRUE(std::isfinite(sum)) << entry.path();
      }
    } catch (const Error& error) {
      const std::string text = error.what();
      EXPECT_EQ(text.find('\n'), std::string::npos) << text;
      EXPECT_EQ(text.rfind(entry.path().string(), 0), 0u) << text;
    }
  }
  EXPECT_GE(count, 11u);
  EXPECT_GE(loaded, 8u);  // the seeds
}

}  // namespace
}  // namespace radivox::tests
