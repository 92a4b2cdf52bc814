#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// One axis of the Chebyshev distance transform over bricks. max separates: D(x,y,z) = min_k max(|z − k|, min_j max(|y − j|, min_i |x − i|)).
// The search along the axis ends where the step alone is as far as the best found. One lane a word of four bricks.
#define RADIVOX_BIND_GRID 0
#define RADIVOX_BIND_OCCUPANCY 1
#define RADIVOX_BIND_DISTANCE 2  // of the axes before; not read for x
#include "shared/dispatch.glsl"
#include "shared/voxel_lookup.glsl"

layout(local_size_x = 64) in;
layout(set = 0, binding = 3, scalar) writeonly buffer Distances { uint distances[]; };
layout(push_constant, scalar) uniform Push { uint axis; };

const uint kFar = 255u;

uint distanceBefore(uint brick) {
  if (axis != 0u) return brickDistance(brick);
  return brickBits(brick) == uvec2(0u) ? kFar : 0u;
}

uint distanceOf(uint brick, uint stride) {
  uint at = brickCoordinate(brick, grid.bricks)[axis];
  uint last = grid.bricks[axis] - 1u;
  uint best = distanceBefore(brick);
  for (uint step_ = 1u; step_ < best && (step_ <= at || at + step_ <= last); ++step_) {
    if (step_ <= at) best = min(best, max(step_, distanceBefore(brick - step_ * stride)));
    if (at + step_ <= last) best = min(best, max(step_, distanceBefore(brick + step_ * stride)));
  }
  return best;
}

void main() {
  uint first = 4u * radivoxItemIndex();
  if (first >= grid.brickCount) return;
  uint stride = axis == 0u ? 1u : (axis == 1u ? grid.bricks.x : grid.bricks.x * grid.bricks.y);
  uint word = 0u;
  for (uint i = 0u; i < 4u && first + i < grid.brickCount; ++i) word |= distanceOf(first + i, stride) << (8u * i);
  distances[first >> 2] = word;
}
