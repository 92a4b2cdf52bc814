#version 460
#extension GL_GOOGLE_include_directive : require
#include "view.glsl"
// What Radivox's lighting nodes read (docs/nodes.md, frame.gbuffer). Any G-buffer can be brought into this form; the nearer positions are
// to their triangles' planes, the better. An interpolator's rounding is enough to turn a shadow at a wall's foot on or off, so this one
// takes the point where the camera ray meets the plane.
layout(location = 0) flat in uint triangle;
layout(location = 0) out vec4 outPosition;  // m; w: distance along the view axis, 0: sky
layout(location = 1) out vec4 outNormal;    // unit, on the viewer's side
layout(location = 2) out vec4 outAlbedo;    // a: 1 surface, 0 sky
layout(location = 3) out vec4 outEmission;  // radiance, front side only
layout(location = 4) out uint outTriangle;  // id + 1; 0: sky

void main() {
  Vertex a = vertices.at[3u * triangle], b = vertices.at[3u * triangle + 1u], c = vertices.at[3u * triangle + 2u];
  vec2 ndc = gl_FragCoord.xy / vec2(view.size) * 2.0 - 1.0;
  vec3 d = (view.inverseViewProjection * vec4(ndc, 0.0, 1.0)).xyz;  // reversed z: the direction to what is infinitely far

  // Möller and Trumbore.
  vec3 ab = b.position - a.position, ac = c.position - a.position;
  vec3 q = cross(d, ac);
  float determinant = dot(ab, q);
  float inverse = determinant != 0.0 ? 1.0 / determinant : 0.0;
  vec3 s = view.eye - a.position;
  float u = clamp(dot(s, q) * inverse, 0.0, 1.0);
  float v = clamp(dot(d, cross(s, ab)) * inverse, 0.0, 1.0 - u);
  vec3 position = a.position + u * ab + v * ac;

  vec3 geometric = cross(ab, ac);
  bool front = dot(geometric, d) < 0.0;
  if (!front) geometric = -geometric;
  vec3 normal = (1.0 - u - v) * a.normal + u * b.normal + v * c.normal;
  normal *= inversesqrt(dot(normal, normal));
  if (dot(normal, geometric) < 0.0) normal = -normal;

  outPosition = vec4(position, dot(position - view.eye, view.forward));
  outNormal = vec4(normal, 0.0);
  outAlbedo = vec4(a.albedo, 1.0);
  outEmission = vec4(front ? a.emission : vec3(0.0), 0.0);
  outTriangle = triangle + 1u;
}
