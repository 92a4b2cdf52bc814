// Emission is summed in units of a power of two just above the largest radiance of any material (`peak`: its bits), so that neither a
// candle nor the sun falls out of the fixed-point range.
int emissionExponent(uint peak) { return clamp(int(peak >> 23) - 126, -100, 100); }
float emissionDownscale(uint peak) { return uintBitsToFloat(uint(127 - emissionExponent(peak)) << 23); }
float emissionUpscale(uint peak) { return uintBitsToFloat(uint(127 + emissionExponent(peak)) << 23); }
