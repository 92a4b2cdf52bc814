// Which sides of a surface are there (docs/data_flow.md, Decisions).
#pragma once

#include <cstdint>

namespace radivox::frame {

enum class Sides : uint32_t {
  Both,  ///< every surface reflects and casts shadows on both sides, whatever doubleSided says
  Gltf,  ///< back faces of single-sided materials are not there
};

}  // namespace radivox::frame
