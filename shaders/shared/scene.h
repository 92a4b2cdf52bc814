// The scene on the device: flattened world-space triangles in metres relative to Scene::origin, y up. Radiometry: METHODS section 0.
#ifndef RADIVOX_SHADERS_SHARED_SCENE_H
#define RADIVOX_SHADERS_SHARED_SCENE_H
#include "types.h"
RADIVOX_SHARED_BEGIN

struct Vertex {
  vec3 position;    // m
  vec3 normal;      // unit shading normal
  vec2 uvBase;      // texture coordinates of the base colour texture, its transform applied
  vec2 uvEmissive;  // likewise of the emissive texture
};

// Material::flags
RADIVOX_CONST uint kMaterialDoubleSided = 1u;
RADIVOX_CONST uint kMaterialAlphaMask = 2u;
RADIVOX_CONST uint kMaterialEmissive = 4u;
RADIVOX_CONST uint kNoTexture = 0xffffffffu;

struct Material {
  vec3 albedo;            // base colour factor, linear Rec. 709, in [0, 0.999]
  float alpha;            // base colour factor's alpha
  vec3 emission;          // L_e = emissiveFactor · emissiveStrength, W/(m² sr), front side only
  float alphaCutoff;
  uint baseTexture;       // index in the texture table, or kNoTexture
  uint emissiveTexture;
  uint flags;
};

// Texture table entry. Texels are 8-bit RGBA, one uint each, mip levels one after the other, in one buffer read by device address.
RADIVOX_CONST uint kWrapRepeat = 0u;
RADIVOX_CONST uint kWrapClamp = 1u;
RADIVOX_CONST uint kWrapMirror = 2u;
RADIVOX_CONST uint kTextureNearest = 1u;  // flags: no bilinear filter
RADIVOX_CONST uint kTextureSrgb = 2u;     // flags: decode sRGB before filtering (alpha is linear)
struct Texture {
  uvec2 address;  // device address of level 0, low and high word
  uint width;
  uint height;
  uint levelCount;
  uint wrapU;
  uint wrapV;
  uint flags;
};

RADIVOX_CONST uint kLightDirectional = 0u;
RADIVOX_CONST uint kLightPoint = 1u;
RADIVOX_CONST uint kLightSpot = 2u;
RADIVOX_CONST uint kLightEmitterSample = 3u;  // one point on an emissive triangle; radiates into its front hemisphere with a cosine

RADIVOX_CONST uint kSkySun = 0xfffffffeu;  // Light::triangle

struct Light {
  vec3 position;       // m; point, spot, emitter sample
  uint type;
  vec3 direction;      // unit, along which light travels (spot axis); emitter sample: front normal
  float range;         // m, 0: unlimited (KHR_lights_punctual windowing)
  vec3 intensity;      // directional: irradiance on a facing plane, W/m²; point, spot: W/sr; emitter sample: L_e · its share of area, W/sr along the normal
  float cosInner;      // spot
  float cosOuter;      // spot
  uint firstShadowView;
  uint shadowViewCount;  // directional 1; spot 1, or 5 when its outer half angle is above 60°; point 6; emitter sample 5
  uint triangle;         // emitter sample: the emissive triangle it stands for; kSkySun: taken out of the sky's image; else kNoTexture
};

// One view of a light: a square tile of resolution² texels at (offsetX, offsetY) of a shadow map layer. viewProjection fills the tile
// with clip space [−1, 1]² (texel = offset + (ndc·0.5 + 0.5)·resolution). Views of a light meet at their edges without overlap. Perspective
// views end nowhere: inverseViewProjection · (ndc, 0, 1) is the direction of a ray, exact where a difference of points would cancel.
// The map stores depth (reversed z) and triangle id + 1 of the nearest surface seen from the light.
struct ShadowView {
  mat4 viewProjection;   // relative world metres → clip, reversed z
  mat4 inverseViewProjection;
  vec3 origin;           // light position; directional: unused
  uint light;
  float texelFlux;       // directional: texel area in m²; others: texel area on the plane at distance 1 m (for solid angles)
  uint resolution;       // texels a side; 0: no face is in the view, and it has no tile
  uint layer;
  uint offsetX;          // texels, of the tile's top left corner in the layer
  uint offsetY;
};

struct EmissiveTriangle {
  uint triangle;
  float area;       // m²
  vec3 emission;    // mean L_e over the triangle
  float cumulativePower;  // Σ up to and with this one of area · luminance, divided by the total
};

struct Camera {
  mat4 viewProjection;  // relative world metres → clip, reversed z, infinite far plane
  mat4 inverseViewProjection;
  vec3 position;        // m, relative to Scene::origin
  uint orthographic;    // 0: perspective
  vec3 forward;         // unit
  float pixelAngle;     // world size of a pixel at distance 1 (perspective) or everywhere (orthographic), m
  uint width;
  uint height;
};

struct SceneInfo {
  vec3 boundsMin;  // m, relative to Scene::origin
  uint triangleCount;
  vec3 boundsMax;
  uint lightCount;
  vec3 skyRadiance;  // W/(m² sr), constant over the sphere; adds to the image in scene.sky
  uint materialCount;
  uint emissiveTriangleCount;
  uint shadowViewCount;
  float emissiveArea;  // m²
  uint emitterSampleCount;  // lights of type kLightEmitterSample; 0 with emissive triangles: emitters light through rays
  uint skyWidth;   // texels of the sky's image; 0: none
  uint skyHeight;
  float skyTurn;   // radians about +y (shaders/shared/sky.h)
};

RADIVOX_SHARED_END
#endif
