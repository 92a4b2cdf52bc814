// A module of two node types. Compiled three times: linked into the test program, as a library, and as a library for another engine.
#include "engine/graph/node.h"
#include "engine/plugin/registry.h"

namespace radivox::oracles {

namespace {

/// Writes `value` + 1 to four words.
class Plain : public graph::Node {
 public:
  static constexpr std::string_view kType = "test_module.plain";
  std::string_view type() const override { return kType; }
  params::Table& params() override { return table_; }
  void declare(graph::Declaration& d) override {
    if (value_ == 13) throw Error(ErrorCode::Unsupported, "test_module.plain cannot count to 13");
    d.write("out", graph::Shape::buffer(4, graph::Extent::of("width")), "words", graph::UseTransfer);
  }
  void record(graph::RecordContext& context) override { context.commands().fill(context.buffer("out"), value_ + 1); }

 private:
  uint32_t value_ = 4;
  params::Table table_{{params::number("value", &value_, {0, 100}, "what is written", params::Invalidates::Rerun)}};
};

/// All of the node's calls go through: three host-paced steps, a figure from each of stepDone and frameDone.
class Stepping : public graph::Node {
 public:
  static constexpr std::string_view kType = "test_module.stepping";
  std::string_view type() const override { return kType; }
  params::Table& params() override { return table_; }
  void declare(graph::Declaration& d) override {
    d.write("out", graph::Shape::buffer(4, 4), "words", graph::UseTransfer);
    d.hostPaced();
  }
  void prepare(graph::PrepareContext& context) override { prepared_ = context.has("out"); }
  uint32_t stepCount(graph::RecordContext&) override { return prepared_ ? 3 : 0; }
  void record(graph::RecordContext& context) override { context.commands().fill(context.buffer("out"), context.step()); }
  void stepDone(graph::RecordContext& context) override { context.reportStat("steps", context.step() + 1.0); }
  void frameDone(graph::RecordContext& context) override { context.reportStat("frames", 1.0); }

 private:
  bool prepared_ = false;
  params::Table table_;
};

}  // namespace

void registerTestModule(plugin::Registry& registry) {
  registry.add<Plain>("writes words");
  registry.add<Stepping>("writes words in steps");
}

}  // namespace radivox::oracles

RADIVOX_MODULE(radivox::oracles::registerTestModule);
