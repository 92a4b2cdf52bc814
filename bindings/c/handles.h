// What is behind radivox.h: handles, errors, structs of other versions. Private to bindings/c.
#pragma once

#include <algorithm>
#include <cstring>
#include <map>
#include <memory>
#include <new>
#include <string>
#include <type_traits>

#include "bindings/c/radivox.h"
#include "engine/graph/executor.h"
#include "engine/scene/gpu_scene.h"

namespace radivox::c {

/// Keeps the message for radivoxLastError. Cannot fail: a long one is cut.
RadivoxResult fail(RadivoxResult result, const char* message) noexcept;
RadivoxResult resultOf(ErrorCode code) noexcept;

struct Interrupted {};

/// No exception gets past it.
template <class Action>
RadivoxResult guarded(Action&& action) noexcept {
  try {
    action();
    return RADIVOX_OK;
  } catch (const Error& e) {
    return fail(resultOf(e.code()), e.what());
  } catch (const Interrupted&) {
    return fail(RADIVOX_INTERRUPTED, "interrupted by the progress callback");
  } catch (const std::bad_alloc&) {
    return fail(RADIVOX_OUT_OF_MEMORY, "out of memory on the host");
  } catch (const std::exception& e) {
    return fail(RADIVOX_INTERNAL_ERROR, e.what());
  } catch (...) {
    return fail(RADIVOX_INTERNAL_ERROR, "an exception of an unknown type");
  }
}

/// Throws BadInput for NULL, naming the argument.
template <class T>
T& require(T* pointer, const char* name) {
  if (pointer == nullptr) throw Error(ErrorCode::BadInput, std::string(name) + " is NULL");
  return *pointer;
}
std::string requireText(const char* text, const char* name);

/// A struct of the caller's version as one of ours. Members that the caller does not know are 0; those that we do not know must be.
template <class T>
T takeStruct(const T* given, const char* name) {
  static_assert(std::is_trivially_copyable_v<T>);
  const uint32_t size = require(given, name).structSize;
  if (size < 2 * sizeof(uint32_t)) throw Error(ErrorCode::BadInput, std::string(name) + "->structSize is not set; write sizeof *" + name);
  const auto* bytes = reinterpret_cast<const unsigned char*>(given);
  if (size > sizeof(T) && std::any_of(bytes + sizeof(T), bytes + size, [](unsigned char byte) { return byte != 0; })) {
    throw Error(ErrorCode::Unsupported, std::string(name) + " asks for what this version of Radivox does not know; use the later library");
  }
  T full{};
  std::memcpy(&full, given, std::min<size_t>(size, sizeof(T)));
  return full;
}

/// Ours into the caller's, as far as it knows it.
template <class T>
void giveStruct(T* to, T value, const char* name) {
  const uint32_t size = require(to, name).structSize;
  if (size < 2 * sizeof(uint32_t)) throw Error(ErrorCode::BadInput, std::string(name) + "->structSize is not set; write sizeof *" + name);
  value.structSize = size;
  std::memcpy(to, &value, std::min<size_t>(size, sizeof(T)));
}

scene::CameraDescription takeCamera(const RadivoxCamera* given);

/// A graph with what its nodes come from and what they hold.
struct GraphState {
  std::shared_ptr<gpu::Device> device;  ///< of the renderer that prepared its nodes; outlives their pipelines
  plugin::Registry registry;
  graph::Graph graph;
  bool hasRenderer = false;
};

class Renderer {
 public:
  Renderer(const RadivoxRendererInfo& info);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  void setCamera(const scene::CameraDescription& camera);
  void setLights();
  void setGeometry();
  void resize(uint32_t width, uint32_t height);
  void importImage(const std::string& name, const RadivoxImageInfo& image, uint64_t version);
  void importBuffer(const std::string& name, const RadivoxBufferInfo& buffer, uint64_t version);
  void run(RadivoxProgress progress, void* user);
  bool isReadyToRecord();
  bool hasPlan() const { return executor_ != nullptr; }  ///< false after what makes it plan anew, until the next run
  graph::Executor& executor() { return *executor_; }
  gpu::Device& device() { return *device_; }
  gpu::Image& findImage(const std::string& endpoint);
  const gpu::Buffer& findBuffer(const std::string& endpoint);

  std::string text;  ///< what was last returned
  graph::FrameStats stats;

 private:
  /// Its numbers of things changed, or what the plan was made for.
  void takeScene();
  struct Imported {
    graph::Import shape;
    gpu::Image image;
    gpu::Buffer buffer;
    uint64_t version = 0;
    bool isGiven = false;
  };
  bool isPlanCurrent() const;
  void plan();
  void importAll();
  Imported& findImport(const std::string& name);

  std::shared_ptr<gpu::Device> device_;
  std::shared_ptr<scene::Scene> scene_;
  std::shared_ptr<GraphState> graph_;
  scene::Request request_;
  scene::CameraDescription camera_;
  scene::Traits traits_;
  uint64_t planVersion_ = 0;
  std::unique_ptr<scene::GpuScene> gpuScene_;
  std::map<std::string, Imported> imports_;
  std::unique_ptr<graph::Executor> executor_;
};

}  // namespace radivox::c

struct RadivoxDevice {
  std::shared_ptr<radivox::gpu::Device> device;
};
struct RadivoxScene {
  std::shared_ptr<radivox::scene::Scene> scene;
};
struct RadivoxGraph {
  std::shared_ptr<radivox::c::GraphState> state;
  std::string text, choices;  ///< what was last returned
};
struct RadivoxRenderer {
  std::unique_ptr<radivox::c::Renderer> renderer;
};
