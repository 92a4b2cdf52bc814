// What a build without optional parts says: one line that names the part and how to get it. Each test is there where its part is not.
#include "tests/cli/command.h"

namespace radivox::test {

class MissingParts : public CommandTest {};

#ifndef RADIVOX_WITH_VDB
TEST_F(MissingParts, VoxelFiles) {
  const std::vector<std::string> words = {"no OpenVDB", "install libopenvdb-dev", "-DRADIVOX_VDB=ON"};
  expectError({"vdb", "builtin:cornell", "--out", path("a.vdb")}, 3, words);
  expectError({"vdb", "--grids", "help"}, 3, words);
  expectError({"vdb", "--print", path("a.vdb")}, 3, words);
  expectError({"vdb", "--diff", path("a.vdb"), path("b.vdb")}, 3, words);
}
#endif

#ifndef RADIVOX_WITH_REFERENCE
TEST_F(MissingParts, PathTracer) {
  const std::vector<std::string> words = {"no path tracer", "install libembree-dev", "-DRADIVOX_REFERENCE=ON"};
  expectError({"reference", "builtin:cornell", "--out", path("a.exr")}, 3, words);
  expectError({"render", "builtin:cornell", "--max-error", "0.1", "--out", path("a.exr")}, 3, words);
  expectError({"report", "builtin:cornell", "--out", path("report")}, 3, words);
  expectError({"report", "builtin:cornell", "--out", path("report")}, 3, {"give --reference FILE.exr, or"});
}
#endif

#ifndef RADIVOX_WITH_WINDOW
TEST_F(MissingParts, Window) {
  const std::vector<std::string> words = {"install libglfw3-dev and libimgui-dev", "-DRADIVOX_VIEWER=ON"};
  expectError({"view", "builtin:cornell"}, 3, words);
  expectError({"view", "builtin:cornell"}, 3, {"no window", "--headless --out FILE"});
  expectError({"view", "builtin:cornell", "--headless", "--panels", "--out", path("a.png")}, 3, words);
  expectError({"view", "builtin:cornell", "--headless", "--truth", "--out", path("a.png")}, 3, words);
}
#endif

}  // namespace radivox::test
