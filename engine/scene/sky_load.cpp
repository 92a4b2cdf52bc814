// Where a sky comes from: a file, or one that is computed.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <new>

#include "engine/error.h"
#include "engine/scene/sky.h"

namespace radivox::scene {

namespace {

constexpr double kPi = 3.14159265358979323846;

struct Spec {
  std::string source;
  double scale = 1, turn = 0;
  Suns suns = Suns::TakeOut;
};

double readNumber(const std::string& sky, const std::string& key, const std::string& text, double least, double most) {
  double value = 0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  if (result.ec == std::errc() && result.ptr == text.data() + text.size() && value >= least && value <= most) return value;
  throw Error(ErrorCode::BadInput,
              sky + ": " + key + "=" + text + ": give a " + (least < 0 ? "number of degrees" : "number, 0 or more, as in scale=0.5"));
}

Spec parse(const std::string& sky) {
  Spec spec;
  const size_t question = sky.rfind('?');
  spec.source = sky.substr(0, question);
  size_t at = question == std::string::npos ? sky.size() : question + 1;
  while (at < sky.size()) {
    const size_t end = std::min(sky.find('&', at), sky.size()), equals = std::min(sky.find('=', at), end);
    const std::string key = sky.substr(at, equals - at), value = equals < end ? sky.substr(equals + 1, end - equals - 1) : "";
    if (key == "scale") {
      spec.scale = readNumber(sky, key, value, 0, 1e12);
    } else if (key == "turn") {
      spec.turn = readNumber(sky, key, value, -1e6, 1e6);
    } else if (key == "sun" && (value == "keep" || value == "light")) {
      spec.suns = value == "keep" ? Suns::Keep : Suns::TakeOut;
    } else {
      throw Error(ErrorCode::BadInput, sky + ": \"" + sky.substr(at, end - at) +
                                           "\" is no setting of a sky; there are scale=X, turn=DEGREES and sun=keep|light (default light)");
    }
    at = end + 1;
  }
  return spec;
}

/// A clear sky about 3 pm: pale at the horizon, blue above, dim ground, and a sun of 0.53° that gives 8 W/m² where the rest gives 1.3 on flat ground.
image::Image makeClear() {
  image::Image image;
  image.width = 512;
  image.height = 256;
  image.data.resize(size_t{image.width} * image.height * 3);
  const auto put = [&image](uint32_t x, uint32_t y, const glm::vec3& value) {
    for (glm::length_t c = 0; c < 3; ++c) image.at(x, y, static_cast<uint32_t>(c)) += value[c];
  };
  const glm::vec3 zenith(0.12f, 0.25f, 0.55f), horizon(0.7f, 0.8f, 0.9f), ground(0.10f, 0.09f, 0.08f);
  for (uint32_t y = 0; y < image.height; ++y) {
    const double height = std::cos(kPi * (y + 0.5) / image.height);
    const glm::vec3 value = height < 0 ? ground : glm::mix(zenith, horizon, static_cast<float>(std::pow(1 - height, 4)));
    for (uint32_t x = 0; x < image.width; ++x) put(x, y, value);
  }
  // Points of the disc, each with its share of the flux.
  constexpr int kRings = 16, kSpokes = 32;
  const double elevation = 40 * kPi / 180, u = 0.65, radius = 0.265 * kPi / 180;
  const glm::vec3 irradiance(8.6f, 8.f, 6.8f);
  for (int ring = 0; ring < kRings; ++ring) {
    for (int spoke = 0; spoke < kSpokes; ++spoke) {
      const double r = radius * std::sqrt((ring + 0.5) / kRings), angle = 2 * kPi * (spoke + 0.5) / kSpokes;
      const double polar = kPi / 2 - elevation + r * std::sin(angle), at = u + r * std::cos(angle) / std::sin(polar) / (2 * kPi);
      const auto x = static_cast<uint32_t>(at * image.width), y = static_cast<uint32_t>(polar / kPi * image.height);
      const double solidAngle = (std::cos(kPi * y / image.height) - std::cos(kPi * (y + 1) / image.height)) * 2 * kPi / image.width;
      put(x, y, irradiance / static_cast<float>(solidAngle * kRings * kSpokes));
    }
  }
  return image;
}

image::Image read(const std::string& source, const std::string& sky) {
  constexpr std::string_view kBuiltin = "builtin:";
  if (source.rfind(kBuiltin, 0) == 0) {
    if (source == "builtin:clear") return makeClear();
    throw Error(ErrorCode::BadInput, sky + ": no such sky; there is builtin:clear");
  }
  std::string extension = std::filesystem::path(source).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(), [](unsigned char c) { return std::tolower(c); });
  if (extension == ".hdr") return image::readHdr(source);
  if (extension != ".exr") throw Error(ErrorCode::BadInput, sky + ": a sky is an .exr or .hdr file, or builtin:clear; give one of these");
  for (image::Layer& layer : image::readExr(source)) {
    if (layer.name == "color") return std::move(layer.image);
  }
  throw Error(ErrorCode::BadInput, source + ": it has no channels R, G and B; save it as an RGB image");
}

}  // namespace

std::shared_ptr<const Sky> loadSky(const std::string& sky) {
  const Spec spec = parse(sky);
  try {
    return makeSky(read(spec.source, sky), spec.source, spec.scale, spec.turn, spec.suns);
  } catch (const std::bad_alloc&) {
    throw Error(ErrorCode::OutOfMemory, spec.source + ": does not fit into memory; scale the image down");
  }
}

}  // namespace radivox::scene
