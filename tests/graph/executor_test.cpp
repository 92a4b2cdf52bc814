// What runs when: versions, counts, modified resources, parameters.
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

class ExecutorTest : public GpuTest {};

TEST_F(ExecutorTest, RunsOnlyWhatChanged) {
  NodeHarness h(device());
  addFill(h.graph(), "a");
  addFill(h.graph(), "b");
  addAdd(h.graph(), "add_a");
  addCopy(h.graph(), "copy_b");
  h.connect("a.out", "add_a.in");
  h.connect("b.out", "copy_b.in");
  h.output("add_a.out");
  h.output("copy_b.out");
  h.set("a.value", "7");
  h.run();
  EXPECT_EQ(h.download<uint32_t>("add_a.out"), repeat(4, 8));
  EXPECT_EQ(h.download<uint32_t>("copy_b.out"), repeat(4, 1));
  h.run();
  EXPECT_EQ(h.runCount("a"), 1u);
  EXPECT_EQ(h.runCount("add_a"), 1u);
  h.set("b.value", "9");
  h.run();
  EXPECT_EQ(h.runCount("a"), 1u);
  EXPECT_EQ(h.runCount("add_a"), 1u);
  EXPECT_EQ(h.runCount("b"), 2u);
  EXPECT_EQ(h.runCount("copy_b"), 2u);
  EXPECT_EQ(h.download<uint32_t>("add_a.out"), repeat(4, 8));
  EXPECT_EQ(h.download<uint32_t>("copy_b.out"), repeat(4, 9));
}

TEST_F(ExecutorTest, RunsEveryFrameWhereTheNodeSaysSo) {
  NodeHarness h(device());
  addFake(
      h.graph(), "clock",
      [](Declaration& d) {
        d.write("out", Shape::buffer(4, 4), "words", graph::UseTransfer);
        d.runEveryFrame();
      },
      [](RecordContext& c) { c.commands().fill(c.buffer("out"), 5); });
  addCopy(h.graph(), "reader");
  addFill(h.graph(), "still");
  h.connect("clock.out", "reader.in");
  h.output("reader.out");
  h.output("still.out");
  for (int i = 0; i < 3; ++i) h.run();
  EXPECT_EQ(h.runCount("clock"), 3u);
  EXPECT_EQ(h.runCount("reader"), 3u);
  EXPECT_EQ(h.runCount("still"), 1u);
}

TEST_F(ExecutorTest, NewImportVersionsRunTheirReaders) {
  NodeHarness h(device());
  h.importBuffer("in.a", repeat(4, 10));
  h.importBuffer("in.b", repeat(4, 20));
  addAdd(h.graph(), "a");
  addAdd(h.graph(), "b");
  h.connect("in.a", "a.in");
  h.connect("in.b", "b.in");
  h.output("a.out");
  h.output("b.out");
  h.run();
  h.importBuffer("in.b", repeat(4, 30));
  h.run();
  EXPECT_EQ(h.runCount("a"), 1u);
  EXPECT_EQ(h.runCount("b"), 2u);
  EXPECT_EQ(h.download<uint32_t>("a.out"), repeat(4, 11));
  EXPECT_EQ(h.download<uint32_t>("b.out"), repeat(4, 31));
}

