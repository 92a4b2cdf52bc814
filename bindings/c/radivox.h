/* Radivox for hosts in other languages: a device adopted, a graph from JSON, imports, frames recorded, parameters, errors.
 *
 * Results   Every function that can fail returns a RadivoxResult; radivoxLastError() then says, in one line of UTF-8, what is wrong, where,
 *           and the mend. Nothing is thrown across this border. What a failed call was to write is not written.
 * Handles   Opaque; made by radivoxCreate… (or Adopt, Load), destroyed by radivoxDestroy…, in any order: what another handle still needs
 *           lives on inside it. Destroying NULL does nothing. Vulkan's own handles stay yours: instance, device and queue outlive every
 *           handle made on them, imported images and buffers outlive the frames that use them.
 * Structs   `structSize` is sizeof the struct as you compiled it: later versions add members at the end, and 0 in a member is its default.
 *           Structs that come in arrays have no size and never change.
 * Strings   Yours are copied. Ours (const char*) are good until the next call with the same handle.
 * Units     Metres, radians, W/m² (irradiance, directional lights), W/sr (point and spot lights), W/(m² sr) (radiance, emission); colours
 *           are linear Rec. 709. Right-handed, y up; a camera looks along −z. Images' rows go from the top.
 * Threads   One thread at a time for a device and all that is made on it; different devices may have different threads.
 *           radivoxLastError() is a thread's own. Pipelines are compiled by threads of Radivox's own, which end before the call does.
 *
 * docs/embedding.md tells the frame step by step; samples/embed/c is a host in C.
 */
#ifndef RADIVOX_H
#define RADIVOX_H

#include <stddef.h>
#include <stdint.h>
#include <vulkan/vulkan_core.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define RADIVOX_API __attribute__((visibility("default")))
#else
#define RADIVOX_API
#endif

typedef enum RadivoxResult {
  RADIVOX_OK = 0,
  RADIVOX_INTERNAL_ERROR = 1, /* a mistake of Radivox's: please report it */
  RADIVOX_BAD_INPUT = 2,      /* an argument, file, graph, parameter or scene is wrong */
  RADIVOX_UNSUPPORTED = 3,    /* the device or this build lacks what is asked for */
  RADIVOX_OUT_OF_MEMORY = 4,  /* host or device memory, or a limit of the device */
  RADIVOX_DEVICE_FAILED = 5,  /* a Vulkan call failed for another reason */
  RADIVOX_INTERRUPTED = 6,    /* a progress callback said so */
  RADIVOX_RESULT_32_BIT = 0x7fffffff
} RadivoxResult;

/* What went wrong in this thread's last failed call; "" before any. Good until this thread's next failure. */
RADIVOX_API const char* radivoxLastError(void);

/* "0.1.0" */
RADIVOX_API const char* radivoxVersion(void);

typedef struct RadivoxNeeds RadivoxNeeds;       /* what a VkDevice must enable */
typedef struct RadivoxDevice RadivoxDevice;     /* a device, yours or its own */
typedef struct RadivoxScene RadivoxScene;       /* triangles, materials, lights, cameras, in host memory */
typedef struct RadivoxGraph RadivoxGraph;       /* nodes and edges, and their parameters */
typedef struct RadivoxRenderer RadivoxRenderer; /* a graph planned for a scene on a device, and run frame by frame */

/* -- Device ------------------------------------------------------------------------------------------------------------------------ */

/* Asks before you make your VkDevice. RADIVOX_UNSUPPORTED names what this physical device lacks. */
RADIVOX_API RadivoxResult radivoxCreateNeeds(VkPhysicalDevice physicalDevice, RadivoxNeeds** needs);
RADIVOX_API void radivoxDestroyNeeds(RadivoxNeeds* needs);
/* For VkDeviceCreateInfo::pNext; good while `needs` is. To enable more, set the same members in a chain of your own. */
RADIVOX_API const VkPhysicalDeviceFeatures2* radivoxNeededFeatures(const RadivoxNeeds* needs);
RADIVOX_API uint32_t radivoxNeededExtensionCount(const RadivoxNeeds* needs);
RADIVOX_API const char* const* radivoxNeededExtensions(const RadivoxNeeds* needs);
RADIVOX_API uint32_t radivoxNeededQueueFamily(const RadivoxNeeds* needs); /* graphics and compute */

