// Random graphs, random changes, run or recorded at random: after each frame every output holds what a host evaluation of the same graph
// gives, and the validation layer has seen no hazard.
#include <gtest/gtest.h>

#include <random>

#include "engine/graph/executor.h"
#include "tests/graph/gpu_nodes.h"
#include "tests/oracles/gpu_fixture.h"

namespace radivox::oracles {
namespace {

using graph::Declaration;
using graph::Extent;
using graph::RecordContext;
using graph::Shape;

constexpr uint32_t kWords = 64;

/// One node of the model: its value is that of every word of its output.
struct Model {
  enum class Kind { Fill, Add, Scratch, Modify, Sized, HostPaced } kind;
  std::vector<size_t> inputs;
  uint32_t value = 1;
  bool dead = false;  ///< its version was modified: nobody may read it any more
  uint32_t evaluate(const std::vector<Model>& all) const {
    uint32_t sum = value;
    for (const size_t input : inputs) sum += all[input].evaluate(all);
    return kind == Kind::HostPaced ? sum + value : sum;  // adds its value in each of two steps
  }
};

class RandomGraph {
 public:
  RandomGraph(gpu::Device& device, uint32_t seed) : device_(device), random_(seed), add_(std::make_shared<AddPipeline>()) {
    add_->prepare(device);
    const size_t count = 4 + pick(10);
    for (size_t i = 0; i < count; ++i) append();
    for (size_t i = 0; i < model_.size(); ++i) {
      if (!model_[i].dead) graph_.output(port(i));
    }
    executor_ = std::make_unique<graph::Executor>(device, graph_, input_.compile(graph_), input_.traits, input_.request, input_.counts);
  }

  void changeSomething() {
    const size_t i = pick(model_.size());
    model_[i].value = static_cast<uint32_t>(1 + pick(20));
    graph_.set(name(i) + ".value", std::to_string(model_[i].value));
  }

  void frame() {
    if (executor_->isReadyToRecord() && pick(2) == 0) {
      device_.submitAndWait([&](VkCommandBuffer commands) { executor_->record(commands); });
      executor_->frameCompleted();
      ++recorded;
    } else {
      executor_->run();
    }
    for (size_t i = 0; i < model_.size(); ++i) {
      if (model_[i].dead) continue;
      const gpu::Buffer* buffer = executor_->findBuffer(port(i));
      ASSERT_NE(buffer, nullptr);
      const uint32_t words = model_[i].kind == Model::Kind::Sized ? model_[model_[i].inputs[0]].evaluate(model_) : kWords;
      ASSERT_EQ(gpu::downloadAs<uint32_t>(device_, *buffer, words), repeat(words, model_[i].evaluate(model_))) << name(i);
    }
  }

  size_t pick(size_t count) { return random_() % count; }
  uint32_t recorded = 0;

 private:
  static std::string name(size_t i) { return "n" + std::to_string(i); }
  std::string port(size_t i) const { return name(i) + (model_[i].kind == Model::Kind::Modify ? ".data" : ".out"); }

  /// A node whose output may be read, with kWords words; none: kNone.
  std::optional<size_t> pickInput() {
    std::vector<size_t> candidates;
    for (size_t i = 0; i < model_.size(); ++i) {
      if (!model_[i].dead && model_[i].kind != Model::Kind::Sized) candidates.push_back(i);
    }
    if (candidates.empty()) return std::nullopt;
    return candidates[pick(candidates.size())];
  }

  bool isRead(size_t i) const {
    for (const Model& m : model_) {
      if (std::find(m.inputs.begin(), m.inputs.end(), i) != m.inputs.end()) return true;
    }
    return false;
  }

