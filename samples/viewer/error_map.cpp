#include "samples/viewer/error_map.h"

#include <algorithm>
#include <cmath>

namespace radivox::viewer {

image::Image relativeErrors(const image::Image& reference, const image::Image& test) {
  image::checkComparable(reference, test, "the stored picture", "this picture");
  const double mean = image::meanOf(reference);
  image::Image errors{reference.width, reference.height, 1, {}};
  const size_t count = size_t{reference.width} * reference.height, channels = reference.channels;
  errors.data.resize(count);
  for (size_t i = 0; i < count; ++i) {
    double sum = 0;
    for (size_t c = 0; c < channels; ++c) {
      const double r = static_cast<double>(reference.data[i * channels + c]), t = static_cast<double>(test.data[i * channels + c]);
      const double scale = std::sqrt(r * r + 0.01 * mean * mean);
      if (scale > 0) sum += std::abs(t - r) / scale;
    }
    errors.data[i] = static_cast<float>(sum / static_cast<double>(channels));
  }
  return errors;
}

image::Image paintError(const image::Image& reference, const image::Image& test) {
  image::Image errors = relativeErrors(reference, test);
  for (float& value : errors.data) value = std::clamp(value, 0.f, 1.f);
  return image::paintHeat(errors);
}

}  // namespace radivox::viewer
