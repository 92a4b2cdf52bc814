#include "engine/plugin/registry.h"
#include "modules/frame/composite.h"
#include "modules/frame/direct.h"
#include "modules/frame/gbuffer.h"
#include "modules/frame/shadow_map.h"
#include "modules/frame/tone_map.h"

namespace radivox::frame {

void registerNodes(plugin::Registry& registry) {
  registry.add<ShadowMap>("what every light sees: depth and triangle of the nearest surface");
  registry.add<GBuffer>("what the camera sees: position, normal, albedo, emission, triangle");
  registry.add<Direct>("direct irradiance on screen from punctual lights and emitters");
  registry.add<Composite>("radiance on screen from albedo, irradiance and emission");
  registry.add<ToneMap>("radiance to sRGB: exposure by percentile, linear or filmic");
}

}  // namespace radivox::frame

RADIVOX_MODULE(radivox::frame::registerNodes);
