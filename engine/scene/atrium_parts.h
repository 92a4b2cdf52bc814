// Architectural elements of the atrium. Internal to engine/scene.
#pragma once

#include "engine/scene/builtin_mesh.h"

namespace radivox::scene {

/// How finely curves are cut: segment counts grow with `fineness`, 1 being the default scene's.
struct AtriumDetail {
  double fineness = 1;
  bool roundColumns = true;  ///< else square piers
  bool vaults = true;        ///< else flat ceilings
  bool ornaments = true;     ///< balusters, archivolts, dentils, urns, fountain
  uint32_t segments(double base, uint32_t least) const { return std::max(least, static_cast<uint32_t>(std::lround(base * fineness))); }
};

/// A wall's own frame: s along it (to the right as one faces it), y up, d towards the court.
struct WallFrame {
  glm::dvec3 origin, right, front;
  glm::dvec3 at(double s, double y, double d) const { return origin + right * s + glm::dvec3(0, y, 0) + front * d; }
};

/// A box in a wall's frame; faces may be left out.
void addFrameBox(MeshBuilder& mesh, const WallFrame& frame, const glm::dvec3& lo, const glm::dvec3& hi, uint32_t material);

/// Wall of `thickness` around d = 0 over [s0, s1] × [spring, top], with a round arch of `radius` in its middle, rising from `spring`.
void addArchPanel(MeshBuilder& mesh, const WallFrame& frame, double s0, double s1, double spring, double top, double radius,
                  double thickness, const AtriumDetail& detail, uint32_t material);
/// A raised band around that arch on the court's side.
void addArchivolt(MeshBuilder& mesh, const WallFrame& frame, double centre, double spring, double radius, double wallFace,
                  const AtriumDetail& detail, uint32_t material);

/// A surface of revolution about the vertical through `foot`: radius and height over t in [0, 1], rising or falling; front outside when
/// height rises with t.
using Profile = std::function<glm::dvec2(double t)>;
void addLathe(MeshBuilder& mesh, const glm::dvec3& foot, const Profile& profile, uint32_t around, uint32_t along, uint32_t material);

/// Plinth, base, shaft with entasis, capital, abacus, from `foot` up to `height`.
void addColumn(MeshBuilder& mesh, const glm::dvec3& foot, double height, double radius, const AtriumDetail& detail, uint32_t shaft,
               uint32_t trim);
void addBaluster(MeshBuilder& mesh, const glm::dvec3& foot, double height, double radius, const AtriumDetail& detail, uint32_t material);
void addUrn(MeshBuilder& mesh, const glm::dvec3& foot, const AtriumDetail& detail, uint32_t stone, uint32_t leaves);
void addFountain(MeshBuilder& mesh, const glm::dvec3& foot, const AtriumDetail& detail, uint32_t stone, uint32_t water);

/// A groin vault over [lo, hi], rising from `spring` by `rise`, seen from below.
void addVault(MeshBuilder& mesh, const glm::dvec2& lo, const glm::dvec2& hi, double spring, double rise, const AtriumDetail& detail,
              uint32_t material);

/// A sheet without thickness hanging from [s0, s1] at `top` down to `bottom`, in `folds` folds that open downwards.
void addCurtain(MeshBuilder& mesh, const WallFrame& frame, double s0, double s1, double bottom, double top, double d, double folds,
                double depth, const AtriumDetail& detail, uint32_t material);

/// A horizontal rectangle facing up, of slabs about `slab` wide, each of one of `materials` by its place.
void addPaving(MeshBuilder& mesh, const glm::dvec2& lo, const glm::dvec2& hi, double y, double slab, const AtriumDetail& detail,
               const std::vector<uint32_t>& materials);

}  // namespace radivox::scene
