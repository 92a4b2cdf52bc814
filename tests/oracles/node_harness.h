// Runs one node, or a few, on given inputs: for tests of a node against its oracle.
//
//   NodeHarness h(device, traits, request);
//   h.importBuffer("in.faces", faces);                       // any "name.name"; bytes as the shader sees them
//   h.add("cluster", std::make_unique<ClusterNode>());
//   h.connect("in.faces", "cluster.faces");                  // inputs named scene.* and view.* connect themselves
//   h.setCount("faces", faces.size());
//   h.set("cluster.iterations", "4");
//   h.output("cluster.labels");
//   h.run();                                                  // compiles on the first call, later calls run what is stale
//   const auto labels = h.download<uint32_t>("cluster.labels");
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "engine/graph/executor.h"

namespace radivox::oracles {

class NodeHarness {
 public:
  explicit NodeHarness(gpu::Device& device, scene::Traits traits = {}, scene::Request request = {});
  ~NodeHarness();
  NodeHarness(const NodeHarness&) = delete;
  NodeHarness& operator=(const NodeHarness&) = delete;

  /// A new import, or new contents (and version) of a known one; the size may change only before the first run.
  void importBytes(const std::string& name, const void* data, size_t bytes, uint32_t elementBytes = 4);
  template <class T>
  void importBuffer(const std::string& name, const std::vector<T>& data) {
    importBytes(name, data.data(), data.size() * sizeof(T), sizeof(T));
  }
  template <class T>
  void importValue(const std::string& name, const T& value) {
    importBytes(name, &value, sizeof(T), sizeof(T));
  }
  /// Tightly packed rows of every layer, top row first. Colour formats.
  void importPixels(const std::string& name, const gpu::ImageInfo& info, const void* data, size_t bytes);
  template <class T>
  void importImage(const std::string& name, const gpu::ImageInfo& info, const std::vector<T>& texels) {
    importPixels(name, info, texels.data(), texels.size() * sizeof(T));
  }
  /// Things that live elsewhere (GpuScene); they must outlive the harness.
  void importBuffer(const std::string& name, const gpu::Buffer& buffer, uint64_t version = 1);
  void importImage(const std::string& name, gpu::Image& image, uint64_t version = 1);

  graph::Node& add(const std::string& name, std::unique_ptr<graph::Node> node);
  template <class N>
  N& add(const std::string& name) {
    return static_cast<N&>(add(name, std::make_unique<N>()));
  }
  void connect(const std::string& from, const std::string& to);
  void output(const std::string& nodePort);
  void set(const std::string& nodeParam, const std::string& value);  ///< after the first run a Plan change makes a new executor
  void setCount(const std::string& name, uint64_t value);            ///< before the first run

  void run(const graph::Progress& progress = {});

  bool has(const std::string& nodePort);
  /// All of a buffer port (`count` elements when given).
  template <class T>
  std::vector<T> download(const std::string& nodePort) {
    const gpu::Buffer& from = buffer(nodePort);
    return gpu::downloadAs<T>(device_, from, bytes(nodePort) / sizeof(T));
  }
  template <class T>
  std::vector<T> download(const std::string& nodePort, size_t count) {
    return gpu::downloadAs<T>(device_, buffer(nodePort), count);
  }
  template <class T>
  std::vector<T> downloadImage(const std::string& nodePort, uint32_t layer = 0) {
    return castTexels<T>(gpu::download(device_, image(nodePort), layer));
  }
  /// Each buffer of a growable port.
  template <class T>
  std::vector<std::vector<T>> downloadGrown(const std::string& nodePort) {
    std::vector<std::vector<T>> all;
    for (const gpu::Buffer* b : executor().findGrown(nodePort)) all.push_back(gpu::downloadAs<T>(device_, *b, b->bytes() / sizeof(T)));
    return all;
  }
  const gpu::Buffer& buffer(const std::string& nodePort);  ///< throws when there is none
  gpu::Image& image(const std::string& nodePort);
  uint64_t count(const std::string& name);
  double figure(const std::string& node, const std::string& stat);  ///< of reportStat
  uint32_t runCount(const std::string& node);
  graph::Executor& executor();
  graph::Graph& graph() { return graph_; }

 private:
  struct ImportedBuffer {
    gpu::Buffer own;
    const gpu::Buffer* buffer = nullptr;
    uint64_t version = 1;
    uint32_t elementBytes = 4;
  };
  struct ImportedImage {
    gpu::Image own;
    gpu::Image* image = nullptr;
    uint64_t version = 1;
  };
  template <class T>
  static std::vector<T> castTexels(const std::vector<std::byte>& raw) {
    std::vector<T> out(raw.size() / sizeof(T));
    if (!out.empty()) std::memcpy(out.data(), raw.data(), out.size() * sizeof(T));
    return out;
  }
  uint64_t bytes(const std::string& nodePort);
  void compile();

  gpu::Device& device_;
  scene::Traits traits_;
  scene::Request request_;
  graph::Counts counts_;
  graph::Graph graph_;
  std::map<std::string, ImportedBuffer> buffers_;  // before the executor, which points into them
  std::map<std::string, ImportedImage> images_;
  std::unique_ptr<graph::Executor> executor_;
};

}  // namespace radivox::oracles
