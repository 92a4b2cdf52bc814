#include "engine/plugin/registry.h"
#include "modules/reference/path_trace.h"

namespace radivox::reference {

void registerNodes(plugin::Registry& registry) {
  registry.add<PathTrace>("the truth on screen: radiance and its parts by path tracing on the host");
}

}  // namespace radivox::reference

RADIVOX_MODULE(radivox::reference::registerNodes);
