/* Global illumination in a host written in C: embed_c SCENE GRAPH.json OUT.exr [WIDTHxHEIGHT]
 *
 * The host makes instance, device and command buffer. Its "renderer" is a graph of one node (frame.gbuffer), to have images of a host to
 * import: a real one has its own. Frames go into the host's command buffer while the camera walks to its place. */
#include <radivox.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <vulkan/vulkan.h>

static const char* const kHostGraph =
    "{\"nodes\": {\"gbuffer\": {\"type\": \"frame.gbuffer\"}},"
    " \"outputs\": [\"gbuffer.position\", \"gbuffer.normal\", \"gbuffer.albedo\", \"gbuffer.emission\", \"gbuffer.triangle\"]}";
static const char* const kPorts[5] = {"position", "normal", "albedo", "emission", "triangle"};
static const VkFormat kFormats[5] = {VK_FORMAT_R32G32B32A32_SFLOAT, VK_FORMAT_R32G32B32A32_SFLOAT, VK_FORMAT_R32G32B32A32_SFLOAT,
                                     VK_FORMAT_R32G32B32A32_SFLOAT, VK_FORMAT_R32_UINT};
enum { kFrameCount = 4 };

static void check(RadivoxResult result) {
  if (result == RADIVOX_OK) return;
  fprintf(stderr, "embed_c: %s\n", radivoxLastError());
  exit((int)result);
}

static void checkVulkan(VkResult result, const char* call) {
  if (result == VK_SUCCESS || result == VK_INCOMPLETE) return;
  fprintf(stderr, "embed_c: %s failed: %d\n", call, (int)result);
  exit(1);
}

static char* readFile(const char* path) {
  FILE* file = fopen(path, "rb");
  char* text = NULL;
  long size = 0;
  if (file != NULL && fseek(file, 0, SEEK_END) == 0) size = ftell(file);
  if (size > 0) text = calloc((size_t)size + 1, 1);
  if (text == NULL || fseek(file, 0, SEEK_SET) != 0 || fread(text, 1, (size_t)size, file) != (size_t)size) {
    fprintf(stderr, "embed_c: %s: cannot be read\n", path);
    exit(2);
  }
  fclose(file);
  return text;
}

typedef struct Host {
  VkInstance instance;
  VkPhysicalDevice physicalDevice;
  VkDevice device;
  VkQueue queue;
  VkCommandPool pool;
  VkCommandBuffer commands;
} Host;

