// The atrium: a court with an arcade on the ground, a gallery above, open to the sky. All numbers are metres.
#include <cmath>

#include "engine/scene/atrium_parts.h"

namespace radivox::scene {

namespace {

constexpr double kBay = 3.4;            // between columns, and the depth of the aisles
constexpr double kGroundSpring = 2.95;  // where arches and vaults begin
constexpr double kGroundTop = 4.65;
constexpr double kGallery = 5.0;  // floor of the upper storey
constexpr double kUpperSpring = 7.25;
constexpr double kCeiling = 9.0;
constexpr double kRoofEdge = 9.4;
constexpr double kRoofRidge = 10.7;
constexpr double kRadius = 1.36;  // of the arches
constexpr double kWall = 0.62;    // thickness of the ground arcade
constexpr double kUpperWall = 0.5;
constexpr double kLedge = 0.5;  // the gallery floor's edge, from the column line towards the court

struct Materials {
  uint32_t stone, column, trim, plaster, dado, vault, wood, roof, water, leaves;
  std::vector<uint32_t> floor, gallery, cloth;
};

Materials addMaterials(MeshBuilder& mesh) {
  Materials m{};
  m.stone = mesh.addMaterial("arcade stone", {0.60f, 0.53f, 0.43f});
  m.column = mesh.addMaterial("column stone", {0.67f, 0.61f, 0.53f});
  m.trim = mesh.addMaterial("trim", {0.71f, 0.66f, 0.58f});
  m.plaster = mesh.addMaterial("plaster", {0.70f, 0.61f, 0.48f});
  m.dado = mesh.addMaterial("dado", {0.34f, 0.10f, 0.06f});
  m.vault = mesh.addMaterial("vault", {0.74f, 0.70f, 0.62f});
  m.wood = mesh.addMaterial("wood", {0.21f, 0.12f, 0.06f});
  m.roof = mesh.addMaterial("roof", {0.46f, 0.21f, 0.13f});
  m.water = mesh.addMaterial("water", {0.05f, 0.13f, 0.15f});
  m.leaves = mesh.addMaterial("leaves", {0.07f, 0.19f, 0.04f});
  m.floor = {mesh.addMaterial("slab light", {0.52f, 0.46f, 0.38f}), mesh.addMaterial("slab grey", {0.44f, 0.40f, 0.35f}),
             mesh.addMaterial("slab warm", {0.49f, 0.40f, 0.31f}), mesh.addMaterial("slab dark", {0.36f, 0.31f, 0.27f})};
  m.gallery = {mesh.addMaterial("tile red", {0.45f, 0.23f, 0.15f}), mesh.addMaterial("tile brown", {0.40f, 0.24f, 0.17f})};
  const auto cloth = [&](const char* name, const glm::vec3& albedo) {
    return mesh.addMaterial(name, albedo, glm::vec3(0.f), shared::kMaterialDoubleSided);
  };
  m.cloth = {cloth("red cloth", {0.58f, 0.03f, 0.03f}), cloth("blue cloth", {0.03f, 0.10f, 0.52f}),
             cloth("green cloth", {0.05f, 0.36f, 0.09f}), cloth("ochre cloth", {0.68f, 0.38f, 0.05f})};
  return m;
}

class AtriumBuilder {
 public:
  AtriumBuilder(MeshBuilder& mesh, const Materials& materials, const AtriumDetail& detail, uint32_t baysX, uint32_t baysZ)
      : mesh_(mesh), m_(materials), detail_(detail), baysX_(baysX), baysZ_(baysZ), lengthX_(kBay * baysX), lengthZ_(kBay * baysZ) {}

  void build() {
    // The court is [0, lengthX] × [0, lengthZ]; each side as one sees it from the court.
    const WallFrame sides[4] = {{{0, 0, 0}, {1, 0, 0}, {0, 0, 1}},
                                {{lengthX_, 0, lengthZ_}, {-1, 0, 0}, {0, 0, -1}},
                                {{0, 0, lengthZ_}, {0, 0, -1}, {1, 0, 0}},
                                {{lengthX_, 0, 0}, {0, 0, 1}, {-1, 0, 0}}};
    for (uint32_t k = 0; k < 4; ++k) {
      const uint32_t bays = k < 2 ? baysX_ : baysZ_;
      addSide(sides[k], bays, k);
      addBackWall(sides[k], bays);
    }
    for (const double x : {0.0, lengthX_}) {
      for (const double z : {0.0, lengthZ_}) {
        // Corner posts, a little thinner than the walls that they join.
        addPost(x, z, kGroundSpring, kGroundTop, kWall - 0.004);
        addPost(x, z, kUpperSpring, kCeiling, kUpperWall - 0.004);
      }
    }
    addFloors();
    addRoof();
    if (detail_.ornaments) addFurniture();
  }

