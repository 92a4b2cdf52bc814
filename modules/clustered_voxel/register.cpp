#include "engine/plugin/registry.h"

namespace radivox::clustered_voxel {

void registerNodes(plugin::Registry& registry) { (void)registry; }

}  // namespace radivox::clustered_voxel