typedef struct RadivoxAdoptInfo {
  uint32_t structSize;
  uint32_t queueFamily;
  VkInstance instance;
  VkPhysicalDevice physicalDevice;
  VkDevice device;
  /* Left alone by you while radivoxRun, radivoxCreateRenderer, radivoxSetLights, radivoxSetGeometry and radivoxWritePicture work. */
  VkQueue queue;
  const VkPhysicalDeviceFeatures2* enabledFeatures; /* as you gave it to vkCreateDevice; NULL: as radivoxNeededFeatures has it */
  const char* const* extensions;                    /* those you enabled */
  uint32_t extensionCount;
  VkBool32 debugUtils;           /* you enabled VK_EXT_debug_utils: objects get names */
  const char* pipelineCacheFile; /* read now, written when the device is destroyed; NULL: none */
} RadivoxAdoptInfo;
RADIVOX_API RadivoxResult radivoxAdoptDevice(const RadivoxAdoptInfo* info, RadivoxDevice** device);

typedef struct RadivoxDeviceInfo {
  uint32_t structSize;
  uint32_t physicalDevice; /* 0: the best; else 1 + its index */
  VkBool32 validation;     /* with Khronos' layer; messages go to stderr */
  const char* pipelineCacheFile;
} RadivoxDeviceInfo;
/* An instance and a device of Radivox's own. `info` may be NULL. */
RADIVOX_API RadivoxResult radivoxCreateDevice(const RadivoxDeviceInfo* info, RadivoxDevice** device);
RADIVOX_API void radivoxDestroyDevice(RadivoxDevice* device);

/* -- Scene ------------------------------------------------------------------------------------------------------------------------- */

typedef struct RadivoxVertex {
  float position[3];
  float normal[3]; /* unit */
  float uv[2];     /* of the textures */
} RadivoxVertex;

typedef enum RadivoxMaterialFlags {
  RADIVOX_MATERIAL_DOUBLE_SIDED = 1, /* read by nodes with sides=gltf only; surfaces reflect on both sides by default */
  RADIVOX_MATERIAL_ALPHA_MASK = 2,   /* texels of `albedoTexture` with alpha below alphaCutoff are not there */
  RADIVOX_MATERIAL_FLAGS_32_BIT = 0x7fffffff
} RadivoxMaterialFlags;
#define RADIVOX_NO_TEXTURE 0xffffffffu

typedef struct RadivoxMaterial {
  float albedo[3];   /* in [0, 0.999]; above is lowered */
  float alpha;       /* factor of the texture's */
  float emission[3]; /* radiance, front side only: where the corners go counter-clockwise */
  float alphaCutoff;
  uint32_t albedoTexture; /* index, or RADIVOX_NO_TEXTURE */
  uint32_t emissionTexture;
  uint32_t flags; /* RadivoxMaterialFlags */
} RadivoxMaterial;

typedef enum RadivoxWrap {
  RADIVOX_WRAP_REPEAT = 0,
  RADIVOX_WRAP_CLAMP = 1,
  RADIVOX_WRAP_MIRROR = 2,
  RADIVOX_WRAP_32_BIT = 0x7fffffff
} RadivoxWrap;

typedef struct RadivoxTexture {
  const uint8_t* rgba; /* width · height · 4 bytes, rows from the top; copied */
  uint32_t width, height;
  uint32_t wrapU, wrapV; /* RadivoxWrap */
  VkBool32 srgb;         /* the colours are sRGB-encoded; alpha is linear */
  VkBool32 nearest;      /* no filter */
} RadivoxTexture;

typedef enum RadivoxLightType {
  RADIVOX_LIGHT_DIRECTIONAL = 0,
  RADIVOX_LIGHT_POINT = 1,
  RADIVOX_LIGHT_SPOT = 2,
  RADIVOX_LIGHT_TYPE_32_BIT = 0x7fffffff
} RadivoxLightType;

