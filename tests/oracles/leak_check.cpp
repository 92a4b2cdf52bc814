// What the leak check of AddressSanitizer needs to know, in every program that makes devices.
#if defined(__SANITIZE_ADDRESS__)
#include <dlfcn.h>

#include <initializer_list>

// The validation layer (1.3.239) forgets a few hundred bytes per device; the same tests without the layer (VK_LAYER_PATH=/nonexistent)
// leak nothing. Only what the layer allocates is excused.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() { return "leak:libVkLayer_khronos_validation\n"; }

// The leak check needs the libraries still loaded at exit, to tell whose memory it sees and to find what a driver still points at; the
// loader unloads them with the last instance.
__attribute__((constructor)) static void keepVulkanLibrariesLoaded() {
  for (const char* name : {"libVkLayer_khronos_validation.so", "libvulkan_lvp.so"}) ::dlopen(name, RTLD_LAZY | RTLD_NODELETE);
}
#endif
