// Bindings 0…5 of every stage that looks voxel faces up (modules/clustered_voxel/structure.h).
#ifndef RADIVOX_CLUSTERED_VOXEL_STRUCTURE_GLSL
#define RADIVOX_CLUSTERED_VOXEL_STRUCTURE_GLSL
#define RADIVOX_BIND_GRID 0
#define RADIVOX_BIND_OCCUPANCY 1
#define RADIVOX_BIND_RANK 2
#define RADIVOX_BIND_FACE_MASK 3
#define RADIVOX_BIND_FIRST_FACE 4
#define RADIVOX_BIND_FACES 5
#include "shared/voxel_lookup.glsl"

#endif
