// The triangles' corners as a picture (RGBA32F, clustered_voxel.triangles): three texels a triangle, each a corner in grid space and, as w, a
// component of the triangle's unit normal (world = grid axes). Rays fetch them in one go where vertices take three loads through three indices.
#ifndef RADIVOX_SHADERS_SHARED_TRIANGLE_CORNERS_H
#define RADIVOX_SHADERS_SHARED_TRIANGLE_CORNERS_H
#include "types.h"
RADIVOX_SHARED_BEGIN

RADIVOX_CONST uint kCornerRow = 1024u;                         // triangles a row
RADIVOX_CONST uint kMostCornerTriangles = 4096u * kCornerRow;  // rows that every device has; beyond, rays load vertices

RADIVOX_SHARED_END

#ifndef __cplusplus
ivec2 cornerTexel(uint triangle) { return ivec2(3u * (triangle % kCornerRow), triangle / kCornerRow); }
#endif
#endif
