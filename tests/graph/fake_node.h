// A node written as lambdas: declare for plans without a GPU, record for the executor.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "engine/graph/plan.h"

namespace radivox::oracles {

class FakeNode final : public graph::Node {
 public:
  using Declare = std::function<void(graph::Declaration&)>;
  using Record = std::function<void(graph::RecordContext&)>;

  explicit FakeNode(Declare declare, Record record = {}) : onDeclare(std::move(declare)), onRecord(std::move(record)) {}

  std::string_view type() const override { return typeName; }
  params::Table& params() override { return table_; }
  void declare(graph::Declaration& declaration) override { onDeclare(declaration); }
  void prepare(graph::PrepareContext& context) override {
    if (onPrepare) onPrepare(context);
  }
  uint32_t stepCount(graph::RecordContext& context) override { return onStepCount ? onStepCount(context) : 1; }
  void record(graph::RecordContext& context) override {
    if (onRecord) onRecord(context);
  }
  void stepDone(graph::RecordContext& context) override {
    if (onStepDone) onStepDone(context);
  }
  void frameDone(graph::RecordContext& context) override {
    if (onFrameDone) onFrameDone(context);
  }

  std::string typeName = "test.fake";
  Declare onDeclare;
  Record onRecord, onStepDone, onFrameDone;
  std::function<void(graph::PrepareContext&)> onPrepare;
  std::function<uint32_t(graph::RecordContext&)> onStepCount;
  // Two parameters, so that their changes can be tested.
  uint32_t value = 1;
  bool tall = false;

 private:
  params::Table table_{{params::number("value", &value, {0, 1000}, "what is written", params::Invalidates::Rerun),
                        params::flag("tall", &tall, "twice the size", params::Invalidates::Plan)}};
};

/// Adds a FakeNode and returns it.
inline FakeNode& addFake(graph::Graph& graph, const std::string& name, FakeNode::Declare declare, FakeNode::Record record = {}) {
  return static_cast<FakeNode&>(graph.add(name, std::make_unique<FakeNode>(std::move(declare), std::move(record))));
}

/// compile() without a device.
struct PlanInput {
  scene::Traits traits;
  scene::Request request;
  gpu::Capabilities capabilities;
  std::vector<graph::Import> imports;
  graph::Counts counts;
  graph::Plan compile(const graph::Graph& graph) const { return graph::compile(graph, {traits, request, capabilities, imports, counts}); }
  /// The message of the Error that compile() throws; "" when it does not.
  std::string error(const graph::Graph& graph) const {
    try {
      compile(graph);
    } catch (const Error& e) {
      return e.what();
    }
    return "";
  }
};

}  // namespace radivox::oracles
