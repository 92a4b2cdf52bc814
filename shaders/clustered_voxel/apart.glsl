// Which faces of a voxel the piece of a triangle in it is no part of (voxelize/part_sides.comp). The includer declares triangleFirst[] and triangleIds[].
#ifndef RADIVOX_CLUSTERED_VOXEL_APART_GLSL
#define RADIVOX_CLUSTERED_VOXEL_APART_GLSL
#include "shared/listed_triangle.h"

// A bit a direction; 0 where the voxel has no list.
uint apartIn(uint voxel, uint triangle) {
  uint low = triangleFirst[voxel], end = triangleFirst[voxel + 1u];
  for (uint high = end; low < high;) {
    uint middle = (low + high) / 2u;
    if (listedTriangle(triangleIds[middle]) < triangle) low = middle + 1u;
    else high = middle;
  }
  if (low >= end) return 0u;
  uint entry = triangleIds[low];
  return listedTriangle(entry) == triangle ? listedApart(entry) : 0u;
}

#endif
