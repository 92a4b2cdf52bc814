// Which grids there are, what they hold, and what each of them is made of. No GPU, no OpenVDB.
//
// A family is a quantity. Its plain name is the value of a whole voxel; NAME_pos_x … NAME_neg_z are those of the voxel's six faces.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace radivox::vdb {

enum class Kind : uint8_t { Float, Int, Vector };

/// What must be read beside the grid and its voxels; a bit each.
enum Need : uint32_t {
  NeedFaces = 1,       ///< mask, first, faces
  NeedFragments = 2,   ///< fragments
  NeedNormals = 4,     ///< normals
  NeedLabels = 8,      ///< labels
  NeedClusters = 16,   ///< clusters
  NeedRows = 32,       ///< row_start, entries
  NeedDirect = 64,     ///< face_irradiance
  NeedIndirect = 128,  ///< irradiance, valid
  NeedError = 256,     ///< error, valid
};

/// An input of vdb.write: the node type and port that it comes from, and who needs it.
struct Input {
  const char* port;
  const char* nodeType;
  const char* from;
  uint32_t need;  ///< 0: every grid
};
const std::vector<Input>& inputs();

struct Family {
  const char* name;
  Kind kind;
  const char* unit;
  const char* meaning;      ///< of a voxel
  const char* faceMeaning;  ///< of a face; null: the family has no grids by direction
  uint32_t needs;
  uint32_t faceNeeds;
  bool isFog;        ///< a density from 0 to 1, say: shown as fog
  bool isDirection;  ///< vectors that turn with the axes
};
const std::vector<Family>& families();

constexpr int kWholeVoxel = -1;

struct GridName {
  const Family* family = nullptr;
  int face = kWholeVoxel;  ///< or 0…5: +x −x +y −y +z −z
  bool named = false;      ///< asked for by its own name and not by a group's: it is an error if it cannot be made
  uint32_t needs() const { return face == kWholeVoxel ? family->needs : family->faceNeeds; }
  const char* meaning() const { return face == kWholeVoxel ? family->meaning : family->faceMeaning; }
  std::string print() const;  ///< "area_pos_x"
};

constexpr std::string_view kDefaultGrids = "default";

/// "occupancy,direct_faces" → grids, in the order of families(), each once. Groups: `default`, `all`, `voxels` (every plain name) and
/// NAME_faces (six directions). Throws BadInput with the nearest name.
std::vector<GridName> parseGrids(const std::string& text);
uint32_t needsOf(const std::vector<GridName>& grids);

/// What `--grids help` prints.
std::string printCatalogue();

}  // namespace radivox::vdb
