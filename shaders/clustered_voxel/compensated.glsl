// Sums of many floats with the error of about one rounding (Neumaier: the low parts that additions drop are carried along). The order
// of additions is the caller's, so results have the same bits on every run.
#ifndef RADIVOX_CLUSTERED_VOXEL_COMPENSATED_GLSL
#define RADIVOX_CLUSTERED_VOXEL_COMPENSATED_GLSL

struct CompensatedSum {
  float high, low;
};
struct CompensatedSum3 {
  vec3 high, low;
};

void addTo(inout CompensatedSum sum, float value) {
  precise float total = sum.high + value;
  precise float part = total - sum.high;
  precise float error = (sum.high - (total - part)) + (value - part);
  precise float low = sum.low + error;
  sum.high = total;
  sum.low = low;
}
void addTo(inout CompensatedSum3 sum, vec3 value) {
  precise vec3 total = sum.high + value;
  precise vec3 part = total - sum.high;
  precise vec3 error = (sum.high - (total - part)) + (value - part);
  precise vec3 low = sum.low + error;
  sum.high = total;
  sum.low = low;
}

#endif
