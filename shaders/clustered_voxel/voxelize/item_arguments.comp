#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Compute way, third step (after the scan of the counts): indirect arguments for one lane an item, folded as Commands::dispatchItems does.
layout(local_size_x = 1) in;
layout(set = 0, binding = 0, scalar) readonly buffer FirstItems { uint firstItems[]; };  // [triangleCount]: the total
layout(set = 0, binding = 1, scalar) writeonly buffer Arguments { uvec3 arguments; };
layout(push_constant, scalar) uniform Push {
  uint triangleCount;
  uint itemLimit;
};

const uint kGroupSize = 64u;
const uint kMaxGroupsX = 32768u;

void main() {
  uint groups = (firstItems[triangleCount] + kGroupSize - 1u) / kGroupSize;
  uint rows = (groups + kMaxGroupsX - 1u) / kMaxGroupsX;
  arguments = uvec3(min(groups, kMaxGroupsX), rows, groups == 0u ? 0u : 1u);
}
