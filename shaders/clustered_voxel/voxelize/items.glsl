// Work items of the compute way: a triangle's columns, cut into runs that a lane walks. A triangle of up to kColumnsPerItem columns is
// one item; a wall that covers the whole grid is thousands.
#ifndef RADIVOX_VOXELIZE_ITEMS_GLSL
#define RADIVOX_VOXELIZE_ITEMS_GLSL

layout(push_constant, scalar) uniform Push {
  uint triangleCount;
  uint itemLimit;  // most items that one triangle may have, so that the total stays below 2³¹
};

const uint kColumnsPerItem = 16u;

uint itemCountOf(Triangle t) {
  if (!t.isValid) return 0u;
  uvec2 extent = uvec2(t.high.xy - t.low.xy + 1);
  return clamp((extent.x * extent.y + kColumnsPerItem - 1u) / kColumnsPerItem, 1u, itemLimit);
}

#endif
