#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Every shadow-map texel drops its flux into the voxel faces of the surface it lands on. See modules/clustered_voxel/inject/inject.h.
// A lane takes a short column of texels: next to each other they mostly land in one voxel, and what it gets is added up before memory is touched.
#include "shared/dispatch.glsl"
#include "shared/light.glsl"
#include "shared/scene.h"

#define RADIVOX_BIND_GRID 6
#define RADIVOX_BIND_OCCUPANCY 7
#define RADIVOX_BIND_RANK 8
layout(constant_id = 2) const uint kMaskStride = 2u;  // planes; 1: masks themselves
layout(constant_id = 3) const uint kMaskShift = 26u;  // 0
#define RADIVOX_BIND_MASK_WORDS 9
#define RADIVOX_BIND_FIRST_FACE 10
#include "shared/face_shares.h"
#include "shared/voxel_lookup.glsl"

layout(local_size_x = 64) in;

layout(set = 0, binding = 0, scalar) readonly buffer InfoBuffer { SceneInfo info; };
layout(set = 0, binding = 1, scalar) readonly buffer LightBuffer { Light lights[]; };
layout(set = 0, binding = 2, scalar) readonly buffer ViewBuffer { ShadowView views[]; };
layout(set = 0, binding = 3, scalar) readonly buffer VertexBuffer { Vertex vertices[]; };
layout(set = 0, binding = 4, scalar) readonly buffer IndexBuffer { uint indices[]; };
layout(set = 0, binding = 5) uniform usampler2DArray shadowTriangle;
layout(set = 0, binding = 11, scalar) buffer FluxLowBuffer { uint fluxLow[]; };  // RGB a face
layout(set = 0, binding = 12, scalar) buffer TableBuffer { uint viewTable[]; };  // [0] exponent as int; [1 + v] first run of view v
layout(set = 0, binding = 13, scalar) buffer StatusBuffer { uint status[]; };
layout(set = 0, binding = 14, scalar) readonly buffer TriangleMaterialBuffer { uint triangleMaterials[]; };
layout(set = 0, binding = 15, scalar) readonly buffer MaterialBuffer { Material materials[]; };
layout(set = 0, binding = 16, scalar) buffer FluxHighBuffer { uint fluxHigh[]; };
layout(set = 0, binding = 17, scalar) readonly buffer FacesBuffer { Face faces[]; };
layout(set = 0, binding = 18, scalar) readonly buffer TriangleFirstBuffer { uint triangleFirst[]; };
layout(set = 0, binding = 19, scalar) readonly buffer TriangleIdsBuffer { uint triangleIds[]; };
layout(constant_id = 1) const bool kApart = false;  // pieces of other sides leave faces
layout(constant_id = 0) const uint kSoleLight = 0xffffffffu;  // the kind of the one light; all ones: there may be more
const uint kRun = 16u;  // texels
layout(push_constant, scalar) uniform Push {
  uint viewCount;
  uint lightCount;
  uint faceCount;  // 0: make the table
};

#include "clustered_voxel/apart.glsl"

void makeTable() {
  // No light's flux can pass this: the sum in any face stays below 2^62 of the fixed-point unit.
  float total = 0.0;
  for (uint l = 0; l < lightCount; ++l) {
    float peak = max(lights[l].intensity.x, max(lights[l].intensity.y, lights[l].intensity.z));
    total += lights[l].type == kLightDirectional ? 0.0 : 12.566371 * peak;
  }
  uint runs = 0;
  for (uint v = 0; v < viewCount; ++v) {
    viewTable[1 + v] = runs;
    uint count = views[v].resolution * views[v].resolution;
    runs += views[v].resolution * ((views[v].resolution + kRun - 1) / kRun);
    Light light = lights[views[v].light];
    if (light.type == kLightDirectional) {
      float peak = max(light.intensity.x, max(light.intensity.y, light.intensity.z));
      total += peak * views[v].texelFlux * float(count);
    }
  }
  viewTable[1 + viewCount] = runs;
  int exponent = total > 0.0 && !isinf(total) ? 61 - int(ceil(log2(total))) : 0;
  viewTable[0] = uint(clamp(exponent, -120, 120));
}

