// Recording into a host's command buffer: when it is allowed, what it does, several frames under way.
#include <gtest/gtest.h>

#include "engine/graph/executor.h"
#include "tests/graph/gpu_nodes.h"
#include "tests/oracles/gpu_fixture.h"

namespace radivox::oracles {
namespace {

using graph::Declaration;
using graph::Extent;
using graph::RecordContext;
using graph::Shape;

/// A host: a camera it writes each frame, a graph that prepares once and draws every frame.
///   counter ┄ items ┄▶ prepared ──▶ draw (reads in.camera through scratch)
class RecordTest : public GpuTest {
 protected:
  void SetUp() override {
    GpuTest::SetUp();
    add_ = std::make_shared<AddPipeline>();
    addCounter(graph_, "counter", "items");
    addFill(graph_, "prepared", Extent::of("items"));
    FakeNode& draw = addFake(graph_, "draw", [](Declaration& d) {
      d.read("camera", "words");
      d.read("prepared", "words");
      d.scratch("temporary", Shape::buffer(4, 4), "words", graph::UseCompute);
      d.write("color", Shape::buffer(4, 4), "words", graph::UseCompute);
      d.readBack("seen", Shape::buffer(4, 4), "words");
    });
    draw.onPrepare = [this](graph::PrepareContext& c) { add_->prepare(c.device()); };
    draw.onRecord = [this, &draw](RecordContext& c) {
      add_->dispatch(c.commands(), c.buffer("camera"), c.buffer("temporary"), 4, draw.value);
      c.commands().barrier();
      add_->dispatch(c.commands(), c.buffer("temporary"), c.buffer("color"), 4, 0);
      c.commands().barrier();
      c.commands().copy(c.buffer("color"), c.buffer("seen"), 16);
    };
    draw.onFrameDone = [this](RecordContext& c) { seen_.push_back(*static_cast<const uint32_t*>(c.buffer("seen").mapped())); };
    graph_.connect("host.camera", "draw.camera");
    graph_.connect("prepared.out", "draw.prepared");
    graph_.output("draw.color");
    graph_.set("counter.value", "100");
    input_.imports = {{"host.camera", Shape::buffer(4, 4)}};
    camera_ = gpu::Buffer(device(), "host.camera", 16);
    result_ = gpu::Buffer(device(), "result", 64, gpu::MemoryKind::ReadBack);
    executor_ = std::make_unique<graph::Executor>(device(), graph_, input_.compile(graph_), input_.traits, input_.request, input_.counts);
  }

  void TearDown() override {
    executor_.reset();
    camera_ = {};
    result_ = {};
    graph_ = {};
    add_.reset();
    GpuTest::TearDown();
  }

  void setCamera(uint32_t value) {
    gpu::upload(device(), camera_, repeat(4, value));
    executor_->importBuffer("host.camera", camera_, ++version_);
  }

  uint32_t runs(const std::string& node) {
    for (const auto& stats : executor_->stats().nodes) {
      if (stats.name == node) return stats.runCount;
    }
    return 0;
  }

  /// Records the next frame and copies its first word to word `slot` of result_.
  void recordFrame(VkCommandBuffer commands, uint32_t slot) {
    executor_->record(commands);
    const VkBufferCopy region{0, slot * 4, 4};
    vkCmdCopyBuffer(commands, executor_->findBuffer("draw.color")->handle(), result_.handle(), 1, &region);
  }
  uint32_t result(uint32_t slot) { return static_cast<const uint32_t*>(result_.mapped())[slot]; }