TEST_F(ExecutorTest, ChangedAndFirstRunSayWhy) {
  NodeHarness h(device());
  h.importBuffer("in.a", repeat(4, 1));
  h.importBuffer("in.b", repeat(4, 1));
  std::string seen;
  FakeNode& node = addFake(h.graph(), "node", [](Declaration& d) {
    d.read("a", "words");
    d.read("b", "words");
    d.write("out", Shape::buffer(4, 4), "words", graph::UseTransfer);
  });
  node.onRecord = [&seen](RecordContext& c) {
    seen = std::string(c.firstRun() ? "first " : "") + (c.changed("a") ? "a " : "") + (c.changed("b") ? "b " : "");
    c.commands().fill(c.buffer("out"), 0);
  };
  std::string done;
  node.onFrameDone = [&done](RecordContext& c) { done = std::string(c.firstRun() ? "first " : "") + (c.changed("b") ? "b " : ""); };
  h.connect("in.a", "node.a");
  h.connect("in.b", "node.b");
  h.output("node.out");
  h.run();
  EXPECT_EQ(seen, "first a b ");
  h.importBuffer("in.b", repeat(4, 2));
  h.run();
  EXPECT_EQ(seen, "b ");
  EXPECT_EQ(done, "b ") << "the same answers until the frame is done";
  h.set("node.value", "3");
  h.run();
  EXPECT_EQ(seen, "first a b ") << "parameters changed: nothing of the last run may be kept";
  seen = "did not run";
  h.run();
  EXPECT_EQ(seen, "did not run");
}

TEST_F(ExecutorTest, CountsSizeWhatTheyShape) {
  NodeHarness h(device());
  FakeNode& counter = addCounter(h.graph(), "counter", "items");
  addFill(h.graph(), "shaped", Extent::of("items") * 2);
  addFill(h.graph(), "other");
  h.output("shaped.out");
  h.output("other.out");
  h.set("counter.value", "5");
  h.run();
  EXPECT_EQ(h.count("items"), 5u);
  EXPECT_EQ(h.download<uint32_t>("shaped.out"), repeat(10, 1));
  h.set("counter.value", "3");
  h.run();
  EXPECT_EQ(h.count("items"), 3u);
  EXPECT_EQ(h.buffer("shaped.out").bytes(), 24u);
  EXPECT_EQ(h.runCount("shaped"), 2u);
  EXPECT_EQ(h.runCount("other"), 1u);
  // The counter runs again and counts the same: what it shapes stays.
  counter.params().set("counter", "value", "4");
  counter.params().set("counter", "value", "3");
  const VkBuffer before = h.buffer("shaped.out").handle();
  h.run();
  EXPECT_EQ(h.runCount("counter"), 3u);
  EXPECT_EQ(h.runCount("shaped"), 2u);
  EXPECT_EQ(h.buffer("shaped.out").handle(), before);
}

TEST_F(ExecutorTest, ACountMayBeZero) {
  NodeHarness h(device());
  addCounter(h.graph(), "counter", "items");
  const auto add = std::make_shared<AddPipeline>();
  FakeNode& node = addFake(h.graph(), "shaped", [](Declaration& d) {
    d.write("out", Shape::buffer(4, Extent::of("items")), "words", graph::UseCompute);
    d.scratch("temporary", Shape::buffer(4, Extent::of("items")), "words");
  });
  node.onPrepare = [add](graph::PrepareContext& c) { add->prepare(c.device()); };
  node.onRecord = [add](RecordContext& c) {
    add->dispatch(c.commands(), c.buffer("temporary"), c.buffer("out"), static_cast<uint32_t>(c.count("items")), 1);
  };
  h.output("shaped.out");
  h.set("counter.value", "0");
  h.run();
  EXPECT_EQ(h.count("items"), 0u);
  EXPECT_EQ(h.buffer("shaped.out").bytes(), 16u);
  EXPECT_TRUE(h.download<uint32_t>("shaped.out").empty());
}

TEST_F(ExecutorTest, AKnownCountMayChange) {
  NodeHarness h(device(), {}, {.width = 6, .height = 2});
  addCounter(h.graph(), "counter", "items");
  addFill(h.graph(), "prepared", Extent::of("items"));
  addFill(h.graph(), "view", Extent::of("width") * "height");
  h.output("prepared.out");
  h.output("view.out");
  h.run();
  EXPECT_EQ(h.download<uint32_t>("view.out"), repeat(12, 1));
  h.executor().setCount("width", 10);
  EXPECT_FALSE(h.executor().isReadyToRecord()) << "something must be allocated first";
  h.run();
  EXPECT_EQ(h.download<uint32_t>("view.out"), repeat(20, 1));
  EXPECT_EQ(h.runCount("view"), 2u);
  EXPECT_EQ(h.runCount("prepared"), 1u);
  EXPECT_THROW(h.executor().setCount("items", 3), Error);
}

