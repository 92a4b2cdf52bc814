// The node contract. A node declares ports and needs (cheaply, no GPU), prepares pipelines once its plan is known, and records
// commands with no allocation and no throw.
//
// When a node runs: RunWhen::OnChange (default) when the version of an input it reads, one of its parameters, or the plan changed
// since it last ran; RunWhen::EveryFrame always. A node that did not run leaves its outputs, which consumers still read.
//
// Sizes that only the GPU knows (how many voxels, faces, clusters) are *counts*: a node publishes a count from a word of one of its
// output buffers; ports of later nodes are shaped by it. The executor ends a submission after the publishing node, reads the word,
// allocates, and goes on. Once counts are known and nothing changes there are no such stops.
//
// A count may be 0: its buffers then have 16 bytes, the nodes run all the same and must cope (Commands::dispatchItems records nothing).
// A node without any Write, Modify or ReadBack port works for the world outside the graph (a file): it is never culled for want of readers.
// A node that modifies a resource makes the writer of the version before it run again too, or it would modify its own result.
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/gpu/commands.h"
#include "engine/graph/resource.h"
#include "engine/params/params.h"
#include "engine/scene/traits.h"

namespace radivox::graph {

enum class Access : uint8_t {
  Read,      ///< input
  Write,     ///< output; all of it, or (persistent) parts of it, new
  Modify,    ///< input and output in one: the old version of the resource is dead to everybody else
  Scratch,   ///< private to the run; contents undefined at start; memory is shared with other nodes' scratch and later outputs
  ReadBack,  ///< output in host memory, valid after the frame's work is done
};

/// Pipeline stages that touch a port, for barriers.
enum Use : uint32_t {
  UseCompute = 1,
  UseRaster = 2,      ///< vertex, geometry and fragment shaders
  UseAttachment = 4,  ///< colour or depth attachment
  UseTransfer = 8,
  UseIndirect = 16,
  UseHost = 32,
  UseAddress = 64,  ///< compute shaders, by the buffer's address: it may be larger than what a binding shows
};

struct Port {
  std::string name;
  Access access = Access::Read;
  Shape shape;                       ///< outputs and scratch; ignored for Read (the producer's shape holds)
  std::optional<ResourceKind> kind;  ///< Read and Modify: what must come in, checked while compiling; unset: anything
  std::string meaning;               ///< type, unit, meaning of 0: "E_dir per face, W/m², 0: unlit"
  uint32_t use = UseCompute | UseTransfer;
  bool optional = false;  ///< Read: may stay unconnected. Write: made only when somebody reads it
  bool unwanted =
      false;  ///< Read: not needed for this scene or request; the edge is ignored, and `unwantedReason` explains a culled producer
  std::string unwantedReason;
  bool persistent = false;  ///< Write: contents of the last run are kept and updated in part (zero-filled when made)
  bool growable = false;    ///< Write: allocated by the node itself while it runs (RecordContext::grow), never by its shape
  /// Read, in host-paced nodes: what is read here is seldom needed again. Where all others that read it come before this node by the graph's edges, the
  /// port is a Modify one, and the memory is freed once the node has run: when the node, or one of the others, runs again, the writer does before it.
  bool frees = false;
};

/// Filled by Node::declare. Port order is print order.
class Declaration {
 public:
  Declaration(const scene::Traits& traits_, const scene::Request& request_, const gpu::Capabilities& capabilities_)
      : traits(traits_), request(request_), capabilities(capabilities_) {}
  const scene::Traits& traits;
  const scene::Request& request;
  const gpu::Capabilities& capabilities;

  /// Input. Names that begin with "scene." or "view." connect themselves to the import of that name.
  Port& read(std::string name, std::string meaning, uint32_t use = UseCompute);
  /// An input that may stay unconnected; unless `wanted`, it is not needed for this scene or request, for `reason`.
  Port& readIf(bool wanted, std::string name, std::string meaning, std::string reason, uint32_t use = UseCompute);
  Port& write(std::string name, Shape shape, std::string meaning, uint32_t use = UseCompute | UseTransfer);
  Port& modify(std::string name, std::string meaning, uint32_t use = UseCompute);
  Port& scratch(std::string name, Shape shape, std::string meaning, uint32_t use = UseCompute | UseTransfer);
  Port& readBack(std::string name, Shape shape, std::string meaning);

