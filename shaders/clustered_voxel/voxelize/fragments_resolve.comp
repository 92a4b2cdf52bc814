#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// From sums to the mean normal of each voxel: one lane a voxel.
#include "shared/dispatch.glsl"
#include "shared/fixed_point.glsl"
#include "shared/functions.h"

layout(local_size_x = 64) in;
layout(set = 0, binding = 0, scalar) readonly buffer AreaSums { uvec2 areaSums[]; };
layout(set = 0, binding = 1, scalar) readonly buffer NormalSums { uvec2 normalSums[]; };
layout(set = 0, binding = 2, scalar) writeonly buffer Normals { vec3 normals[]; };
layout(push_constant, scalar) uniform Push { uint voxelCount; };

void main() {
  uint voxel = radivoxItemIndex();
  if (voxel >= voxelCount) return;
  uvec2 area = areaSums[voxel];
  uvec2 minus = fixedNegate(area);
  vec3 sum = vec3(fixedToFloat(fixedAdd(normalSums[3u * voxel], minus)), fixedToFloat(fixedAdd(normalSums[3u * voxel + 1u], minus)),
                  fixedToFloat(fixedAdd(normalSums[3u * voxel + 2u], minus)));
  float whole = fixedToFloat(area);
  precise float squared = sum.x * sum.x + sum.y * sum.y + sum.z * sum.z;
  // Two skins of a thin wall cancel but for rounding: below a thousandth of the area there is no direction left.
  precise float least = 1e-6 * whole * whole;
  precise vec3 normal = vec3(0.0);
  if (squared > least && squared > 1e-30) normal = sum * preciseInverseSqrt(squared);
  normals[voxel] = normal;
}
