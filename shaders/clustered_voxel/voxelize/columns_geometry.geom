#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Geometry way: a polygon whose fragments hold every column that the triangle overlaps. It is the rectangle of those columns, clipped by the
// three edges moved outward by half a pixel's extent: never larger than the bounds, however thin the triangle is, and drawn as a strip
// whose inner edges belong to one side only, so that each column gets one fragment.
#include "clustered_voxel/voxelize/triangle.glsl"
#include "clustered_voxel/voxelize/raster_square.glsl"

layout(triangles) in;
layout(triangle_strip, max_vertices = 7) out;
layout(location = 0) flat in uint vertexTriangleId[];
layout(location = 0) flat out uint triangleId;

// Pixels; bears the rasterizer's snapping to 1/256 and our own rounding. The columns' own test decides.
const float kMargin = 0.02;

void main() {
  Triangle t = loadTriangle(vertexTriangleId[0]);
  if (!t.isValid) return;
  vec2 least = vec2(t.low.xy) + 0.5 - kMargin - 0.25;
  vec2 most = vec2(t.high.xy) + 0.5 + kMargin + 0.25;
  vec2 polygon[8] = vec2[8](least, vec2(most.x, least.y), most, vec2(least.x, most.y), vec2(0.0), vec2(0.0), vec2(0.0), vec2(0.0));
  uint count = 4u;
  for (uint e = 0u; e < 3u && t.hasPlane; ++e) {
    // Inside: normal · (x − p) ≥ −reach, the normal turned inward.
    vec2 direction = t.edge[e].xy;
    vec2 inward = t.normal.z > 0.0 ? vec2(-direction.y, direction.x) : vec2(direction.y, -direction.x);
    float reach = (0.5 + kMargin) * (abs(inward.x) + abs(inward.y));
    if (!(reach > 1e-20)) continue;
    vec2 kept[8];
    uint keptCount = 0u;
    for (uint c = 0u; c < count; ++c) {
      vec2 a = polygon[c], b = polygon[(c + 1u) % count];
      float sideA = dot(inward, a - t.p[e].xy) + reach, sideB = dot(inward, b - t.p[e].xy) + reach;
      if (sideA >= 0.0 && keptCount < 8u) kept[keptCount++] = a;
      if ((sideA > 0.0 && sideB < 0.0) || (sideA < 0.0 && sideB > 0.0)) {
        if (keptCount < 8u) kept[keptCount++] = mix(a, b, clamp(sideA / (sideA - sideB), 0.0, 1.0));
      }
    }
    if (keptCount < 3u) return;
    for (uint c = 0u; c < keptCount; ++c) polygon[c] = kept[c];
    count = keptCount;
  }
  // Strip order of a convex polygon: 0, 1, n−1, 2, n−2, …
  for (uint s = 0u; s < min(count, 7u); ++s) {
    triangleId = t.id;
    gl_Position = columnToClip(polygon[(s & 1u) == 1u ? (s + 1u) / 2u : (count - s / 2u) % count]);
    EmitVertex();
  }
  EndPrimitive();
}
