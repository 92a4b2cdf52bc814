// What each face counts for in a mean over its cluster: the weights of clustered_voxel.visibility; its area where they are not given, or nobody sees
// any face of the cluster. Define RADIVOX_BIND_WEIGHTS and RADIVOX_WEIGHTED (a constant: the port is connected) first; faces[] is Face × F.
#ifndef RADIVOX_CLUSTERED_VOXEL_WEIGHTS_GLSL
#define RADIVOX_CLUSTERED_VOXEL_WEIGHTS_GLSL

layout(set = 0, binding = RADIVOX_BIND_WEIGHTS, scalar) readonly buffer RadivoxWeights { uint weights[]; };

float weightOf(uint face, bool byArea) { return byArea ? faces[face].area : float(weights[face]); }

#endif
