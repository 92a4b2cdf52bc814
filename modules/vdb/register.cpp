#include "engine/plugin/registry.h"
#include "modules/vdb/write_node.h"

namespace radivox::vdb {

void registerNodes(plugin::Registry& registry) { registry.add<Write>("voxels, faces and clusters as grids of an OpenVDB or NanoVDB file"); }

}  // namespace radivox::vdb

RADIVOX_MODULE(radivox::vdb::registerNodes);
