#include "engine/graph/node.h"
#include "engine/plugin/registry.h"
#include "modules/clustered_voxel/bounce/bounce.h"
#include "modules/clustered_voxel/cluster/cluster.h"
#include "modules/clustered_voxel/cluster/members.h"
#include "modules/clustered_voxel/cluster/shares.h"
#include "modules/clustered_voxel/filter/filter.h"
#include "modules/clustered_voxel/gather/gather.h"
#include "modules/clustered_voxel/gather_pixels/gather_pixels.h"
#include "modules/clustered_voxel/index/index.h"
#include "modules/clustered_voxel/inject/inject.h"
#include "modules/clustered_voxel/inspect/inspect.h"
#include "modules/clustered_voxel/mark/mark.h"
#include "modules/clustered_voxel/shade/shade.h"
#include "modules/clustered_voxel/sky/sky.h"
#include "modules/clustered_voxel/stability.h"
#include "modules/clustered_voxel/visibility/transfer.h"
#include "modules/clustered_voxel/visibility/visibility.h"
#include "modules/clustered_voxel/voxelize/faces.h"
#include "modules/clustered_voxel/voxelize/fragments.h"
#include "modules/clustered_voxel/voxelize/surface.h"
#include "modules/clustered_voxel/voxelize/triangles.h"
#include "modules/clustered_voxel/voxelize/voxelize.h"

namespace radivox::clustered_voxel {

// In reading order: what each stage writes, the next ones read (docs/data_flow.md).
void registerNodes(plugin::Registry& registry) {
  registry.add<Voxelize>("which voxels the surfaces touch, exactly and conservatively");
  registry.add<Index>("from a voxel's place to its number, and bricks to the nearest voxel");
  registry.add<Faces>("which of a voxel's six faces carry surface");
  registry.add<Surface>("area, albedo, mean normal, position and emission of voxel faces");
  registry.add<Triangles>("which triangles meet each voxel, for rays that start close by");
  registry.add<Fragments>("how many triangles meet in a voxel, and their mean normal");
  registry.add<Visibility>("what each voxel face sees: form factors by counting rays");
  registry.add<Cluster>("groups faces that lie near each other and face the same way");
  registry.add<Members>("what each cluster holds, and its means");
  registry.add<Shares>("how much each member counts in its cluster's means");
  registry.add<Transfer>("form factors between clusters, a sparse matrix");
  registry.add<Sky>("light of the sky on voxel faces, from the rays that left the scene");
  registry.add<Inject>("direct light at voxel faces, by shadow-map flux or the paper's points");
  registry.add<Bounce>("light that surfaces pass on among themselves, to a stated residual");
  registry.add<Mark>("voxel faces that this view needs");
  registry.add<Gather>("irradiance of the needed faces from their visible clusters, lazily");
  registry.add<Filter>("smooths gathered irradiance over surfaces, not across walls");
  registry.add<GatherPixels>("indirect irradiance on screen by voxel rays from the pixels");
  registry.add<Inspect>("voxel face and cluster of each pixel, for pictures");
  registry.add<Shade>("indirect irradiance on screen from voxel faces");
  addStabilityCases(registry);
}

}  // namespace radivox::clustered_voxel

RADIVOX_MODULE(radivox::clustered_voxel::registerNodes);
