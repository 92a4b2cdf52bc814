// main() of the raster ways: a fragment is one column of its triangle. Include after visitVoxel is defined.
layout(location = 0) flat in uint triangleId;

void main() {
  Triangle t = loadTriangle(triangleId);
  if (t.isValid) visitColumn(t, ivec2(gl_FragCoord.xy));
}
