// A triangle in grid space, and the one test that decides which voxels it overlaps.
//
// Exact separating-axis test of the triangle against the closed cube dilated by kDilation on every side. Rounding moves no corner and
// no plane by more than kDilation, so the result holds every voxel that the exact test finds, and none that the exact test with
// cubes dilated by 2·kDilation does not. Triangles longer than kLongTriangle edges are decided with double-floats: at distance d a
// float product is only good to d·2⁻²³ voxel edges. Only +, − and × are used, so every device finds the same voxels.
#ifndef RADIVOX_VOXELIZE_TRIANGLE_GLSL
#define RADIVOX_VOXELIZE_TRIANGLE_GLSL
#include "clustered_voxel/voxelize/double_float.glsl"
#include "shared/scene.h"
#include "shared/voxel_codec.h"

layout(set = 0, binding = 0, scalar) readonly buffer RadivoxGrid { Grid grid; };
layout(set = 0, binding = 1, scalar) readonly buffer RadivoxVertices { Vertex vertices[]; };
layout(set = 0, binding = 2, scalar) readonly buffer RadivoxIndices { uint indices[]; };

const float kDilation = 2e-5;      // voxel edges
const float kLongTriangle = 64.0;  // voxel edges
const float kLeastNormal = 1e-30;  // h²; below it a triangle has no plane, and is tested by its edges alone

// All vectors have their components turned so that z is the dominant axis of the normal (turn): columns run along z, and no component
// is chosen at run time.
struct Triangle {
  uint id;
  uint axis;        // what z stands for: the dominant axis of the normal; without a plane, the axis of least extent
  vec3 p[3];        // grid space
  vec3 edge[3];     // p1 − p0, p2 − p1, p0 − p2, rounded
  vec3 edgeLow[3];  // what rounding left; 0 unless isLong
  vec3 normal;      // edge0 × edge1 = twice the area along the geometric normal, h²
  vec3 normalLow;
  ivec3 low;        // voxels that the dilated bounds reach, inclusive, inside the grid
  ivec3 high;
  bool isLong;
  bool hasPlane;
  bool isValid;     // finite, and somewhere in the grid
};

vec3 turn(vec3 v, uint axis) { return axis == 0u ? v.yzx : (axis == 1u ? v.zxy : v); }
vec3 turnBack(vec3 v, uint axis) { return axis == 0u ? v.zxy : (axis == 1u ? v.yzx : v); }
ivec3 turn(ivec3 v, uint axis) { return axis == 0u ? v.yzx : (axis == 1u ? v.zxy : v); }
ivec3 turnBack(ivec3 v, uint axis) { return axis == 0u ? v.zxy : (axis == 1u ? v.yzx : v); }

// Loops whose body is a double-float expression turn the vectors round instead of choosing components: the compiler then keeps one copy of the
// body, and pipelines are made several times faster.
void crossProduct(vec3 a, vec3 aLow, vec3 b, vec3 bLow, out vec3 product, out vec3 productLow) {
  product = productLow = vec3(0.0);
  for (uint k = 0u; k < 3u; ++k) {
    DoubleFloat component = differenceOfProducts(DoubleFloat(a.y, aLow.y), DoubleFloat(b.z, bLow.z), DoubleFloat(a.z, aLow.z),
                                                 DoubleFloat(b.y, bLow.y));
    product = vec3(product.yz, component.hi);
    productLow = vec3(productLow.yz, component.lo);
    a = a.yzx;
    aLow = aLow.yzx;
    b = b.yzx;
    bLow = bLow.yzx;
  }
}

