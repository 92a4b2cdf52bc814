// Form factors in closed form, in double precision. Irradiance from a surface of uniform radiance L is π L F.
#pragma once

#include <glm/glm.hpp>
#include <vector>

namespace radivox::oracles {

/// From a point with unit normal n to a flat polygon that lies above its horizon (Lambert's boundary formula). Either winding.
double pointToPolygon(const glm::dvec3& p, const glm::dvec3& n, const std::vector<glm::dvec3>& corners);

/// Between two squares that face each other.
double parallelSquares(double side, double distance);

/// Between two faces of a cube that share an edge: what the opposite face leaves, by symmetry.
inline double adjacentCubeFaces() { return (1.0 - parallelSquares(1.0, 1.0)) / 4.0; }

}  // namespace radivox::oracles
