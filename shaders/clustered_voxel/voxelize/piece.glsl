// The piece of a triangle inside one voxel: its area and centroid. Same bits in every stage and on every device (see functions.h).
//
// Seen along the dominant axis z, the piece is the triangle, cut by the slab 0 ≤ z ≤ 1, inside the unit square. The slab leaves at most five
// edges: the triangle's three, and one along each plane, which share their end points, so the outline is closed whatever the
// rounding. Area and moments are integrals of the outline's height, clamped to the square, over x (as glyph rasterizers
// do it): no list of corners, which few compilers keep in registers, and no edge depends on another.
#ifndef RADIVOX_VOXELIZE_PIECE_GLSL
#define RADIVOX_VOXELIZE_PIECE_GLSL
#include "clustered_voxel/voxelize/triangle.glsl"

// Positions are turned, in grid space relative to the voxel's low corner.
struct Piece {
  vec3 normal;  // unit geometric normal
  float area;   // h²; 0: no piece
  vec3 middle;  // centroid
  vec2 low;     // the triangle's bounds inside the unit square, along x and y
  vec2 high;
};

const float kTiny = 1e-20;

// One straight part of the outline above [low.x, low.x + width]: heights from a to b over low.y; width and x over low.x.
vec3 trapezoid(float x, float width, float a, float b) {
  precise float area = 0.5 * width * (a + b);
  precise float momentX = width * (1.0 / 6.0) * (x * (2.0 * a + b) + (x + width) * (a + 2.0 * b));
  precise float momentY = width * (1.0 / 6.0) * (a * a + a * b + b * b);
  return vec3(area, momentX, momentY);
}

// ∫ dx, ∫ x dx and ½∫ y dx of the height of edge p → q over low.y, clamped to low and high; negative where it runs backward.
vec3 integrateEdge(vec2 p, vec2 q, vec2 low, vec2 high) {
  bool backward = q.x < p.x;
  if (backward) {
    vec2 swapped = p;
    p = q;
    q = swapped;
  }
  precise float run = q.x - p.x;
  float startX = clamp(p.x, low.x, high.x), endX = clamp(q.x, low.x, high.x);
  precise float width = endX - startX;
  if (!(run > kTiny && width > 0.0)) return vec3(0.0);
  precise float slope = (q.y - p.y) * preciseReciprocal(run);
  // Each end is reached from the corner next to it, so that an end that is a corner stays exact.
  precise float startY = p.y + (startX - p.x) * slope;
  precise float endY = q.y + (endX - q.x) * slope;
  float lowest = min(p.y, q.y), highest = max(p.y, q.y);
  startY = clamp(startY, lowest, highest);
  endY = clamp(endY, lowest, highest);
  // Where the edge leaves and enters the band of heights.
  precise float rise = endY - startY;
  float atLow = 0.0, atHigh = 0.0;
  if (abs(rise) > kTiny) {
    float perRise = preciseReciprocal(abs(rise)) * (rise < 0.0 ? -1.0 : 1.0);
    precise float toLow = (low.y - startY) * perRise;
    precise float toHigh = (high.y - startY) * perRise;
    atLow = clamp(toLow, 0.0, 1.0);
    atHigh = clamp(toHigh, 0.0, 1.0);
  }
  float t1 = min(atLow, atHigh), t2 = max(atLow, atHigh);
  precise float y1 = startY + rise * t1;
  precise float y2 = startY + rise * t2;
  precise float h0 = clamp(startY, low.y, high.y) - low.y;
  precise float h1 = clamp(y1, low.y, high.y) - low.y;
  precise float h2 = clamp(y2, low.y, high.y) - low.y;
  precise float h3 = clamp(endY, low.y, high.y) - low.y;
  precise float x0 = startX - low.x;
  precise float width1 = width * t1;
  precise float width2 = width * (t2 - t1);
  precise float width3 = width * (1.0 - t2);
  precise vec3 sum = trapezoid(x0, width1, h0, h1) + trapezoid(x0 + width1, width2, h1, h2) + trapezoid(x0 + width1 + width2, width3, h2, h3);
  return backward ? -sum : sum;
}

// Where the edge a → b passes height z; the same point whichever end comes first, as the outline's neighbours need it.
vec2 crossingAt(vec3 a, vec3 b, float z) {
  precise float along = (z - a.z) * preciseReciprocal(max(abs(b.z - a.z), kTiny)) * (b.z < a.z ? -1.0 : 1.0);
  precise vec2 crossing = a.xy + (b.xy - a.xy) * clamp(along, 0.0, 1.0);
  return crossing;
}

// Height of the triangle's plane at a point of the square.
float planeHeight(vec3 corner, vec3 scaledNormal, vec2 point) {
  precise float height = corner.z - (scaledNormal.x * (point.x - corner.x) + scaledNormal.y * (point.y - corner.y));
  return height;
}

// Normal with z = 1 (scaled by it, not flipped): slopes, at most 1.
vec3 scaledNormal(Triangle t) {
  precise vec3 scaled = t.normal * (preciseReciprocal(abs(t.normal.z)) * (t.normal.z < 0.0 ? -1.0 : 1.0));
  return vec3(scaled.xy, 1.0);
}

