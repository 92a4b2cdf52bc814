// Item index for Commands::dispatchItems: groups are folded into rows of at most 32768 along y.
#ifndef RADIVOX_SHADERS_SHARED_DISPATCH_GLSL
#define RADIVOX_SHADERS_SHARED_DISPATCH_GLSL

uint radivoxGroupIndex() { return gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x; }
uint radivoxItemIndex() { return radivoxGroupIndex() * gl_WorkGroupSize.x + gl_LocalInvocationID.x; }

#endif
