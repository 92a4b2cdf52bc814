// For tests of the executor: target(x, y) = source(x, y) + amount, on R32UI images of one layer.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0, r32ui) uniform readonly uimage2D sourceImage;
layout(set = 0, binding = 1, r32ui) uniform writeonly uimage2D targetImage;
layout(push_constant) uniform Push { uint amount; };

void main() {
  ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(texel, imageSize(targetImage)))) return;
  imageStore(targetImage, texel, uvec4(imageLoad(sourceImage, texel).x + amount));
}
