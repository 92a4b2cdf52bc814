#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// One iteration of x = b + ρFx: the residual r = b + ρFx − x of every row, and the next x. Plain: x + r. Chebyshev: x + ω r + (ω − 1) d with
// d the step before. The group that finishes last looks at the maxima and sets the next sweep's coefficients, or ends the iteration.
#include "clustered_voxel/bounce/row_product.glsl"
layout(set = 0, binding = 1, scalar) readonly buffer Clusters { Cluster clusters[]; };
layout(set = 0, binding = 2, scalar) readonly buffer Source { vec3 source[]; };
layout(set = 0, binding = 3, scalar) buffer Iterate { vec3 iterate[]; };  // two vectors; sweeps read one and write the other in turn
layout(set = 0, binding = 4, scalar) buffer Steps { vec3 steps[]; };
layout(set = 0, binding = 5, scalar) coherent buffer Control { BounceControl control; };

const uint kWarmUpSweeps = 8u;
const uint kWindowSweeps = 16u;
// Where rounding of x itself, 2⁻²⁴ of it, and of the terms of r keeps r from falling.
const float kRoundingFloor = 1.1920928955078125e-7;  // 2⁻²³
const uint kInfinity = 0x7f800000u;
// The residual is measured against the brightest source. A lamp that is 10¹⁵ times dimmer, in a room of its own, would be lost in it: what is
// lit must also be right to this part of itself, and plain steps from b or above, which only ever add light, see to that.
const float kMostStray = 1e-3;
const uint kMostFinishSweeps = 256u;

shared uint groupResidual[3];
shared uint groupRatio[3];
shared uint groupSize[3];
shared uint groupStray;

// One lane, after all groups of the sweep.
void decide() {
  float measure = 0.0;   // of the residual, in units of what is asked for
  float relative = 0.0;
  for (uint k = 0; k < 3u; ++k) {
    float residual = uintBitsToFloat(control.sweepResidual[k]);
    float size = uintBitsToFloat(control.sweepSize[k]);
    float limit = max(push.tolerance * uintBitsToFloat(control.source[k]), kRoundingFloor * size);
    if (residual > 0.0) {
      measure = max(measure, limit > 0.0 ? residual / limit : uintBitsToFloat(kInfinity));
      relative = max(relative, size > 0.0 ? residual / size : uintBitsToFloat(kInfinity));
    }
    // Collatz and Wielandt: with all steps d ≥ 0, max (ρFd) / d bounds the spectral radius from above; a plain step's next residual is ρFd.
    if (control.phase == kPhaseWarmUp && control.iterations > 0u && control.sweepRatio[k] != kInfinity) {
      uint bound = floatBitsToUint(uintBitsToFloat(control.sweepRatio[k]) * 1.00001);
      control.radius[k] = min(control.radius[k], bound);
    }
    control.sweepResidual[k] = 0u;
    control.sweepRatio[k] = 0u;
    control.sweepSize[k] = 0u;
  }
  float stray = uintBitsToFloat(control.sweepStray);
  control.sweepStray = 0u;
  control.residual = relative;
  control.iterations += 1u;
  control.groupsDone = 0u;
  if (control.phase == kPhaseCounted) return;

  if (control.phase == kPhaseFinish) {
    control.strayIterations += 1u;
    if (stray <= kMostStray || control.strayIterations >= kMostFinishSweeps || control.iterations >= push.iterationLimit)
      control.groups = uvec3(0u);
  } else if (measure <= 1.0) {
    control.stopReason = kStopResidual;
    if (stray <= kMostStray || control.iterations >= push.iterationLimit)
      control.groups = uvec3(0u);
    else
      control.phase = kPhaseFinish;
  } else if (control.iterations >= push.iterationLimit) {
    control.groups = uvec3(0u);
  } else if (control.phase == kPhaseWarmUp) {
    if (control.iterations == kWarmUpSweeps) {
      control.phase = kPhaseChebyshev;
      control.chebyshevStep = 0u;
      control.windowStep = 0u;
      control.windowMeasure = measure;
    }
  } else {
    if (control.phase == kPhaseChebyshev) {
      // ω₁ = 1, ω₂ = 1 / (1 − r²/2), ω = 1 / (1 − r²ω/4): eigenvalues taken as real, in [−r, r].
      control.chebyshevStep += 1u;
      vec3 squared = uintBitsToFloat(control.radius) * uintBitsToFloat(control.radius);
      control.omega = control.chebyshevStep == 1u ? 1.0 / (1.0 - 0.5 * squared) : 1.0 / (1.0 - 0.25 * squared * control.omega);
    }
    control.windowStep += 1u;
    if (control.windowStep == kWindowSweeps) {
      if (measure >= control.windowMeasure) {
        if (control.phase == kPhaseChebyshev) {
          // Not what the theory says: strongly complex eigenvalues, or rounding. Plain steps contract in any case.
          control.phase = kPhasePlain;
          control.omega = vec3(1.0);
          control.fallback = 1u;
        } else {
          control.stopReason = kStopRounding;
          control.groups = uvec3(0u);
        }
      }
      control.windowStep = 0u;
      control.windowMeasure = measure;
    }
  }
}

void main() {
  uint lane = gl_LocalInvocationID.x;
  if (lane < 3u) groupResidual[lane] = groupRatio[lane] = groupSize[lane] = 0u;
  if (lane == 0u) groupStray = 0u;
  uint readFrom = (control.iterations & 1u) * push.clusterCount;
  uint writeTo = push.clusterCount - readFrom;
  bool isChebyshev = control.phase == kPhaseChebyshev;
  bool isWarmUp = control.phase == kPhaseWarmUp;
  vec3 omega = control.omega;
  vec3 least = leastIterate(control.phase);
  uint c = rowOfLane();
  vec3 received;
#define RADIVOX_VECTOR(i) max(iterate[readFrom + (i)], least)
  radivoxRowProduct(c, received);
  if (isFirstOfRow() && c < push.clusterCount) {
    vec3 reflected = clusters[c].albedo * received;
    vec3 x = iterate[readFrom + c];
    vec3 b = source[c];
    vec3 step = steps[c];
    precise vec3 residual = (reflected - x) + b;
    vec3 next = isChebyshev ? omega * residual + (omega - 1.0) * step : residual;
    iterate[writeTo + c] = isChebyshev ? x + next : b + reflected;
    steps[c] = next;
    for (uint k = 0; k < 3u; ++k) {
      atomicMax(groupResidual[k], floatBitsToUint(abs(residual[k])));
      atomicMax(groupSize[k], floatBitsToUint(abs(x[k])));
      if (b[k] > 0.0) atomicMax(groupStray, x[k] > 0.0 ? floatBitsToUint(abs(residual[k]) / x[k]) : kInfinity);
      if (isWarmUp && residual[k] > 0.0)
        atomicMax(groupRatio[k], step[k] > 0.0 ? floatBitsToUint(residual[k] / step[k]) : kInfinity);
    }
  }
  barrier();
  if (lane < 3u) {
    atomicMax(control.sweepResidual[lane], groupResidual[lane]);
    atomicMax(control.sweepRatio[lane], groupRatio[lane]);
    atomicMax(control.sweepSize[lane], groupSize[lane]);
  }
  if (lane == 0u) atomicMax(control.sweepStray, groupStray);
  memoryBarrierBuffer();
  barrier();
  if (lane == 0u) {
    uint groupCount = gl_NumWorkGroups.x * gl_NumWorkGroups.y;
    if (atomicAdd(control.groupsDone, 1u) + 1u == groupCount) {
      memoryBarrierBuffer();
      decide();
    }
  }
}
