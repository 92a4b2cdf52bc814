// Voxel and face lookup over bound buffers. Before including this file, define the bindings of the buffers that the shader has;
// each brings its buffer's name and the functions that need no more than what is defined:
//   RADIVOX_BIND_GRID        grid          Grid                 isInside(ivec3)
//   RADIVOX_BIND_OCCUPANCY   occupancy[]   uvec2 × B            isOccupied(ivec3)               (needs GRID)
//   RADIVOX_BIND_RANK        brickRank[]   u32 × B              voxelIndex(ivec3)               (needs GRID, OCCUPANCY)
//   RADIVOX_BIND_VOXELS      voxels[]      u32 × V              voxelCoordinate(voxel)
//   RADIVOX_BIND_DISTANCE    brickDistances[] u8 × B            brickDistance(brick)
//   RADIVOX_BIND_FACE_MASK   faceMasks[]   u32 × V              hasFace(voxel, f)
//   RADIVOX_BIND_FIRST_FACE  firstFaces[]  u32 × (V + 1)        faceIndex(voxel, f)             (needs FACE_MASK)
//   RADIVOX_BIND_FACES       faces[]       Face × F
// With RADIVOX_TEXELS defined, OCCUPANCY and RANK are read as texels, which CPU devices load for all lanes at once; then use brickBits() and
// rankOf(). All are read only. What is not found is kNone. `voxel` is a compact index unless it is an ivec3 coordinate.
#ifndef RADIVOX_SHADERS_SHARED_VOXEL_LOOKUP_GLSL
#define RADIVOX_SHADERS_SHARED_VOXEL_LOOKUP_GLSL
#include "shared/voxel_codec.h"

#ifdef RADIVOX_BIND_GRID
layout(set = 0, binding = RADIVOX_BIND_GRID, scalar) readonly buffer RadivoxGrid { Grid grid; };
bool isInside(ivec3 voxel) { return all(greaterThanEqual(voxel, ivec3(0))) && all(lessThan(voxel, ivec3(grid.size))); }
#endif

#ifdef RADIVOX_BIND_OCCUPANCY
#ifdef RADIVOX_TEXELS
layout(set = 0, binding = RADIVOX_BIND_OCCUPANCY) uniform usamplerBuffer occupancyTexels;
uvec2 brickBits(uint brick) { return uvec2(texelFetch(occupancyTexels, int(2u * brick)).x, texelFetch(occupancyTexels, int(2u * brick + 1u)).x); }
#else
layout(set = 0, binding = RADIVOX_BIND_OCCUPANCY, scalar) readonly buffer RadivoxOccupancy { uvec2 occupancy[]; };
uvec2 brickBits(uint brick) { return occupancy[brick]; }
#endif
bool isOccupied(ivec3 voxel) {
  if (!isInside(voxel)) return false;
  return hasBit(brickBits(brickOf(uvec3(voxel), grid.bricks)), bitOf(uvec3(voxel)));
}
#endif

#ifdef RADIVOX_BIND_RANK
#ifdef RADIVOX_TEXELS
layout(set = 0, binding = RADIVOX_BIND_RANK) uniform usamplerBuffer rankTexels;
uint rankOf(uint brick) { return texelFetch(rankTexels, int(brick)).x; }
#else
layout(set = 0, binding = RADIVOX_BIND_RANK, scalar) readonly buffer RadivoxRank { uint brickRank[]; };
uint rankOf(uint brick) { return brickRank[brick]; }
#endif
uint voxelIndex(ivec3 voxel) {
  if (!isInside(voxel)) return kNone;
  uint brick = brickOf(uvec3(voxel), grid.bricks);
  uint bit = bitOf(uvec3(voxel));
  uvec2 word = brickBits(brick);
  return hasBit(word, bit) ? rankOf(brick) + countBitsBelow(word, bit) : kNone;
}
#endif

#ifdef RADIVOX_BIND_VOXELS
layout(set = 0, binding = RADIVOX_BIND_VOXELS, scalar) readonly buffer RadivoxVoxels { uint voxels[]; };
uvec3 voxelCoordinate(uint voxel) { return unpackVoxel(voxels[voxel]); }
#endif

#ifdef RADIVOX_BIND_DISTANCE
layout(set = 0, binding = RADIVOX_BIND_DISTANCE, scalar) readonly buffer RadivoxDistance { uint brickDistances[]; };
uint brickDistance(uint brick) { return (brickDistances[brick >> 2] >> ((brick & 3u) * 8u)) & 0xffu; }
#endif

#ifdef RADIVOX_BIND_FACE_MASK
layout(set = 0, binding = RADIVOX_BIND_FACE_MASK, scalar) readonly buffer RadivoxFaceMask { uint faceMasks[]; };
bool hasFace(uint voxel, uint f) { return ((faceMasks[voxel] >> f) & 1u) != 0u; }
#endif

#ifdef RADIVOX_BIND_FIRST_FACE
layout(set = 0, binding = RADIVOX_BIND_FIRST_FACE, scalar) readonly buffer RadivoxFirstFace { uint firstFaces[]; };
uint faceIndex(uint voxel, uint f) {
  uint mask = faceMasks[voxel];
  if (((mask >> f) & 1u) == 0u) return kNone;
  return firstFaces[voxel] + uint(bitCount(mask & ((1u << f) - 1u)));
}
#endif

#ifdef RADIVOX_BIND_FACES
layout(set = 0, binding = RADIVOX_BIND_FACES, scalar) readonly buffer RadivoxFaces { Face faces[]; };
#endif

#endif
