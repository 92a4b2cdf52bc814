#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Hardware way: the triangle seen along its dominant axis, for conservative rasterization. Triangles that are thinner than a pixel there
// may vanish once their corners are snapped; one triangle around their bounds is drawn instead, and the columns' own test sorts out.
#include "clustered_voxel/voxelize/triangle.glsl"
#include "clustered_voxel/voxelize/raster_square.glsl"

layout(location = 0) flat out uint triangleId;

void main() {
  triangleId = uint(gl_VertexIndex) / 3u;
  uint corner = uint(gl_VertexIndex) % 3u;
  Triangle t = loadTriangle(triangleId);
  if (!t.isValid) {
    gl_Position = vec4(2.0, 2.0, 0.5, 1.0);  // all three corners: no fragments
    return;
  }
  float longest = 0.0;
  for (uint e = 0u; e < 3u; ++e) longest = max(longest, max(abs(t.edge[e].x), abs(t.edge[e].y)));
  bool isThin = !(abs(t.normal.z) > longest);  // twice the area over the longest edge: the height in pixels
  vec2 low = vec2(t.low.xy) + 0.25, extent = vec2(t.high.xy - t.low.xy) + 0.5;
  vec2 around = low + vec2(corner == 1u ? 2.0 : 0.0, corner == 2u ? 2.0 : 0.0) * extent;
  gl_Position = columnToClip(isThin ? around : t.p[corner].xy);
}
