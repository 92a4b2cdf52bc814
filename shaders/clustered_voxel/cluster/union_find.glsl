// Lock-free union-find over faces. The higher root is hung below the lower, so the root of a set is its lowest face whatever the order.
// A failed exchange means that the root has sunk since, so every loop ends. Define RADIVOX_BIND_PARENTS before.
#ifndef RADIVOX_CLUSTER_UNION_FIND_GLSL
#define RADIVOX_CLUSTER_UNION_FIND_GLSL

layout(set = 0, binding = RADIVOX_BIND_PARENTS, scalar) coherent volatile buffer Parents { uint parents[]; };

uint findRoot(uint s) {
  uint parent = parents[s];
  while (parent != s) {
    uint above = parents[parent];
    if (above != parent) parents[s] = above;  // s is no root and never will be: only shortens its way
    s = parent;
    parent = above;
  }
  return s;
}

void unite(uint a, uint b) {
  uint high = findRoot(a);
  uint low = findRoot(b);
  while (high != low) {
    if (high < low) {
      uint swapped = high;
      high = low;
      low = swapped;
    }
    uint found = atomicCompSwap(parents[high], high, low);
    if (found == high) return;
    high = findRoot(found);
  }
}

#endif
