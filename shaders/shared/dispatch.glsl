// Item index for Commands::dispatchItems: groups are folded into rows of at most 32768 along y.
#ifndef RADIVOX_SHADERS_SHARED_DISPATCH_GLSL
#define RADIVOX_SHADERS_SHARED_DISPATCH_GLSL

uint radivoxGroupIndex() { return gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x; }
// A macro, so that gl_WorkGroupSize is read where the shader uses it: in a function included before the shader's layout(local_size_x)
// glslang takes it for 1 and says nothing.
#define radivoxItemIndex() (radivoxGroupIndex() * gl_WorkGroupSize.x + gl_LocalInvocationID.x)

#endif