TEST_F(ExecutorTest, ChainsOfCountsSettleInOneRun) {
  // a counts 3; b is shaped by it and publishes 30; c is shaped by that.
  NodeHarness h(device());
  addCounter(h.graph(), "a", "n");
  FakeNode& b = addFake(h.graph(), "b", [](Declaration& d) {
    d.write("out", Shape::buffer(4, Extent::of("n")), "words", graph::UseTransfer);
    d.publishCount("m", "out", 0);
  });
  b.onRecord = [](RecordContext& c) { c.commands().fill(c.buffer("out"), static_cast<uint32_t>(c.count("n")) * 10); };
  addFill(h.graph(), "c", Extent::of("m"));
  h.output("c.out");
  h.set("a.value", "3");
  h.run();
  EXPECT_EQ(h.download<uint32_t>("c.out").size(), 30u);
  h.set("a.value", "4");
  h.run();
  EXPECT_EQ(h.download<uint32_t>("c.out").size(), 40u);
  EXPECT_EQ(h.runCount("c"), 2u);
}

TEST_F(ExecutorTest, ModifyRunsTheWriterBeforeItAgain) {
  //  fill 100 ──▶ first += 1 ──▶ second += 1 ──▶ copy
  NodeHarness h(device());
  addFill(h.graph(), "fill");
  addModify(h.graph(), "first");
  addModify(h.graph(), "second");
  addCopy(h.graph(), "copy");
  h.connect("fill.out", "first.data");
  h.connect("first.data", "second.data");
  h.connect("second.data", "copy.in");
  h.output("copy.out");
  h.set("fill.value", "100");
  h.run();
  EXPECT_EQ(h.download<uint32_t>("copy.out"), repeat(4, 102));
  h.set("second.value", "5");  // would give 107 on top of its own result
  h.run();
  EXPECT_EQ(h.download<uint32_t>("copy.out"), repeat(4, 106));
  EXPECT_EQ(h.runCount("fill"), 2u);
  EXPECT_EQ(h.runCount("first"), 2u);
  h.run();
  EXPECT_EQ(h.runCount("second"), 2u) << "nothing changed, nothing runs";
}

TEST_F(ExecutorTest, ModifyShapedByACountGoesBackToTheWriter) {
  // The count is only known after `fill` has run: when it changes, `modify` turns stale and `fill`, which came before, must run again.
  NodeHarness h(device());
  addFill(h.graph(), "fill");
  addCounter(h.graph(), "counter", "items");
  const auto add = std::make_shared<AddPipeline>();
  FakeNode& modify = addFake(h.graph(), "modify", [](Declaration& d) {
    d.modify("data", "words");
    d.scratch("temporary", Shape::buffer(4, Extent::of("items")), "words");
  });
  modify.onPrepare = [add](graph::PrepareContext& c) { add->prepare(c.device()); };
  modify.onRecord = [add](RecordContext& c) {
    add->dispatch(c.commands(), c.buffer("data"), c.buffer("data"), 4, static_cast<uint32_t>(c.count("items")));
  };
  h.connect("fill.out", "modify.data");
  h.output("modify.data");
  h.set("fill.value", "100");
  h.set("counter.value", "7");
  h.run();
  EXPECT_EQ(h.download<uint32_t>("modify.data"), repeat(4, 107));
  h.set("counter.value", "9");
  h.run();
  EXPECT_EQ(h.download<uint32_t>("modify.data"), repeat(4, 109));
  EXPECT_EQ(h.runCount("fill"), 2u);
}