Triangle loadTriangle(uint id) {
  Triangle t;
  t.id = id;
  for (uint c = 0u; c < 3u; ++c) t.p[c] = toGridSpace(grid, vertices[indices[3u * id + c]].position);
  vec3 least = min(t.p[0], min(t.p[1], t.p[2]));
  vec3 most = max(t.p[0], max(t.p[1], t.p[2]));
  precise vec3 extent = most - least;
  precise vec3 dilatedLeast = least - kDilation;
  precise vec3 dilatedMost = most + kDilation;
  t.isValid = all(greaterThanEqual(extent, vec3(0.0))) && all(lessThan(abs(least), vec3(1e6))) && all(lessThan(abs(most), vec3(1e6)));
  // A closed cube whose upper plane is just touched counts as well: ceil − 1 and not floor.
  t.low = max(ivec3(ceil(clamp(dilatedLeast, -2.0, 2048.0))) - 1, ivec3(0));
  t.high = min(ivec3(floor(clamp(dilatedMost, -2.0, 2048.0))), ivec3(grid.size) - 1);
  t.isValid = t.isValid && all(lessThanEqual(t.low, t.high));
  t.isLong = max(extent.x, max(extent.y, extent.z)) > kLongTriangle;
  for (uint e = 0u; e < 3u; ++e) {
    for (uint k = 0u; k < 3u; ++k) {
      DoubleFloat difference = exactSum(t.p[(e + 1u) % 3u][k], -t.p[e][k]);
      t.edge[e][k] = difference.hi;
      t.edgeLow[e][k] = t.isLong ? difference.lo : 0.0;
    }
  }
  crossProduct(t.edge[0], t.edgeLow[0], t.edge[1], t.edgeLow[1], t.normal, t.normalLow);
  vec3 size = abs(t.normal);
  t.hasPlane = max(size.x, max(size.y, size.z)) > kLeastNormal;
  if (t.hasPlane) {
    t.axis = size.x >= size.y && size.x >= size.z ? 0u : (size.y >= size.z ? 1u : 2u);
  } else {
    t.axis = extent.x <= extent.y && extent.x <= extent.z ? 0u : (extent.y <= extent.z ? 1u : 2u);
  }
  for (uint c = 0u; c < 3u; ++c) {
    t.p[c] = turn(t.p[c], t.axis);
    t.edge[c] = turn(t.edge[c], t.axis);
    t.edgeLow[c] = turn(t.edgeLow[c], t.axis);
  }
  t.normal = turn(t.normal, t.axis);
  t.normalLow = turn(t.normalLow, t.axis);
  t.low = turn(t.low, t.axis);
  t.high = turn(t.high, t.axis);
  return t;
}

// Do the edges, seen along turned axis k, part the triangle from the voxel? Of an edge's two ends and the corner opposite, the ends have one
// value, a_i·q_j − a_j·q_i with q relative to the voxel's centre, and the corner has that value plus twice the projected area.
bool isSeparatedAlong(Triangle t, uint k, vec3 centre) {
  uint i = (k + 1u) % 3u, j = (k + 2u) % 3u;
  for (uint e = 0u; e < 3u; ++e) {
    precise float qi = t.p[e][i] - centre[i];
    precise float qj = t.p[e][j] - centre[j];
    precise float side = t.edge[e][i] * qj - t.edge[e][j] * qi;
    precise float opposite = side + t.normal[k];
    precise float radius = (0.5 + kDilation) * (abs(t.edge[e][i]) + abs(t.edge[e][j]));
    if (min(side, opposite) > radius || max(side, opposite) < -radius) return true;
  }
  return false;
}

// The same with double-floats, for long triangles: along z, then x and y, `axisCount` of them from `skipped` on.
bool isSeparatedExactly(Triangle t, uint skipped, uint axisCount, vec3 centre) {
  // Component x is the axis; first turn z there.
  vec3 normal = t.normal.zxy, c = centre.zxy;
  vec3 p0 = t.p[0].zxy, p1 = t.p[1].zxy, p2 = t.p[2].zxy;
  vec3 e0 = t.edge[0].zxy, e1 = t.edge[1].zxy, e2 = t.edge[2].zxy;
  vec3 low0 = t.edgeLow[0].zxy, low1 = t.edgeLow[1].zxy, low2 = t.edgeLow[2].zxy;
  for (uint step_ = 0u; step_ < 3u * (skipped + axisCount); ++step_) {
    if (step_ >= 3u * skipped) {
      DoubleFloat exact = differenceOfProducts(DoubleFloat(e0.y, low0.y), exactSum(p0.z, -c.z), DoubleFloat(e0.z, low0.z),
                                               exactSum(p0.y, -c.y));
      precise float side = exact.hi;
      precise float opposite = side + normal.x;
      precise float radius = (0.5 + kDilation) * (abs(e0.y) + abs(e0.z));
      if (min(side, opposite) > radius || max(side, opposite) < -radius) return true;
    }
    // The next edge; after three, the next axis.
    bool turns = step_ % 3u == 2u;
    vec3 p = p0, e = e0, low = low0;
    p0 = turns ? p1.yzx : p1;
    e0 = turns ? e1.yzx : e1;
    low0 = turns ? low1.yzx : low1;
    p1 = turns ? p2.yzx : p2;
    e1 = turns ? e2.yzx : e2;
    low1 = turns ? low2.yzx : low2;
    p2 = turns ? p.yzx : p;
    e2 = turns ? e.yzx : e;
    low2 = turns ? low.yzx : low;
    normal = turns ? normal.yzx : normal;
    c = turns ? c.yzx : c;
  }
  return false;
}

