#include "engine/plugin/registry.h"

namespace radivox::reference {

void registerNodes(plugin::Registry&) {}

}  // namespace radivox::reference

RADIVOX_MODULE(radivox::reference::registerNodes);