/* What any host does, with the features and extensions that Radivox asks for. */
static void makeHost(Host* host, RadivoxNeeds** needs) {
  VkApplicationInfo application = {VK_STRUCTURE_TYPE_APPLICATION_INFO};
  VkInstanceCreateInfo instanceInfo = {VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO};
  VkDeviceQueueCreateInfo queueInfo = {VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO};
  VkDeviceCreateInfo deviceInfo = {VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO};
  VkCommandPoolCreateInfo poolInfo = {VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
  VkCommandBufferAllocateInfo commandsInfo = {VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
  const float priority = 1.f;
  uint32_t count = 1;

  application.apiVersion = VK_API_VERSION_1_3;
  instanceInfo.pApplicationInfo = &application;
  checkVulkan(vkCreateInstance(&instanceInfo, NULL, &host->instance), "vkCreateInstance");
  checkVulkan(vkEnumeratePhysicalDevices(host->instance, &count, &host->physicalDevice), "vkEnumeratePhysicalDevices");

  check(radivoxCreateNeeds(host->physicalDevice, needs));
  queueInfo.queueFamilyIndex = radivoxNeededQueueFamily(*needs);
  queueInfo.queueCount = 1;
  queueInfo.pQueuePriorities = &priority;
  deviceInfo.pNext = radivoxNeededFeatures(*needs);
  deviceInfo.queueCreateInfoCount = 1;
  deviceInfo.pQueueCreateInfos = &queueInfo;
  deviceInfo.enabledExtensionCount = radivoxNeededExtensionCount(*needs);
  deviceInfo.ppEnabledExtensionNames = radivoxNeededExtensions(*needs);
  checkVulkan(vkCreateDevice(host->physicalDevice, &deviceInfo, NULL, &host->device), "vkCreateDevice");
  vkGetDeviceQueue(host->device, queueInfo.queueFamilyIndex, 0, &host->queue);

  poolInfo.flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT;
  poolInfo.queueFamilyIndex = queueInfo.queueFamilyIndex;
  checkVulkan(vkCreateCommandPool(host->device, &poolInfo, NULL, &host->pool), "vkCreateCommandPool");
  commandsInfo.commandPool = host->pool;
  commandsInfo.commandBufferCount = 1;
  checkVulkan(vkAllocateCommandBuffers(host->device, &commandsInfo, &host->commands), "vkAllocateCommandBuffers");
}

static void submitAndWait(Host* host) {
  VkSubmitInfo submit = {VK_STRUCTURE_TYPE_SUBMIT_INFO};
  submit.commandBufferCount = 1;
  submit.pCommandBuffers = &host->commands;
  checkVulkan(vkEndCommandBuffer(host->commands), "vkEndCommandBuffer");
  checkVulkan(vkQueueSubmit(host->queue, 1, &submit, VK_NULL_HANDLE), "vkQueueSubmit");
  checkVulkan(vkQueueWaitIdle(host->queue), "vkQueueWaitIdle");
}

static RadivoxGraph* makeGraph(const char* json, const char* name) {
  RadivoxGraphInfo info = {0};
  RadivoxGraph* graph = NULL;
  info.structSize = sizeof info;
  info.json = json;
  info.name = name;
  check(radivoxCreateGraph(&info, &graph));
  return graph;
}

static void printParameters(RadivoxGraph* graph) {
  uint32_t i, count = radivoxParameterCount(graph);
  for (i = 0; i < count; ++i) {
    RadivoxParameter parameter = {0};
    parameter.structSize = sizeof parameter;
    check(radivoxDescribeParameter(graph, i, &parameter));
    printf("%s.%s = %s: %s\n", parameter.node, parameter.name, parameter.defaultValue, parameter.help);
  }
}

/* The frame that a renderer has to do, in the host's command buffer where it can be; 1 where it was. */
static int drawFrame(Host* host, RadivoxRenderer* renderer) {
  VkCommandBufferBeginInfo begin = {VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
  if (!radivoxIsReadyToRecord(renderer)) {
    check(radivoxRun(renderer, NULL, NULL));
    return 0;
  }
  checkVulkan(vkBeginCommandBuffer(host->commands, &begin), "vkBeginCommandBuffer");
  check(radivoxRecord(renderer, host->commands));
  submitAndWait(host);
  check(radivoxFrameCompleted(renderer));
  return 1;
}

static void importImages(RadivoxRenderer* from, RadivoxRenderer* to, uint64_t version) {
  int i;
  for (i = 0; i < 5; ++i) {
    char endpoint[32], name[32];
    RadivoxImageInfo image = {0};
    image.structSize = sizeof image;
    sprintf(endpoint, "gbuffer.%s", kPorts[i]);
    sprintf(name, "host.%s", kPorts[i]);
    check(radivoxFindImage(from, endpoint, &image));
    check(radivoxImportImage(to, name, &image, version));
  }
}

int main(int argc, char** argv) {
  Host host = {0};
  RadivoxNeeds* needs = NULL;
  RadivoxDevice* device = NULL;
  RadivoxScene* scene = NULL;
  RadivoxGraph *hostGraph = NULL, *graph = NULL;
  RadivoxRenderer *hostRenderer = NULL, *renderer = NULL;
  RadivoxAdoptInfo adopt = {0};
  RadivoxRendererInfo info = {0};
  RadivoxCamera camera = {0};
  RadivoxImport imports[5];
  char names[5][32];
  char* json;
  unsigned width = 320, height = 180;
  int i, recorded = 0;

  if (argc < 4 || (argc > 4 && sscanf(argv[4], "%ux%u", &width, &height) != 2)) {
    fprintf(stderr, "embed_c SCENE GRAPH.json OUT.exr [WIDTHxHEIGHT]\n");
    return 2;
  }
  makeHost(&host, &needs);
  adopt.structSize = sizeof adopt;
  adopt.instance = host.instance;
  adopt.physicalDevice = host.physicalDevice;
  adopt.device = host.device;
  adopt.queue = host.queue;
  adopt.queueFamily = radivoxNeededQueueFamily(needs);
  adopt.enabledFeatures = radivoxNeededFeatures(needs);
  adopt.extensions = radivoxNeededExtensions(needs);
  adopt.extensionCount = radivoxNeededExtensionCount(needs);
  check(radivoxAdoptDevice(&adopt, &device));
  check(radivoxLoadScene(argv[1], &scene));

  json = readFile(argv[2]);
  graph = makeGraph(json, argv[2]);
  free(json);
  check(radivoxReplaceByImports(graph, "gbuffer", "host"));
  check(radivoxSetParameter(graph, "voxelize.resolution", "64"));
  printParameters(graph);
  hostGraph = makeGraph(kHostGraph, "the host's graph");

  /* A mistake is one line that says what, where, and the mend. */
  if (radivoxSetParameter(graph, "voxelize.resolutoin", "64") != RADIVOX_BAD_INPUT) return 1;
  printf("as it should: %s\n", radivoxLastError());

  info.structSize = sizeof info;
  info.width = width;
  info.height = height;
  info.bounces = RADIVOX_ALL_BOUNCES;
  info.device = device;
  info.scene = scene;
  info.graph = hostGraph;
  check(radivoxCreateRenderer(&info, &hostRenderer));
  memset(imports, 0, sizeof imports);
  for (i = 0; i < 5; ++i) {
    sprintf(names[i], "host.%s", kPorts[i]);
    imports[i].name = names[i];
    imports[i].format = kFormats[i];
  }
  info.graph = graph;
  info.imports = imports;
  info.importCount = 5;
  check(radivoxCreateRenderer(&info, &renderer));

  camera.structSize = sizeof camera;
  check(radivoxGetCamera(scene, 0, &camera));
  camera.position[0] += 0.05f * (float)(kFrameCount - 1);
  for (i = 0; i < kFrameCount; ++i) {
    check(radivoxSetCamera(hostRenderer, &camera));
    check(radivoxSetCamera(renderer, &camera));
    drawFrame(&host, hostRenderer);
    importImages(hostRenderer, renderer, (uint64_t)i + 1);
    recorded += drawFrame(&host, renderer);
    if (i + 2 < kFrameCount) {
      camera.position[0] -= 0.05f;
    } else {
      check(radivoxGetCamera(scene, 0, &camera));
    }
  }
  check(radivoxWritePicture(renderer, "composite.color", argv[3]));
  printf("%d of %d frames in the host's own command buffer\n", recorded, (int)kFrameCount);

  radivoxDestroyDevice(device); /* in any order */
  radivoxDestroyRenderer(renderer);
  radivoxDestroyRenderer(hostRenderer);
  radivoxDestroyGraph(graph);
  radivoxDestroyGraph(hostGraph);
  radivoxDestroyScene(scene);
  radivoxDestroyNeeds(needs);
  vkDestroyCommandPool(host.device, host.pool, NULL);
  vkDestroyDevice(host.device, NULL);
  vkDestroyInstance(host.instance, NULL);
  return 0;
}
