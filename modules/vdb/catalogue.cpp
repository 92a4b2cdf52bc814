#include "modules/vdb/catalogue.h"

#include <algorithm>
#include <set>

#include "engine/params/params.h"

namespace radivox::vdb {

namespace {

constexpr const char* kDirections[] = {"pos_x", "neg_x", "pos_y", "neg_y", "pos_z", "neg_z"};
/// Groups of parseGrids that are no family's.
constexpr const char* kGroups[] = {"default", "all", "voxels"};
/// Families whose directions are in `default`.
constexpr std::string_view kDefaultFaces[] = {"area", "direct", "indirect"};

bool isDefaultFace(std::string_view family) {
  return std::find(std::begin(kDefaultFaces), std::end(kDefaultFaces), family) != std::end(kDefaultFaces);
}

std::vector<GridName> gridsOf(const Family& family) {
  std::vector<GridName> grids{{&family, kWholeVoxel}};
  for (int face = 0; face < 6 && family.faceMeaning != nullptr; ++face) grids.push_back({&family, face});
  return grids;
}

/// Does `word` of a selection name this grid?
bool covers(const std::string& word, const GridName& grid) {
  if (word == "all") return true;
  if (word == "voxels") return grid.face == kWholeVoxel;
  if (word == "default") return grid.face == kWholeVoxel || isDefaultFace(grid.family->name);
  if (grid.face != kWholeVoxel && word == std::string(grid.family->name) + "_faces") return true;
  return word == grid.print();
}

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> words;
  for (size_t begin = 0; begin <= text.size();) {
    const size_t end = std::min(text.find(',', begin), text.size());
    words.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return words;
}

[[noreturn]] void failUnknown(const std::string& word) {
  std::vector<std::string> names(std::begin(kGroups), std::end(kGroups));
  for (const Family& family : families()) {
    for (const GridName& grid : gridsOf(family)) names.push_back(grid.print());
    if (family.faceMeaning != nullptr) names.push_back(std::string(family.name) + "_faces");
  }
  const std::string near = params::nearestName(word, names);
  std::string message = "unknown grid '" + word + "'; ";
  if (!near.empty()) message += "did you mean '" + near + "'? ";
  message += "there is default, all, voxels";
  for (const Family& family : families()) message += std::string(", ") + family.name;
  throw Error(ErrorCode::BadInput, message + ", and NAME_faces for its six directions; see --grids help");
}

}  // namespace

const std::vector<Input>& inputs() {
  static const std::vector<Input> table = {
      {"grid", "clustered_voxel.voxelize", "grid", 0},
      {"voxels", "clustered_voxel.index", "voxels", 0},
      {"mask", "clustered_voxel.faces", "mask", NeedFaces},
      {"first", "clustered_voxel.faces", "first", NeedFaces},
      {"faces", "clustered_voxel.surface", "faces", NeedFaces},
      {"fragments", "clustered_voxel.fragments", "count", NeedFragments},
      {"normals", "clustered_voxel.fragments", "normal", NeedNormals},
      {"labels", "clustered_voxel.cluster", "labels", NeedLabels},
      {"cluster_places", "clustered_voxel.members", "places", NeedClusters},
      {"row_start", "clustered_voxel.visibility", "row_start", NeedRows},
      {"entries", "clustered_voxel.visibility", "entries", NeedRows},
      {"face_irradiance", "clustered_voxel.inject", "face_irradiance", NeedDirect},
      {"irradiance", "clustered_voxel.gather", "irradiance", NeedIndirect},
      {"error", "clustered_voxel.gather", "error", NeedError},
      {"valid", "clustered_voxel.gather", "valid", NeedIndirect | NeedError},
  };
  return table;
}

const std::vector<Family>& families() {
  constexpr uint32_t kRows = NeedFaces | NeedLabels | NeedRows;
  static const std::vector<Family> table = {
      {"occupancy", Kind::Float, "1", "1 where a surface touches the voxel", nullptr, 0, 0, true, false},
      {"fragment_count", Kind::Int, "triangles", "triangles that overlap the voxel", nullptr, NeedFragments, 0, false, false},
      {"mean_normal", Kind::Vector, "1", "unit mean of the surface's normals by area; 0 where they cancel or it only touches",
       "unit mean normal of the face's surface", NeedNormals, NeedFaces, false, true},
      {"albedo", Kind::Vector, "1", "linear Rec. 709 reflectance, mean over the faces by area", "linear Rec. 709 reflectance", NeedFaces,
       NeedFaces, false, false},
      {"area", Kind::Float, "voxel edge squared", "sum over the faces",
       "surface area as seen along the direction: a wall square to it has 1", NeedFaces, NeedFaces, true, false},
      {"cluster_id", Kind::Int, "id", "cluster of the largest face", "cluster", NeedFaces | NeedLabels, NeedFaces | NeedLabels, false,
       false},
      {"cluster_color", Kind::Vector, "linear RGB", "a bright colour for the cluster of the largest face",
       "a bright colour for the cluster", NeedFaces | NeedLabels, NeedFaces | NeedLabels, false, false},
      {"cluster_normal", Kind::Vector, "1", "mean normal of the cluster of the largest face", "mean normal of the cluster",
       NeedFaces | NeedLabels | NeedClusters, NeedFaces | NeedLabels | NeedClusters, false, true},
      {"lit", Kind::Float, "1", "share of the voxel's area on faces that lights reach; 0: in shadow", "1 where a light reaches the face",
       NeedFaces | NeedDirect, NeedFaces | NeedDirect, true, false},
      {"direct", Kind::Vector, "W/m^2", "irradiance from lights and emitter samples, mean over the faces by area",
       "irradiance from lights and emitter samples", NeedFaces | NeedDirect, NeedFaces | NeedDirect, false, false},
      {"indirect", Kind::Vector, "W/m^2", "irradiance after the first bounce, mean over the faces by area",
       "irradiance after the first bounce", NeedFaces | NeedIndirect, NeedFaces | NeedIndirect, false, false},
      {"visible_clusters", Kind::Int, "clusters", "clusters that the rays of any of the voxel's faces hit",
       "clusters that the face's rays hit", kRows, kRows, false, false},
      {"misses", Kind::Float, "1", "share of rays that left the scene, mean over the faces by area", "share of rays that left the scene",
       kRows, kRows, true, false},
      {"error", Kind::Vector, "W/m^2", "standard error of indirect, mean over the faces by area",
       "standard error of indirect by the spread of its rays", NeedFaces | NeedError, NeedFaces | NeedError, false, false},
  };
  return table;
}

std::string GridName::print() const { return face == kWholeVoxel ? family->name : std::string(family->name) + "_" + kDirections[face]; }

std::vector<GridName> parseGrids(const std::string& text) {
  const std::vector<std::string> words = split(text);
  std::vector<GridName> selected;
  std::set<std::string> used;
  for (const Family& family : families()) {
    for (GridName grid : gridsOf(family)) {
      bool wanted = false;
      for (const std::string& word : words) {
        if (!covers(word, grid)) continue;
        wanted = true;
        used.insert(word);
        const bool isGroup = std::find(std::begin(kGroups), std::end(kGroups), word) != std::end(kGroups);
        grid.named = grid.named || !isGroup;
      }
      if (wanted) selected.push_back(grid);
    }
  }
  for (const std::string& word : words) {
    if (used.count(word) == 0) failUnknown(word);
  }
  return selected;
}

uint32_t needsOf(const std::vector<GridName>& grids) {
  uint32_t needs = 0;
  for (const GridName& grid : grids) needs |= grid.needs();
  return needs;
}

std::string printCatalogue() {
  std::string text =
      "Grids of `radivox vdb --grids NAME[,NAME...]`. Only what they need is computed; they stand in order of what that costs.\n\n";
  const auto pad = [](std::string s, size_t width) {
    s.resize(std::max(width, s.size() + 1), ' ');
    return s;
  };
  for (const Family& family : families()) {
    text += "  " + pad(family.name, 18) + family.meaning + " [" + family.unit + "]\n";
  }
  text +=
      "\nOf each face direction, as NAME_pos_x, NAME_neg_x, NAME_pos_y, NAME_neg_y, NAME_pos_z, NAME_neg_z, or all six as NAME_faces:\n\n";
  for (const Family& family : families()) {
    if (family.faceMeaning != nullptr) text += "  " + pad(family.name, 18) + family.faceMeaning + "\n";
  }
  return text +
         "\nGroups:\n\n"
         "  default           voxels, area_faces, direct_faces, indirect_faces\n"
         "  voxels            every name of the first list\n"
         "  all               everything\n";
}

}  // namespace radivox::vdb