  /// Publishes the 32-bit word at `byteOffset` of output `port` as count `name` after each run of this node. An empty `port`: the
  /// (host-paced) node gives the value itself, RecordContext::setCount. Every count that shapes a port must be declared by its publisher.
  void publishCount(std::string name, std::string port, uint64_t byteOffset);
  /// The node works in host-paced steps (Node::stepCount, Node::stepDone): each step is a submission of its own.
  void hostPaced() { hostPaced_ = true; }
  void runEveryFrame() { everyFrame_ = true; }
  /// The node has nothing to do here; its outputs do not exist. `reason` is printed in the plan.
  void leaveOut(std::string reason) { leftOut_ = std::move(reason); }
  /// What a person may want to change, since it would give nearly the same for less; the plan prints it, nothing acts on it.
  void advise(std::string advice) { advice_ = std::move(advice); }

  std::deque<Port> ports;  ///< not a vector: what read() and write() return stays good when more ports follow
  struct PublishedCount {
    std::string name, port;
    uint64_t byteOffset;
  };
  std::vector<PublishedCount> publishedCounts;
  bool isHostPaced() const { return hostPaced_; }
  bool runsEveryFrame() const { return everyFrame_; }
  const std::string& leftOut() const { return leftOut_; }
  const std::string& advice() const { return advice_; }

 private:
  bool hostPaced_ = false;
  bool everyFrame_ = false;
  std::string leftOut_, advice_;
};

/// What a node sees while it prepares pipelines: the device, and which optional ports are there.
class PrepareContext {
 public:
  virtual ~PrepareContext() = default;
  virtual gpu::Device& device() = 0;
  virtual bool has(std::string_view port) const = 0;  ///< the port is connected / its output is wanted
  virtual const scene::Traits& traits() const = 0;
  virtual const scene::Request& request() const = 0;
};

/// What a node sees while it runs.
class RecordContext {
 public:
  virtual ~RecordContext() = default;
  virtual gpu::Commands& commands() = 0;
  virtual bool has(std::string_view port) const = 0;
  virtual const gpu::Buffer& buffer(std::string_view port) = 0;
  virtual gpu::Image& image(std::string_view port) = 0;
  virtual uint64_t count(std::string_view name) const = 0;     ///< asserts that it is known
  virtual bool changed(std::string_view inputPort) const = 0;  ///< its version differs from the one this node last ran with
  virtual bool firstRun() const = 0;                           ///< never run yet, or its parameters or plan changed
  virtual uint32_t step() const = 0;                           ///< host-paced nodes
  virtual const scene::Traits& traits() const = 0;
  virtual const scene::Request& request() const = 0;

  // Only in host-paced nodes, only from stepDone / at the start of record of a step:
  /// Appends a device buffer of `bytes` to growable port `port`; earlier ones stay. Returns it. Throws OutOfMemory.
  virtual const gpu::Buffer& grow(std::string_view port, uint64_t bytes) = 0;
  /// Frees all buffers of a growable port: in step 0 before growing, or at the end of a node that modifies what only it needed.
  virtual void clearGrown(std::string_view port) = 0;
  /// Buffers of a growable port, own or input, in the order they were grown.
  virtual std::vector<const gpu::Buffer*> grown(std::string_view port) const = 0;
  /// Host copy of part of a buffer port; valid in stepDone.
  virtual std::vector<std::byte> readBuffer(std::string_view port, uint64_t offset, uint64_t bytes) = 0;
  /// Publishes a count from the host (host-paced nodes).
  virtual void setCount(std::string_view name, uint64_t value) = 0;
  virtual void reportProgress(double fraction) = 0;
  /// Figures for --stats (`node.name`), e.g. iterations, rays. Any time while recording or in stepDone.
  virtual void reportStat(std::string_view name, double value) = 0;
};

class Node {
 public:
  virtual ~Node() = default;
  virtual std::string_view type() const = 0;  ///< "clustered_voxel.voxelize"
  virtual params::Table& params() = 0;
  virtual void declare(Declaration& declaration) = 0;
  virtual void prepare(PrepareContext&) {}
  virtual uint32_t stepCount(RecordContext&) { return 1; }  ///< host-paced nodes; asked again after each step, so it may grow
  virtual void record(RecordContext& context) = 0;
  virtual void stepDone(RecordContext&) {}  ///< host-paced nodes: the GPU has finished this step
  /// After the frame's work is done and only if the node ran: read-back ports may be read here, stats reported.
  virtual void frameDone(RecordContext&) {}
};

}  // namespace radivox::graph