 private:
  void addPost(double x, double z, double low, double high, double side) {
    mesh_.addBlock({x, 0.5 * (low + high), z}, {side, high - low, side}, 0, m_.stone);
  }

  void addSide(const WallFrame& f, uint32_t bays, uint32_t side) {
    const double length = kBay * bays;
    for (uint32_t i = 0; i < bays; ++i) {
      const double s0 = kBay * i, s1 = kBay * (i + 1), middle = 0.5 * (s0 + s1);
      addArchPanel(mesh_, f, s0, s1, kGroundSpring, kGroundTop, kRadius, kWall, detail_, m_.stone);
      addArchPanel(mesh_, f, s0, s1, kUpperSpring, kCeiling, kRadius, kUpperWall, detail_, m_.plaster);
      // The corner column belongs to the side that begins there.
      addColumn(mesh_, f.at(s0, 0, 0), kGroundSpring, 0.25, detail_, m_.column, m_.trim);
      addColumn(mesh_, f.at(s0, kGallery, 0), kUpperSpring - kGallery, 0.18, detail_, m_.column, m_.trim);
      if (detail_.ornaments) {
        addArchivolt(mesh_, f, middle, kGroundSpring, kRadius, kWall / 2, detail_, m_.trim);
        addArchivolt(mesh_, f, middle, kUpperSpring, kRadius, kUpperWall / 2, detail_, m_.trim);
      }
      addBalustrade(f, s0, s1);
      addCloth(f, i, bays, side);
    }
    // String course under the gallery's edge, cornice under the roof's. The floor above each is a little higher, so no two faces coincide.
    addFrameBox(mesh_, f, {0.3, kGroundTop - 0.05, -kWall / 2 + 0.002}, {length - 0.3, kGallery - 0.006, kLedge + 0.02}, m_.trim);
    addFrameBox(mesh_, f, {0.3, kCeiling - 0.05, -kUpperWall / 2 + 0.002}, {length - 0.3, kRoofEdge - 0.006, kLedge + 0.13}, m_.trim);
    if (!detail_.ornaments) return;
    const auto dentils = static_cast<uint32_t>(std::lround((length - 1.4) / 0.4));
    for (uint32_t i = 0; i < dentils; ++i) {
      const double s = 0.7 + (length - 1.4) * (i + 0.5) / dentils;
      addFrameBox(mesh_, f, {s - 0.09, kCeiling - 0.24, kUpperWall / 2 - 0.02}, {s + 0.09, kCeiling - 0.048, kUpperWall / 2 + 0.16},
                  m_.trim);
    }
  }

  void addBalustrade(const WallFrame& f, double s0, double s1) {
    constexpr double kRail = 0.95;
    const double lo = s0 + 0.2, hi = s1 - 0.2;
    addFrameBox(mesh_, f, {lo, kGallery + kRail - 0.1, -0.13}, {hi, kGallery + kRail, 0.13}, m_.trim);
    if (!detail_.ornaments) {
      addFrameBox(mesh_, f, {lo, kGallery, -0.06}, {hi, kGallery + kRail - 0.1, 0.06}, m_.stone);
      return;
    }
    addFrameBox(mesh_, f, {lo, kGallery, -0.1}, {hi, kGallery + 0.12, 0.1}, m_.trim);
    constexpr int kBalusters = 8;
    for (int i = 0; i < kBalusters; ++i) {
      const double s = lo + (hi - lo) * (i + 0.5) / kBalusters;
      addBaluster(mesh_, f.at(s, kGallery + 0.12, 0), kRail - 0.22, 0.1, detail_, m_.column);
    }
  }

  /// Curtains in some ground arches of the long sides, banners over the balustrade between them.
  void addCloth(const WallFrame& f, uint32_t bay, uint32_t bays, uint32_t side) {
    if (side >= 2) return;
    const double s0 = kBay * bay, s1 = s0 + kBay;
    const uint32_t colour = m_.cloth[(bay / 2 + side * 2) % m_.cloth.size()];
    if (bay % 2 == side) {
      // Drawn half open in every second of them.
      const double right = bay % 4 < 2 ? s1 - 0.4 : 0.5 * (s0 + s1) + 0.1;
      const double width = right - (s0 + 0.4);
      addCurtain(mesh_, f, s0 + 0.4, right, 0.12, kGroundSpring - 0.12, -0.05, width < 2 ? 6 : 7, width < 2 ? 0.11 : 0.08, detail_, colour);
      if (detail_.ornaments)
        addFrameBox(mesh_, f, {s0 + 0.3, kGroundSpring - 0.13, -0.07}, {s1 - 0.3, kGroundSpring - 0.09, -0.03}, m_.wood);
    } else if (bay > 0 && bay + 1 < bays) {
      addCurtain(mesh_, f, s0 + 1.05, s1 - 1.05, kGallery - 1.25, kGallery + 0.9, kLedge + 0.06, 2, 0.03, detail_, colour);
    }
  }