vec3 unitNormal(Triangle t) {
  vec3 scaled = scaledNormal(t);
  precise float squared = scaled.x * scaled.x + scaled.y * scaled.y + 1.0;
  precise vec3 unit = scaled * (preciseInverseSqrt(squared) * (t.normal.z < 0.0 ? -1.0 : 1.0));
  return unit;
}

vec3 cornerInVoxel(Triangle t, uint corner, ivec3 voxel) {
  precise vec3 q = t.p[corner] - vec3(voxel);
  return q;
}

// Area and moments of the outline, seen along z.
vec3 integrateOutline(vec3 q[3], vec2 low, vec2 high) {
  precise vec3 sum = vec3(0.0);
  vec2 leave[2], enter[2];  // where the outline crosses z = 0 and z = 1
  leave[0] = leave[1] = enter[0] = enter[1] = vec2(0.0);
  for (uint e = 0u; e < 3u; ++e) {
    vec3 a = q[e], b = q[(e + 1u) % 3u];
    vec2 start = a.xy, end = b.xy;
    if ((a.z < 0.0) != (b.z < 0.0)) {
      vec2 crossing = crossingAt(a, b, 0.0);
      if (a.z < 0.0)
        start = enter[0] = crossing;
      else
        end = leave[0] = crossing;
    }
    if ((a.z > 1.0) != (b.z > 1.0)) {
      vec2 crossing = crossingAt(a, b, 1.0);
      if (a.z > 1.0)
        start = enter[1] = crossing;
      else
        end = leave[1] = crossing;
    }
    bool outside = (a.z < 0.0 && b.z < 0.0) || (a.z > 1.0 && b.z > 1.0);
    if (!outside) sum = sum + integrateEdge(start, end, low, high);
  }
  // Planes that the outline does not cross have both points at the origin, and no length.
  sum = sum + integrateEdge(leave[0], enter[0], low, high);
  sum = sum + integrateEdge(leave[1], enter[1], low, high);
  return sum;
}

Piece measurePiece(Triangle t, ivec3 voxel) {
  Piece piece = Piece(vec3(0.0, 0.0, 1.0), 0.0, vec3(0.5), vec2(0.0), vec2(1.0));
  if (!t.hasPlane) return piece;
  vec3 q[3];
  for (uint c = 0u; c < 3u; ++c) q[c] = cornerInVoxel(t, c, voxel);
  // Voxels are half-open for area: what lies in the plane to the next voxel is that one's. (Differences near 1 are exact.)
  vec3 least = min(q[0], min(q[1], q[2]));
  vec3 most = max(q[0], max(q[1], q[2]));
  if (any(equal(least, vec3(1.0)))) return piece;
  piece.low = clamp(least.xy, vec2(0.0), vec2(1.0));
  piece.high = clamp(most.xy, vec2(0.0), vec2(1.0));
  piece.normal = unitNormal(t);
  if (all(greaterThanEqual(least, vec3(0.0))) && all(lessThanEqual(most, vec3(1.0)))) {
    precise float whole = 0.5 * abs(t.normal.z) * preciseReciprocal(abs(piece.normal.z));
    precise vec3 mean = (q[0] + q[1] + q[2]) * (1.0 / 3.0);
    piece.area = whole;
    piece.middle = clamp(mean, vec3(0.0), vec3(1.0));
    return piece;
  }
  // The area lies below the outline, and the outline goes round against the clock where the normal looks along +z.
  precise vec3 sum = integrateOutline(q, piece.low, piece.high) * (t.normal.z < 0.0 ? 1.0 : -1.0);
  if (!(sum.x > kTiny)) return piece;
  precise float area = sum.x * preciseReciprocal(abs(piece.normal.z));
  precise vec2 middle = piece.low + sum.yz * preciseReciprocal(sum.x);
  piece.area = area;
  piece.middle.xy = clamp(middle, piece.low, piece.high);
  piece.middle.z = clamp(planeHeight(q[0], scaledNormal(t), piece.middle.xy), 0.0, 1.0);
  return piece;
}

// Barycentric coordinates (of corners 1 and 2) of a point, seen along z.
vec2 barycentricOf(Triangle t, ivec3 voxel, vec2 point) {
  precise vec2 q = point - cornerInVoxel(t, 0u, voxel).xy;
  float scale = preciseReciprocal(abs(t.normal.z)) * (t.normal.z < 0.0 ? -1.0 : 1.0);
  // normal.z = edge0 × edge1 = edge0 × (p2 − p0), and edge2 = p0 − p2.
  precise float b = (q.y * t.edge[2].x - q.x * t.edge[2].y) * scale;
  precise float c = (t.edge[0].x * q.y - t.edge[0].y * q.x) * scale;
  return vec2(b, c);
}

vec2 clampToTriangle(vec2 weights) {
  float b = clamp(weights.x, 0.0, 1.0);
  precise float rest = 1.0 - b;
  return vec2(b, clamp(weights.y, 0.0, rest));
}

#endif