TEST_F(ExecutorTest, ACountThatDiffersAtEachRunSettles) {
  //  fill ──▶ modify, shaped by a count of fill's that is another at each run: one run each, no endless chase
  NodeHarness h(device());
  uint32_t next = 0;
  addFake(
      h.graph(), "fill",
      [](Declaration& d) {
        d.write("out", Shape::buffer(4, 4), "words", graph::UseTransfer);
        d.write("count", Shape::buffer(4, 1), "words", graph::UseTransfer);
        d.publishCount("items", "count", 0);
      },
      [&next](RecordContext& c) {
        c.commands().fill(c.buffer("out"), 0);
        c.commands().fill(c.buffer("count"), ++next);
      });
  addFake(
      h.graph(), "modify",
      [](Declaration& d) {
        d.modify("data", "words", graph::UseTransfer);
        d.scratch("s", Shape::buffer(4, Extent::of("items")), "words");
      },
      [](RecordContext& c) { c.commands().fill(c.buffer("data"), static_cast<uint32_t>(c.count("items"))); });
  h.connect("fill.out", "modify.data");
  h.output("modify.data");
  h.run();
  EXPECT_EQ(h.download<uint32_t>("modify.data"), repeat(4, 1));
  h.set("fill.value", "2");
  h.run();
  EXPECT_EQ(h.download<uint32_t>("modify.data"), repeat(4, 2));
  EXPECT_EQ(h.runCount("fill"), 2u);
  EXPECT_EQ(h.runCount("modify"), 2u);
}

TEST_F(ExecutorTest, PlanParametersAskForANewPlan) {
  NodeHarness h(device());
  FakeNode& fill = addFill(h.graph(), "fill");
  h.output("fill.out");
  h.run();
  fill.params().set("fill", "tall", "true");
  try {
    h.executor().run();
    FAIL() << "ran a plan that no longer holds";
  } catch (const Error& e) {
    EXPECT_STREQ(e.what(), "a parameter of fill changed the plan; compile the graph again");
  }
  EXPECT_FALSE(h.executor().isReadyToRecord());
}

TEST_F(ExecutorTest, MissingImportsAreNamed) {
  graph::Graph g;
  addFake(g, "sink", [](Declaration& d) {
    d.read("scene.a", "a");
    d.read("scene.b", "b");
  });
  PlanInput input;
  input.imports = {{"scene.a", Shape::buffer(4, 4)}, {"scene.b", Shape::buffer(4, 4)}, {"scene.unused", Shape::buffer(4, 4)}};
  graph::Executor executor(device(), g, input.compile(g), input.traits, input.request, {});
  try {
    executor.run();
    FAIL();
  } catch (const Error& e) {
    EXPECT_STREQ(e.what(), "the plan reads imports that were not given: scene.a, scene.b");
  }
}

TEST_F(ExecutorTest, ImportsOfTheWrongKindAreRefused) {
  graph::Graph g;
  addFake(g, "sink", [](Declaration& d) { d.read("scene.a", "a"); });
  PlanInput input;
  input.imports = {{"scene.a", Shape::image(VK_FORMAT_R32_UINT, 4, 4)}};
  graph::Executor executor(device(), g, input.compile(g), input.traits, input.request, {});
  const gpu::Buffer buffer(device(), "a", 16);
  EXPECT_THROW(executor.importBuffer("scene.a", buffer, 1), Error);
}

TEST_F(ExecutorTest, ReadBackAndFrameDone) {
  NodeHarness h(device());
  uint32_t seen = 0, calls = 0;
  FakeNode& node = addFake(h.graph(), "node", [](Declaration& d) { d.readBack("result", Shape::buffer(4, 4), "words"); }, {});
  node.onRecord = [&node](RecordContext& c) { c.commands().fill(c.buffer("result"), node.value); };
  node.onFrameDone = [&](RecordContext& c) {
    ++calls;
    seen = static_cast<const uint32_t*>(c.buffer("result").mapped())[3];
    c.reportStat("seen", seen);
  };
  h.output("node.result");
  h.set("node.value", "42");
  h.run();
  EXPECT_EQ(seen, 42u);
  EXPECT_EQ(h.figure("node", "seen"), 42.0);
  h.run();
  EXPECT_EQ(calls, 1u) << "only if the node ran";
}

