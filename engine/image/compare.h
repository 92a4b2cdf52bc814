// How wrong an image is (METHODS section 5), against one reference or against two independent halves of one.
//
// A noisy reference makes every image look wrong by its own noise. Two halves a, b of it mend that: E[(m − a)(m − b)] is the squared error of
// m alone, since their noises are independent, and how far a and b differ says how sure the figure is.
#pragma once

#include <optional>

#include "engine/image/image.h"

namespace radivox::image {

/// Throws BadInput on images of different shape, without pixels, or with a pixel that is not finite, naming image, pixel and channel.
void checkComparable(const Image& reference, const Image& test, const std::string& referenceName = "the reference",
                     const std::string& testName = "the test image");

/// `share` in [0, 1] of the values in ascending order, by linear interpolation. Not of nothing.
double percentileOf(std::vector<double> values, double share);

struct Truth {
  Image mean;             ///< the best estimate: of both halves
  Image a, b;             ///< empty where there is only one
  double shareOfA = 0.5;  ///< of the samples
  bool hasHalves() const { return !a.data.empty(); }
};
Truth truthOf(Image reference);
/// mean = shareOfA·a + (1 − shareOfA)·b. Throws BadInput as checkComparable, and for shares outside (0, 1).
Truth truthOf(Image a, Image b, double shareOfA = 0.5);

/// Of the reference's noise; only two halves tell.
struct Uncertainty {
  double mseError = 0;   ///< standard error of Comparison::mse
  double biasError = 0;  ///< standard error of Comparison::bias
  double rmseLow = 0;    ///< 95 % interval of Comparison::rmse
  double rmseHigh = 0;
  double floorRmse = 0;    ///< RMSE of the reference's mean against what it converges to: what `plainRmse` cannot go below
  double floorRelMse = 0;  ///< likewise
  double psnrHalves = 0;   ///< one half against the other: about what the reference can show at all, dB
  double psnrBlocksHalves = 0;
};

/// Over all channels of all pixels.
struct Comparison {
  uint64_t pixelCount = 0;
  double meanReference = 0, meanTest = 0;
  double bias = 1;        ///< mean(test)/mean(reference); +∞ over a black reference, 1 if both are black
  double mse = 0;         ///< with halves unbiased: noise may bring it below 0
  double rmse = 0;        ///< √ max(mse, 0)
  double plainRmse = 0;   ///< against the mean, its noise counted in
  double relMse = 0;      ///< mean((t − r)²/(r² + 0.01·mean(r)²)), r of the mean; with halves (t − a)(t − b) over that
  double psnr = 0;        ///< dB, against the mean; +∞ for equal images
  double psnrBlocks = 0;  ///< of 4×4 block means; NaN for images of less than 4 pixels a side
  double exposure = 1;    ///< that psnr was taken at
  std::optional<Uncertainty> uncertainty;
};
/// `exposure` for psnr; nothing: the one that puts the reference's 99th percentile at 1.
Comparison compare(const Truth& truth, const Image& test, std::optional<float> exposure = {});

/// One channel, 0 to 1, as linear RGB for writePng: black, violet, red, orange, pale yellow, ever brighter.
Image paintHeat(const Image& map);

}  // namespace radivox::image
