// The unit normal of a triangle's front from its vertices, the same bits on every device; 0 for one without area. The includer declares vertices[] and
// indices[].
#ifndef RADIVOX_SHADERS_SHARED_TRIANGLE_NORMAL_GLSL
#define RADIVOX_SHADERS_SHARED_TRIANGLE_NORMAL_GLSL
#include "shared/functions.h"

float triangleDot(vec3 a, vec3 b) {
  precise float sum = a.x * b.x + a.y * b.y;
  precise float all_ = sum + a.z * b.z;
  return all_;
}

vec3 normalOfEdges(vec3 e1, vec3 e2) {
  precise vec3 across = vec3(e1.y * e2.z - e1.z * e2.y, e1.z * e2.x - e1.x * e2.z, e1.x * e2.y - e1.y * e2.x);
  precise vec3 unit = across * preciseInverseSqrt(max(triangleDot(across, across), 1e-30));
  return unit;
}

vec3 triangleNormal(uint id) {
  vec3 a = vertices[indices[3u * id]].position;
  return normalOfEdges(vertices[indices[3u * id + 1u]].position - a, vertices[indices[3u * id + 2u]].position - a);
}

#endif
