#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Every face goes to its cluster's part of the list, in any order; describe.comp sorts each part.
#include "shared/dispatch.glsl"
#include "shared/types.h"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { uint faceCount; };
layout(set = 0, binding = 0, scalar) readonly buffer Labels { uint labels[]; };
layout(set = 0, binding = 1, scalar) readonly buffer Starts { uint starts[]; };
layout(set = 0, binding = 2, scalar) buffer Cursors { uint cursors[]; };
layout(set = 0, binding = 3, scalar) writeonly buffer Members { uint members[]; };

void main() {
  uint s = radivoxItemIndex();
  if (s >= faceCount) return;
  uint cluster = labels[s];
  members[starts[cluster] + atomicAdd(cursors[cluster], 1u)] = s;
}
