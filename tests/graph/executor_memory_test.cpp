// What the executor allocates, when, and what the device refuses.
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

class ExecutorMemoryTest : public GpuTest {
 protected:
  VkDeviceSize held() { return device().memoryUse().current; }
};

/// out = in + 1 through a scratch buffer of `words` words, so that shared scratch memory that is not kept apart shows.
void addThroughScratch(graph::Graph& graph, const std::string& name, uint32_t words) {
  const auto add = std::make_shared<AddPipeline>();
  FakeNode& node = addFake(graph, name, [words](Declaration& d) {
    d.read("in", "words");
    d.write("out", Shape::buffer(4, words), "words", graph::UseCompute);
    d.scratch("temporary", Shape::buffer(4, words), "words", graph::UseCompute);
  });
  node.onPrepare = [add](graph::PrepareContext& c) { add->prepare(c.device()); };
  node.onRecord = [add, words](RecordContext& c) {
    add->dispatch(c.commands(), c.buffer("in"), c.buffer("temporary"), words, 1);
    c.commands().barrier();
    add->dispatch(c.commands(), c.buffer("temporary"), c.buffer("out"), words, 0);
  };
}

TEST_F(ExecutorMemoryTest, ScratchIsSharedAndKeptApartByBarriers) {
  constexpr uint32_t kWords = 1 << 18;  // 1 MiB
  NodeHarness h(device());
  addFill(h.graph(), "fill", kWords);
  std::string last = "fill";
  for (const char* name : {"a", "b", "c", "d"}) {
    addThroughScratch(h.graph(), name, kWords);
    h.connect(last + ".out", std::string(name) + ".in");
    last = name;
  }
  h.output("d.out");
  const VkDeviceSize before = held();
  h.run();
  EXPECT_EQ(h.download<uint32_t>("d.out"), repeat(kWords, 5));
  // Five outputs and one shared piece of scratch, not four; and change for the executor's own.
  const VkDeviceSize used = held() - before;
  EXPECT_GE(used, 6u * 4 * kWords);
  EXPECT_LT(used, 7u * 4 * kWords);
}

TEST_F(ExecutorMemoryTest, ScratchOfPreparationsIsGivenBack) {
  constexpr uint32_t kWords = 1 << 18;
  NodeHarness h(device());
  FakeNode& prepare = addFake(h.graph(), "prepare", [](Declaration& d) {
    d.write("count", Shape::buffer(4, 1), "words", graph::UseTransfer);
    d.scratch("large", Shape::buffer(4, kWords), "words", graph::UseTransfer);
    d.publishCount("items", "count", 0);
  });
  prepare.onRecord = [](RecordContext& c) {
    c.commands().fill(c.buffer("large"), 1);
    c.commands().fill(c.buffer("count"), 64);
  };
  FakeNode& steady = addFake(h.graph(), "steady", [](Declaration& d) {
    d.write("out", Shape::buffer(4, Extent::of("items")), "words", graph::UseTransfer);
    d.scratch("small", Shape::buffer(4, 1024), "words", graph::UseTransfer);
  });
  steady.onRecord = [](RecordContext& c) {
    c.commands().fill(c.buffer("small"), 1);
    c.commands().fill(c.buffer("out"), 2);
  };
  h.output("steady.out");
  const VkDeviceSize before = held();
  h.run();
  EXPECT_LT(held() - before, 1u << 20) << "1 MiB of scratch was for the preparation only";
  bool keptSmall = false;
  for (const auto& resource : h.executor().stats().resources) {
    EXPECT_NE(resource.name, "prepare.large");
    keptSmall |= resource.name == "steady.small";
  }
  EXPECT_TRUE(keptSmall) << "the steady frame's scratch stays";
}

TEST_F(ExecutorMemoryTest, PersistentBuffersAreZeroOnceAndThenKept) {
  NodeHarness h(device());
  addCounter(h.graph(), "counter", "items");
  const auto add = std::make_shared<AddPipeline>();
  FakeNode& node = addFake(h.graph(), "node", [](Declaration& d) {
    d.write("sum", Shape::buffer(4, Extent::of("items")), "words", graph::UseCompute).persistent = true;
  });
  node.onPrepare = [add](graph::PrepareContext& c) { add->prepare(c.device()); };
  node.onRecord = [add](RecordContext& c) {
    add->dispatch(c.commands(), c.buffer("sum"), c.buffer("sum"), static_cast<uint32_t>(c.count("items")), 1);
  };
  h.output("node.sum");
  h.set("counter.value", "6");
  h.run();
  EXPECT_EQ(h.download<uint32_t>("node.sum"), repeat(6, 1));
  for (const char* value : {"2", "3"}) {
    h.set("node.value", value);
    h.run();
  }
  EXPECT_EQ(h.download<uint32_t>("node.sum"), repeat(6, 3));
  h.set("counter.value", "9");
  h.run();
  EXPECT_EQ(h.download<uint32_t>("node.sum"), repeat(9, 1)) << "a new buffer starts at zero";
}

