// main() of the compute way: one lane walks one item's columns. Include after visitVoxel is defined.
#include "clustered_voxel/voxelize/items.glsl"
#include "shared/dispatch.glsl"

layout(local_size_x = 64) in;
layout(set = 0, binding = 3, scalar) readonly buffer FirstItems { uint firstItems[]; };  // [triangleCount]: the total

// The last triangle whose first item is not after `item`; triangles without items share theirs with the next and are passed over.
uint triangleOfItem(uint item) {
  uint low = 0u, high = triangleCount;
  while (high - low > 1u) {
    uint middle = (low + high) >> 1;
    if (firstItems[middle] <= item)
      low = middle;
    else
      high = middle;
  }
  return low;
}

void main() {
  uint item = radivoxItemIndex();
  if (item >= firstItems[triangleCount]) return;
  uint triangle = triangleOfItem(item);
  Triangle t = loadTriangle(triangle);
  uvec2 extent = uvec2(t.high.xy - t.low.xy + 1);
  uint columnCount = extent.x * extent.y;
  uint itemCount = itemCountOf(t);
  uint run = (columnCount + itemCount - 1u) / itemCount;
  uint first = min((item - firstItems[triangle]) * run, columnCount);
  Walk walk = walkColumns(first, min(first + run, columnCount));
  ivec3 voxel;
  while (findVoxel(t, walk, voxel)) visitVoxel(t, voxel);
}
