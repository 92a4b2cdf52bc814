// What bench.comp and its host side (modules/clustered_voxel/visibility/ray_bench.h) agree on.
#ifndef RADIVOX_CLUSTERED_VOXEL_BENCH_H
#define RADIVOX_CLUSTERED_VOXEL_BENCH_H
#include "../../shared/voxel_codec.h"
RADIVOX_SHARED_BEGIN

// What bench.comp does (constant 5).
RADIVOX_CONST uint kBenchRays = 0u;       // writes the rays that trace.comp casts
RADIVOX_CONST uint kBenchLifted = 1u;     // the same, lifted off their surface by kBenchLift
RADIVOX_CONST uint kBenchTraversal = 2u;  // casts rays: to the first voxel with faces
RADIVOX_CONST uint kBenchPlanes = 3u;     // to the first plane
RADIVOX_CONST uint kBenchWalk = 4u;       // as trace.comp: triangles in the first voxels, planes beyond

RADIVOX_CONST float kBenchLift = 1.5f;  // voxels: clear of the voxels of a flat surface

struct BenchRay {
  vec3 origin;  // grid space
  uint excluded;
  vec3 direction;  // unit
  uint own;
};

RADIVOX_SHARED_END
#endif
