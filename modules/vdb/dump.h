// Writes grids of voxels to a .vdb or .nvdb file, one after the other: what the node vdb.write, `radivox vdb` and a viewer's "dump" share.
//
//   const vdb::DumpSummary written = vdb::dumpFrame(device, graph, executor, traits, {.file = "hall.vdb", .grids = "occupancy,direct_faces"});
//
// cost    reads each buffer that a grid needs once; one grid at a time is in memory, 512 values for each block of 8³ voxels that holds any
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/graph/executor.h"
#include "modules/vdb/voxel_data.h"

namespace radivox::vdb {

/// Which way is up in the file. Y: as in the scene, in glTF and in Houdini. Z: turned as Blender turns glTF files when it imports them.
enum class Up : uint8_t { Y, Z };

struct DumpRequest {
  std::string file;                  ///< ends in .vdb or .nvdb
  std::string grids{kDefaultGrids};  ///< parseGrids
  std::string scene;                 ///< its name, for the file's metadata
  Up up = Up::Y;
  glm::dvec3 origin{0.0};  ///< Traits::origin
};

struct DumpedGrid {
  std::string name;
  uint64_t voxelCount = 0;  ///< active
};

struct DumpSummary {
  std::vector<DumpedGrid> grids;
  std::vector<std::string> leftOut;  ///< grids of groups that could not be made: "indirect: needs irradiance, …"
  uint32_t resolution = 0;           ///< N
  float voxelEdge = 0.f;             ///< m
  uint64_t voxelCount = 0;           ///< occupied
  uint64_t fileBytes = 0;
  uint64_t memoryBytes = 0;  ///< host memory at most, beside the buffers
};

/// Throws BadInput for names that are no .vdb or .nvdb file, or that cannot be written.
void checkFileName(const std::string& file);

class Dump {
 public:
  /// Reads the voxels and opens the file. Throws BadInput where a grid that was asked for by name lacks its input or the file cannot be
  /// written, OutOfMemory where host memory will not do; both name the mend.
  Dump(DumpRequest request, Buffers buffers);
  ~Dump();  ///< without finish() nothing stays of the file
  Dump(Dump&&) noexcept;

  size_t gridCount() const;
  size_t gridsDone() const;
  void writeNext();  ///< one grid
  DumpSummary finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// All at once, from what the executor has after a frame. `graph` is what it runs. Buffers that the plan left out make no grids (leftOut says
/// so); fragments and error need to be outputs of the graph, or nobody makes them. The GPU must be done with the frame.
DumpSummary dumpFrame(gpu::Device& device, const graph::Graph& graph, const graph::Executor& executor, const scene::Traits& traits,
                      DumpRequest request, const graph::Progress& progress = {});

}  // namespace radivox::vdb