// 64-bit fixed point: exact, since a float's 24 bits lie somewhere within the 62.
uvec2 toUnits(float value, int exponent) {
  float high = floor(ldexp(value, exponent - 32));
  float low = ldexp(value, exponent) - high * 4294967296.0;
  return uvec2(uint(low), uint(high));
}

void addFlux(uint word, uvec2 value) {
  if (value.x == 0u && value.y == 0u) return;
  uint old = atomicAdd(fluxLow[word], value.x);
  uint carry = old + value.x < old ? 1u : 0u;
  uint high = value.y + carry;
  if (high != 0u) atomicAdd(fluxHigh[word], high);
}

bool isDominant() { return grid.dominant != 0u; }

// How much of the power on surface with normal n each of its faces gets. Where it belongs to one, that is the first, whatever its axis.
vec3 sharesOf(vec3 n) { return isDominant() ? vec3(1.0, 0.0, 0.0) : abs(n); }

// The faces of the voxel at `coord` that surface with normal n is part of, as sharesOf() has them; kNone: none, or one that does not show it. Returns
// what of it found a face. Light on a back goes where the face is made of backs: a face that shows fronts does not show it, and beside the edge of a
// thin-walled room those fronts may lie inside, the lit back outside.
float facesAt(ivec3 coord, uint triangle, vec3 n, bool isBack, out uvec3 found) {
  found = uvec3(kNone);
  uint voxel = voxelIndex(coord);
  if (voxel == kNone) return 0.0;
  uint apart = kApart ? apartIn(voxel, triangle) : 0u;
  vec3 shares = faceShares(n, isDominant());
  float weight = 0.0;
  for (uint k = 0; k < 3; ++k) {
    uint f = 2 * k + (n[k] < 0.0 ? 1u : 0u);
    uint face = faceIndex(voxel, f);
    if (face == kNone || shares[k] == 0.0) continue;
    weight += shares[k] * shares[k];
    if (((apart >> f) & 1u) != 0u || (isBack && (faces[face].position & kMadeOfBacks) == 0u)) continue;
    found[isDominant() ? 0u : k] = face;
  }
  return weight;
}

void deposit(uvec3 found, vec3 shares, vec3 power, int exponent) {
  for (uint k = 0; k < 3; ++k) {
    if (found[k] == kNone) continue;
    for (uint c = 0; c < 3; ++c) addFlux(found[k] * 3 + c, toUnits(power[c] * shares[k], exponent));
  }
}

// What the run has brought to one voxel's faces so far.
uvec3 sumFaces = uvec3(kNone);
uvec2 sums[9];

void flush() {
  for (uint k = 0; k < 3; ++k) {
    if (sumFaces[k] == kNone) continue;
    for (uint c = 0; c < 3; ++c) addFlux(sumFaces[k] * 3 + c, sums[3 * k + c]);
  }
}

