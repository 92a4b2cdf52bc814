#include "tests/oracles/truth.h"

#include "engine/error.h"
#include "tests/oracles/pipeline.h"

namespace radivox::oracles {

namespace {

image::Image mixed(const image::Image& a, const image::Image& b, double weightA) {
  image::Image out = a;
  for (size_t i = 0; i < out.data.size(); ++i) out.data[i] = static_cast<float>(weightA * a.data[i] + (1.0 - weightA) * b.data[i]);
  return out;
}

image::Image masked(const image::Image& in, const image::Image& albedo) {
  image::Image out = in;
  for (size_t i = 0; i < size_t{in.width} * in.height; ++i)
    if (albedo.data[3 * i] + albedo.data[3 * i + 1] + albedo.data[3 * i + 2] <= 0.f)
      for (size_t c = 0; c < 3; ++c) out.data[3 * i + c] = 0.f;
  return out;
}

}  // namespace

image::Image layerOf(const std::vector<image::Layer>& layers, const std::string& name) {
  for (const image::Layer& layer : layers)
    if (layer.name == name) return layer.image;
  throw Error(ErrorCode::BadInput, "truth has no layer " + name);
}

Truth loadTruth(const std::string& name, double weightA) {
  const std::string folder = sharedFolder() + "/truth/" + name;
  const auto a = image::readExr(folder + "_a.exr"), b = image::readExr(folder + "_b.exr");
  Truth truth;
  truth.color = mixed(layerOf(a, "color"), layerOf(b, "color"), weightA);
  truth.direct = mixed(layerOf(a, "irradiance_direct"), layerOf(b, "irradiance_direct"), weightA);
  truth.indirect = mixed(layerOf(a, "irradiance_indirect"), layerOf(b, "irradiance_indirect"), weightA);
  truth.albedo = mixed(layerOf(a, "albedo"), layerOf(b, "albedo"), weightA);
  truth.noiseFloorIndirect = compareToTruth(layerOf(a, "irradiance_indirect"), layerOf(b, "irradiance_indirect"), truth.albedo).psnr;
  return truth;
}

Difference compareToTruth(const image::Image& reference, const image::Image& test, const image::Image& albedo) {
  const image::Image r = image::blockMeans(masked(reference, albedo), 4), t = image::blockMeans(masked(test, albedo), 4);
  return {image::psnr(r, t), image::meanOf(t) / image::meanOf(r)};
}

}  // namespace radivox::oracles
