// How to get the parts that a build may lack: the second half of one line, after "; ". The first half says what is missing.
#pragma once

namespace radivox::cli {

inline constexpr const char* kGetPathTracer = "install libembree-dev and libtbb-dev, and build with -DRADIVOX_REFERENCE=ON";
inline constexpr const char* kGetVdb =
    "install libopenvdb-dev, libnanovdb-dev, libboost-dev, libtbb-dev and zlib1g-dev, and build with -DRADIVOX_VDB=ON";
inline constexpr const char* kGetWindow = "install libglfw3-dev and libimgui-dev, and build with -DRADIVOX_VIEWER=ON";

}  // namespace radivox::cli