  void append() {
    const auto add = add_;
    const size_t self = model_.size();
    const auto input = pickInput();
    const size_t kind = input ? pick(8) : 0;
    if (kind <= 1) {
      model_.push_back({Model::Kind::Fill, {}});
      FakeNode& node = addFill(graph_, name(self), kWords);
      if (pick(4) == 0) {
        node.onDeclare = [declare = node.onDeclare](Declaration& d) {
          declare(d);
          d.runEveryFrame();
        };
      }
    } else if (kind == 2) {
      model_.push_back({Model::Kind::Add, {*input}});
      FakeNode& node = addFake(graph_, name(self), [](Declaration& d) {
        d.read("in", "words");
        d.write("out", Shape::buffer(4, kWords), "words", graph::UseCompute);
      });
      node.onRecord = [add, &node](RecordContext& c) { add->dispatch(c.commands(), c.buffer("in"), c.buffer("out"), kWords, node.value); };
    } else if (kind <= 4) {
      model_.push_back({Model::Kind::Scratch, {*input}});
      FakeNode& node = addFake(graph_, name(self), [](Declaration& d) {
        d.read("in", "words");
        d.scratch("temporary", Shape::buffer(4, kWords), "words", graph::UseCompute);
        d.write("out", Shape::buffer(4, kWords), "words", graph::UseCompute);
      });
      node.onRecord = [add, &node](RecordContext& c) {
        add->dispatch(c.commands(), c.buffer("in"), c.buffer("temporary"), kWords, node.value);
        c.commands().barrier();
        add->dispatch(c.commands(), c.buffer("temporary"), c.buffer("out"), kWords, 0);
      };
    } else if (kind == 5) {
      if (isRead(*input)) return;  // others read this version: it may not die
      model_[*input].dead = true;
      model_.push_back({Model::Kind::Modify, {*input}});
      FakeNode& node = addFake(graph_, name(self), [](Declaration& d) { d.modify("data", "words"); });
      node.onRecord = [add, &node](RecordContext& c) {
        add->dispatch(c.commands(), c.buffer("data"), c.buffer("data"), kWords, node.value);
      };
      graph_.connect(port(*input), name(self) + ".data");
      return;
    } else if (kind == 6) {
      // A publisher of its input's value, and a node of that many words: the value itself is at most a few hundred.
      model_.push_back({Model::Kind::Scratch, {*input}});
      const std::string count = "count" + std::to_string(self);
      FakeNode& publisher = addFake(graph_, name(self), [count](Declaration& d) {
        d.read("in", "words");
        d.scratch("temporary", Shape::buffer(4, kWords), "words", graph::UseCompute);
        d.write("out", Shape::buffer(4, kWords), "words", graph::UseCompute);
        d.publishCount(count, "out", 8);
      });
      publisher.onRecord = [add, &publisher](RecordContext& c) {
        add->dispatch(c.commands(), c.buffer("in"), c.buffer("temporary"), kWords, publisher.value);
        c.commands().barrier();
        add->dispatch(c.commands(), c.buffer("temporary"), c.buffer("out"), kWords, 0);
      };
      graph_.connect(port(*input), name(self) + ".in");
      model_.push_back({Model::Kind::Sized, {self}});
      FakeNode& sized = addFake(graph_, name(self + 1), [count](Declaration& d) {
        d.read("in", "words", graph::UseTransfer);
        d.write("out", Shape::buffer(4, Extent::of(count)), "words", graph::UseTransfer);
      });
      sized.onRecord = [count, &sized](RecordContext& c) {
        c.commands().fill(c.buffer("out"), static_cast<uint32_t>(c.count(count)) + sized.value);
      };
      graph_.connect(port(self), name(self + 1) + ".in");
      return;
    } else {
      model_.push_back({Model::Kind::HostPaced, {*input}});
      FakeNode& node = addFake(graph_, name(self), [](Declaration& d) {
        d.read("in", "words");
        d.write("out", Shape::buffer(4, kWords), "words", graph::UseCompute);
        d.hostPaced();
      });
      node.onStepCount = [](RecordContext&) { return 2u; };
      node.onRecord = [add, &node](RecordContext& c) {
        add->dispatch(c.commands(), c.step() == 0 ? c.buffer("in") : c.buffer("out"), c.buffer("out"), kWords, node.value);
      };
    }
    if (input && kind > 1) graph_.connect(port(*input), name(self) + ".in");
  }

  gpu::Device& device_;
  std::mt19937 random_;
  std::shared_ptr<AddPipeline> add_;
  graph::Graph graph_;
  std::vector<Model> model_;
  PlanInput input_;
  std::unique_ptr<graph::Executor> executor_;
};

class RandomGraphTest : public GpuTest {};

TEST_F(RandomGraphTest, SlowEveryFrameEqualsTheHostEvaluation) {
  uint32_t recorded = 0;
  for (uint32_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomGraph graph(device(), seed);
    for (int frame = 0; frame < 8; ++frame) {
      SCOPED_TRACE("frame " + std::to_string(frame));
      for (size_t changes = graph.pick(4); changes > 0; --changes) graph.changeSomething();
      graph.frame();
      if (HasFatalFailure()) return;
    }
    recorded += graph.recorded;
  }
  EXPECT_GT(recorded, 50u) << "recording was hardly tried";
}

}  // namespace
}  // namespace radivox::oracles