typedef struct RadivoxLight {
  uint32_t type; /* RadivoxLightType */
  float position[3];
  float direction[3];   /* unit, along which light travels */
  float intensity[3];   /* W/m² on a facing plane (directional), else W/sr */
  float range;          /* 0: unlimited */
  float innerConeAngle; /* spot: from the axis */
  float outerConeAngle;
} RadivoxLight;

typedef struct RadivoxCamera {
  uint32_t structSize;
  VkBool32 orthographic;
  float position[3];
  float orientation[4]; /* quaternion x, y, z, w */
  float verticalAngle;  /* perspective: of the whole picture */
  float halfHeight;     /* orthographic */
  float nearPlane;      /* along the view axis, above 0 */
  float farPlane;       /* orthographic only; perspective ends nowhere */
} RadivoxCamera;

typedef struct RadivoxSceneInfo {
  uint32_t structSize;
  uint32_t vertexCount;
  const RadivoxVertex* vertices;
  const uint32_t* indices;           /* 3 a triangle */
  const uint32_t* triangleMaterials; /* 1 a triangle; NULL: all 0 */
  uint32_t triangleCount;
  uint32_t materialCount; /* at least 1 */
  const RadivoxMaterial* materials;
  const RadivoxTexture* textures;
  uint32_t textureCount;
  uint32_t lightCount;
  const RadivoxLight* lights;
  float skyRadiance[3]; /* constant over the sphere */
} RadivoxSceneInfo;
/* Your triangles, in world space; everything is copied. */
RADIVOX_API RadivoxResult radivoxCreateScene(const RadivoxSceneInfo* info, RadivoxScene** scene);
/* A .gltf or .glb file, or "builtin:NAME". */
RADIVOX_API RadivoxResult radivoxLoadScene(const char* file, RadivoxScene** scene);
RADIVOX_API void radivoxDestroyScene(RadivoxScene* scene);
RADIVOX_API uint32_t radivoxCameraCount(const RadivoxScene* scene);
RADIVOX_API RadivoxResult radivoxGetCamera(const RadivoxScene* scene, uint32_t index, RadivoxCamera* camera);
RADIVOX_API uint32_t radivoxLightCount(const RadivoxScene* scene);
RADIVOX_API RadivoxResult radivoxGetLight(const RadivoxScene* scene, uint32_t index, RadivoxLight* light);
/* For renderers to come, and for radivoxSetLights. */
RADIVOX_API RadivoxResult radivoxSetSceneLights(RadivoxScene* scene, const RadivoxLight* lights, uint32_t lightCount,
                                                const float skyRadiance[3]);
/* Where a thing moves: vertices by an affine map, 4 columns of 4; mirrors are refused. For renderers to come, and for radivoxSetGeometry. */
RADIVOX_API RadivoxResult radivoxMoveVertices(RadivoxScene* scene, uint32_t firstVertex, uint32_t vertexCount, const float matrix[16]);
/* Things in a scene that was loaded: each a range of vertices. The name is good while the scene is. */
RADIVOX_API uint32_t radivoxObjectCount(const RadivoxScene* scene);
RADIVOX_API RadivoxResult radivoxGetObject(const RadivoxScene* scene, uint32_t index, const char** name, uint32_t* firstVertex,
                                           uint32_t* vertexCount);

/* -- Graph ------------------------------------------------------------------------------------------------------------------------- */

typedef struct RadivoxGraphInfo {
  uint32_t structSize;
  uint32_t moduleCount;
  const char* json;           /* as in samples/graphs/ */
  const char* name;           /* of the file, for errors; NULL: "graph" */
  const char* const* modules; /* libraries with more nodes; all that this build has are there already */
} RadivoxGraphInfo;
RADIVOX_API RadivoxResult radivoxCreateGraph(const RadivoxGraphInfo* info, RadivoxGraph** graph);
RADIVOX_API void radivoxDestroyGraph(RadivoxGraph* graph);