  graph::Graph graph_;
  PlanInput input_;
  std::shared_ptr<AddPipeline> add_;
  gpu::Buffer camera_, result_;
  std::unique_ptr<graph::Executor> executor_;
  std::vector<uint32_t> seen_;
  uint64_t version_ = 0;
};

TEST_F(RecordTest, ReadyOnceThePreparationsHaveRun) {
  EXPECT_FALSE(executor_->isReadyToRecord()) << "no camera yet";
  setCamera(5);
  EXPECT_FALSE(executor_->isReadyToRecord()) << "counts are not known";
  executor_->run();
  EXPECT_TRUE(executor_->isReadyToRecord());
  setCamera(6);
  EXPECT_TRUE(executor_->isReadyToRecord()) << "only the view changed";
  graph_.set("prepared.value", "3");
  EXPECT_TRUE(executor_->isReadyToRecord()) << "what is stale publishes nothing";
  graph_.set("counter.value", "101");
  EXPECT_FALSE(executor_->isReadyToRecord()) << "a count may change";
  executor_->run();
  EXPECT_TRUE(executor_->isReadyToRecord());
}

TEST_F(RecordTest, RecordsWhatIsStaleAndNothingElse) {
  setCamera(5);
  executor_->run();
  setCamera(20);
  device().submitAndWait([&](VkCommandBuffer commands) { recordFrame(commands, 0); });
  executor_->frameCompleted();
  EXPECT_EQ(result(0), 21u);
  EXPECT_EQ(runs("draw"), 2u);
  EXPECT_EQ(runs("prepared"), 1u);
  EXPECT_EQ(seen_, (std::vector<uint32_t>{6, 21})) << "frameDone after run() and after frameCompleted()";
  device().submitAndWait([&](VkCommandBuffer commands) { recordFrame(commands, 1); });
  executor_->frameCompleted();
  EXPECT_EQ(result(1), 21u) << "nothing was stale: the output stays";
  EXPECT_EQ(runs("draw"), 2u);
}

TEST_F(RecordTest, SeesWhatTheHostWroteInTheSameCommandBuffer) {
  setCamera(5);
  executor_->run();
  executor_->importBuffer("host.camera", camera_, ++version_);
  device().submitAndWait([&](VkCommandBuffer commands) {
    vkCmdFillBuffer(commands, camera_.handle(), 0, VK_WHOLE_SIZE, 70);  // no barrier: record() places one
    recordFrame(commands, 0);
  });
  executor_->frameCompleted();
  EXPECT_EQ(result(0), 71u);
}

TEST_F(RecordTest, BarriersToAndFromTheHost) {
  // One dispatch and nothing else, so that no other barrier covers for those at both ends: the host writes the import just before and
  // reads the output just after, both by transfer.
  graph::Graph g;
  addAdd(g, "add");
  g.connect("host.camera", "add.in");
  g.output("add.out");
  graph::Executor executor(device(), g, input_.compile(g), input_.traits, input_.request, {});
  setCamera(1);
  executor.importBuffer("host.camera", camera_, 1);
  executor.run();
  executor.importBuffer("host.camera", camera_, 2);
  device().submitAndWait([&](VkCommandBuffer commands) {
    vkCmdFillBuffer(commands, camera_.handle(), 0, VK_WHOLE_SIZE, 70);
    executor.record(commands);
    const VkBufferCopy region{0, 0, 16};
    vkCmdCopyBuffer(commands, executor.findBuffer("add.out")->handle(), result_.handle(), 1, &region);
  });
  executor.frameCompleted();
  EXPECT_EQ(result(3), 71u);
}

TEST_F(RecordTest, SeveralFramesUnderWay) {
  // Three frames in one submission, each with another parameter: nothing waits between them but barriers.
  setCamera(100);
  executor_->run();
  device().submitAndWait([&](VkCommandBuffer commands) {
    for (uint32_t frame = 0; frame < 3; ++frame) {
      graph_.set("draw.value", std::to_string(10 * (frame + 1)));
      recordFrame(commands, frame);
    }
  });
  EXPECT_EQ(result(0), 110u);
  EXPECT_EQ(result(1), 120u);
  EXPECT_EQ(result(2), 130u);
  EXPECT_THROW(executor_->run(), Error) << "frames are under way";
  for (int i = 0; i < 3; ++i) executor_->frameCompleted();
  EXPECT_THROW(executor_->frameCompleted(), Error);
  EXPECT_EQ(seen_.size(), 4u);
  executor_->run();
}

TEST_F(RecordTest, AllocatesNothingOnceItHasRecorded) {
  setCamera(5);
  executor_->run();
  for (int frame = 0; frame < 3; ++frame) {
    setCamera(static_cast<uint32_t>(frame));
    const gpu::MemoryUse before = device().memoryUse();
    device().submitAndWait([&](VkCommandBuffer commands) { executor_->record(commands); });
    executor_->frameCompleted();
    if (frame > 0) {
      EXPECT_EQ(device().memoryUse().current, before.current);
      EXPECT_EQ(device().memoryUse().allocationCount, before.allocationCount);
    }
  }
  const auto stats = executor_->stats();
  EXPECT_EQ(stats.nodes.back().name, "draw");
  EXPECT_EQ(stats.nodes.back().gpuMs > 0.0, device().capabilities().timestampPeriodNs > 0);
}

TEST_F(RecordTest, RefusedWhileNotReady) {
  setCamera(5);
  device().submitAndWait([&](VkCommandBuffer commands) { EXPECT_THROW(executor_->record(commands), Error); });
  EXPECT_THROW(executor_->frameCompleted(), Error);
  executor_->run();
  EXPECT_EQ(seen_, (std::vector<uint32_t>{6}));
}

TEST_F(RecordTest, NodesOfEveryFrameAreInEachRecording) {
  graph::Graph g;
  FakeNode& clock = addFake(g, "clock", [](Declaration& d) {
    d.write("out", Shape::buffer(4, 4), "words", graph::UseTransfer);
    d.runEveryFrame();
  });
  uint32_t frame = 0;
  clock.onRecord = [&frame](RecordContext& c) { c.commands().fill(c.buffer("out"), ++frame); };
  g.output("clock.out");
  graph::Executor executor(device(), g, input_.compile(g), input_.traits, input_.request, {});
  executor.run();
  for (uint32_t i = 2; i < 5; ++i) {
    device().submitAndWait([&](VkCommandBuffer commands) { executor.record(commands); });
    executor.frameCompleted();
    EXPECT_EQ(gpu::downloadAs<uint32_t>(device(), *executor.findBuffer("clock.out"), 4), repeat(4, i));
  }
}

TEST_F(RecordTest, NotReadyWhileItsScratchIsGivenBack) {
  // `view` ran beside a preparation, whose scratch memory went with it; the first frame of its own is a run(), then recording may begin.
  graph::Graph g;
  addCounter(g, "counter", "items");
  FakeNode& view = addFake(g, "view", [](Declaration& d) {
    d.scratch("temporary", Shape::buffer(4, 64), "words", graph::UseTransfer);
    d.write("out", Shape::buffer(4, 4), "words", graph::UseTransfer);
  });
  view.onRecord = [&view](RecordContext& c) {
    c.commands().fill(c.buffer("temporary"), view.value);
    c.commands().barrier();
    c.commands().copy(c.buffer("temporary"), c.buffer("out"), 16);
  };
  addFill(g, "shaped", Extent::of("items"));
  g.output("view.out");
  g.output("shaped.out");
  graph::Executor executor(device(), g, input_.compile(g), input_.traits, input_.request, {});
  executor.run();
  EXPECT_TRUE(executor.isReadyToRecord()) << "nothing is stale";
  g.set("view.value", "2");
  EXPECT_FALSE(executor.isReadyToRecord());
  executor.run();
  g.set("view.value", "3");
  EXPECT_TRUE(executor.isReadyToRecord());
  device().submitAndWait([&](VkCommandBuffer commands) { executor.record(commands); });
  executor.frameCompleted();
  EXPECT_EQ(gpu::downloadAs<uint32_t>(device(), *executor.findBuffer("view.out"), 4), repeat(4, 3));
}

TEST_F(RecordTest, HostPacedNodesAreNeverRecorded) {
  graph::Graph g;
  FakeNode& node = addFake(g, "node", [](Declaration& d) {
    d.write("out", Shape::buffer(4, 4), "words", graph::UseTransfer);
    d.hostPaced();
  });
  node.onRecord = [](RecordContext& c) { c.commands().fill(c.buffer("out"), 1); };
  g.output("node.out");
  graph::Executor executor(device(), g, input_.compile(g), input_.traits, input_.request, {});
  EXPECT_FALSE(executor.isReadyToRecord());
  executor.run();
  EXPECT_TRUE(executor.isReadyToRecord()) << "it has run, and nothing is stale";
  g.set("node.value", "2");
  EXPECT_FALSE(executor.isReadyToRecord());
}

}  // namespace
}  // namespace radivox::oracles
