// Rows of F times a vector of colours: eight lanes a row, eight rows a group. Lanes take every eighth entry and their sums are added
// in order, so the result does not depend on the device's subgroups.
#ifndef RADIVOX_BOUNCE_ROW_PRODUCT_GLSL
#define RADIVOX_BOUNCE_ROW_PRODUCT_GLSL
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#include "clustered_voxel/bounce/bounce_types.h"
#include "clustered_voxel/compensated.glsl"
#include "shared/dispatch.glsl"
#include "shared/transfer_entry.h"
#include "shared/voxel.h"

layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { BouncePush push; };
layout(set = 0, binding = 0, scalar) readonly buffer RowStart { uint rowStart[]; };

layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer MatrixEntry { uint value; };
// The number of an entry times four does not fit 32 bits in large scenes.
uint entryAt(uint index) {
  uint high, low;
  umulExtended(index, 4u, high, low);
  uint carry;
  uint addressLow = uaddCarry(push.matrix.x, low, carry);
  return MatrixEntry(uvec2(addressLow, push.matrix.y + high + carry)).value;
}

// The solution is nowhere below 0, and iterates are, by what is small beside the brightest: where sweeps finish, that counts as 0.
vec3 leastIterate(uint phase) { return vec3(phase == kPhaseFinish ? 0.0 : uintBitsToFloat(0xff800000u)); }

const uint kRowLanes = 8u;
shared vec3 laneHigh[64];
shared vec3 laneLow[64];

uint rowOfLane() { return radivoxGroupIndex() * (64u / kRowLanes) + gl_LocalInvocationID.x / kRowLanes; }
bool isFirstOfRow() { return gl_LocalInvocationID.x % kRowLanes == 0u; }

// Define vectorAt(column) before use: RADIVOX_VECTOR(i). All lanes call this; the row's first lane gets the product.
#define radivoxRowProduct(row, product)                                                            \
  {                                                                                                \
    CompensatedSum3 sum_ = CompensatedSum3(vec3(0.0), vec3(0.0));                                  \
    if (row < push.clusterCount) {                                                                 \
      uint end_ = rowStart[row + 1u];                                                              \
      for (uint e_ = rowStart[row] + gl_LocalInvocationID.x % kRowLanes; e_ < end_; e_ += kRowLanes) { \
        uint entry_ = entryAt(e_);                                                                 \
        float weight_ = float(transferUnits(entry_, push.weightBits)) * transferUnit(push.weightBits); \
        addTo(sum_, weight_ * RADIVOX_VECTOR(transferColumn(entry_, push.weightBits)));            \
      }                                                                                            \
    }                                                                                              \
    laneHigh[gl_LocalInvocationID.x] = sum_.high;                                                  \
    laneLow[gl_LocalInvocationID.x] = sum_.low;                                                    \
    barrier();                                                                                     \
    if (isFirstOfRow()) {                                                                          \
      for (uint i_ = 1u; i_ < kRowLanes; ++i_) {                                                   \
        addTo(sum_, laneHigh[gl_LocalInvocationID.x + i_]);                                        \
        addTo(sum_, laneLow[gl_LocalInvocationID.x + i_]);                                         \
      }                                                                                            \
      product = sum_.high + sum_.low;                                                              \
    }                                                                                              \
  }

#endif
