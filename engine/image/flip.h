// FLIP: how different two images look when one flips between them. From the papers' definitions:
//   LDR  Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström, Fairchild: FLIP: A Difference Evaluator for Alternating Images, 2020
//   HDR  Andersson, Nilsson, Shirley, Akenine-Möller: Visualizing Errors in Rendered High Dynamic Range Images, 2021
#pragma once

#include "engine/image/image.h"

namespace radivox::image {

/// 0.7 m before a screen 0.7 m and 3840 pixels wide.
constexpr double kFlipPixelsPerDegree = 0.7 * 3840.0 / 0.7 * 3.14159265358979323846 / 180.0;

struct FlipMap {
  Image error;            ///< one channel, 0 (the same) to 1
  double mean = 0;        ///< of `error`
  double percentile = 0;  ///< the 99th, by linear interpolation
};

struct HdrFlipMap : FlipMap {
  double startExposure = 0;  ///< log2 stops: the reference's brightest pixel lands at 0.85
  double stopExposure = 0;   ///< its median pixel does
  uint32_t exposureCount = 0;
};

/// Display-referred images: linear values, clamped to [0, 1] here; 1 or 3 channels (a fourth is ignored). Both functions throw BadInput on
/// images of different shape and on pixels that are not finite, naming the pixel.
/// Cost: about 500 multiplications a pixel and image; HDR as often as there are exposures.
FlipMap flip(const Image& reference, const Image& test, double pixelsPerDegree = kFlipPixelsPerDegree);
/// Scene-referred images: the largest LDR error over the exposures that show the reference's range, tone-mapped as filmic (ACES) curves do.
HdrFlipMap hdrFlip(const Image& reference, const Image& test, double pixelsPerDegree = kFlipPixelsPerDegree);

}  // namespace radivox::image
