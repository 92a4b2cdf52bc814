// Irradiance from a triangle of uniform radiance, in closed form: Lambert's boundary formula with the polygon clipped to the
// receiver's horizon. Form factor F: E = π L F.
#ifndef RADIVOX_SHADERS_FRAME_POLYGON_GLSL
#define RADIVOX_SHADERS_FRAME_POLYGON_GLSL

// Keeps what lies above the plane through the origin with normal n. A triangle clipped twice has at most 5 corners.
void clipAbove(inout vec3 corners[5], inout uint count, vec3 n) {
  vec3 from[5] = corners;
  uint fromCount = count;
  count = 0u;
  [[dont_unroll]] for (uint i = 0u; i < fromCount; ++i) {
    vec3 a = from[i], b = from[i + 1u < fromCount ? i + 1u : 0u];
    float da = dot(a, n), db = dot(b, n);
    if (da >= 0.0) corners[min(count++, 4u)] = a;
    if ((da > 0.0 && db < 0.0) || (da < 0.0 && db > 0.0)) corners[min(count++, 4u)] = mix(a, b, da / (da - db));
  }
  count = min(count, 5u);
}

// Form factor from the point at the origin with shading normal n, on a surface with geometric normal g, to the front side of triangle
// abc (corners relative to the point). 0 from behind the triangle.
float triangleFormFactor(vec3 a, vec3 b, vec3 c, vec3 n, vec3 g) {
  vec3 normal = cross(b - a, c - a);
  float doubleArea = length(normal);
  float facing = -dot(a, normal);
  if (!(facing > 1e-7 * doubleArea * length(a))) return 0.0;

  vec3 centre = (a + b + c) * (1.0 / 3.0);
  float distance2 = dot(centre, centre);
  float size2 = max(dot(b - a, b - a), max(dot(c - b, c - b), dot(a - c, a - c)));
  // Far away the edge terms cancel to nothing in single precision; there the point formula is exact to 1e-4.
  if (size2 < 1e-4 * distance2) {
    float cosReceiver = dot(centre, n), cosGeometric = dot(centre, g);
    if (!(cosReceiver > 0.0 && cosGeometric > 0.0)) return 0.0;
    return cosReceiver * -dot(centre, normal) * 0.5 / (3.14159265358979 * distance2 * distance2);
  }

  vec3 corners[5];
  corners[0] = a;
  corners[1] = b;
  corners[2] = c;
  uint count = 3u;
  clipAbove(corners, count, n);
  if (dot(n, g) < 0.99999) clipAbove(corners, count, g);
  if (count < 3u) return 0.0;
  vec3 sum = vec3(0.0);
  vec3 last = normalize(corners[count - 1u]);
  [[dont_unroll]] for (uint i = 0u; i < count; ++i) {
    vec3 next = normalize(corners[i]);
    vec3 axis = cross(last, next);
    float sine = length(axis);
    // angle / sin(angle) is 1 as the edge shrinks.
    sum += axis * (sine > 1e-6 ? atan(sine, dot(last, next)) / sine : 1.0);
    last = next;
  }
  return clamp(abs(dot(sum, n)) * (0.5 / 3.14159265358979), 0.0, 1.0);
}

#endif