void main() {
  uint i = radivoxItemIndex();
  if (faceCount == 0u) {
    if (i == 0u) makeTable();
    return;
  }
  if (i >= viewTable[1 + viewCount]) return;
  uint low = 0, high = viewCount;  // the last view whose first run is ≤ i
  while (kSoleLight != kLightDirectional && high - low > 1) {
    uint middle = (low + high) / 2;
    if (viewTable[1 + middle] <= i) low = middle;
    else high = middle;
  }
  ShadowView view = views[low];
  Light light = lights[view.light];
  if (kSoleLight != 0xffffffffu) light.type = kSoleLight;
  uint local = i - viewTable[1 + low];
  uvec2 texel = uvec2(local % view.resolution, local / view.resolution * kRun);
  uint end = min(texel.y + kRun, view.resolution);
  int exponent = int(viewTable[0]);

  uint id = 0u;  // of the texel before, + 1
  vec3 a = vec3(0.0), front = vec3(0.0);
  bool hasPlane = false, isDouble = false;
  ivec3 sumCoord = ivec3(-1);
  uint sumId = 0u;
  float sumWeight = 0.0;
  bool sumFront = true;
  uint lit = 0u, lost = 0u;
  for (; texel.y < end; ++texel.y) {
    uint here = texelFetch(shadowTriangle, ivec3(view.offsetX + texel.x, view.offsetY + texel.y, view.layer), 0).x;
    if (here == 0u) continue;
    uint triangle = here - 1;
    if (here != id) {
      id = here;
      a = vertices[indices[3 * triangle]].position;
      vec3 b = vertices[indices[3 * triangle + 1]].position;
      vec3 c = vertices[indices[3 * triangle + 2]].position;
      front = cross(b - a, c - a);
      float doubleArea = length(front);
      hasPlane = doubleArea > 0.0;
      front /= doubleArea;
      isDouble = (materials[triangleMaterials[triangle]].flags & kMaterialDoubleSided) != 0u;
    }
    if (!hasPlane) continue;

    // The texel centre's ray meets the triangle's plane: exact, where the stored depth is rounded.
    vec2 ndc = (vec2(texel) + 0.5) / float(view.resolution) * 2.0 - 1.0;
    vec3 origin, d;
    shadowRay(view, light, ndc, origin, d);
    float slope = dot(front, d);
    if (slope == 0.0) continue;
    float t = dot(front, a - origin) / slope;
    vec3 p = origin + t * d;
    bool isFront = slope < 0.0;
    bool isBack = !isFront && !isDouble;
    if (isBack && grid.singleSided != 0u) continue;
    vec3 n = isFront ? front : -front;  // the side that the light reaches
    vec3 power = shadowTexelFlux(view, light, d, p);
    if (!(max(power.x, max(power.y, power.z)) > 0.0)) continue;
    ++lit;

    vec3 q = toGridSpace(grid, p);
    ivec3 coord = ivec3(floor(q));
    if (here != sumId || coord != sumCoord || isFront != sumFront) {
      flush();
      sumWeight = facesAt(coord, triangle, n, isBack, sumFaces);
      sumId = here;
      sumCoord = coord;
      sumFront = isFront;
      for (uint w = 0; w < 9; ++w) sums[w] = uvec2(0u);
    }
    vec3 shares = sharesOf(n);
    for (uint k = 0; k < (isDominant() ? 1u : 3u); ++k) {
      for (uint c = 0; c < 3; ++c) {
        uvec2 units = toUnits(power[c] * shares[k], exponent);
        uint sum = sums[3 * k + c].x + units.x;
        sums[3 * k + c] = uvec2(sum, sums[3 * k + c].y + units.y + (sum < units.x ? 1u : 0u));
      }
    }
    if (sumWeight > 0.5) continue;
    // On the border between two voxels rounding may choose the one that has no such face: try the nearer neighbours.
    vec3 inside = q - floor(q);
    bool placed = false;
    for (int k = 0; k < 3 && !placed; ++k) {
      ivec3 step = ivec3(0);
      step[k] = inside[k] < 0.5 ? -1 : 1;
      if (min(inside[k], 1.0 - inside[k]) >= 0.01) continue;
      uvec3 found;
      placed = facesAt(coord + step, triangle, n, isBack, found) > 0.5;
      deposit(found, shares, power, exponent);
    }
    lost += placed ? 0u : 1u;
  }
  flush();
  if (lost != 0u) atomicAdd(status[0], lost);
  if (lit != 0u) {
    uint old = atomicAdd(status[1], lit);
    if (old + lit < old) atomicAdd(status[2], 1u);
  }
}
