// The module's own cases of `radivox stability`: what only its stages can be asked, voxel face by voxel face.
#pragma once

#include "engine/plugin/registry.h"

namespace radivox::clustered_voxel {

void addStabilityCases(plugin::Registry& registry);

}  // namespace radivox::clustered_voxel
