#include "engine/plugin/registry.h"

namespace radivox::frame {

void registerNodes(plugin::Registry& registry) { (void)registry; }

}  // namespace radivox::frame
