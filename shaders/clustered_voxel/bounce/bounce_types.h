// What the dispatches of clustered_voxel.bounce share: push constants and the solver's state.
#ifndef RADIVOX_SHADERS_CLUSTERED_VOXEL_BOUNCE_TYPES_H
#define RADIVOX_SHADERS_CLUSTERED_VOXEL_BOUNCE_TYPES_H
#include "../../shared/types.h"
RADIVOX_SHARED_BEGIN

struct BouncePush {
  uvec2 matrix;         // device address of the entries of F (shared/transfer_entry.h)
  uint clusterCount;
  uint faceCount;
  uint iterationLimit;
  float tolerance;      // of the residual, relative to the greatest source
  uint startBelow;      // 1: x₀ = −max b (see bounce.h), 0: x₀ = b
  uint hasEmission;
  uint weightBits;      // of an entry of F
  uint senders;         // where in its buffer the vector starts that the last bounce at faces starts from
};

RADIVOX_CONST uint kPhaseWarmUp = 0u;     // plain steps, which also bound the spectral radius
RADIVOX_CONST uint kPhaseChebyshev = 1u;
RADIVOX_CONST uint kPhasePlain = 2u;      // plain steps to the end: asked for, or fallen back to
RADIVOX_CONST uint kPhaseCounted = 3u;    // as many plain steps as were recorded

RADIVOX_CONST uint kPhaseFinish = 4u;     // plain steps for what a far brighter light elsewhere drowned

RADIVOX_CONST uint kStopNone = 0u;        // iterationLimit came first (or a counted run)
RADIVOX_CONST uint kStopResidual = 1u;    // as small as asked for
RADIVOX_CONST uint kStopRounding = 2u;    // as small as float arithmetic lets it become

// Non-negative floats are kept as bits where they are maxima of atomics. One value a channel.
struct BounceControl {
  uvec3 groups;         // indirect dispatch arguments of a sweep; zero: done
  uint groupsDone;      // of the running sweep
  // The four words of the status port.
  uint iterations;
  float residual;       // |b + ρFx − x| / |x|, maximum norms
  uint fallback;
  uint stopReason;
  uint phase;
  uint chebyshevStep;
  uint windowStep;      // sweeps since windowMeasure
  float windowMeasure;
  uvec3 sweepResidual;
  uvec3 sweepRatio;
  uvec3 sweepSize;
  uint sweepStray;      // |r| / x of lit clusters (b > 0), the largest; infinity where x is not above 0
  uint strayIterations; // sweeps of kPhaseFinish
  uvec3 source;         // max b
  uvec3 radius;         // upper bound of the spectral radius of ρF
  vec3 omega;
};

RADIVOX_SHARED_END
#endif