TEST_F(ExecutorMemoryTest, PersistentImagesAreZero) {
  NodeHarness h(device());
  addFake(h.graph(), "node", [](Declaration& d) {
    d.write("color", Shape::image(VK_FORMAT_R32_UINT, 5, 3, 2, true), "texels").persistent = true;
    d.write("depth", Shape::image(VK_FORMAT_D32_SFLOAT, 4, 4), "depth", graph::UseAttachment).persistent = true;
  });
  h.output("node.color");
  h.output("node.depth");
  h.run();
  for (const uint32_t layer : {0u, 1u}) EXPECT_EQ(h.downloadImage<uint32_t>("node.color", layer), repeat(15, 0));
  EXPECT_EQ(h.downloadImage<float>("node.depth"), std::vector<float>(16, 0.f));
}

TEST_F(ExecutorMemoryTest, BuffersBeyondTheDeviceNamePortSizeAndLimit) {
  const auto errorFor = [&](uint64_t words, uint32_t use) -> std::string {
    NodeHarness h(device());
    addFake(h.graph(), "node", [&](Declaration& d) { d.write("out", Shape::buffer(4, words), "words", use); });
    h.output("node.out");
    try {
      h.run();
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::OutOfMemory);
      return e.what();
    }
    return "";
  };
  const gpu::Capabilities& limits = device().capabilities();
  const uint64_t words = limits.maxBufferSize / 4 + 1;
  EXPECT_EQ(errorFor(words, graph::UseTransfer),
            "node.out needs " + std::to_string(words * 4) + " B, more than this device's largest buffer of " +
                std::to_string(limits.maxBufferSize) + " B: at most 99 % of it fits; use a smaller resolution or scene");
  if (limits.maxStorageBufferRange < limits.maxBufferSize) {
    const uint64_t bindable = limits.maxStorageBufferRange / 4 + 1;
    EXPECT_EQ(errorFor(bindable, graph::UseCompute),
              "node.out needs " + std::to_string(bindable * 4) + " B, more than this device's largest storage buffer binding of " +
                  std::to_string(limits.maxStorageBufferRange) + " B: at most 99 % of it fits; use a smaller resolution or scene");
  }
  EXPECT_NE(errorFor(uint64_t{1} << 63, graph::UseTransfer).find("does not fit in 64 bits"), std::string::npos);
}

TEST_F(ExecutorMemoryTest, ImagesBeyondTheDeviceNamePortSizeAndLimit) {
  NodeHarness h(device());
  const uint64_t side = uint64_t{device().capabilities().maxImageDimension2D} + 1;
  addFake(h.graph(), "node", [&](Declaration& d) { d.write("out", Shape::image(VK_FORMAT_R32_UINT, side, 1), "texels"); });
  h.output("node.out");
  try {
    h.run();
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::OutOfMemory);
    EXPECT_EQ(std::string(e.what()), "node.out needs " + std::to_string(side) + " texels a row, this device's limit is " +
                                         std::to_string(side - 1) + "; use a smaller size");
  }
}

/// A graph with everything that allocates: counts, host steps that grow, scratch, persistent buffers, images.
void addEverything(NodeHarness& h) {
  addFill(h.graph(), "fill", 256);
  addThroughScratch(h.graph(), "scratch", 256);
  addCounter(h.graph(), "counter", "items");
  FakeNode& grow = addFake(h.graph(), "grow", [](Declaration& d) {
    d.write("entries", {}, "words", graph::UseTransfer).growable = true;
    d.write("log", Shape::buffer(4, Extent::of("items")), "words", graph::UseTransfer).persistent = true;
    d.scratch("temporary", Shape::buffer(4, Extent::of("items")), "words", graph::UseTransfer);
    d.publishCount("entries", "", 0);
    d.hostPaced();
  });
  grow.onStepCount = [](RecordContext&) { return 2u; };
  grow.onRecord = [](RecordContext& c) {
    if (c.step() == 0) c.clearGrown("entries");
    c.commands().fill(c.grow("entries", 64), 9);
    c.commands().fill(c.buffer("log"), 3);
  };
  grow.onStepDone = [](RecordContext& c) { c.setCount("entries", c.grown("entries").size() * 16); };
  addFake(
      h.graph(), "last",
      [](Declaration& d) {
        d.read("entries", "words", graph::UseTransfer);
        d.read("in", "words");
        d.write("out", Shape::buffer(4, Extent::of("entries")), "words", graph::UseTransfer);
        d.write("picture", Shape::image(VK_FORMAT_R32_UINT, 4, 4), "texels").persistent = true;
      },
      [](RecordContext& c) {
        VkDeviceSize offset = 0;
        for (const gpu::Buffer* buffer : c.grown("entries")) {
          c.commands().copy(*buffer, c.buffer("out"), 64, 0, offset);
          offset += 64;
        }
      });
  h.connect("fill.out", "scratch.in");
  h.connect("scratch.out", "last.in");
  h.connect("grow.entries", "last.entries");
  h.output("last.out");
  h.output("last.picture");
  h.output("scratch.out");
}

