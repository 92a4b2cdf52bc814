// Host-paced nodes: steps with a wait after each, growing buffers, counts from the host, progress, interruption.
#include <gtest/gtest.h>

#include "tests/graph/gpu_nodes.h"
#include "tests/oracles/gpu_fixture.h"
#include "tests/oracles/node_harness.h"

namespace radivox::oracles {
namespace {

using graph::Declaration;
using graph::Extent;
using graph::RecordContext;
using graph::Shape;

class HostPacedTest : public GpuTest {};

/// Doubles `work` in every step by compute until it passes 100, asking for one step more each time; then publishes the last word.
struct Doubling {
  AddPipeline add;
  uint32_t wanted = 1;
  std::vector<uint32_t> seen;
};

FakeNode& addDoubling(graph::Graph& graph, std::shared_ptr<Doubling> state) {
  FakeNode& node = addFake(graph, "doubling", [](Declaration& d) {
    d.read("in", "words");
    d.write("work", Shape::buffer(4, 4), "words", graph::UseCompute | graph::UseTransfer);
    d.publishCount("result", "", 0);
    d.publishCount("last", "work", 12);
    d.hostPaced();
  });
  node.onPrepare = [state](graph::PrepareContext& c) { state->add.prepare(c.device()); };
  node.onStepCount = [state](RecordContext& c) {
    if (c.step() == 0 && state->seen.empty()) state->wanted = 1;
    return state->wanted;
  };
  node.onRecord = [state](RecordContext& c) {
    if (c.step() == 0) {
      state->seen.clear();
      state->wanted = 1;
      state->add.dispatch(c.commands(), c.buffer("in"), c.buffer("work"), 4, 0);
    } else {
      state->add.dispatch(c.commands(), c.buffer("work"), c.buffer("work"), 4, state->seen.back());
    }
  };
  node.onStepDone = [state](RecordContext& c) {
    uint32_t word = 0;
    std::memcpy(&word, c.readBuffer("work", 4, 4).data(), 4);
    state->seen.push_back(word);
    if (word <= 100) ++state->wanted;
    c.setCount("result", word);
    c.reportStat("steps", double(state->seen.size()));
  };
  return node;
}

TEST_F(HostPacedTest, StepsSeeWhatTheStepBeforeWrote) {
  NodeHarness h(device());
  addFill(h.graph(), "fill");
  const auto state = std::make_shared<Doubling>();
  addDoubling(h.graph(), state);
  addFill(h.graph(), "shaped", Extent::of("result"));
  addFill(h.graph(), "also", Extent::of("last"));
  h.connect("fill.out", "doubling.in");
  h.output("shaped.out");
  h.output("also.out");
  h.output("doubling.work");
  h.set("fill.value", "7");
  h.run();
  EXPECT_EQ(state->seen, (std::vector<uint32_t>{7, 14, 28, 56, 112}));
  EXPECT_EQ(h.count("result"), 112u);
  EXPECT_EQ(h.count("last"), 112u);
  EXPECT_EQ(h.download<uint32_t>("shaped.out").size(), 112u);
  EXPECT_EQ(h.download<uint32_t>("also.out").size(), 112u);
  EXPECT_EQ(h.figure("doubling", "steps"), 5.0);
  h.run();
  EXPECT_EQ(h.runCount("doubling"), 1u);
  h.set("fill.value", "60");
  h.run();
  EXPECT_EQ(h.count("result"), 120u);
  EXPECT_EQ(h.runCount("shaped"), 2u);
}

/// Grows two buffers, the second once the first is known; its reader sums their first words through copies.
void addGrowing(graph::Graph& graph) {
  FakeNode& grow = addFake(graph, "grow", [](Declaration& d) {
    d.write("entries", {}, "words", graph::UseTransfer).growable = true;
    d.publishCount("entry_count", "", 0);
    d.hostPaced();
  });
  grow.onStepCount = [](RecordContext&) { return 2u; };
  grow.onRecord = [&grow](RecordContext& c) {
    if (c.step() == 0) c.clearGrown("entries");
    const gpu::Buffer& buffer = c.grow("entries", (c.step() + 1) * 16);
    c.commands().fill(buffer, grow.value + c.step());
    c.setCount("entry_count", c.grown("entries").size());
  };
  addFake(
      graph, "reader",
      [](Declaration& d) {
        d.read("entries", "words", graph::UseTransfer);
        d.write("out", Shape::buffer(4, Extent::of("entry_count")), "words", graph::UseTransfer);
      },
      [](RecordContext& c) {
        VkDeviceSize offset = 0;
        for (const gpu::Buffer* buffer : c.grown("entries")) {
          c.commands().copy(*buffer, c.buffer("out"), 4, buffer->bytes() - 4, offset);
          offset += 4;
        }
      });
  graph.connect("grow.entries", "reader.entries");
  graph.output("reader.out");
}

TEST_F(HostPacedTest, GrownBuffersStayUntilTheNextRun) {
  NodeHarness h(device());
  addGrowing(h.graph());
  h.set("grow.value", "5");
  h.run();
  EXPECT_EQ(h.download<uint32_t>("reader.out"), (std::vector<uint32_t>{5, 6}));
  const auto grown = h.downloadGrown<uint32_t>("grow.entries");
  ASSERT_EQ(grown.size(), 2u);
  EXPECT_EQ(grown[0], repeat(4, 5));
  EXPECT_EQ(grown[1], repeat(8, 6));
  const VkDeviceSize held = device().memoryUse().current;
  h.set("grow.value", "8");
  h.run();
  EXPECT_EQ(h.download<uint32_t>("reader.out"), (std::vector<uint32_t>{8, 9}));
  EXPECT_EQ(device().memoryUse().current, held) << "clearGrown gives the old ones back";
  uint64_t bytes = 0;
  for (const auto& resource : h.executor().stats().resources) {
    if (resource.name == "grow.entries") bytes = resource.bytes;
  }
  EXPECT_EQ(bytes, 48u);
}

/// Adds `value` to what it reads, which it would free.
FakeNode& addFreeing(graph::Graph& graph, const std::string& name, const std::shared_ptr<AddPipeline>& add) {
  FakeNode& node = addFake(graph, name, [](Declaration& d) {
    d.read("in", "words").frees = true;
    d.write("out", Shape::buffer(4, 4), "words");
    d.hostPaced();
  });
  node.onPrepare = [add](graph::PrepareContext& c) { add->prepare(c.device()); };
  node.onRecord = [add, &node](RecordContext& c) { add->dispatch(c.commands(), c.buffer("in"), c.buffer("out"), 4, node.value); };
  return node;
}

uint64_t bytesOf(NodeHarness& h, const std::string& resource) {
  for (const auto& r : h.executor().stats().resources)
    if (r.name == resource) return r.bytes;
  return 0;
}

TEST_F(HostPacedTest, WhatOnlyOneNodeReadsItMayFree) {
  NodeHarness h(device());
  addFill(h.graph(), "fill");
  addFreeing(h.graph(), "frees", std::make_shared<AddPipeline>());
  h.connect("fill.out", "frees.in");
  h.output("frees.out");
  h.set("fill.value", "7");
  h.set("frees.value", "1");
  h.run();
  EXPECT_EQ(h.download<uint32_t>("frees.out"), repeat(4, 8));
  EXPECT_EQ(bytesOf(h, "fill.out"), 0u);
  EXPECT_EQ(h.executor().findBuffer("fill.out"), nullptr);
  h.run();
  EXPECT_EQ(h.runCount("fill"), 1u) << "nothing changed";
  h.set("frees.value", "2");
  h.run();
  EXPECT_EQ(h.download<uint32_t>("frees.out"), repeat(4, 9));
  EXPECT_EQ(h.runCount("fill"), 2u) << "what was freed is made again";
  h.set("fill.value", "10");
  h.run();
  EXPECT_EQ(h.download<uint32_t>("frees.out"), repeat(4, 12));
  EXPECT_EQ(bytesOf(h, "fill.out"), 0u);
}

TEST_F(HostPacedTest, WhatOthersReadBeforeIsFreed) {
  //  fill ──▶ before ──▶ frees: adds up, and frees what fill wrote
  //    └──────────────────▲
  NodeHarness h(device());
  addFill(h.graph(), "fill");
  addAdd(h.graph(), "before");
  const auto add = std::make_shared<AddPipeline>();
  FakeNode& frees = addFake(h.graph(), "frees", [](Declaration& d) {
    d.read("in", "words").frees = true;
    d.read("after", "words");
    d.write("out", Shape::buffer(4, 4), "words");
    d.hostPaced();
  });
  frees.onPrepare = [add](graph::PrepareContext& c) { add->prepare(c.device()); };
  frees.onRecord = [add, &frees](RecordContext& c) { add->dispatch(c.commands(), c.buffer("in"), c.buffer("out"), 4, frees.value); };
  h.connect("fill.out", "before.in");
  h.connect("fill.out", "frees.in");
  h.connect("before.out", "frees.after");
  h.output("frees.out");
  h.output("before.out");
  h.set("fill.value", "7");
  h.set("before.value", "1");
  h.set("frees.value", "2");
  h.run();
  EXPECT_EQ(h.download<uint32_t>("before.out"), repeat(4, 8));
  EXPECT_EQ(h.download<uint32_t>("frees.out"), repeat(4, 9));
  EXPECT_EQ(bytesOf(h, "fill.out"), 0u);
  h.run();
  EXPECT_EQ(h.runCount("fill"), 1u) << "nothing changed";
  h.set("before.value", "5");
  h.run();
  EXPECT_EQ(h.download<uint32_t>("before.out"), repeat(4, 12)) << "what was freed is made again for the others too";
  EXPECT_EQ(h.download<uint32_t>("frees.out"), repeat(4, 9));
  EXPECT_EQ(h.runCount("fill"), 2u);
  EXPECT_EQ(bytesOf(h, "fill.out"), 0u);
  h.set("frees.value", "3");
  h.run();
  EXPECT_EQ(h.download<uint32_t>("frees.out"), repeat(4, 10));
  EXPECT_EQ(h.runCount("fill"), 3u);
  EXPECT_EQ(bytesOf(h, "fill.out"), 0u);
}

TEST_F(HostPacedTest, WhatOthersReadIsNotFreed) {
  for (const std::string other : {"output", "reader", "rival"}) {
    NodeHarness h(device());
    addFill(h.graph(), "fill");
    const auto add = std::make_shared<AddPipeline>();
    addFreeing(h.graph(), "frees", add);
    h.connect("fill.out", "frees.in");
    h.output("frees.out");
    if (other == "output") h.output("fill.out");
    if (other == "reader") addAdd(h.graph(), "other");
    if (other == "rival") addFreeing(h.graph(), "other", add);
    if (other != "output") {
      h.connect("fill.out", "other.in");
      h.output("other.out");
    }
    h.set("fill.value", "7");
    h.set("frees.value", "1");
    h.run();
    EXPECT_EQ(h.download<uint32_t>("frees.out"), repeat(4, 8)) << other;
    h.set("frees.value", "2");
    h.run();
    EXPECT_EQ(h.download<uint32_t>("frees.out"), repeat(4, 9)) << other;
    EXPECT_EQ(h.runCount("fill"), 1u) << other;
    EXPECT_GT(bytesOf(h, "fill.out"), 0u) << other;
  }
}

TEST_F(HostPacedTest, GrowingBeyondTheDeviceNamesThePort) {
  NodeHarness h(device());
  FakeNode& grow = addFake(h.graph(), "grow", [](Declaration& d) {
    d.write("entries", {}, "words", graph::UseTransfer).growable = true;
    d.hostPaced();
  });
  const uint64_t tooMuch = device().capabilities().maxBufferSize + 1;
  grow.onRecord = [tooMuch](RecordContext& c) { c.grow("entries", tooMuch); };
  h.output("grow.entries");
  try {
    h.run();
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::OutOfMemory);
    EXPECT_NE(std::string(e.what()).find("grow.entries[0] needs " + std::to_string(tooMuch) + " B"), std::string::npos) << e.what();
  }
}

TEST_F(HostPacedTest, ProgressRisesToOne) {
  NodeHarness h(device());
  addFill(h.graph(), "fill");
  addDoubling(h.graph(), std::make_shared<Doubling>());
  h.connect("fill.out", "doubling.in");
  h.output("doubling.work");
  h.set("fill.value", "30");
  std::vector<std::pair<std::string, double>> calls;
  h.run([&](std::string_view node, double fraction) { calls.emplace_back(node, fraction); });
  ASSERT_EQ(calls.size(), 6u);
  EXPECT_EQ(calls[0], (std::pair<std::string, double>{"fill", 0.0}));
  EXPECT_EQ(calls[1], (std::pair<std::string, double>{"fill", 1.0}));
  EXPECT_EQ(calls[2], (std::pair<std::string, double>{"doubling", 0.0}));
  EXPECT_EQ(calls.back(), (std::pair<std::string, double>{"doubling", 1.0}));
}

TEST_F(HostPacedTest, NoStepsIsLegal) {
  NodeHarness h(device());
  FakeNode& node = addFake(h.graph(), "node", [](Declaration& d) {
    d.write("out", Shape::buffer(4, 4), "words").persistent = true;
    d.hostPaced();
  });
  node.onStepCount = [](RecordContext&) { return 0u; };
  h.output("node.out");
  h.run();
  EXPECT_EQ(h.runCount("node"), 1u);
  h.run();
  EXPECT_EQ(h.runCount("node"), 1u);
}

TEST_F(HostPacedTest, AnInterruptedModifyStartsFromTheVersionBefore) {
  //  fill 100 ──▶ modify: += 1 in each of three steps
  NodeHarness h(device());
  addFill(h.graph(), "fill");
  const auto add = std::make_shared<AddPipeline>();
  uint32_t stepsDone = 0;
  FakeNode& node = addFake(h.graph(), "modify", [](Declaration& d) {
    d.modify("data", "words");
    d.hostPaced();
  });
  node.onPrepare = [add](graph::PrepareContext& c) { add->prepare(c.device()); };
  node.onStepCount = [](RecordContext&) { return 3u; };
  node.onRecord = [add](RecordContext& c) { add->dispatch(c.commands(), c.buffer("data"), c.buffer("data"), 4, 1); };
  node.onStepDone = [&stepsDone](RecordContext&) { ++stepsDone; };
  h.connect("fill.out", "modify.data");
  h.output("modify.data");
  h.set("fill.value", "100");
  h.run();
  EXPECT_EQ(h.download<uint32_t>("modify.data"), repeat(4, 103));
  h.set("modify.value", "2");
  stepsDone = 0;
  EXPECT_THROW(h.executor().run({}, [&] { return stepsDone == 2; }), Error);
  EXPECT_EQ(stepsDone, 2u);
  h.run();
  EXPECT_EQ(h.download<uint32_t>("modify.data"), repeat(4, 103));
}

TEST_F(HostPacedTest, InterruptionStopsBetweenStepsAndTheNextRunStartsAnew) {
  NodeHarness h(device());
  addFill(h.graph(), "fill");
  const auto state = std::make_shared<Doubling>();
  addDoubling(h.graph(), state);
  h.connect("fill.out", "doubling.in");
  h.output("doubling.work");
  h.set("fill.value", "7");
  h.run();
  h.set("fill.value", "9");
  try {
    h.executor().run({}, [&] { return state->seen.size() == 2; });
    FAIL() << "not interrupted";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::BadInput);
    EXPECT_STREQ(e.what(), "interrupted");
  }
  EXPECT_EQ(state->seen, (std::vector<uint32_t>{9, 18}));
  h.run();
  EXPECT_EQ(state->seen, (std::vector<uint32_t>{9, 18, 36, 72, 144}));
  EXPECT_EQ(h.count("result"), 144u);
}

}  // namespace
}  // namespace radivox::oracles
