// Pictures to be compared: their files, layers, and which pixels count.
#pragma once

#include <string>
#include <vector>

#include "engine/image/compare.h"

namespace radivox::cli {

struct PictureFile {
  std::string path;
  bool displayReferred = false;  ///< .png: values as a screen shows them; .exr: linear radiometry
  std::vector<image::Layer> layers;
};
/// .exr or .png by its name. Throws BadInput.
PictureFile readPicture(const std::string& path);

/// A layer without its alpha. A file of one layer is that layer, whatever it is called. Throws BadInput with the names there are.
image::Image takeLayer(const PictureFile& file, const std::string& name);

/// "A" or "A,B" (two independent halves); a file that has a comma in its name is one.
std::vector<std::string> splitReference(const std::string& text);

/// "256,512" of --weights: the first half's share of the samples. Throws BadInput.
double parseWeights(const std::string& text);

/// What a layer is compared with, every file checked and named in errors.
struct LayerTruth {
  image::Truth truth;
  std::vector<char> leftOut;  ///< a pixel: nonzero where `layer` says nothing; empty: every pixel counts
  /// Irradiance means something only on surfaces that reflect: where the reference's albedo is 0 (sky, emitters) pixels are left out.
  void maskPixels(image::Image& image) const;  ///< they count as 0 everywhere
  uint64_t leftOutCount() const;
};
LayerTruth takeTruth(const std::vector<PictureFile>& files, const std::string& layer, double shareOfA);

}  // namespace radivox::cli
