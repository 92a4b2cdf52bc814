// An entry of a voxel's list of triangles (clustered_voxel.triangles ids): the triangle, and which faces of the voxel its piece there is no part of.
//   triangle | faces << kListedBits, a bit a direction (faces are numbered in shared/voxel.h)
#ifndef RADIVOX_SHADERS_SHARED_LISTED_TRIANGLE_H
#define RADIVOX_SHADERS_SHARED_LISTED_TRIANGLE_H
#include "functions.h"
RADIVOX_SHARED_BEGIN

RADIVOX_CONST uint kListedBits = 26u;
RADIVOX_CONST uint kMostListedTriangles = 1u << kListedBits;

RADIVOX_FUNCTION uint listedTriangle(uint entry) { return entry & (kMostListedTriangles - 1u); }
RADIVOX_FUNCTION uint listedApart(uint entry) { return entry >> kListedBits; }

RADIVOX_SHARED_END
#endif
