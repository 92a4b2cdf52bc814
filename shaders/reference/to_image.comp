#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// What the host traced, a vec4 a pixel, as an image.
layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0, scalar) readonly buffer Pixels { vec4 pixels[]; };
layout(set = 0, binding = 1, rgba32f) writeonly uniform image2D result;

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy), size = imageSize(result);
  if (any(greaterThanEqual(pixel, size))) return;
  imageStore(result, pixel, pixels[pixel.y * size.x + pixel.x]);
}
