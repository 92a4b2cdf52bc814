// What trace.comp and filter.comp measure the noise of.
#ifndef RADIVOX_CLUSTERED_VOXEL_GATHER_PIXELS_SPREAD_GLSL
#define RADIVOX_CLUSTERED_VOXEL_GATHER_PIXELS_SPREAD_GLSL

// Bounded, so that sums of its squares are.
float luminanceOf(vec3 light) { return min(dot(light, vec3(0.2126, 0.7152, 0.0722)), 1e18); }

#endif
