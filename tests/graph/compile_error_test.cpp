// Graphs that compile() refuses. All errors of a graph come in one message, each with its place and, where there is one, the near name.
#include <gtest/gtest.h>

#include "tests/graph/fake_node.h"

namespace radivox::oracles {
namespace {

using graph::Declaration;
using graph::Extent;
using graph::Graph;
using graph::Shape;

const Shape kWords = Shape::buffer(4, 4);
const Shape kImage = Shape::image(VK_FORMAT_R32G32B32A32_SFLOAT, 8, 8);

void addSource(Graph& graph, const std::string& name) {
  addFake(graph, name, [](Declaration& d) { d.write("out", kWords, "words"); });
}
void addPass(Graph& graph, const std::string& name) {
  addFake(graph, name, [](Declaration& d) {
    d.read("in", "words");
    d.write("out", kWords, "words");
  });
}
void addModify(Graph& graph, const std::string& name) {
  addFake(graph, name, [](Declaration& d) { d.modify("data", "words"); });
}
void addSink(Graph& graph, const std::string& name) {
  addFake(graph, name, [](Declaration& d) { d.read("in", "words"); });
}

TEST(ForbiddenGraph, UnknownNode) {
  //  source ──▶ sink      (edge says "sorce")
  Graph g;
  addSource(g, "source");
  addSink(g, "sink");
  g.connect("sorce.out", "sink.in");
  EXPECT_EQ(PlanInput().error(g), "graph: edge sorce.out → sink.in: no node is named sorce, no import sorce.out; did you mean source?");
}

TEST(ForbiddenGraph, UnknownTarget) {
  Graph g;
  addSource(g, "source");
  addSink(g, "sink");
  g.connect("source.out", "sink.in");
  g.connect("source.out", "snik.in");
  EXPECT_EQ(PlanInput().error(g), "graph: edge source.out → snik.in: no node is named snik; did you mean sink?");
}

TEST(ForbiddenGraph, UnknownPort) {
  //  source.uot ──▶ sink.in
  Graph g;
  addSource(g, "source");
  addSink(g, "sink");
  g.connect("source.uot", "sink.in");
  EXPECT_EQ(PlanInput().error(g), "graph: edge source.uot → sink.in: source has no port uot; did you mean out?");
}

TEST(ForbiddenGraph, UnknownPortWithoutNearName) {
  Graph g;
  addSource(g, "source");
  addSink(g, "sink");
  g.connect("source.irradiance", "sink.in");
  EXPECT_EQ(PlanInput().error(g), "graph: edge source.irradiance → sink.in: source has no port irradiance; it has out");
}

TEST(ForbiddenGraph, ReadConnectedToRead) {
  //  sink.in ──▶ other.in
  Graph g;
  addSource(g, "source");
  addSink(g, "sink");
  addSink(g, "other");
  g.connect("source.out", "sink.in");
  g.connect("sink.in", "other.in");
  EXPECT_EQ(PlanInput().error(g), "graph: edge sink.in → other.in: sink.in is an input; an edge starts at an output");
}

TEST(ForbiddenGraph, WriteConnectedToWrite) {
  //  a.out ──▶ b.out
  Graph g;
  addSource(g, "a");
  addSource(g, "b");
  g.connect("a.out", "b.out");
  EXPECT_EQ(PlanInput().error(g), "graph: edge a.out → b.out: b.out is an output; an edge ends at an input");
}

TEST(ForbiddenGraph, ScratchIsPrivate) {
  Graph g;
  addFake(g, "a", [](Declaration& d) { d.scratch("temporary", kWords, "words"); });
  addSink(g, "sink");
  g.connect("a.temporary", "sink.in");
  g.output("a.temporary");
  EXPECT_EQ(PlanInput().error(g),
            "graph: edge a.temporary → sink.in: a.temporary is scratch memory, private to its node; an edge starts at an output; "
            "output a.temporary: it is scratch memory, private to its node");
}

TEST(ForbiddenGraph, TwoProducers) {
  //  a ──┐
  //      ├──▶ sink.in
  //  b ──┘
  Graph g;
  addSource(g, "a");
  addSource(g, "b");
  addSink(g, "sink");
  g.connect("a.out", "sink.in");
  g.connect("b.out", "sink.in");
  EXPECT_EQ(PlanInput().error(g), "graph: sink.in has two producers: a.out and b.out; remove one edge");
}

TEST(ForbiddenGraph, RequiredInputUnconnected) {
  Graph g;
  addSink(g, "sink");
  EXPECT_EQ(PlanInput().error(g), "graph: sink.in is not connected");
}

TEST(ForbiddenGraph, UnconnectedEvenWhereNobodyReadsTheNode) {
  Graph g;
  addPass(g, "lonely");
  EXPECT_EQ(PlanInput().error(g), "graph: lonely.in is not connected");
}

TEST(ForbiddenGraph, MissingImport) {
  Graph g;
  addFake(g, "sink", [](Declaration& d) { d.read("scene.vertices", "vertices"); });
  PlanInput input;
  input.imports = {{"scene.vertex", kWords}};
  EXPECT_EQ(input.error(g),
            "graph: sink.scene.vertices needs the import scene.vertices, which the host does not give; it gives scene.vertex");
}

TEST(ForbiddenGraph, ImportAndNodeOfOneName) {
  Graph g;
  addSource(g, "host");
  addSink(g, "sink");
  g.connect("host.out", "sink.in");
  PlanInput input;
  input.imports = {{"host.out", kWords}};
  EXPECT_EQ(input.error(g), "graph: edge host.out → sink.in: host is a node and host.out an import; rename the node");
}

TEST(ForbiddenGraph, KindsDiffer) {
  //  source.out (buffer) ──▶ sink.in (image)
  Graph g;
  addSource(g, "source");
  addFake(g, "picture", [](Declaration& d) { d.write("out", kImage, "picture"); });
  addFake(g, "sink", [](Declaration& d) { d.read("in", "a picture").kind = graph::ResourceKind::Image; });
  addFake(g, "draw", [](Declaration& d) { d.modify("target", "a picture", graph::UseAttachment); });
  addFake(g, "dispatch", [](Declaration& d) { d.read("arguments", "indirect arguments", graph::UseIndirect); });
  g.connect("source.out", "sink.in");
  g.connect("source.out", "draw.target");
  g.connect("picture.out", "dispatch.arguments");
  const std::string error = PlanInput().error(g);
  EXPECT_NE(error.find("sink.in takes an image, source.out is a buffer"), std::string::npos) << error;
  EXPECT_NE(error.find("draw.target takes an image, source.out is a buffer"), std::string::npos) << error;
  EXPECT_NE(error.find("dispatch.arguments takes a buffer, picture.out is an image"), std::string::npos) << error;
}

TEST(ForbiddenGraph, KindFollowsModifyToTheFirstWriter) {
  //  picture ──▶ draw (modify) ──▶ sink.in (buffer)
  Graph g;
  addFake(g, "picture", [](Declaration& d) { d.write("out", kImage, "picture"); });
  addFake(g, "draw", [](Declaration& d) { d.modify("target", "a picture", graph::UseAttachment); });
  addFake(g, "sink", [](Declaration& d) { d.read("in", "words").kind = graph::ResourceKind::Buffer; });
  g.connect("picture.out", "draw.target");
  g.connect("draw.target", "sink.in");
  EXPECT_EQ(PlanInput().error(g), "graph: sink.in takes a buffer, draw.target is an image");
}

TEST(ForbiddenGraph, Cycle) {
  //  a ──▶ b ──▶ c ──┐
  //  ▲               │
  //  └───────────────┘
  Graph g;
  addPass(g, "a");
  addPass(g, "b");
  addPass(g, "c");
  g.connect("c.out", "a.in");
  g.connect("a.out", "b.in");
  g.connect("b.out", "c.in");
  g.output("c.out");
  EXPECT_EQ(PlanInput().error(g), "graph: cycle: a → b → c → a; remove one of these edges");
}

TEST(ForbiddenGraph, CycleOfOne) {
  //  a ──┐
  //  ▲   │
  //  └───┘
  Graph g;
  addPass(g, "a");
  g.connect("a.out", "a.in");
  g.output("a.out");
  EXPECT_EQ(PlanInput().error(g), "graph: cycle: a → a; remove one of these edges");
}

TEST(ForbiddenGraph, CycleThroughACount) {
  //  counter publishes "items" and reads what a node shaped by "items" writes:
  //  shaped ──▶ counter
  //     ▲          │ count items
  //     └──────────┘
  Graph g;
  addFake(g, "shaped", [](Declaration& d) { d.write("out", Shape::buffer(4, Extent::of("items")), "items"); });
  addFake(g, "counter", [](Declaration& d) {
    d.read("in", "items");
    d.write("count", kWords, "number");
    d.publishCount("items", "count", 0);
  });
  g.connect("shaped.out", "counter.in");
  g.output("counter.count");
  EXPECT_EQ(PlanInput().error(g), "graph: cycle: shaped → counter → shaped; remove one of these edges");
}

TEST(ForbiddenGraph, DeadVersionRead) {
  //  source v0 ──▶ modify ──▶ v1
  //      └───────▶ late           late would see v0 or v1, by chance of order
  Graph g;
  addSource(g, "source");
  addModify(g, "modify");
  addSink(g, "late");
  addSink(g, "good");
  g.connect("source.out", "modify.data");
  g.connect("source.out", "late.in");
  g.connect("modify.data", "good.in");
  EXPECT_EQ(PlanInput().error(g), "graph: late.in reads source.out, a version that modify modifies; read modify.data instead");
}

TEST(ForbiddenGraph, TwoModifyOneVersion) {
  //             ┌──▶ first
  //  source v0 ─┤
  //             └──▶ second
  Graph g;
  addSource(g, "source");
  addModify(g, "first");
  addModify(g, "second");
  g.connect("source.out", "first.data");
  g.connect("source.out", "second.data");
  g.output("first.data");
  g.output("second.data");
  EXPECT_EQ(PlanInput().error(g), "graph: first.data and second.data both modify source.out; chain them: one takes what the other gives");
}

TEST(ForbiddenGraph, DeadVersionAsOutput) {
  Graph g;
  addSource(g, "source");
  addModify(g, "modify");
  g.connect("source.out", "modify.data");
  g.output("source.out");
  g.output("modify.data");
  EXPECT_EQ(PlanInput().error(g), "graph: output source.out is a version that modify modifies; output modify.data instead");
}

TEST(ForbiddenGraph, CountThatNobodyPublishes) {
  Graph g;
  addFake(g, "a", [](Declaration& d) { d.write("out", Shape::buffer(4, Extent::of("triangels") * 3), "indices"); });
  g.output("a.out");
  PlanInput input;
  input.counts = {{"triangles", 7}};
  EXPECT_EQ(input.error(g), "graph: a.out is shaped by the count triangels, which nobody publishes; did you mean triangles?");
}

TEST(ForbiddenGraph, CountOfItsOwnNode) {
  Graph g;
  addFake(g, "a", [](Declaration& d) {
    d.write("count", kWords, "number");
    d.write("out", Shape::buffer(4, Extent::of("items")), "items");
    d.publishCount("items", "count", 0);
  });
  g.output("a.out");
  EXPECT_EQ(PlanInput().error(g), "graph: a.out is shaped by the count items, which its own node publishes");
}

TEST(ForbiddenGraph, CountOfTwoPublishers) {
  Graph g;
  for (const char* name : {"a", "b"}) {
    addFake(g, name, [](Declaration& d) {
      d.write("count", kWords, "number");
      d.publishCount("items", "count", 0);
    });
  }
  EXPECT_EQ(PlanInput().error(g), "graph: the count items is published by a and b");
}

TEST(ForbiddenGraph, CountFromWhatIsNoOutput) {
  Graph g;
  addFake(g, "a", [](Declaration& d) {
    d.write("out", kWords, "words");
    d.publishCount("items", "cuont", 0);
  });
  addFake(g, "b", [](Declaration& d) {
    d.write("out", kWords, "words");
    d.publishCount("things", "", 0);  // from the host, but not host-paced
  });
  EXPECT_EQ(PlanInput().error(g),
            "graph: a publishes the count items from \"cuont\", which is no output of it; "
            "b publishes the count things from \"\", which is no output of it");
}

TEST(ForbiddenGraph, FreeingWithoutHostSteps) {
  Graph g;
  addFake(g, "a", [](Declaration& d) { d.write("out", kWords, "words"); });
  addFake(g, "b", [](Declaration& d) {
    d.read("in", "words").frees = true;
    d.write("out", kWords, "words").frees = true;
  });
  g.connect("a.out", "b.in");
  g.output("b.out");
  EXPECT_EQ(PlanInput().error(g),
            "graph: b.in frees what it reads, but is no input of a host-paced node; "
            "b.out frees what it reads, but is no input of a host-paced node");
}

// A host that looks at what nodes hand on asks that nothing be freed.
TEST(Plan, KeepsAllWhereTheHostAsks) {
  Graph g;
  addFake(g, "a", [](Declaration& d) { d.write("out", kWords, "words"); });
  addFake(g, "b", [](Declaration& d) {
    d.read("in", "words").frees = true;
    d.write("out", kWords, "words");
    d.hostPaced();
  });
  g.connect("a.out", "b.in");
  g.output("b.out");
  PlanInput input;
  for (const bool keepsAll : {false, true}) {
    const graph::Plan plan = graph::compile(g, {input.traits, input.request, input.capabilities, {}, {}, keepsAll});
    const graph::PlannedPort* port = plan.findPort("b", "in");
    ASSERT_NE(port, nullptr);
    EXPECT_EQ(port->frees, !keepsAll);
    EXPECT_EQ(port->access, keepsAll ? graph::Access::Read : graph::Access::Modify);
  }
}

TEST(ForbiddenGraph, GrowingWithoutHostSteps) {
  Graph g;
  addFake(g, "a", [](Declaration& d) { d.write("entries", kWords, "words").growable = true; });
  g.output("a.entries");
  EXPECT_EQ(PlanInput().error(g), "graph: a.entries is growable, but a is not host-paced");
}

TEST(ForbiddenGraph, OnePortTwice) {
  Graph g;
  addFake(g, "a", [](Declaration& d) {
    d.write("out", kWords, "words");
    d.scratch("out", kWords, "words");
  });
  EXPECT_EQ(PlanInput().error(g), "graph: a declares the port out twice");
}

TEST(ForbiddenGraph, UnknownOutput) {
  Graph g;
  addSource(g, "source");
  g.output("suorce.out");
  g.output("source.in");
  EXPECT_EQ(PlanInput().error(g),
            "graph: output suorce.out: no node is named suorce; did you mean source?; output source.in: source has no port in; it has out");
}

TEST(ForbiddenGraph, AllErrorsInOneMessage) {
  Graph g;
  addSource(g, "a");
  addSink(g, "b");
  addSink(g, "c");
  g.connect("a.uot", "b.in");
  g.output("nowhere.out");
  EXPECT_EQ(PlanInput().error(g),
            "graph: edge a.uot → b.in: a has no port uot; did you mean out?; output nowhere.out: no node is named nowhere; "
            "c.in is not connected");
}

TEST(ForbiddenGraph, NamesOfNodes) {
  Graph g;
  addSource(g, "a");
  EXPECT_THROW(addSource(g, "a"), Error);
  EXPECT_THROW(addSource(g, "a.b"), Error);
  EXPECT_THROW(addSource(g, ""), Error);
  EXPECT_THROW(g.connect("a", "b.in"), Error);
  EXPECT_THROW(g.connect("a.out", ".in"), Error);
  EXPECT_THROW(g.connect("a.", "b.in"), Error);
  EXPECT_THROW(g.output("a"), Error);
}

}  // namespace
}  // namespace radivox::oracles
