// Whole plans as text: order, segments, lifetimes, aliasing, barriers. And the parts that have an answer of their own.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/graph/fake_node.h"

namespace radivox::oracles {
namespace {

using graph::Counts;
using graph::Declaration;
using graph::Extent;
using graph::Graph;
using graph::Plan;
using graph::Shape;

Shape words(Extent count) { return Shape::buffer(4, std::move(count)); }

/// A small voxel method: one count from the GPU, one host-paced node, one image, one persistent port, one modified image.
Graph sampleGraph() {
  Graph g;
  addFake(g, "voxelize", [](Declaration& d) {
    d.read("scene.vertices", "vertices");
    d.write("occupancy", words(Extent::of("bricks") * 2), "bits per voxel", graph::UseCompute);
    d.write("count", words(4), "number of voxels", graph::UseCompute);
    d.scratch("keys", words(Extent::of("triangles")), "sort keys");
    d.scratch("small", words(1), "total");
    d.publishCount("voxels", "count", 4);
  }).typeName = "test.voxelize";
  addFake(g, "index", [](Declaration& d) {
    d.read("occupancy", "bits per voxel");
    d.write("rank", words(Extent::of("bricks")), "voxels before the brick");
    d.scratch("sums", words(Extent::of("bricks") / 64 + 1), "block sums");
  }).typeName = "test.index";
  addFake(g, "visibility", [](Declaration& d) {
    d.read("rank", "voxels before the brick");
    d.write("entries", {}, "what is seen").growable = true;
    d.write("rows", words(Extent::of("voxels") + 1), "first entry");
    d.publishCount("entries", "", 0);
    d.hostPaced();
  }).typeName = "test.visibility";
  addFake(g, "gather", [](Declaration& d) {
    d.read("entries", "what is seen");
    d.read("rows", "first entry");
    d.write("irradiance", words(Extent::of("voxels") * 4), "E, W/m²").persistent = true;
    d.scratch("list", words(Extent::of("voxels")), "faces to do");
  }).typeName = "test.gather";
  addFake(g, "shade", [](Declaration& d) {
    d.read("irradiance", "E, W/m²", graph::UseRaster);
    d.write("color", Shape::image(VK_FORMAT_R32G32B32A32_SFLOAT, Extent::of("width"), Extent::of("height")), "radiance",
            graph::UseAttachment);
    d.scratch("tiles", words(Extent::of("width") * "height"), "tile list");
    d.runEveryFrame();
  }).typeName = "test.shade";
  addFake(g, "overlay", [](Declaration& d) {
    d.modify("color", "radiance");
    d.readBack("histogram", words(64), "pixels per bin");
  }).typeName = "test.overlay";
  addFake(g, "unused", [](Declaration& d) { d.write("out", words(4), "words"); }).typeName = "test.unused";
  g.connect("voxelize.occupancy", "index.occupancy");
  g.connect("index.rank", "visibility.rank");
  g.connect("visibility.entries", "gather.entries");
  g.connect("visibility.rows", "gather.rows");
  g.connect("gather.irradiance", "shade.irradiance");
  g.connect("shade.color", "overlay.color");
  g.output("overlay.color");
  return g;
}

PlanInput sampleInput() {
  PlanInput input;
  input.imports = {{"scene.vertices", Shape::buffer(40, Extent::of("vertices"))}};
  input.counts = {{"bricks", 4096}, {"triangles", 1000}, {"vertices", 500}, {"width", 64}, {"height", 32}};
  return input;
}

TEST(PlanText, Golden) {
  const Plan plan = sampleInput().compile(sampleGraph());
  EXPECT_EQ(plan.printText(sampleInput().counts), R"(plan: 6 nodes in 3 segments, 1 left out
segment 0
  0 voxelize (test.voxelize), on change
      read scene.vertices ← scene.vertices
      write occupancy: 4 B × 2·bricks = 32768 B
      write count: 4 B × 4 = 16 B
      scratch keys: 4 B × triangles = 4000 B, slot 0
      scratch small: 4 B × 1 = 4 B, slot 1
      count voxels from count + 4 B
  1 index (test.index), on change
      barrier voxelize.occupancy: write compute → read compute
      barrier slot 0: write compute|transfer → write compute|transfer
      read occupancy ← voxelize.occupancy
      write rank: 4 B × bricks = 16384 B
      scratch sums: 4 B × bricks/64+1 = 260 B, slot 0
segment 1
  2 visibility (test.visibility), on change, host-paced
      barrier index.rank: write compute|transfer → read compute
      read rank ← index.rank
      write entries: grows
      write rows: 4 B × voxels+1 = ? B
      count entries from the host
segment 2
  3 gather (test.gather), on change
      barrier visibility.entries: write compute|transfer → read compute
      barrier visibility.rows: write compute|transfer → read compute
      read entries ← visibility.entries
      read rows ← visibility.rows
      write irradiance: 4 B × 4·voxels = ? B, persistent
      scratch list: 4 B × voxels = ? B, slot 2
  4 shade (test.shade), every frame
      barrier gather.irradiance: write compute|transfer → read raster
      barrier slot 2: write compute|transfer → write compute|transfer
      read irradiance ← gather.irradiance
      write color: RGBA32F width × height = 32768 B
      scratch tiles: 4 B × width·height = 8192 B, slot 2
  5 overlay (test.overlay), on change
      barrier shade.color: write attach → write compute
      modify color ← shade.color v0 → v1
      read back histogram: 4 B × 64 = 256 B
left out
  unused (test.unused): no reader of unused.out
shared scratch memory
  slot 0, segment 0, 4000 B: voxelize.keys, index.sums
  slot 1, segment 0, 4 B: voxelize.small
  slot 2, segment 2, at least 8192 B: gather.list, shade.tiles
memory (of what is known before the first run): kept 81936 B, scratch 12196 B (12456 B unshared), host 256 B, imported 20000 B
)");
}

TEST(PlanText, CountsFillIn) {
  PlanInput input = sampleInput();
  const Plan plan = input.compile(sampleGraph());
  input.counts["voxels"] = 300;
  input.counts["entries"] = 5;
  const std::string text = plan.printText(input.counts);
  EXPECT_NE(text.find("write rows: 4 B × voxels+1 = 1204 B\n"), std::string::npos) << text;
  EXPECT_NE(text.find("count voxels from count + 4 B = 300\n"), std::string::npos) << text;
  EXPECT_NE(text.find("count entries from the host = 5\n"), std::string::npos) << text;
}

TEST(PlanText, SameGraphSameText) {
  const PlanInput input = sampleInput();
  EXPECT_EQ(input.compile(sampleGraph()).printText(input.counts), input.compile(sampleGraph()).printText(input.counts));
}

TEST(PlanDot, Golden) {
  Graph g;
  addFake(g, "a", [](Declaration& d) {
    d.read("scene.info", "scene");
    d.write("out", words(4), "words");
  });
  addFake(g, "b", [](Declaration& d) { d.modify("data", "words"); });
  addFake(g, "c", [](Declaration& d) { d.read("in", "words"); });
  addFake(g, "off", [](Declaration& d) { d.leaveOut("a \"reason\""); });
  g.connect("a.out", "b.data");
  g.connect("b.data", "c.in");
  PlanInput input;
  input.imports = {{"scene.info", words(1)}};
  EXPECT_EQ(input.compile(g).printDot(), R"(digraph plan {
  rankdir=LR;
  node [shape=box];
  subgraph cluster_0 {
    label="segment 0";
    "a" [tooltip="test.fake, on change"];
    "b" [tooltip="test.fake, on change"];
    "c" [tooltip="test.fake, on change"];
  }
  "scene.info" [shape=ellipse];
  "scene.info" -> "a" [label="scene.info"];
  "a" -> "b" [label="data", style=bold];
  "b" -> "c" [label="in"];
  "off" [style=dotted, tooltip="a \"reason\""];
}
)");
}

TEST(PlanJson, HoldsWhatTheTextHolds) {
  const PlanInput input = sampleInput();
  const auto json = nlohmann::json::parse(input.compile(sampleGraph()).printJson(input.counts));
  EXPECT_EQ(json["segments"], 3);
  EXPECT_EQ(json["steps"].size(), 6u);
  EXPECT_EQ(json["steps"][2]["node"], "visibility");
  EXPECT_EQ(json["steps"][2]["host_paced"], true);
  EXPECT_EQ(json["steps"][2]["segment"], 1);
  EXPECT_EQ(json["steps"][4]["runs"], "every frame");
  EXPECT_EQ(json["steps"][5]["barriers"][0]["resource"], "shade.color");
  EXPECT_EQ(json["steps"][5]["barriers"][0]["from"], "write attach");
  EXPECT_EQ(json["left_out"][0]["node"], "unused");
  EXPECT_EQ(json["memory"]["kept"], 81936);
  EXPECT_EQ(json["memory"]["complete"], false);
  const auto& resources = json["resources"];
  const auto find = [&](const std::string& name) {
    for (const auto& r : resources) {
      if (r["name"] == name) return r;
    }
    return nlohmann::json();
  };
  EXPECT_EQ(find("voxelize.keys")["alias_slot"], find("index.sums")["alias_slot"]);
  EXPECT_EQ(find("voxelize.occupancy")["first_use"], 0);
  EXPECT_EQ(find("voxelize.occupancy")["last_use"], 1);
  EXPECT_TRUE(find("visibility.entries")["bytes"].is_null());
  EXPECT_EQ(find("shade.color")["output"], true);
  EXPECT_EQ(find("gather.irradiance")["persistent"], true);
}

// Order ------------------------------------------------------------------------------------------------------------------------------

std::string orderOf(const Plan& plan) {
  std::string text;
  for (const auto& step : plan.steps) text += (text.empty() ? "" : " ") + plan.nodeNames[step.node] + "/" + std::to_string(step.segment);
  return text;
}

void addPass(Graph& g, const std::string& name, const std::vector<std::string>& from) {
  addFake(g, name, [from](Declaration& d) {
    for (size_t i = 0; i < from.size(); ++i) d.read("in" + std::to_string(i), "words");
    d.write("out", words(4), "words");
  });
  for (size_t i = 0; i < from.size(); ++i) g.connect(from[i] + ".out", name + ".in" + std::to_string(i));
  g.output(name + ".out");
}

TEST(PlanOrder, InsertionOrderWhereEdgesAllowIt) {
  //  z ──▶ y ──▶ x,   a and b alone: what is added first goes first, as soon as it can
  Graph g;
  addPass(g, "x", {"y"});
  addPass(g, "a", {});
  addPass(g, "y", {"z"});
  addPass(g, "z", {});
  addPass(g, "b", {});
  EXPECT_EQ(orderOf(PlanInput().compile(g)), "a/0 z/0 y/0 x/0 b/0");
}

TEST(PlanOrder, NothingMovesThatIsInOrder) {
  Graph g;
  addPass(g, "a", {});
  addPass(g, "b", {});
  addPass(g, "c", {"a"});
  addPass(g, "d", {"b", "c"});
  addPass(g, "e", {});
  EXPECT_EQ(orderOf(PlanInput().compile(g)), "a/0 b/0 c/0 d/0 e/0");
}

void addCounter(Graph& g, const std::string& name, const std::string& count) {
  addFake(g, name, [count](Declaration& d) {
    d.write("out", words(4), "words");
    d.publishCount(count, "out", 0);
  });
}

TEST(PlanSegments, RiseOnlyWhereACountIsNeeded) {
  //  a publishes n, b publishes m, c is shaped by both, d by n: one stop serves all
  Graph g;
  addCounter(g, "a", "n");
  addCounter(g, "b", "m");
  addFake(g, "c", [](Declaration& d) { d.write("out", words(Extent::of("n") * "m"), "words"); });
  addFake(g, "d", [](Declaration& d) { d.write("out", words(Extent::of("n")), "words"); });
  g.output("c.out");
  g.output("d.out");
  EXPECT_EQ(orderOf(PlanInput().compile(g)), "a/0 b/0 c/1 d/1");
}

TEST(PlanSegments, ScratchAndReadBackAndImagesAreShapedToo) {
  for (int kind = 0; kind < 3; ++kind) {
    Graph g;
    addCounter(g, "a", "n");
    addFake(g, "b", [kind](Declaration& d) {
      d.write("out", words(1), "words");
      if (kind == 0) d.scratch("s", words(Extent::of("n")), "words");
      if (kind == 1) d.readBack("r", words(Extent::of("n")), "words");
      if (kind == 2) d.write("i", Shape::image(VK_FORMAT_R32_UINT, 4, 4, Extent::of("n"), true), "layers");
    });
    g.output("b.out");
    EXPECT_EQ(orderOf(PlanInput().compile(g)), "a/0 b/1") << kind;
  }
}

TEST(PlanSegments, AnAbsentOptionalPortNeedsNoStop) {
  Graph g;
  addCounter(g, "a", "n");
  addFake(g, "b", [](Declaration& d) {
    d.write("out", words(1), "words");
    d.write("more", words(Extent::of("n")), "words").optional = true;
  });
  g.output("a.out");
  g.output("b.out");
  EXPECT_EQ(orderOf(PlanInput().compile(g)), "a/0 b/0");
  g.output("b.more");
  EXPECT_EQ(orderOf(PlanInput().compile(g)), "a/0 b/1");
}

TEST(PlanSegments, HostPacedNodesStandAlone) {
  Graph g;
  addPass(g, "a", {});
  addFake(g, "h", [](Declaration& d) {
    d.read("in", "words");
    d.write("out", words(1), "words");
    d.hostPaced();
  });
  g.connect("a.out", "h.in");
  g.output("h.out");
  addPass(g, "b", {});
  addPass(g, "c", {});
  EXPECT_EQ(orderOf(PlanInput().compile(g)), "a/0 h/1 b/2 c/2");
}

// Aliasing ---------------------------------------------------------------------------------------------------------------------------

TEST(PlanAliasing, LargeMeetsLargeAndOneNodeNeverSharesWithItself) {
  Graph g;
  addFake(g, "a", [](Declaration& d) {
    d.scratch("small", words(8), "");
    d.scratch("large", words(1000), "");
    d.write("out", words(1), "");
  });
  addFake(g, "b", [](Declaration& d) {
    d.scratch("large", words(2000), "");
    d.scratch("small", words(4), "");
    d.scratch("picture", Shape::image(VK_FORMAT_R32_UINT, 8, 8), "");
    d.write("out", words(1), "");
  });
  g.output("a.out");
  g.output("b.out");
  const Plan plan = PlanInput().compile(g);
  const auto slot = [&](const char* node, const char* port) { return plan.resources[plan.findPort(node, port)->resource].aliasSlot; };
  EXPECT_EQ(slot("a", "large"), slot("b", "large"));
  EXPECT_EQ(slot("a", "small"), slot("b", "small"));
  EXPECT_NE(slot("a", "large"), slot("a", "small"));
  EXPECT_NE(slot("b", "picture"), slot("b", "large")) << "images and buffers may need different kinds of memory";
  EXPECT_NE(slot("b", "picture"), slot("b", "small"));
}

TEST(PlanAliasing, SegmentsDoNotShare) {
  Graph g;
  addFake(g, "a", [](Declaration& d) {
    d.scratch("s", words(8), "");
    d.write("out", words(1), "");
    d.publishCount("n", "out", 0);
  });
  addFake(g, "b", [](Declaration& d) {
    d.scratch("s", words(8), "");
    d.write("out", words(Extent::of("n")), "");
  });
  g.output("b.out");
  const Plan plan = PlanInput().compile(g);
  EXPECT_NE(plan.resources[plan.findPort("a", "s")->resource].aliasSlot, plan.resources[plan.findPort("b", "s")->resource].aliasSlot);
}

TEST(PlanAliasing, ScratchLiesInAnOutputThatIsWrittenAfterIt) {
  Graph g;
  addFake(g, "source", [](Declaration& d) { d.write("out", words(9), ""); });
  addFake(g, "a", [](Declaration& d) {
    d.read("in", "");
    d.scratch("one", words(1000), "");
    d.scratch("other", words(1000), "");
    d.scratch("kept", words(500), "");
    d.write("out", words(1), "");
  });
  addFake(g, "between", [](Declaration& d) {
    d.read("in", "");
    d.write("out", words(500), "").persistent = true;
  });
  addFake(g, "b", [](Declaration& d) {
    d.read("in", "");
    d.write("out", words(1000), "");
  });
  // Runs without a: what it wrote may still be read when a runs again.
  addFake(g, "beside", [](Declaration& d) {
    d.read("in", "");
    d.write("out", words(1000), "");
  });
  g.connect("source.out", "a.in");
  g.connect("a.out", "between.in");
  g.connect("between.out", "b.in");
  g.connect("source.out", "beside.in");
  g.output("b.out");
  g.output("beside.out");
  const Plan plan = PlanInput().compile(g);
  const auto resource = [&](const char* node, const char* port) { return plan.resources[plan.findPort(node, port)->resource]; };
  EXPECT_EQ(resource("a", "one").lender, plan.findPort("b", "out")->resource);
  EXPECT_EQ(resource("a", "one").aliasSlot, graph::kNoSlot);
  EXPECT_EQ(resource("a", "other").lender, graph::kNoResource) << "it is lent once";
  EXPECT_NE(resource("a", "other").aliasSlot, graph::kNoSlot);
  EXPECT_EQ(resource("a", "kept").lender, graph::kNoResource) << "what is persistent is never lent";
  const std::string text = plan.printText({});
  EXPECT_NE(text.find("scratch one: 4 B × 1000 = 4000 B, in b.out"), std::string::npos) << text;
  EXPECT_NE(text.find("barrier b.out: write"), std::string::npos) << text;
}

// Barriers ---------------------------------------------------------------------------------------------------------------------------

TEST(PlanBarriers, OncePerUseAfterAWrite) {
  //  a ──▶ b, c (compute), d (raster): b's barrier serves c, d needs its own
  Graph g;
  addFake(g, "a", [](Declaration& d) { d.write("out", words(1), "", graph::UseCompute); });
  for (const char* name : {"b", "c"}) {
    addFake(g, name, [](Declaration& d) { d.read("in", ""); });
    g.connect("a.out", std::string(name) + ".in");
  }
  addFake(g, "d", [](Declaration& d) { d.read("in", "", graph::UseRaster); });
  g.connect("a.out", "d.in");
  const Plan plan = PlanInput().compile(g);
  EXPECT_EQ(plan.steps[0].barriers.size(), 0u);
  EXPECT_EQ(plan.steps[1].barriers.size(), 1u);
  EXPECT_EQ(plan.steps[2].barriers.size(), 0u);
  ASSERT_EQ(plan.steps[3].barriers.size(), 1u);
  EXPECT_EQ(plan.steps[3].barriers[0].fromUse, uint32_t{graph::UseCompute});
  EXPECT_EQ(plan.steps[3].barriers[0].toUse, uint32_t{graph::UseRaster});
}

TEST(PlanBarriers, AWriteWaitsForReads) {
  //  import ──▶ reader;  import ──▶ writer would be a dead version: modify after a chain of reads instead
  //  a ──▶ m (modify) ──▶ b ;  m waits for a's write, b for m's
  Graph g;
  addFake(g, "a", [](Declaration& d) { d.write("out", words(1), "", graph::UseTransfer); });
  addFake(g, "m", [](Declaration& d) { d.modify("data", "", graph::UseCompute); });
  addFake(g, "b", [](Declaration& d) { d.read("in", "", graph::UseIndirect); });
  g.connect("a.out", "m.data");
  g.connect("m.data", "b.in");
  const Plan plan = PlanInput().compile(g);
  ASSERT_EQ(plan.steps[1].barriers.size(), 1u);
  EXPECT_TRUE(plan.steps[1].barriers[0].writeBefore);
  EXPECT_TRUE(plan.steps[1].barriers[0].writeAfter);
  ASSERT_EQ(plan.steps[2].barriers.size(), 1u);
  EXPECT_EQ(plan.steps[2].barriers[0].fromUse, uint32_t{graph::UseCompute});
  EXPECT_FALSE(plan.steps[2].barriers[0].writeAfter);
}

// Shapes -----------------------------------------------------------------------------------------------------------------------------

TEST(Shapes, EvaluateRoundsUpAndAdds) {
  const Counts counts{{"faces", 65}, {"width", 3}};
  EXPECT_EQ((Extent::of("faces") / 32).evaluate(counts), 3u);
  EXPECT_EQ((Extent::of("faces") / 32 + 1).evaluate(counts), 4u);
  EXPECT_EQ((Extent::of("faces") * 4 + 2).evaluate(counts), 262u);
  EXPECT_EQ((Extent::of("faces") * "width").evaluate(counts), 195u);
  EXPECT_EQ(Extent(7).evaluate({}), 7u);
  EXPECT_EQ((Extent::of("faces") / 32).evaluate({{"faces", 0}}), 0u);
  EXPECT_FALSE(Extent::of("clusters").evaluate(counts).has_value());
}

TEST(Shapes, OverflowIsAnErrorNotASmallNumber) {
  const Counts counts{{"n", uint64_t{1} << 40}};
  EXPECT_THROW((Extent::of("n") * "n").evaluate(counts), Error);
  EXPECT_THROW((Extent::of("n") * (uint64_t{1} << 23) + (uint64_t{1} << 63)).evaluate(counts), Error);
}

TEST(Shapes, Print) {
  EXPECT_EQ((Extent::of("faces") * 4 / 32 + 64).print(), "4·faces/32+64");
  EXPECT_EQ(Extent(3).print(), "3");
  EXPECT_EQ(Shape::buffer(24, Extent::of("faces")).print(), "24 B × faces");
  EXPECT_EQ(Shape::image(VK_FORMAT_D32_SFLOAT, 16, 16, Extent::of("views"), true).print(), "D32F 16 × 16 × views");
}

}  // namespace
}  // namespace radivox::oracles