TEST_F(ExecutorMemoryTest, RecoversFromEveryFailedAllocationAndSubmission) {
  // The n-th allocation or submission fails, for every n until none does. Each time the error is clean, nothing leaks (the fixture looks),
  // and the same executor then gives the right answer.
  uint32_t failures = 0;
  for (uint32_t n = 1; n < 200; ++n) {
    NodeHarness h(device());
    addEverything(h);
    h.set("counter.value", "40");
    h.set("fill.value", "7");
    bool failed = false;
    device().failAfter(n);
    try {
      h.run();
    } catch (const Error& e) {
      failed = true;
      ++failures;
      EXPECT_NE(std::string(e.what()), "");
    }
    device().failAfter(0);
    if (failed) h.run();
    EXPECT_EQ(h.download<uint32_t>("last.out"), repeat(32, 9)) << n;
    EXPECT_EQ(h.download<uint32_t>("scratch.out"), repeat(256, 8)) << n;
    EXPECT_EQ(h.downloadImage<uint32_t>("last.picture"), repeat(16, 0)) << n;
    if (!failed) break;
  }
  EXPECT_GT(failures, 10u) << "the hook did not reach the executor";
  EXPECT_LT(failures, 199u);
}

TEST_F(ExecutorMemoryTest, RecoversFromAFailureInALaterRun) {
  // After one good run, all inputs change and the n-th step of the second run fails.
  uint32_t failures = 0;
  for (uint32_t n = 1; n < 200; ++n) {
    NodeHarness h(device());
    addEverything(h);
    h.set("counter.value", "40");
    h.run();
    h.set("counter.value", "50");
    h.set("fill.value", "20");
    bool failed = false;
    device().failAfter(n);
    try {
      h.run();
    } catch (const Error&) {
      failed = true;
      ++failures;
    }
    device().failAfter(0);
    if (failed) h.run();
    EXPECT_EQ(h.download<uint32_t>("last.out"), repeat(32, 9)) << n;
    EXPECT_EQ(h.download<uint32_t>("scratch.out"), repeat(256, 21)) << n;
    if (!failed) break;
  }
  EXPECT_GT(failures, 5u);
  EXPECT_LT(failures, 199u);
}

TEST_F(ExecutorMemoryTest, ANodeThatThrowsLeavesTheExecutorUsable) {
  NodeHarness h(device());
  bool fail = true;
  addFill(h.graph(), "fill");
  addModify(h.graph(), "modify");
  addFake(
      h.graph(), "node",
      [](Declaration& d) {
        d.read("in", "words", graph::UseTransfer);
        d.write("out", Shape::buffer(4, 4), "words", graph::UseTransfer);
        d.write("picture", Shape::image(VK_FORMAT_R32_UINT, 4, 4), "texels").persistent = true;
        d.write("plain", Shape::image(VK_FORMAT_R32_UINT, 4, 4), "texels", graph::UseAttachment);
      },
      [&fail](RecordContext& c) {
        if (fail) throw Error(ErrorCode::Unsupported, "not yet");
        // Only right if the layout is what the device has, not what was recorded in vain.
        gpu::Commands::Attachment target{&c.image("plain"), 0, true, {}};
        target.clearValue.color.uint32[0] = 3;
        c.commands().beginRendering({4, 4}, std::span(&target, 1), nullptr);
        c.commands().endRendering();
        c.commands().copy(c.buffer("in"), c.buffer("out"), 16);
      });
  h.connect("fill.out", "modify.data");
  h.connect("modify.data", "node.in");
  h.output("node.out");
  h.output("node.picture");
  h.output("node.plain");
  h.set("fill.value", "50");
  EXPECT_THROW(h.run(), Error);
  EXPECT_THROW(h.run(), Error);
  fail = false;
  h.run();
  EXPECT_EQ(h.download<uint32_t>("node.out"), repeat(4, 51)) << "not modified once per attempt";
  EXPECT_EQ(h.downloadImage<uint32_t>("node.picture"), repeat(16, 0));
  EXPECT_EQ(h.downloadImage<uint32_t>("node.plain"), repeat(16, 3));
}

}  // namespace
}  // namespace radivox::oracles
