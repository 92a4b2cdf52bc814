#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// One lane a cluster: sorts its members by face id (heap sort: n log n whatever the order, in place) and takes the area-weighted means
// in that order.
#include "clustered_voxel/compensated.glsl"
#include "shared/dispatch.glsl"
#define RADIVOX_BIND_VOXELS 0
#define RADIVOX_BIND_FACES 1
#include "shared/voxel_lookup.glsl"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { uint clusterCount; };
layout(set = 0, binding = 2, scalar) readonly buffer Starts { uint starts[]; };
layout(set = 0, binding = 3, scalar) buffer Members { uint members[]; };
layout(set = 0, binding = 4, scalar) writeonly buffer Clusters { Cluster clusters[]; };
layout(set = 0, binding = 5, scalar) writeonly buffer Places { ClusterPlace places[]; };
layout(constant_id = 0) const bool kPlaces = false;  // somebody reads them

// Lets members[begin + hole] sink to its place in the heap of `count` members.
void sink(uint begin, uint hole, uint count) {
  uint value = members[begin + hole];
  for (;;) {
    uint child = 2u * hole + 1u;
    if (child >= count) break;
    uint larger = members[begin + child];
    if (child + 1u < count) {
      uint right = members[begin + child + 1u];
      if (right > larger) {
        larger = right;
        child += 1u;
      }
    }
    if (larger <= value) break;
    members[begin + hole] = larger;
    hole = child;
  }
  members[begin + hole] = value;
}

void sortMembers(uint begin, uint end) {
  bool sorted = true;
  for (uint i = begin + 1u; i < end; ++i)
    if (members[i] < members[i - 1u]) sorted = false;
  if (sorted) return;
  uint count = end - begin;
  for (uint i = count / 2u; i > 0u; --i) sink(begin, i - 1u, count);
  for (uint last = count - 1u; last > 0u; --last) {
    uint greatest = members[begin];
    members[begin] = members[begin + last];
    members[begin + last] = greatest;
    sink(begin, 0u, last);
  }
}

void main() {
  uint c = radivoxItemIndex();
  if (c > clusterCount) return;
  if (c == clusterCount) {
    clusters[c] = Cluster(vec3(0.0), starts[c]);
    return;
  }
  uint begin = starts[c];
  uint end = starts[c + 1u];
  sortMembers(begin, end);
  CompensatedSum area = CompensatedSum(0.0, 0.0);
  CompensatedSum3 position = CompensatedSum3(vec3(0.0), vec3(0.0));
  CompensatedSum3 normal = position;
  CompensatedSum3 albedo = position;
  for (uint i = begin; i < end; ++i) {
    Face face = faceAt(members[i]);
    addTo(area, face.area);
    addTo(position, face.area * facePosition(face, voxelCoordinate(face.key >> 3)));
    addTo(normal, face.area * decodeNormal(face.normal));
    addTo(albedo, face.area * decodeAlbedo(face.albedo));
  }
  float whole = area.high + area.low;
  Cluster cluster;
  cluster.albedo = (albedo.high + albedo.low) / whole;
  cluster.firstMember = begin;
  clusters[c] = cluster;
  if (!kPlaces) return;
  ClusterPlace place;
  place.area = whole;
  place.position = (position.high + position.low) / whole;
  // No member is farther than a right angle from the others' mean (cluster.h), so this is no zero vector.
  place.normal = normalize(normal.high + normal.low);
  places[c] = place;
}