  void addBackWall(const WallFrame& f, uint32_t bays) {
    const double lo = -kBay, hi = kBay * (bays + 1), d = -kBay;
    const double ends[2][2] = {{0.0, kGallery}, {kGallery, kCeiling}};
    for (int storey = 0; storey < 2; ++storey) {
      const double low = ends[storey][0], high = ends[storey][1];
      for (uint32_t i = 0; i < bays + 2; ++i) {
        const double s0 = lo + kBay * i, s1 = s0 + kBay;
        mesh_.addQuad(f.at(s0, low, d), f.at(s1, low, d), f.at(s1, high, d), f.at(s0, high, d), m_.plaster);
      }
      addFrameBox(mesh_, f, {lo + 0.05, low, d - 0.02}, {hi - 0.05, low + 1.0, d + 0.03}, m_.dado);
      if (!detail_.ornaments) continue;
      addFrameBox(mesh_, f, {lo + 0.06, low + 1.0, d - 0.02}, {hi - 0.06, low + 1.08, d + 0.06}, m_.trim);
      for (uint32_t i = 1; i < bays + 2; ++i) {
        const double s = lo + kBay * i, top = storey == 0 ? kGroundSpring : kCeiling - 0.28;
        addFrameBox(mesh_, f, {s - 0.2, low, d - 0.02}, {s + 0.2, top, d + 0.14}, m_.column);
        addFrameBox(mesh_, f, {s - 0.26, top - 0.16, d - 0.02}, {s + 0.26, top + 0.004, d + 0.2}, m_.trim);
      }
      for (uint32_t i = 1; i < bays + 1; i += 2) {
        const double s = lo + kBay * (i + 0.5);
        addFrameBox(mesh_, f, {s - 0.72, low, d - 0.02}, {s + 0.72, low + 2.42, d + 0.1}, m_.trim);
        addFrameBox(mesh_, f, {s - 0.58, low, d - 0.02}, {s + 0.58, low + 2.28, d + 0.13}, m_.wood);
      }
    }
    // The outside, half a metre further out.
    const double out = d - 0.5;
    mesh_.addQuad(f.at(hi + 0.5, 0, out), f.at(lo - 0.5, 0, out), f.at(lo - 0.5, kRoofRidge, out), f.at(hi + 0.5, kRoofRidge, out),
                  m_.stone);
  }

  /// The ring of aisles as four rectangles: two along x with the corners, two between them.
  void forRing(double inner, const std::function<void(const glm::dvec2& lo, const glm::dvec2& hi)>& rectangle) const {
    rectangle({-kBay, -kBay}, {lengthX_ + kBay, inner});
    rectangle({-kBay, lengthZ_ - inner}, {lengthX_ + kBay, lengthZ_ + kBay});
    rectangle({-kBay, inner}, {inner, lengthZ_ - inner});
    rectangle({lengthX_ - inner, inner}, {lengthX_ + kBay, lengthZ_ - inner});
  }

  void addFloors() {
    const double slab = detail_.vaults ? 0.85 : kBay;
    addPaving(mesh_, {-kBay, -kBay}, {lengthX_ + kBay, lengthZ_ + kBay}, 0.0, slab, detail_, m_.floor);
    forRing(kLedge, [&](const glm::dvec2& lo, const glm::dvec2& hi) { addPaving(mesh_, lo, hi, kGallery, slab, detail_, m_.gallery); });
    for (uint32_t j = 0; j < baysZ_ + 2; ++j) {
      for (uint32_t i = 0; i < baysX_ + 2; ++i) {
        if (i > 0 && i <= baysX_ && j > 0 && j <= baysZ_) continue;
        const glm::dvec2 lo(kBay * (i - 1.0), kBay * (j - 1.0)), hi = lo + kBay;
        addVault(mesh_, lo, hi, kGroundSpring, kGroundTop - kGroundSpring - 0.12, detail_, m_.vault);
      }
    }
    // Upper ceiling, seen from below, and its beams.
    forRing(0.0, [&](const glm::dvec2& lo, const glm::dvec2& hi) {
      mesh_.addQuad({lo.x, kCeiling - 0.02, lo.y}, {hi.x, kCeiling - 0.02, lo.y}, {hi.x, kCeiling - 0.02, hi.y},
                    {lo.x, kCeiling - 0.02, hi.y}, m_.wood);
    });
    if (!detail_.ornaments) return;
    for (uint32_t i = 0; i < baysX_ * 4; ++i) {
      const double x = kBay * (i + 0.5) / 4;
      for (const double z : {-kBay / 2, lengthZ_ + kBay / 2}) mesh_.addBlock({x, kCeiling - 0.12, z}, {0.16, 0.24, kBay}, 0, m_.wood);
    }
    for (uint32_t i = 0; i < baysZ_ * 4; ++i) {
      const double z = kBay * (i + 0.5) / 4;
      for (const double x : {-kBay / 2, lengthX_ + kBay / 2}) mesh_.addBlock({x, kCeiling - 0.12, z}, {kBay, 0.24, 0.16}, 0, m_.wood);
    }
  }

