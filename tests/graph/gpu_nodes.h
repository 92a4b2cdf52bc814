// Small nodes that do GPU work, for tests of the executor: what is in a buffer says who ran, in which order, and with what.
#pragma once

#include <algorithm>

#include "tests/graph/fake_node.h"

namespace radivox::oracles {

/// Writes its parameter `value` to every word of `out`, by transfer.
inline FakeNode& addFill(graph::Graph& graph, const std::string& name, graph::Extent words = 4) {
  FakeNode& node =
      addFake(graph, name, [words](graph::Declaration& d) { d.write("out", graph::Shape::buffer(4, words), "words", graph::UseTransfer); });
  node.onRecord = [&node](graph::RecordContext& c) { c.commands().fill(c.buffer("out"), node.value); };
  return node;
}

/// Copies `in` to `out`, by transfer.
inline FakeNode& addCopy(graph::Graph& graph, const std::string& name, graph::Extent words = 4) {
  return addFake(
      graph, name,
      [words](graph::Declaration& d) {
        d.read("in", "words", graph::UseTransfer);
        d.write("out", graph::Shape::buffer(4, words), "words", graph::UseTransfer);
      },
      [](graph::RecordContext& c) {
        c.commands().copy(c.buffer("in"), c.buffer("out"), std::min(c.buffer("in").bytes(), c.buffer("out").bytes()));
      });
}

/// The compute pipeline target[i] = source[i] + amount.
struct AddPipeline {
  gpu::Pipeline pipeline;
  void prepare(gpu::Device& device) {
    pipeline =
        gpu::Pipeline(device, gpu::ComputePipelineInfo{.shader = "graph/test_add.comp",
                                                       .bindings = {gpu::BindingType::StorageBuffer, gpu::BindingType::StorageBuffer},
                                                       .pushConstantBytes = 8});
  }
  void dispatch(gpu::Commands& commands, const gpu::Buffer& source, const gpu::Buffer& target, uint32_t itemCount, uint32_t amount) const {
    struct Push {
      uint32_t itemCount, amount;
    };
    commands.bind(pipeline, {source, target});
    commands.push(Push{itemCount, amount});
    commands.dispatchItems(itemCount, 64);
  }
};

/// out = in + value, by compute.
inline FakeNode& addAdd(graph::Graph& graph, const std::string& name, uint32_t words = 4) {
  const auto add = std::make_shared<AddPipeline>();
  FakeNode& node = addFake(graph, name, [words](graph::Declaration& d) {
    d.read("in", "words");
    d.write("out", graph::Shape::buffer(4, words), "words", graph::UseCompute);
  });
  node.onPrepare = [add](graph::PrepareContext& c) { add->prepare(c.device()); };
  node.onRecord = [add, words, &node](graph::RecordContext& c) {
    add->dispatch(c.commands(), c.buffer("in"), c.buffer("out"), words, node.value);
  };
  return node;
}

/// data += value in place, by compute.
inline FakeNode& addModify(graph::Graph& graph, const std::string& name, uint32_t words = 4) {
  const auto add = std::make_shared<AddPipeline>();
  FakeNode& node = addFake(graph, name, [](graph::Declaration& d) { d.modify("data", "words"); });
  node.onPrepare = [add](graph::PrepareContext& c) { add->prepare(c.device()); };
  node.onRecord = [add, words, &node](graph::RecordContext& c) {
    add->dispatch(c.commands(), c.buffer("data"), c.buffer("data"), words, node.value);
  };
  return node;
}

/// Publishes its parameter `value` as `count`, from word 1 of `out`.
inline FakeNode& addCounter(graph::Graph& graph, const std::string& name, const std::string& count) {
  FakeNode& node = addFake(graph, name, [count](graph::Declaration& d) {
    d.write("out", graph::Shape::buffer(4, 4), "words", graph::UseTransfer);
    d.publishCount(count, "out", 4);
  });
  node.onRecord = [&node](graph::RecordContext& c) { c.commands().fill(c.buffer("out"), node.value); };
  return node;
}

inline std::vector<uint32_t> repeat(size_t count, uint32_t value) { return std::vector<uint32_t>(count, value); }

}  // namespace radivox::oracles
