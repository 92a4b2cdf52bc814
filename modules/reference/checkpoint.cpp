// The state of a rendering as bytes, and back. Little-endian, as every machine that Embree runs on.
#include <algorithm>
#include <cstring>
#include <type_traits>

#include "engine/error.h"
#include "modules/reference/rendering_state.h"
#include "modules/reference/sampler.h"

namespace radivox::reference {

namespace {

constexpr char kMagic[] = "radivox reference 2\n";

struct Header {
  uint64_t scene = 0, camera = 0, seed = 0;
  uint32_t width = 0, height = 0, bounces = 0, samplesPerPass = 0;
  uint32_t passes = 0, reserved = 0;
  double seconds = 0;
  uint64_t content = 0;  ///< hash of the pixels
};
static_assert(std::is_trivially_copyable_v<Header> && std::is_trivially_copyable_v<PixelMoments>);
static_assert(sizeof(PixelMoments) == 2 * (2 * kChannelCount + 6) * sizeof(float));

uint64_t hashBytes(const void* data, size_t bytes) {
  const auto* p = static_cast<const char*>(data);
  uint64_t hash = combineKeys(0, bytes);
  for (size_t i = 0; i < bytes; i += 8) {
    uint64_t word = 0;
    std::memcpy(&word, p + i, std::min<size_t>(8, bytes - i));
    hash = combineKeys(hash, word);
  }
  return hash;
}

uint64_t hashCamera(const scene::CameraDescription& camera) {
  const float values[] = {camera.position.x,    camera.position.y,    camera.position.z,    camera.orientation.w,
                          camera.orientation.x, camera.orientation.y, camera.orientation.z, camera.yfov,
                          camera.ymag,          camera.znear,         camera.zfar,          camera.orthographic ? 1.f : 0.f};
  return hashBytes(values, sizeof(values));
}

}  // namespace

std::string Rendering::checkpoint() const {
  Header header;
  header.scene = impl_->tracer.fingerprint();
  header.camera = hashCamera(impl_->camera);
  header.seed = impl_->settings.seed;
  header.width = impl_->settings.width;
  header.height = impl_->settings.height;
  header.bounces = impl_->settings.bounces;
  header.samplesPerPass = impl_->settings.samplesPerPass;
  header.passes = impl_->passes;
  header.seconds = impl_->seconds;
  const size_t pixelBytes = impl_->pixels.size() * sizeof(PixelMoments);
  header.content = hashBytes(impl_->pixels.data(), pixelBytes);
  std::string state(kMagic, sizeof(kMagic) - 1);
  state.reserve(state.size() + sizeof(header) + pixelBytes);
  state.append(reinterpret_cast<const char*>(&header), sizeof(header));
  state.append(reinterpret_cast<const char*>(impl_->pixels.data()), pixelBytes);
  return state;
}

void Rendering::resume(const std::string& state, const std::string& source) {
  const size_t magicBytes = sizeof(kMagic) - 1;
  Header header;
  if (state.size() < magicBytes + sizeof(header) || state.compare(0, magicBytes, kMagic) != 0)
    throw Error(ErrorCode::BadInput, source + ": not a checkpoint of this version; begin anew without it");
  std::memcpy(&header, state.data() + magicBytes, sizeof(header));
  const Settings& settings = impl_->settings;
  const auto refuse = [&](const std::string& what, const std::string& theirs, const std::string& ours) {
    throw Error(ErrorCode::BadInput,
                source + ": holds a picture with " + what + " " + theirs + ", not " + ours + "; ask for the same, or begin anew");
  };
  const auto compare = [&](const std::string& what, uint64_t theirs, uint64_t ours) {
    if (theirs != ours) refuse(what, std::to_string(theirs), std::to_string(ours));
  };
  if (header.scene != impl_->tracer.fingerprint())
    throw Error(ErrorCode::BadInput, source + ": holds a picture of another scene (or the scene has changed); begin anew");
  if (header.camera != hashCamera(impl_->camera))
    throw Error(ErrorCode::BadInput, source + ": holds a picture from another camera; name that camera, or begin anew");
  compare("width", header.width, settings.width);
  compare("height", header.height, settings.height);
  if (header.bounces != settings.bounces) {
    const auto print = [](uint32_t bounces) { return bounces == scene::kAllBounces ? std::string("all") : std::to_string(bounces); };
    refuse("bounces", print(header.bounces), print(settings.bounces));
  }
  compare("seed", header.seed, settings.seed);
  if (!impl_->choosesPassSize) compare("samplesPerPass", header.samplesPerPass, settings.samplesPerPass);
  const size_t pixelBytes = impl_->pixels.size() * sizeof(PixelMoments);
  const char* pixels = state.data() + magicBytes + sizeof(header);
  if (state.size() != magicBytes + sizeof(header) + pixelBytes || hashBytes(pixels, pixelBytes) != header.content ||
      header.samplesPerPass == 0)
    throw Error(ErrorCode::BadInput, source + ": damaged; begin anew without it");
  std::memcpy(impl_->pixels.data(), pixels, pixelBytes);
  impl_->settings.samplesPerPass = header.samplesPerPass;
  impl_->passes = header.passes;
  impl_->seconds = header.seconds;
  impl_->checkTarget();
}

}  // namespace radivox::reference