/* Before a renderer takes it: */
/* What `node` makes comes from you: "gbuffer.position" becomes the import "host.position" (with `import` "host"). */
RADIVOX_API RadivoxResult radivoxReplaceByImports(RadivoxGraph* graph, const char* node, const char* import);
/* "node.port": kept, and found by radivoxFindImage and radivoxFindBuffer. What no output needs is left out. */
RADIVOX_API RadivoxResult radivoxAddOutput(RadivoxGraph* graph, const char* endpoint);
RADIVOX_API RadivoxResult radivoxClearOutputs(RadivoxGraph* graph);

/* At any time, also while a renderer uses it; what depends on it runs again in its next frame. */
RADIVOX_API RadivoxResult radivoxSetParameter(RadivoxGraph* graph, const char* nodeParam, const char* value);
RADIVOX_API RadivoxResult radivoxGetParameter(RadivoxGraph* graph, const char* nodeParam, const char** value);
RADIVOX_API RadivoxResult radivoxApplyPreset(RadivoxGraph* graph, const char* json, const char* name);

typedef enum RadivoxParameterType {
  RADIVOX_PARAMETER_BOOL = 0,   /* "true", "false" */
  RADIVOX_PARAMETER_UINT = 1,   /* minimum … maximum */
  RADIVOX_PARAMETER_FLOAT = 2,  /* minimum … maximum */
  RADIVOX_PARAMETER_CHOICE = 3, /* one of choices */
  RADIVOX_PARAMETER_TEXT = 4,   /* any text that the node takes, such as a file's name */
  RADIVOX_PARAMETER_TYPE_32_BIT = 0x7fffffff
} RadivoxParameterType;
typedef struct RadivoxParameter {
  uint32_t structSize;
  uint32_t type; /* RadivoxParameterType */
  const char* node;
  const char* name;
  const char* help; /* one line, with the unit */
  const char* defaultValue;
  const char* choices; /* separated by commas; "" for other types */
  double minimum, maximum;
  VkBool32 replans; /* a change makes the renderer plan anew: its next frame needs radivoxRun */
} RadivoxParameter;
RADIVOX_API uint32_t radivoxParameterCount(const RadivoxGraph* graph);
RADIVOX_API RadivoxResult radivoxDescribeParameter(RadivoxGraph* graph, uint32_t index, RadivoxParameter* parameter);

/* -- Renderer ---------------------------------------------------------------------------------------------------------------------- */

#define RADIVOX_ALL_BOUNCES 0xffffffffu

typedef struct RadivoxImport {
  const char* name; /* "host.position" */
  VkFormat format;  /* of an image of the picture's size; VK_FORMAT_UNDEFINED: a buffer */
  uint32_t bufferBytes;
} RadivoxImport;

typedef struct RadivoxRendererInfo {
  uint32_t structSize;
  uint32_t width, height; /* of the picture */
  uint32_t bounces;       /* indirect ones; RADIVOX_ALL_BOUNCES: the converged solution */
  RadivoxDevice* device;
  RadivoxScene* scene;
  RadivoxGraph* graph; /* of no other renderer: its nodes hold this one's pipelines */
  const RadivoxImport* imports;
  uint32_t importCount;
} RadivoxRendererInfo;
/* Uploads the scene, plans, makes pipelines. Submits to the queue and waits. */
RADIVOX_API RadivoxResult radivoxCreateRenderer(const RadivoxRendererInfo* info, RadivoxRenderer** renderer);
/* Waits for frames that are recorded and not completed. */
RADIVOX_API void radivoxDestroyRenderer(RadivoxRenderer* renderer);

/* The GPU must be done with earlier frames in these four. */
RADIVOX_API RadivoxResult radivoxSetCamera(RadivoxRenderer* renderer, const RadivoxCamera* camera);
RADIVOX_API RadivoxResult radivoxSetLights(RadivoxRenderer* renderer); /* those that the scene has now */
/* Vertices where the scene has them now. With the parameter visibility.keep only rays that pass what has changed are traced again. */
RADIVOX_API RadivoxResult radivoxSetGeometry(RadivoxRenderer* renderer);
RADIVOX_API RadivoxResult radivoxResize(RadivoxRenderer* renderer, uint32_t width, uint32_t height);

