// The voxel grid, voxel faces and clusters: what the clustered_voxel nodes hand to each other.
#ifndef RADIVOX_SHADERS_SHARED_VOXEL_H
#define RADIVOX_SHADERS_SHARED_VOXEL_H
#include "types.h"
RADIVOX_SHARED_BEGIN

// Grid space: p_grid = (p − origin) / h; voxel i holds grid space [i, i+1). N voxels along the longest side of the bounds, with half a
// voxel of margin: h = longest / (N − 1), size_k = ceil(extent_k / h) + 1, centred on the bounds.
struct Grid {
  vec3 origin;    // m, relative to Scene::origin
  float h;        // voxel edge, m
  float inverseH;
  uvec3 size;       // voxels
  uvec3 bricks;     // ceil(size / 4): bricks of 4×4×4 voxels
  uint brickCount;  // product
  uint singleSided; // 1: surfaces reflect on the back only where their material is double-sided (sides=gltf); 0: on both sides
  uint dominant;    // 1: surface belongs to the one face that it looks along the most (faces=dominant); 0: to all that it looks along, by its projection
};

// Faces of a voxel, f = 0…5: +x −x +y −y +z −z. axis = f >> 1, negative if f & 1.
RADIVOX_CONST uint kFaceCount = 6u;

// Brick index: x + bricks.x·(y + bricks.y·z). Bit of a voxel in its brick's 64-bit word (two uints): x + 4y + 16z of the low two bits
// of each coordinate. Compact voxel index = rank[brick] + popcount(bits below), so voxels are ordered by brick, then bit.
// Voxel coordinate packed: x | y << 10 | z << 20.

// faceKey = voxel index << 3 | f. Faces are ordered by key, so face index = firstFace[voxel] + popcount(faceMask[voxel] & (2^f − 1)).
struct Face {
  uint key;
  float area;      // a_s in h²: Σ area · max(0, n·e_f); where Grid::dominant, Σ area of the surface that belongs to it
  uint normal;     // n_s, octahedral snorm16 × 2
  uint position;   // x_s inside the voxel, unorm 10:10:10, x low; kMadeOfBacks
  uvec2 albedo;    // ρ_s, unorm16: r | g << 16, b | margins << 16, see faceMargins
};

// Bit of Face::position: no surface shows its front here, and the face is made of the backs of one-sided surfaces.
RADIVOX_CONST uint kMadeOfBacks = 0x80000000u;

// C + 1 of them: the members of one end where those of the next begin, and the last begins at F.
struct Cluster {
  vec3 albedo;      // area-weighted mean ρ
  uint firstMember; // into the members
};

// Where a cluster is: few ask.
struct ClusterPlace {
  vec3 position;    // area-weighted mean, grid space
  float area;       // A_c = Σ a_s, h²
  vec3 normal;      // unit, area-weighted mean
};

// Visibility row entry, once read (visibility_row.h): id | (count − 1) << 24. id < C: cluster; C ≤ id < C + F: face id − C (near hit); kMissBase + b: miss in
// direction bin b of kSkyBinCount (shaders/shared/sky.h): each side of a cube has kSkyBinSide² under the image of a sky, else one (6 bins: the
// dominant axis of the direction, as faces are numbered).
RADIVOX_CONST uint kEntryIdMask = 0x00ffffffu;
RADIVOX_CONST uint kMissBase = 0x00ffff00u;
RADIVOX_CONST uint kSkyBinSide = 4u;
RADIVOX_CONST uint kSkyBinCount = 6u * kSkyBinSide * kSkyBinSide;
// Not a direction but black: the ray met the back of a one-sided surface (sides=gltf), which lets nothing pass and reflects nothing.
RADIVOX_CONST uint kAbsorbed = kMissBase + kSkyBinCount;
RADIVOX_CONST uint kMaxRays = 256u;

// Row of face s: bits [rowStart[s], rowStart[s+1]) of the chunk s / kRowsPerChunk; a chunk's rowStart has kRowsPerChunk + 1 words. Chunk
// addresses are in a table of uvec2.
RADIVOX_CONST uint kRowsPerChunk = 16384u;

RADIVOX_SHARED_END
#endif
