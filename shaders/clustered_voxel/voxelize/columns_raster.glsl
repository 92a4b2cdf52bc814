// main() of the raster ways: a fragment is one column of its triangle. Include after visitVoxel is defined.
layout(location = 0) flat in uint triangleId;

void main() {
  Triangle t = loadTriangle(triangleId);
  ivec2 column = ivec2(gl_FragCoord.xy);
  // Fragments are more than the triangle's columns where the rasterizer is conservative.
  if (!t.isValid || any(lessThan(column, t.low.xy)) || any(greaterThan(column, t.high.xy))) return;
  uint index = uint(column.x - t.low.x) + uint(t.high.x - t.low.x + 1) * uint(column.y - t.low.y);
  Walk walk = walkColumns(index, index + 1u);
  ivec3 voxel;
  while (findVoxel(t, walk, voxel)) visitVoxel(t, voxel);
}