typedef struct RadivoxImageInfo {
  uint32_t structSize;
  VkFormat format;
  VkImage image;
  VkImageView view; /* of all its layers, one mip level */
  VkImageLayout layout;
  uint32_t width, height, layers;
} RadivoxImageInfo;
/* An image of yours, usage STORAGE (colour) or SAMPLED (depth) at least, in `layout` when the frame begins; the frame leaves colour in
 * GENERAL and depth in DEPTH_READ_ONLY_OPTIMAL. Call it again whenever contents, layout or handle change: `version` must then be another. */
RADIVOX_API RadivoxResult radivoxImportImage(RadivoxRenderer* renderer, const char* name, const RadivoxImageInfo* image, uint64_t version);

typedef struct RadivoxBufferInfo {
  uint32_t structSize;
  VkBuffer buffer;
  VkDeviceSize bytes;
  VkDeviceAddress address; /* 0: it was made without one; nodes that read it by address then cannot */
} RadivoxBufferInfo;
/* Usage STORAGE and TRANSFER_SRC at least. */
RADIVOX_API RadivoxResult radivoxImportBuffer(RadivoxRenderer* renderer, const char* name, const RadivoxBufferInfo* buffer,
                                              uint64_t version);

/* Runs what is stale on Radivox's own command buffers, and waits. The first frame, and every frame that radivoxIsReadyToRecord refuses.
 * `progress` (may be NULL) is called from this thread, must call nothing of this renderer, and ends the run soon by returning VK_FALSE: the
 * next one goes on where it ended. */
typedef VkBool32 (*RadivoxProgress)(void* user, const char* node, double fraction);
RADIVOX_API RadivoxResult radivoxRun(RadivoxRenderer* renderer, RadivoxProgress progress, void* user);

/* VK_TRUE: the next frame needs no new memory, sizes or plan. VK_FALSE also after an error. */
RADIVOX_API VkBool32 radivoxIsReadyToRecord(RadivoxRenderer* renderer);
/* Into your command buffer, outside rendering. All that you recorded before is waited for, and outputs are visible to all after. */
RADIVOX_API RadivoxResult radivoxRecord(RadivoxRenderer* renderer, VkCommandBuffer commands);
/* The GPU is done with the oldest recorded frame. Once for each. */
RADIVOX_API RadivoxResult radivoxFrameCompleted(RadivoxRenderer* renderer);

/* An output's image or buffer, for you to read; good until the next radivoxRun, radivoxResize or radivoxDestroyRenderer.
 * RADIVOX_BAD_INPUT where the plan has none of this name. */
RADIVOX_API RadivoxResult radivoxFindImage(RadivoxRenderer* renderer, const char* endpoint, RadivoxImageInfo* image);
RADIVOX_API RadivoxResult radivoxFindBuffer(RadivoxRenderer* renderer, const char* endpoint, RadivoxBufferInfo* buffer);
/* Reads an RGBA32F image back, waits, and writes its R, G, B: .exr as they are, .png exposed. A whole file or none. */
RADIVOX_API RadivoxResult radivoxWritePicture(RadivoxRenderer* renderer, const char* endpoint, const char* file);

/* The plan: order, what is left out and why, memory, barriers. */
RADIVOX_API RadivoxResult radivoxDescribePlan(RadivoxRenderer* renderer, const char** text);
typedef struct RadivoxNodeTime {
  uint32_t structSize;
  VkBool32 ranLastFrame;
  const char* name;
  double gpuMilliseconds; /* of its last run; 0 where the device has no timestamps */
} RadivoxNodeTime;
RADIVOX_API uint32_t radivoxNodeCount(const RadivoxRenderer* renderer);
RADIVOX_API RadivoxResult radivoxGetNodeTime(RadivoxRenderer* renderer, uint32_t index, RadivoxNodeTime* time);

#ifdef __cplusplus
}
#endif

#endif
