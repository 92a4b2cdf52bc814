// The stencil of voxel faces from which a surface point takes its irradiance. `mark` and `shade` walk it with the same code, so that
// every face that is read has been gathered. Include after structure.glsl; define RECEIVER_VISIT(face, weight, k) first, where k is the axis
// (the caller renormalises per axis and mixes axes by n_k²).
#ifndef RADIVOX_CLUSTERED_VOXEL_RECEIVER_GLSL
#define RADIVOX_CLUSTERED_VOXEL_RECEIVER_GLSL
#include "clustered_voxel/walls.glsl"

// p in grid space, n unit. interpolate: all eight voxels about p; otherwise p's own voxel alone.
void visitReceivers(vec3 p, vec3 n, bool interpolate) {
  ivec3 home = ivec3(floor(p));
  uint homeVoxel = voxelIndex(home);
  ivec3 base = ivec3(floor(p - 0.5));
  vec3 t = p - 0.5 - vec3(base);
  ivec3 ahead = stepAhead(n);
  bool found = false;
  for (int i = 0; i < (interpolate ? 8 : 1); ++i) {
    ivec3 bits = ivec3(i & 1, (i >> 1) & 1, i >> 2);
    ivec3 coord = interpolate ? base + bits : home;
    uint voxel = coord == home ? homeVoxel : voxelIndex(coord);
    if (voxel == kNone) continue;
    vec3 w3 = mix(1.0 - t, t, vec3(bits));
    float trilinear = interpolate ? w3.x * w3.y * w3.z : 1.0;
    for (uint k = 0; k < 3; ++k) {
      if (n[k] * n[k] < 1e-4) continue;
      uint s = faceIndex(voxel, 2 * k + (n[k] < 0.0 ? 1u : 0u));
      if (s == kNone) continue;
      Face face = faceAt(s);
      vec3 x = vec3(coord) + decodePosition(face.position);
      vec3 ns = decodeNormal(face.normal);
      // The face lies on the surface's own sheet: normals agree, and p is near its plane.
      float offPlane = dot(p - x, ns);
      float agree = max(0.0, dot(ns, n)) * max(0.0, 1.0 - offPlane * offPlane);
      // A scrap of surface says little about its voxel.
      float substance = face.area / (face.area + 0.05);
      float weight = (trilinear + 1e-4) * agree * agree * substance;
      if (weight <= 0.0 || (interpolate && coord != home && wallBetween(home, homeVoxel, p, coord, voxel, x, ahead))) continue;
      found = true;
      RECEIVER_VISIT(s, weight, k)
    }
  }
  if (found) return;
  // Nothing on this sheet (a shading normal far from the surface's, a masked rim): any face about that looks the same way.
  for (int i = 0; i < 27; ++i) {
    ivec3 coord = home + ivec3(i % 3, (i / 3) % 3, i / 9) - 1;
    uint voxel = voxelIndex(coord);
    if (voxel == kNone) continue;
    for (uint f = 0; f < kFaceCount; ++f) {
      uint s = faceIndex(voxel, f);
      if (s == kNone) continue;
      vec3 offset = vec3(coord) + decodePosition(faceAt(s).position) - p;
      float weight = max(1e-3, dot(decodeNormal(faceAt(s).normal), n)) / (0.01 + dot(offset, offset) * dot(offset, offset));
      RECEIVER_VISIT(s, weight, 3)
    }
  }
}

#endif
