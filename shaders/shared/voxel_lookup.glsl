// Voxel and face lookup over bound buffers. Before including this file, define the bindings of the buffers that the shader has;
// each brings the functions that need no more than what is defined:
//   RADIVOX_BIND_GRID        grid          Grid                 isInside(ivec3)
//   RADIVOX_BIND_OCCUPANCY   brickBits(brick)     uvec2 × B     isOccupied(ivec3)               (needs GRID)
//   RADIVOX_BIND_RANK        rankOf(brick)        u32 × B       voxelIndex(ivec3)               (needs GRID, OCCUPANCY)
//   RADIVOX_BIND_VOXELS      packedVoxel(voxel)   u32 × V       voxelCoordinate(voxel)
//   RADIVOX_BIND_DISTANCE    brickDistance(brick) u8 × B
//   RADIVOX_BIND_FACE_MASK   faceMask(voxel)      u32 × V       hasFace(voxel, f)
//   RADIVOX_BIND_MASK_WORDS  the same at word kMaskStride · voxel, from bit kMaskShift on: `planes` hold masks, too (shared/voxel_plane.h)
//   RADIVOX_BIND_FIRST_FACE  firstFace(voxel)     u32 × (V + 1) faceIndex(voxel, f)             (needs FACE_MASK)
//   RADIVOX_BIND_FACES       faceAt(s)            Face × F
// All are read only, as texels: what lanes look up at scattered places CPU devices fetch for all lanes at once from these, and lane by lane, with a
// branch each, from storage buffers. What is not used of faceAt() is not fetched. What is not found is kNone. `voxel` is a compact index unless it is
// an ivec3 coordinate.
#ifndef RADIVOX_SHADERS_SHARED_VOXEL_LOOKUP_GLSL
#define RADIVOX_SHADERS_SHARED_VOXEL_LOOKUP_GLSL
#include "shared/voxel_codec.h"

#ifdef RADIVOX_BIND_GRID
layout(set = 0, binding = RADIVOX_BIND_GRID, scalar) readonly buffer RadivoxGrid { Grid grid; };
bool isInside(ivec3 voxel) { return all(greaterThanEqual(voxel, ivec3(0))) && all(lessThan(voxel, ivec3(grid.size))); }
#endif

#ifdef RADIVOX_BIND_OCCUPANCY
layout(set = 0, binding = RADIVOX_BIND_OCCUPANCY) uniform usamplerBuffer occupancyTexels;
uvec2 brickBits(uint brick) { return uvec2(texelFetch(occupancyTexels, int(2u * brick)).x, texelFetch(occupancyTexels, int(2u * brick + 1u)).x); }
bool isOccupied(ivec3 voxel) {
  if (!isInside(voxel)) return false;
  return hasBit(brickBits(brickOf(uvec3(voxel), grid.bricks)), bitOf(uvec3(voxel)));
}
#endif

#ifdef RADIVOX_BIND_RANK
layout(set = 0, binding = RADIVOX_BIND_RANK) uniform usamplerBuffer rankTexels;
uint rankOf(uint brick) { return texelFetch(rankTexels, int(brick)).x; }
uint voxelIndex(ivec3 voxel) {
  if (!isInside(voxel)) return kNone;
  uint brick = brickOf(uvec3(voxel), grid.bricks);
  uint bit = bitOf(uvec3(voxel));
  uvec2 word = brickBits(brick);
  return hasBit(word, bit) ? rankOf(brick) + countBitsBelow(word, bit) : kNone;
}
#endif

#ifdef RADIVOX_BIND_VOXELS
layout(set = 0, binding = RADIVOX_BIND_VOXELS) uniform usamplerBuffer voxelTexels;
uint packedVoxel(uint voxel) { return texelFetch(voxelTexels, int(voxel)).x; }
uvec3 voxelCoordinate(uint voxel) { return unpackVoxel(packedVoxel(voxel)); }
#endif

#ifdef RADIVOX_BIND_DISTANCE
layout(set = 0, binding = RADIVOX_BIND_DISTANCE) uniform usamplerBuffer distanceTexels;
uint brickDistance(uint brick) { return (texelFetch(distanceTexels, int(brick >> 2)).x >> ((brick & 3u) * 8u)) & 0xffu; }
#endif

#ifdef RADIVOX_BIND_FACE_MASK
layout(set = 0, binding = RADIVOX_BIND_FACE_MASK) uniform usamplerBuffer faceMaskTexels;
uint faceMask(uint voxel) { return texelFetch(faceMaskTexels, int(voxel)).x; }
bool hasFace(uint voxel, uint f) { return ((faceMask(voxel) >> f) & 1u) != 0u; }
#endif

#ifdef RADIVOX_BIND_MASK_WORDS
layout(set = 0, binding = RADIVOX_BIND_MASK_WORDS) uniform usamplerBuffer maskTexels;
uint faceMask(uint voxel) { return texelFetch(maskTexels, int(kMaskStride * voxel)).x >> kMaskShift; }
bool hasFace(uint voxel, uint f) { return ((faceMask(voxel) >> f) & 1u) != 0u; }
#endif

#ifdef RADIVOX_BIND_FIRST_FACE
layout(set = 0, binding = RADIVOX_BIND_FIRST_FACE) uniform usamplerBuffer firstFaceTexels;
uint firstFace(uint voxel) { return texelFetch(firstFaceTexels, int(voxel)).x; }
uint faceIndex(uint voxel, uint f) {
  uint mask = faceMask(voxel);
  if (((mask >> f) & 1u) == 0u) return kNone;
  return firstFace(voxel) + uint(bitCount(mask & ((1u << f) - 1u)));
}
#endif

#ifdef RADIVOX_BIND_FACES
layout(set = 0, binding = RADIVOX_BIND_FACES) uniform usamplerBuffer faceTexels;
uint faceWord(uint s, uint word) { return texelFetch(faceTexels, int(6u * s + word)).x; }
Face faceAt(uint s) {
  Face face;
  face.key = faceWord(s, 0u);
  face.area = uintBitsToFloat(faceWord(s, 1u));
  face.normal = faceWord(s, 2u);
  face.position = faceWord(s, 3u);
  face.albedo = uvec2(faceWord(s, 4u), faceWord(s, 5u));
  return face;
}
#endif

#endif
