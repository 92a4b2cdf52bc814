// Sums and products of floats with their rounding errors: a value is hi + lo, |lo| ≤ ulp(hi) / 2. About 44 bits, from + and × alone
// (Dekker 1971, Knuth), so that a device without 64-bit floats or exact fma decides as all others do.
#ifndef RADIVOX_DOUBLE_FLOAT_GLSL
#define RADIVOX_DOUBLE_FLOAT_GLSL

struct DoubleFloat {
  float hi;
  float lo;
};

DoubleFloat exactSum(float a, float b) {
  precise float sum = a + b;
  precise float bPart = sum - a;
  precise float aPart = sum - bPart;
  precise float bMiss = b - bPart;
  precise float aMiss = a - aPart;
  precise float miss = aMiss + bMiss;
  return DoubleFloat(sum, miss);
}

DoubleFloat exactProduct(float a, float b) {
  precise float product = a * b;
  precise float aSplit = a * 4097.0;
  precise float aDiff = aSplit - a;
  precise float aHigh = aSplit - aDiff;
  precise float aLow = a - aHigh;
  precise float bSplit = b * 4097.0;
  precise float bDiff = bSplit - b;
  precise float bHigh = bSplit - bDiff;
  precise float bLow = b - bHigh;
  precise float miss = aHigh * bHigh - product;
  miss = miss + aHigh * bLow;
  miss = miss + aLow * bHigh;
  miss = miss + aLow * bLow;
  return DoubleFloat(product, miss);
}

DoubleFloat add(DoubleFloat a, DoubleFloat b) {
  DoubleFloat sum = exactSum(a.hi, b.hi);
  precise float low = sum.lo + (a.lo + b.lo);
  return exactSum(sum.hi, low);
}

DoubleFloat negate(DoubleFloat a) { return DoubleFloat(-a.hi, -a.lo); }

DoubleFloat multiply(DoubleFloat a, DoubleFloat b) {
  DoubleFloat product = exactProduct(a.hi, b.hi);
  precise float low = product.lo + (a.hi * b.lo + a.lo * b.hi);
  return exactSum(product.hi, low);
}

// a·b − c·d
DoubleFloat differenceOfProducts(DoubleFloat a, DoubleFloat b, DoubleFloat c, DoubleFloat d) {
  return add(multiply(a, b), negate(multiply(c, d)));
}

#endif
