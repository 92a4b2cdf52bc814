// What every pixel shows, as the overlays take it: x: face id + 1, kSolid: a voxel but no face of it, 0: nothing. y: float bits of a shade in
// [0, 1], which is dark on a voxel's edges.
#ifndef RADIVOX_SHADERS_VIEWER_FACES_GLSL
#define RADIVOX_SHADERS_VIEWER_FACES_GLSL

const uint kSolid = 0xffffffffu;

// Of a point on a voxel's side: dark within a pixel or two of its edges, and lighter the more the side looks up or towards x.
// `inside`: in [0, 1]³; `pixel`: size of a pixel there, voxels.
float edgeShade(vec3 inside, uint axis, float pixel) {
  vec3 toEdge = min(inside, 1.0 - inside);
  toEdge[axis] = 1.0;
  float nearest = min(toEdge.x, min(toEdge.y, toEdge.z));
  float line = clamp(nearest / max(1.5 * pixel, 1e-4), 0.0, 1.0);
  // Voxels of a few pixels would be lines alone.
  float strength = clamp(0.25 / max(pixel, 1e-4) - 0.5, 0.0, 0.55);
  return 1.0 - strength * (1.0 - line);
}

#endif
