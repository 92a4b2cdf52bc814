// The executor on a device, with nodes that only fill and copy, so that what is in a buffer says who ran and when.
#include <gtest/gtest.h>

#include "tests/graph/fake_node.h"
#include "tests/oracles/gpu_fixture.h"
#include "tests/oracles/node_harness.h"

namespace radivox::oracles {
namespace {

using graph::Declaration;
using graph::Extent;
using graph::RecordContext;
using graph::Shape;

class ExecutorTest : public GpuTest {};

/// Writes `out`, 4 words of its parameter `value`.
FakeNode& addFill(graph::Graph& graph, const std::string& name, Extent words = 4) {
  FakeNode& node = addFake(graph, name, [words](Declaration& d) { d.write("out", Shape::buffer(4, words), "words", graph::UseTransfer); });
  node.onRecord = [&node](RecordContext& c) { c.commands().fill(c.buffer("out"), node.value); };
  return node;
}

/// Copies `in` to `out`.
FakeNode& addCopy(graph::Graph& graph, const std::string& name, Extent words = 4) {
  return addFake(
      graph, name,
      [words](Declaration& d) {
        d.read("in", "words", graph::UseTransfer);
        d.write("out", Shape::buffer(4, words), "words", graph::UseTransfer);
      },
      [](RecordContext& c) {
        c.commands().copy(c.buffer("in"), c.buffer("out"), std::min(c.buffer("in").bytes(), c.buffer("out").bytes()));
      });
}

TEST_F(ExecutorTest, RunsOnlyWhatChanged) {
  NodeHarness h(device());
  addFill(h.graph(), "a");
  addFill(h.graph(), "b");
  addCopy(h.graph(), "copy_a");
  addCopy(h.graph(), "copy_b");
  h.connect("a.out", "copy_a.in");
  h.connect("b.out", "copy_b.in");
  h.output("copy_a.out");
  h.output("copy_b.out");
  h.set("a.value", "7");
  h.run();
  EXPECT_EQ(h.download<uint32_t>("copy_a.out"), std::vector<uint32_t>(4, 7));
  EXPECT_EQ(h.download<uint32_t>("copy_b.out"), std::vector<uint32_t>(4, 1));
  h.run();
  EXPECT_EQ(h.runCount("a"), 1u);
  EXPECT_EQ(h.runCount("copy_a"), 1u);
  h.set("b.value", "9");
  h.run();
  EXPECT_EQ(h.runCount("a"), 1u);
  EXPECT_EQ(h.runCount("copy_a"), 1u);
  EXPECT_EQ(h.runCount("b"), 2u);
  EXPECT_EQ(h.runCount("copy_b"), 2u);
  EXPECT_EQ(h.download<uint32_t>("copy_a.out"), std::vector<uint32_t>(4, 7));
  EXPECT_EQ(h.download<uint32_t>("copy_b.out"), std::vector<uint32_t>(4, 9));
}

}  // namespace
}  // namespace radivox::oracles
