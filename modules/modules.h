// All modules of this build, linked in.
#pragma once

#include "engine/plugin/registry.h"

namespace radivox {

void registerModules(plugin::Registry& registry);

}  // namespace radivox
