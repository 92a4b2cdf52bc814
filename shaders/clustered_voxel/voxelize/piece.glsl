// The piece of a triangle inside one voxel: area, centroid and points on it. Same bits in every stage and on every device (see functions.h).
#ifndef RADIVOX_VOXELIZE_PIECE_GLSL
#define RADIVOX_VOXELIZE_PIECE_GLSL
#include "clustered_voxel/voxelize/triangle.glsl"

struct Piece {
  vec3 normal;      // unit geometric normal, turned
  float area;       // h²; 0: no piece
  vec3 middle;    // centroid, grid space relative to the voxel's low corner, turned
};

// Corners of the piece, turned, relative to the voxel's low corner. A triangle cut by six planes has at most 9.
const uint kMaxCorners = 9u;
vec3 corners[kMaxCorners];
uint cornerCount;

float sideOf(vec3 corner, uint k, bool upper) {
  precise float side = upper ? 1.0 - corner[k] : corner[k];
  return side;
}

// Keeps what lies on the inner side of the voxel's lower or upper plane of axis k (Sutherland and Hodgman).
void clipBy(uint k, bool upper) {
  bool anyOutside = false;
  for (uint c = 0u; c < cornerCount; ++c) anyOutside = anyOutside || sideOf(corners[c], k, upper) < 0.0;
  if (!anyOutside) return;
  vec3 kept[kMaxCorners];
  uint keptCount = 0u;
  vec3 a = corners[cornerCount - 1u];
  float sideA = sideOf(a, k, upper);
  for (uint c = 0u; c < cornerCount; ++c) {
    vec3 b = corners[c];
    float sideB = sideOf(b, k, upper);
    if (sideA * sideB < 0.0 && keptCount < kMaxCorners) {
      precise float along = min(abs(sideA) * preciseReciprocal(abs(sideA) + abs(sideB)), 1.0);
      precise vec3 cut = a + (b - a) * along;
      cut[k] = upper ? 1.0 : 0.0;
      kept[keptCount++] = cut;
    }
    if (sideB >= 0.0 && keptCount < kMaxCorners) kept[keptCount++] = b;
    a = b;
    sideA = sideB;
  }
  for (uint c = 0u; c < keptCount; ++c) corners[c] = kept[c];
  cornerCount = keptCount;
}

// Twice the area of the fan's triangle (0, c, c + 1) along the unit normal.
float fanWeight(uint c, vec3 normal) {
  precise vec3 a = corners[c] - corners[0];
  precise vec3 b = corners[c + 1u] - corners[0];
  precise vec3 product = vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
  precise float weight = max(product.x * normal.x + product.y * normal.y + product.z * normal.z, 0.0);
  return weight;
}

// Leaves the piece's corners in `corners`.
Piece measurePiece(Triangle t, ivec3 voxel) {
  Piece piece = Piece(vec3(0.0, 0.0, 1.0), 0.0, vec3(0.5));
  if (!t.hasPlane) return piece;
  precise vec3 q0 = t.p[0] - vec3(voxel);
  precise vec3 q1 = t.p[1] - vec3(voxel);
  precise vec3 q2 = t.p[2] - vec3(voxel);
  // Voxels are half-open for area: what lies in the plane to the next voxel is that one's. (Differences near 1 are exact.)
  vec3 least = min(q0, min(q1, q2));
  vec3 most = max(q0, max(q1, q2));
  if (any(equal(least, vec3(1.0)))) return piece;
  corners[0] = q0;
  corners[1] = q1;
  corners[2] = q2;
  cornerCount = 3u;
  if (any(lessThan(least, vec3(0.0))) || any(greaterThan(most, vec3(1.0)))) {
    clipBy(0u, false);
    clipBy(0u, true);
    clipBy(1u, false);
    clipBy(1u, true);
    clipBy(2u, false);
    clipBy(2u, true);
    if (cornerCount < 3u) return piece;
  }
  // z dominates: scaled by it, the squared length is between 1 and 3.
  precise vec3 scaled = t.normal * preciseReciprocal(abs(t.normal.z));
  precise float squared = scaled.x * scaled.x + scaled.y * scaled.y + scaled.z * scaled.z;
  precise vec3 normal = scaled * preciseInverseSqrt(squared);
  piece.normal = normal;
  precise float twiceArea = 0.0;
  precise vec3 moment = vec3(0.0);
  for (uint c = 1u; c + 1u < cornerCount; ++c) {
    float weight = fanWeight(c, normal);
    twiceArea = twiceArea + weight;
    moment = moment + weight * ((corners[c] - corners[0]) + (corners[c + 1u] - corners[0]));
  }
  if (!(twiceArea > 1e-20)) return piece;
  precise float area = 0.5 * twiceArea;
  precise vec3 middle = corners[0] + moment * (preciseReciprocal(twiceArea) * (1.0 / 3.0));
  piece.area = area;
  piece.middle = clamp(middle, vec3(0.0), vec3(1.0));
  return piece;
}

// Point s of `count` spread evenly over the piece's area: strata of equal area along the fan, van der Corput across.
vec3 pointOnPiece(Piece piece, uint s, uint count) {
  precise float target = 2.0 * piece.area * ((float(s) + 0.5) / float(count));  // count is a power of two: exact
  uint chosen = 1u;
  precise float along = 0.5;
  for (uint c = 1u; c + 1u < cornerCount; ++c) {
    float weight = fanWeight(c, piece.normal);
    if (target <= weight || c + 2u == cornerCount) {
      chosen = c;
      along = clamp(target * preciseReciprocal(max(weight, 1e-30)), 0.0, 1.0);
      break;
    }
    target = target - weight;
  }
  precise float across = float(bitfieldReverse(s) >> 8) * (1.0 / 16777216.0) + 0.5 / float(count);
  // The upper half of the unit square folds onto the lower.
  if (along + across > 1.0) {
    precise float folded = 1.0 - across;
    across = folded;
    along = 1.0 - along;
  }
  precise vec3 point =
      corners[0] + (corners[chosen] - corners[0]) * along + (corners[chosen + 1u] - corners[0]) * across;
  return clamp(point, vec3(0.0), vec3(1.0));
}

// Barycentric coordinates (of corners 1 and 2) of a point in the voxel, seen along the dominant axis; inside the triangle.
vec2 barycentricOf(Triangle t, ivec3 voxel, vec3 point) {
  precise vec2 q = (vec2(voxel.xy) - t.p[0].xy) + point.xy;
  float scale = preciseReciprocal(abs(t.normal.z)) * (t.normal.z < 0.0 ? -1.0 : 1.0);
  // normal.z = edge0 × edge1 = edge0 × (p2 − p0), and edge2 = p0 − p2.
  precise float b = (q.y * t.edge[2].x - q.x * t.edge[2].y) * scale;
  precise float c = (t.edge[0].x * q.y - t.edge[0].y * q.x) * scale;
  b = clamp(b, 0.0, 1.0);
  c = clamp(c, 0.0, 1.0 - b);
  return vec2(b, c);
}

#endif