TEST_F(ExecutorTest, StatsHoldWhatHappened) {
  NodeHarness h(device());
  addFill(h.graph(), "fill", 1 << 20);
  addFake(h.graph(), "off", [](Declaration& d) { d.leaveOut("not today"); });
  h.output("fill.out");
  const VkDeviceSize before = device().memoryUse().current;
  h.run();
  graph::FrameStats stats = h.executor().stats();
  ASSERT_EQ(stats.nodes.size(), 1u);
  EXPECT_EQ(stats.nodes[0].name, "fill");
  EXPECT_EQ(stats.nodes[0].type, "test.fake");
  EXPECT_TRUE(stats.nodes[0].ranLastFrame);
  EXPECT_GT(stats.nodes[0].wallMs, 0.0);
  EXPECT_EQ(stats.nodes[0].gpuMs > 0.0, device().capabilities().timestampPeriodNs > 0);
  ASSERT_EQ(stats.resources.size(), 1u);
  EXPECT_EQ(stats.resources[0].name, "fill.out");
  EXPECT_EQ(stats.resources[0].bytes, 4u << 20);
  EXPECT_EQ(stats.culled[0].reason, "not today");
  EXPECT_GE(stats.memory.current, before + (4u << 20));
  h.run();
  EXPECT_FALSE(h.executor().stats().nodes[0].ranLastFrame);
}

TEST_F(ExecutorTest, AnEmptyPlanRuns) {
  NodeHarness h(device());
  h.run();
  EXPECT_TRUE(h.executor().isReadyToRecord());
  EXPECT_TRUE(h.executor().stats().nodes.empty());
}

TEST_F(ExecutorTest, MistakesOfNodesAreNamed) {
  const auto errorOf = [&](std::function<void(RecordContext&)> mistake) -> std::string {
    NodeHarness h(device());
    addFake(
        h.graph(), "node",
        [](Declaration& d) {
          d.read("maybe", "words").optional = true;
          d.write("out", Shape::buffer(4, 4), "words");
          d.write("picture", Shape::image(VK_FORMAT_R32_UINT, 4, 4), "texels");
        },
        std::move(mistake));
    h.output("node.out");
    try {
      h.run();
    } catch (const Error& e) {
      return e.what();
    }
    return "";
  };
  const std::string end = "; this is a mistake in the node";
  EXPECT_EQ(errorOf([](RecordContext& c) { c.buffer("nothing"); }), "node node asks for port nothing, which it did not declare" + end);
  EXPECT_EQ(errorOf([](RecordContext& c) { c.buffer("maybe"); }), "node node asks for port maybe, which is absent: ask has() first" + end);
  EXPECT_EQ(errorOf([](RecordContext& c) { c.image("out"); }), "node node asks for buffer out as an image" + end);
  EXPECT_EQ(errorOf([](RecordContext& c) { c.buffer("picture"); }), "node node asks for image picture as a buffer" + end);
  EXPECT_EQ(errorOf([](RecordContext& c) { c.count("faces"); }),
            "node node asks for the count faces before it is known: shape a port by it" + end);
  EXPECT_EQ(errorOf([](RecordContext& c) { c.grow("out", 4); }),
            "node node grows port out, which it did not declare as a growable output" + end);
  EXPECT_EQ(errorOf([](RecordContext& c) { c.setCount("faces", 4); }),
            "node node sets the count faces without having declared it: publishCount(\"faces\", \"\", 0)" + end);
  EXPECT_EQ(errorOf([](RecordContext& c) { c.readBuffer("out", 0, 4); }), "node node reads back while it records" + end);
}

}  // namespace
}  // namespace radivox::oracles
