// The unit shading normal in the middle of a piece, on the side that the geometric normal looks to. Include after material.glsl.
vec3 shadingNormal(Triangle t, ivec3 turned, Piece piece, vec3 geometric) {
  vec2 weights = clampToTriangle(barycentricOf(t, turned, piece.middle.xy));
  vec3 n0 = vertices[indices[3u * t.id]].normal;
  vec3 n1 = vertices[indices[3u * t.id + 1u]].normal;
  vec3 n2 = vertices[indices[3u * t.id + 2u]].normal;
  precise vec3 sum = n0 + (n1 - n0) * weights.x + (n2 - n0) * weights.y;
  precise float squared = sum.x * sum.x + sum.y * sum.y + sum.z * sum.z;
  if (!(squared > 1e-12 && squared < 1e12)) return geometric;
  precise vec3 normal = sum * preciseInverseSqrt(squared);
  precise float side = normal.x * geometric.x + normal.y * geometric.y + normal.z * geometric.z;
  return side < 0.0 ? -normal : normal;
}
