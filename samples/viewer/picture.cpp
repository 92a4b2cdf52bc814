#include "samples/viewer/picture.h"

#include <cmath>

namespace radivox::viewer {

Pixels encodePixels(const image::Image& image) {
  Pixels pixels{image.width, image.height, {}};
  const size_t count = size_t{image.width} * image.height;
  pixels.rgba.resize(count * 4, 255);
  for (size_t i = 0; i < count; ++i) {
    for (size_t c = 0; c < 3; ++c) {
      const float value = image.data[i * image.channels + (image.channels >= 3 ? c : 0)];
      pixels.rgba[4 * i + c] = static_cast<uint8_t>(std::lround(image::encodeSrgb(std::isfinite(value) ? value : 0.f) * 255.f));
    }
  }
  return pixels;
}

}  // namespace radivox::viewer
