// What a plan leaves out, and the reason it prints.
#include <gtest/gtest.h>

#include <map>

#include "tests/graph/fake_node.h"

namespace radivox::oracles {
namespace {

using graph::Declaration;
using graph::Extent;
using graph::Graph;
using graph::Plan;
using graph::Shape;

const Shape kWords = Shape::buffer(4, 4);

void addPass(Graph& graph, const std::string& name, std::function<void(Declaration&)> more = {}) {
  addFake(graph, name, [more](Declaration& d) {
    d.read("in", "words");
    d.write("out", kWords, "words");
    if (more) more(d);
  });
}

std::vector<std::string> order(const Plan& plan) {
  std::vector<std::string> names;
  for (const auto& step : plan.steps) names.push_back(plan.nodeNames[step.node]);
  return names;
}

std::map<std::string, std::string> reasons(const Plan& plan) {
  std::map<std::string, std::string> map;
  for (const auto& culled : plan.culled) map[culled.name] = culled.reason;
  return map;
}

using Names = std::vector<std::string>;

TEST(Declaration, APortStaysWhereItIsWhenOthersFollow) {
  const scene::Traits traits;
  const scene::Request request;
  const gpu::Capabilities capabilities{};
  Declaration d(traits, request, capabilities);
  const graph::Port& first = d.read("first", "words");
  for (int i = 0; i < 100; ++i) d.write("port " + std::to_string(i), kWords, "words");
  EXPECT_EQ(&first, &d.ports.front());
}

TEST(Cull, OutputsThatNobodyNeeds) {
  //  source ──▶ used ──▶ (output)
  //     └─────▶ unused
  Graph g;
  addFake(g, "source", [](Declaration& d) { d.write("out", kWords, "words"); });
  addPass(g, "unused");
  addPass(g, "used");
  g.connect("source.out", "used.in");
  g.connect("source.out", "unused.in");
  g.output("used.out");
  const Plan plan = PlanInput().compile(g);
  EXPECT_EQ(order(plan), (Names{"source", "used"}));
  EXPECT_EQ(reasons(plan), (std::map<std::string, std::string>{{"unused", "no reader of unused.out"}}));
}

TEST(Cull, ChainWithoutReaderSaysWhoWentFirst) {
  //  a ──▶ b ──▶ c      nobody wants c
  Graph g;
  addFake(g, "a", [](Declaration& d) { d.write("out", kWords, "words"); });
  addPass(g, "b");
  addPass(g, "c");
  g.connect("a.out", "b.in");
  g.connect("b.out", "c.in");
  const auto why = reasons(PlanInput().compile(g));
  EXPECT_EQ(why.at("c"), "no reader of c.out");
  EXPECT_EQ(why.at("b"), "no reader of b.out; c was left out");
  EXPECT_EQ(why.at("a"), "no reader of a.out; b was left out");
}

TEST(Cull, NodeThatLeavesItselfOutTakesItsReadersAlong) {
  //  shadow (no light) ──▶ inject ──▶ bounce ──▶ composite (optional input) ──▶ (output)
  Graph g;
  addFake(g, "shadow", [](Declaration& d) { d.leaveOut("no light casts a shadow"); });  // declares no port at all
  addPass(g, "inject");
  addPass(g, "bounce");
  addFake(g, "composite", [](Declaration& d) {
    d.read("indirect", "light").optional = true;
    d.write("color", kWords, "picture");
  });
  g.connect("shadow.depth", "inject.in");
  g.connect("inject.out", "bounce.in");
  g.connect("bounce.out", "composite.indirect");
  g.output("composite.color");
  const Plan plan = PlanInput().compile(g);
  EXPECT_EQ(order(plan), (Names{"composite"}));
  const auto why = reasons(plan);
  EXPECT_EQ(why.at("shadow"), "no light casts a shadow");
  EXPECT_EQ(why.at("inject"), "needs shadow.depth, which was left out: no light casts a shadow");
  EXPECT_EQ(why.at("bounce"), "needs inject.out, which was left out: no light casts a shadow");
  EXPECT_EQ(plan.findPort("composite", "indirect")->resource, graph::kNoResource);
}

TEST(Cull, UnwantedInputExplainsItsProducer) {
  //  gather ──▶ composite (not wanted: direct light only)
  Graph g;
  addFake(g, "visibility", [](Declaration& d) { d.write("rows", kWords, "words"); });
  addPass(g, "gather");
  addFake(g, "composite", [](Declaration& d) {
    graph::Port& indirect = d.read("indirect", "light");
    indirect.unwanted = !d.request.wantsIndirect();
    indirect.unwantedReason = "direct light only is asked for";
    d.write("color", kWords, "picture");
  });
  g.connect("visibility.rows", "gather.in");
  g.connect("gather.out", "composite.indirect");
  g.output("composite.color");
  PlanInput input;
  EXPECT_EQ(order(input.compile(g)), (Names{"visibility", "gather", "composite"}));
  input.request.bounces = 0;
  const Plan plan = input.compile(g);
  EXPECT_EQ(order(plan), (Names{"composite"}));
  const auto why = reasons(plan);
  EXPECT_EQ(why.at("gather"), "no reader of gather.out; composite does not want gather.out: direct light only is asked for");
  EXPECT_EQ(why.at("visibility"), "no reader of visibility.rows; gather was left out");
}

TEST(Cull, OptionalOutputsExistOnlyForReadersOrOutputs) {
  Graph g;
  addFake(g, "a", [](Declaration& d) {
    d.write("always", kWords, "words");
    d.write("asked", kWords, "words").optional = true;
    d.write("read", kWords, "words").optional = true;
    d.write("nobody", kWords, "words").optional = true;
  });
  addPass(g, "b");
  g.connect("a.read", "b.in");
  g.output("a.asked");
  g.output("b.out");
  const Plan plan = PlanInput().compile(g);
  EXPECT_NE(plan.findPort("a", "always")->resource, graph::kNoResource);
  EXPECT_NE(plan.findPort("a", "asked")->resource, graph::kNoResource);
  EXPECT_NE(plan.findPort("a", "read")->resource, graph::kNoResource);
  EXPECT_EQ(plan.findPort("a", "nobody")->resource, graph::kNoResource);
  // b has another input left out; a's optional port goes with it.
  Graph h;
  addFake(h, "a", [](Declaration& d) {
    d.write("always", kWords, "words");
    d.write("read", kWords, "words").optional = true;
  });
  addFake(h, "off", [](Declaration& d) { d.leaveOut("off"); });
  addPass(h, "b", [](Declaration& d) { d.read("other", "words"); });
  h.connect("a.read", "b.in");
  h.connect("off.out", "b.other");
  h.output("a.always");
  h.output("b.out");
  const Plan without = PlanInput().compile(h);
  EXPECT_EQ(without.findPort("a", "read")->resource, graph::kNoResource);
  EXPECT_EQ(reasons(without).at("b"), "needs off.out, which was left out: off");
}

TEST(Cull, ANodeOfOptionalOutputsNamesThemAll) {
  Graph g;
  addFake(g, "inspect", [](Declaration& d) {
    d.write("face", kWords, "words").optional = true;
    d.write("cluster", kWords, "words").optional = true;
  });
  EXPECT_EQ(reasons(PlanInput().compile(g)).at("inspect"), "no reader of inspect.face, inspect.cluster");
}

TEST(Cull, PublisherOfACountIsNeededWithoutAnEdge) {
  //  counter ┄┄ count items ┄┄▶ shaped ──▶ (output)
  Graph g;
  addFake(g, "shaped", [](Declaration& d) { d.write("out", Shape::buffer(4, Extent::of("items")), "items"); });
  addFake(g, "counter", [](Declaration& d) {
    d.write("count", kWords, "number").optional = true;
    d.publishCount("items", "count", 8);
  });
  g.output("shaped.out");
  const Plan plan = PlanInput().compile(g);
  EXPECT_EQ(order(plan), (Names{"counter", "shaped"}));
  EXPECT_NE(plan.findPort("counter", "count")->resource, graph::kNoResource) << "a published word must be there";
  EXPECT_EQ(plan.segmentCount, 2u);
}

TEST(Cull, CountOfALeftOutNodeLeavesOutWhatItShapes) {
  Graph g;
  addFake(g, "counter", [](Declaration& d) {
    d.write("count", kWords, "number");
    d.publishCount("items", "count", 0);
    d.leaveOut("nothing to count");
  });
  addFake(g, "shaped", [](Declaration& d) { d.write("out", Shape::buffer(4, Extent::of("items")), "items"); });
  g.output("shaped.out");
  EXPECT_EQ(reasons(PlanInput().compile(g)).at("shaped"), "needs the count items of counter, which was left out: nothing to count");
}

TEST(Cull, NodesWithoutOutputsWorkForTheOutside) {
  Graph g;
  addFake(g, "source", [](Declaration& d) { d.write("out", kWords, "words"); });
  addFake(g, "file", [](Declaration& d) { d.read("in", "words"); });
  g.connect("source.out", "file.in");
  EXPECT_EQ(order(PlanInput().compile(g)), (Names{"source", "file"}));
}

TEST(Cull, ModifyThatNobodyReadsIsLeftOutAndKillsNothing) {
  //  source ──▶ modify      nobody reads modify.data
  //     └─────▶ sink
  Graph g;
  addFake(g, "source", [](Declaration& d) { d.write("out", kWords, "words"); });
  addFake(g, "modify", [](Declaration& d) { d.modify("data", "words"); });
  addFake(g, "sink", [](Declaration& d) { d.read("in", "words"); });
  g.connect("source.out", "modify.data");
  g.connect("source.out", "sink.in");
  const Plan plan = PlanInput().compile(g);
  EXPECT_EQ(order(plan), (Names{"source", "sink"}));
  EXPECT_EQ(reasons(plan).at("modify"), "no reader of modify.data");
}

TEST(Cull, UnusedImportsAreNotAskedFor) {
  Graph g;
  addFake(g, "unused", [](Declaration& d) {
    d.read("scene.lights", "lights");
    d.write("out", kWords, "words");
  });
  addFake(g, "used", [](Declaration& d) {
    d.read("scene.info", "scene");
    d.read("view.camera", "camera").optional = true;
    d.write("out", kWords, "words");
  });
  g.output("used.out");
  PlanInput input;
  input.imports = {{"scene.info", kWords}, {"scene.vertices", kWords}};
  const Plan plan = input.compile(g);
  ASSERT_EQ(plan.resources.size(), 2u);
  EXPECT_EQ(plan.resources[plan.findPort("used", "scene.info")->resource].name, "scene.info");
  EXPECT_EQ(plan.findPort("used", "view.camera")->resource, graph::kNoResource);
}

TEST(Cull, OutputOfALeftOutNodeIsNoError) {
  Graph g;
  addFake(g, "off", [](Declaration& d) { d.leaveOut("off"); });
  g.output("off.out");
  const Plan plan = PlanInput().compile(g);
  EXPECT_TRUE(plan.steps.empty());
  EXPECT_EQ(plan.segmentCount, 0u);
  EXPECT_EQ(reasons(plan).at("off"), "off");
}

}  // namespace
}  // namespace radivox::oracles
