#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "frame/tone_map.glsl"

// One group walks a histogram to the bin of the 99th percentile: rank 0.99·(n − 1), in integers.
layout(local_size_x = 256) in;

layout(constant_id = 0) const bool kLow = false;

layout(set = 0, binding = 0, scalar) readonly buffer Bins { uint bins[]; };
layout(set = 0, binding = 1, scalar) buffer Selected { Selection selection; };
layout(set = 0, binding = 2, scalar) buffer Exposure { float exposure; };

layout(push_constant, scalar) uniform Push { float compensation; };

shared uint sums[256];

void main() {
  uint lane = gl_LocalInvocationID.x;
  uint first = kLow ? kHighBins : 0u;
  uint perLane = (kLow ? kLowBins : kHighBins) / 256u;
  uint sum = 0u;
  for (uint i = 0u; i < perLane; ++i) sum += bins[first + lane * perLane + i];
  sums[lane] = sum;
  barrier();
  if (lane != 0u) return;

  uint rank;
  if (kLow) {
    rank = selection.rank;
  } else {
    uint count = 0u;
    for (uint i = 0u; i < 256u; ++i) count += sums[i];
    uint last = max(count, 1u) - 1u;
    // 99·last / 100 without overflow.
    uint rest = last % 100u * 99u;
    rank = last / 100u * 99u + rest / 100u;
    selection.fraction = rest % 100u;
    selection.finiteCount = count;
    selection.next = ~0u;
  }
  uint block = 0u;
  while (block < 255u && rank >= sums[block]) rank -= sums[block++];
  uint bin = block * perLane, end = bin + perLane - 1u;
  while (bin < end && rank >= bins[first + bin]) rank -= bins[first + bin++];
  if (!kLow) {
    selection.highBin = bin;
    selection.rank = rank;
    return;
  }

  uint bits = selection.highBin << 16 | bin;
  float percentile = uintBitsToFloat(bits);
  if (selection.fraction > 0u) {
    uint next = selection.next;
    if (rank + 1u < bins[first + bin]) {
      next = bits;
    } else {
      for (uint above = bin + 1u; above < kLowBins; ++above) {
        if (bins[first + above] == 0u) continue;
        next = selection.highBin << 16 | above;
        break;
      }
    }
    if (next != ~0u) percentile += float(selection.fraction) * 0.01 * (uintBitsToFloat(next) - percentile);
  }
  float factor = 1.0 / percentile;
  bool usable = selection.finiteCount > 0u && percentile > 0.0 && !isinf(factor);
  exposure = (usable ? factor : 1.0) * compensation;
}