bool isSeparatedByPlane(Triangle t, vec3 centre) {
  precise vec3 q = t.p[0] - centre;
  precise float height = t.normal.x * q.x + t.normal.y * q.y + t.normal.z * q.z;
  if (t.isLong) {
    DoubleFloat exact = DoubleFloat(0.0, 0.0);
    vec3 n = t.normal, low = t.normalLow, p = t.p[0], c = centre;
    for (uint k = 0u; k < 3u; ++k) {
      exact = add(exact, multiply(DoubleFloat(n.x, low.x), exactSum(p.x, -c.x)));
      n = n.yzx;
      low = low.yzx;
      p = p.yzx;
      c = c.yzx;
    }
    height = exact.hi;
  }
  precise float radius = (0.5 + kDilation) * (abs(t.normal.x) + abs(t.normal.y) + abs(t.normal.z));
  return abs(height) > radius;
}

bool isSeparatedByBounds(Triangle t, vec3 centre) {
  precise vec3 least = min(t.p[0], min(t.p[1], t.p[2])) - centre;
  precise vec3 most = max(t.p[0], max(t.p[1], t.p[2])) - centre;
  precise float radius = 0.5 + kDilation;
  return any(greaterThan(least, vec3(radius))) || any(lessThan(most, vec3(-radius)));
}

// The columns first…last − 1 of a triangle's rectangle of columns (row by row), and where we are in them. Each (triangle, voxel) pair is met
// once, whichever way the columns are cut up.
struct Walk {
  uint column;  // next one
  uint last;
  ivec3 voxel;  // next one to test; z past lastZ: the column is done
  int lastZ;
};

Walk walkColumns(uint first, uint last) { return Walk(first, last, ivec3(0, 0, 1), 0); }

// Which voxels of the column the triangle's plane may pass. Nothing where its edges part the triangle from the whole column.
void enterColumn(Triangle t, inout Walk walk) {
  uint width = uint(t.high.x - t.low.x + 1);
  walk.voxel.xy = t.low.xy + ivec2(walk.column % width, walk.column / width);
  ++walk.column;
  vec3 centre = vec3(vec2(walk.voxel.xy) + 0.5, 0.0);
  if (t.isLong ? isSeparatedExactly(t, 0u, 1u, centre) : isSeparatedAlong(t, 2u, centre)) return;
  walk.voxel.z = t.low.z;
  walk.lastZ = t.high.z;
  if (t.hasPlane) {
    // Slopes are at most 1. Only a guess at the range (0.02 bears its rounding): the tests decide.
    vec2 slope = -t.normal.xy / t.normal.z;
    float middle = t.p[0].z + dot(slope, centre.xy - t.p[0].xy);
    float reach = 0.5 * (abs(slope.x) + abs(slope.y)) + 0.02;
    walk.voxel.z = max(walk.voxel.z, int(ceil(clamp(middle - reach, -2.0, 2048.0))) - 1);
    walk.lastZ = min(walk.lastZ, int(floor(clamp(middle + reach, -2.0, 2048.0))));
  }
}

// Goes on to the next voxel that the triangle overlaps; false when there is none left. Kept apart from what a stage does with the voxel, so that
// lanes wait for each other before the costly part and not within the search.
bool findVoxel(Triangle t, inout Walk walk, out ivec3 found) {
  found = ivec3(0);
  while (true) {
    if (walk.voxel.z > walk.lastZ) {
      if (walk.column >= walk.last) return false;
      enterColumn(t, walk);
      continue;
    }
    vec3 centre = vec3(walk.voxel) + 0.5;
    found = walk.voxel;
    ++walk.voxel.z;
    if (isSeparatedByBounds(t, centre) || isSeparatedByPlane(t, centre)) continue;
    bool isSeparated = t.isLong ? isSeparatedExactly(t, 1u, 2u, centre) : isSeparatedAlong(t, 0u, centre) || isSeparatedAlong(t, 1u, centre);
    if (!isSeparated) return true;
  }
}

#endif
