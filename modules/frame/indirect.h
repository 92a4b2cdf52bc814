// Whether the picture has light that came by way of other surfaces, or the sky's, which is found with it.
#pragma once

#include "engine/graph/node.h"

namespace radivox::frame {

/// Null, or why nothing of what finds indirect light is needed. Says the same where it is kept all the same (Feature::Bounces).
inline const char* whyNoIndirect(const graph::Declaration& d) {
  if (d.traits.sky && !d.traits.skyImage) return nullptr;
  return d.request.wantsIndirect() ? d.traits.whyNothingBounces() : "0 bounces asked for and no sky";
}

}  // namespace radivox::frame
