// The triangles' corners as texels (vec4, clustered_voxel.triangles): three a triangle, each a corner in grid space and, as w, a component of the
// triangle's unit normal (world = grid axes). Rays fetch them in one go where vertices take three loads through three indices.
#ifndef RADIVOX_SHADERS_SHARED_TRIANGLE_CORNERS_H
#define RADIVOX_SHADERS_SHARED_TRIANGLE_CORNERS_H
#include "types.h"
RADIVOX_SHARED_BEGIN

RADIVOX_CONST uint kCornerBytes = 48u;  // a triangle

RADIVOX_SHARED_END
#endif
