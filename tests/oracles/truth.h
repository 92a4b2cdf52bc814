// Independent renders to compare with (../shared/truth; its README says how they were made). Not there: tests skip themselves.
#pragma once

#include <string>
#include <vector>

#include "engine/image/image.h"

namespace radivox::oracles {

struct Truth {
  image::Image color, direct, indirect, albedo;  ///< mean of both files, weighted by their samples; E in W/m²
  double noiseFloorIndirect = 0;                 ///< dB, file a against file b, 4×4 block means
};

/// `name` as in "sponza_b8"; `weightA` is a's share of the samples.
Truth loadTruth(const std::string& name, double weightA);

/// Throws BadInput where the file has no such layer.
image::Image layerOf(const std::vector<image::Layer>& layers, const std::string& name);

struct Difference {
  double psnr = 0;  ///< dB on 4×4 block means, exposed to the reference's 99th percentile, sRGB-encoded
  double bias = 0;  ///< mean(test) / mean(reference)
};
/// Pixels of albedo 0 (sky, emitters) count as 0 in both.
Difference compareToTruth(const image::Image& reference, const image::Image& test, const image::Image& albedo);

}  // namespace radivox::oracles
