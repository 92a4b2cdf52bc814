// Where and how far a picture is from another.
#pragma once

#include "engine/image/compare.h"

namespace radivox::viewer {

/// Of each pixel the mean over channels of |t − r| / √(r² + 0.01·mean(r)²), the root of what relMSE sums: 0 the same, 1 and more white.
image::Image relativeErrors(const image::Image& reference, const image::Image& test);
/// The same as colours, display-referred.
image::Image paintError(const image::Image& reference, const image::Image& test);

}  // namespace radivox::viewer
