// Triangles against cubes in double precision, from the definition: the separating-axis test and polygon clipping.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <vector>

namespace radivox::oracle {

using Corners = std::array<glm::dvec3, 3>;

/// Does the triangle overlap the closed cube of half edge `half` around `centre`? All 13 axes; touching counts.
bool overlapsCube(const Corners& triangle, const glm::dvec3& centre, double half);

/// Keeps the side of a convex polygon where sign·(p[axis] − plane) ≥ 0.
std::vector<glm::dvec3> clipByPlane(const std::vector<glm::dvec3>& polygon, int axis, double plane, double sign);

/// The part of the triangle inside the closed cube [low, low + 1]³; empty or at least 3 corners.
std::vector<glm::dvec3> clipToVoxel(const Corners& triangle, const glm::dvec3& low);

/// Does this voxel own the triangle? Half-open: a triangle lying in the plane between two voxels belongs to the upper one.
bool ownsPlane(const Corners& triangle, const glm::dvec3& low);

double areaOf(const std::vector<glm::dvec3>& polygon);
/// Area centroid; the mean of the corners when there is no area.
glm::dvec3 centroidOf(const std::vector<glm::dvec3>& polygon);
/// Barycentric coordinates of a point in the triangle's plane.
glm::dvec3 barycentricOf(const Corners& triangle, const glm::dvec3& point);

}  // namespace radivox::oracle