  /// Four planes that fall towards the court, over the aisles and the outer wall.
  void addRoof() {
    const double in = kLedge + 0.15, out = kBay + 0.5;
    const glm::dvec3 inner[4] = {
        {in, kRoofEdge, in}, {lengthX_ - in, kRoofEdge, in}, {lengthX_ - in, kRoofEdge, lengthZ_ - in}, {in, kRoofEdge, lengthZ_ - in}};
    const glm::dvec3 outer[4] = {{-out, kRoofRidge, -out},
                                 {lengthX_ + out, kRoofRidge, -out},
                                 {lengthX_ + out, kRoofRidge, lengthZ_ + out},
                                 {-out, kRoofRidge, lengthZ_ + out}};
    for (int k = 0; k < 4; ++k) {
      const int next = (k + 1) % 4;
      mesh_.addQuad(inner[k], inner[next], outer[next], outer[k], m_.roof);
      // Its edge above the cornice.
      mesh_.addQuad(inner[next], inner[k], inner[k] - glm::dvec3(0, 0.1, 0), inner[next] - glm::dvec3(0, 0.1, 0), m_.trim);
    }
  }

  void addFurniture() {
    addFountain(mesh_, {lengthX_ * 0.5, 0, lengthZ_ * 0.5}, detail_, m_.trim, m_.water);
    for (uint32_t i = 1; i < baysX_; i += 2) {
      for (const double z : {1.1, lengthZ_ - 1.1}) addUrn(mesh_, {kBay * i, 0, z}, detail_, m_.column, m_.leaves);
    }
  }

  MeshBuilder& mesh_;
  const Materials& m_;
  const AtriumDetail detail_;
  const uint32_t baysX_, baysZ_;
  const double lengthX_, lengthZ_;
};

}  // namespace

void buildAtrium(MeshBuilder& mesh, BuiltinParameters& parameters) {
  const double target = parameters.number("triangles", 60000, 2000, 5e6);
  const auto sky = static_cast<float>(parameters.number("sky", 0.4, 0, 1e6));
  const Materials materials = addMaterials(mesh);
  AtriumDetail detail;
  detail.roundColumns = target >= 9000;
  detail.vaults = target >= 6200;
  detail.ornaments = target >= 25000;
  const uint32_t baysX = target >= 6200 ? 7 : 4, baysZ = target >= 6200 ? 3 : 2;
  const auto countAt = [&](double fineness) {
    detail.fineness = fineness;
    mesh.startCounting();
    AtriumBuilder(mesh, materials, detail, baysX, baysZ).build();
    const auto count = static_cast<double>(mesh.triangleCount());
    mesh.stopCounting();
    return count;
  };
  // Counts rise with fineness in small steps: the finest that stays within the target, unless the next step is nearer.
  double lo = 0.01, hi = 16;
  for (int i = 0; i < 40; ++i) {
    const double middle = std::sqrt(lo * hi);
    (countAt(middle) <= target ? lo : hi) = middle;
  }
  detail.fineness = target - countAt(lo) <= countAt(hi) - target ? lo : hi;
  AtriumBuilder(mesh, materials, detail, baysX, baysZ).build();

  const double lengthX = kBay * baysX, lengthZ = kBay * baysZ;
  mesh.addSun({0.48, -1, 0.42}, {10.f, 9.2f, 8.0f});
  mesh.setSky(glm::vec3(0.55f, 0.75f, 1.f) * sky);
  mesh.addCamera("court", {1.0, 1.7, lengthZ * 0.5 - 0.9}, {lengthX * 0.6, 3.5, lengthZ * 0.58}, 1.05);
  mesh.addCamera("gallery", {lengthX + 0.75, kGallery + 1.7, lengthZ * 0.5 - 0.75}, {lengthX * 0.35, 2.4, lengthZ * 0.62}, 1.1);
}

}  // namespace radivox::scene
