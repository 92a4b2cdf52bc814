#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// The count, and indirect dispatch arguments folded as Commands::dispatchItems folds them.
layout(local_size_x = 1) in;
layout(set = 0, binding = 0, scalar) readonly buffer Total { uvec2 total; };
layout(set = 0, binding = 1, scalar) writeonly buffer Count { uint count[4]; };
layout(push_constant, scalar) uniform Push {
  uint groupSize;
  uint maxGroupsX;
  uint isEmpty;  // nothing was summed: total is not written
};

void main() {
  const uint n = isEmpty != 0u ? 0u : total.x;
  const uint groups = n == 0u ? 0u : (n - 1u) / groupSize + 1u;
  count[0] = n;
  count[1] = min(groups, maxGroupsX);
  count[2] = max((groups + maxGroupsX - 1u) / maxGroupsX, 1u);
  count[3] = 1u;
}
