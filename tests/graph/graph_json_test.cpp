// Graphs and presets as text: what is written reads back, and each mistake is named with its place.
#include <gtest/gtest.h>

#include "tests/graph/fake_node.h"

namespace radivox::oracles {
namespace {

using graph::Declaration;
using graph::Graph;
using graph::Shape;

class GraphJson : public ::testing::Test {
 protected:
  GraphJson() {
    registry_.add("test.source", "writes words", [] {
      auto node = std::make_unique<FakeNode>([](Declaration& d) { d.write("out", Shape::buffer(4, 4), "words"); });
      node->typeName = "test.source";
      return node;
    });
    registry_.add("test.sink", "reads words", [] {
      auto node = std::make_unique<FakeNode>([](Declaration& d) { d.read("in", "words"); });
      node->typeName = "test.sink";
      return node;
    });
  }
  Graph read(const std::string& text) { return Graph::fromJson(text, "g.json", registry_); }
  std::string error(const std::string& text) {
    try {
      read(text);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::BadInput);
      return e.what();
    }
    return "";
  }
  plugin::Registry registry_;
};

const char* const kGood = R"({
  "help": "a source and a sink",
  "nodes": {
    "source": {"type": "test.source", "params": {"value": 12, "tall": true}},
    "sink": {"type": "test.sink"}
  },
  "edges": [["source.out", "sink.in"], ["scene.vertices", "sink.other"]],
  "outputs": ["source.out"],
  "aovs": {"color": "source.out", "depth": "source.out.w"}
})";

TEST_F(GraphJson, Reads) {
  const Graph g = read(kGood);
  ASSERT_EQ(g.nodes().size(), 2u);
  EXPECT_EQ(g.nodes()[0].name, "source") << "nodes keep the order of the file";
  EXPECT_EQ(g.nodes()[0].node->params().print(), "value=12 tall=true");
  EXPECT_EQ(g.edges()[1].from.print(), "scene.vertices");
  EXPECT_EQ(g.outputs()[0].print(), "source.out");
  EXPECT_EQ(g.aovs().at("depth"), "source.out.w");
}

TEST_F(GraphJson, WritesWhatItReads) {
  const std::string once = read(kGood).toJson();
  EXPECT_EQ(read(once).toJson(), once);
  EXPECT_NE(once.find("\"value\": 12"), std::string::npos) << once;
  EXPECT_NE(once.find("\"help\": \"a source and a sink\""), std::string::npos) << once;
}

TEST_F(GraphJson, WritesOnlyWhatDiffersFromTheDefaults) {
  Graph g = read(R"({"nodes": {"s": {"type": "test.source", "params": {"value": 1}}}})");
  EXPECT_EQ(g.toJson().find("params"), std::string::npos);
}

TEST_F(GraphJson, ErrorsNameTheirPlace) {
  EXPECT_EQ(error(R"({"nodes": {"a": {"type": "test.sorce"}}})"),
            "g.json: nodes.a.type: no node type test.sorce; did you mean test.source?");
  EXPECT_EQ(error(R"({"nodes": {"a": {"type": "test.source", "params": {"vlaue": 3}}}})"),
            "g.json: nodes.a.params: a.vlaue: no such parameter; did you mean value?");
  EXPECT_EQ(error(R"({"nodes": {"a": {"type": "test.source", "params": {"value": 5000}}}})"),
            "g.json: nodes.a.params: a.value = 5000: out of range; give a whole number from 0 to 1000");
  EXPECT_EQ(error(R"({"nodes": {"a": {"type": "test.source", "params": {"value": [1]}}}})"),
            "g.json: nodes.a.params.value: not a value; write a number, true, false or a name");
  EXPECT_EQ(error(R"({"nodes": {"a": {"typ": "test.source"}}})"), "g.json: nodes.a: has no type; write {\"type\": \"module.node\"}");
  EXPECT_EQ(error(R"({"nodes": {"a": {"type": "test.source", "parms": {}}}})"), "g.json: nodes.a.parms: unknown key; did you mean params?");
  EXPECT_EQ(error(R"({"nodes": {}, "edge": []})"), "g.json: edge: unknown key; did you mean edges?");
  EXPECT_EQ(error(R"({"nodes": {}, "edges": [["a.out"]]})"), "g.json: edges[0]: not an edge; write [\"node.port\", \"node.port\"]");
  EXPECT_EQ(error(R"({"nodes": {}, "edges": [["a", "b.in"]]})"), "g.json: edges[0]: \"a\" is no endpoint; write node.port");
  EXPECT_EQ(error(R"({"nodes": {}, "edges": {}})"), "g.json: edges: not a list; write [[\"node.port\", \"node.port\"], …]");
  EXPECT_EQ(error(R"({"nodes": {}, "outputs": [7]})"), "g.json: outputs[0]: not a name; write \"node.port\"");
  EXPECT_EQ(error(R"({"nodes": {"source": {"type": "test.source"}}, "aovs": {"color": "sorce.out"}})"),
            "g.json: aovs.color: sorce.out names no node and port; did you mean node source?");
  EXPECT_EQ(error(R"({"nodes": {}, "help": 3})"), "g.json: help: not a text");
  EXPECT_EQ(error("{}"), "g.json: nodes: missing; a graph needs {\"nodes\": {…}}");
  EXPECT_EQ(error("[]"), "g.json: top level: not an object; write {\"nodes\": {…}, \"edges\": […], \"outputs\": […]}");
}

TEST_F(GraphJson, AllErrorsInOneMessage) {
  EXPECT_EQ(error(R"({"nodes": {"a": {"type": "nope"}, "b": {"type": "test.source", "params": {"value": "x"}}}, "outputs": ["b"]})"),
            "g.json: nodes.a.type: no node type nope; load the module that has it; "
            "nodes.b.params: b.value = x: not a number; give a whole number from 0 to 1000; "
            "outputs[0]: \"b\" is no endpoint; write node.port");
}

TEST_F(GraphJson, BrokenTextSaysWhere) {
  const std::string what = error("{\n  \"nodes\": {,}\n}");
  EXPECT_NE(what.find("g.json: parse error at line 2, column 13"), std::string::npos) << what;
  EXPECT_EQ(what.find('\n'), std::string::npos) << "one line";
  EXPECT_NE(error(""), "");
  EXPECT_NE(error(std::string("\0\xff", 2)), "");
}

TEST_F(GraphJson, AKeyTwiceIsAMistake) {
  EXPECT_EQ(error(R"({"nodes": {"a": {"type": "test.source"}, "a": {"type": "test.sink"}}})"),
            "g.json: the key a is there twice; remove one");
}

class Preset : public GraphJson {
 protected:
  std::string presetError(Graph& g, const std::string& text) {
    try {
      g.applyPreset(text, "p.json");
    } catch (const Error& e) {
      return e.what();
    }
    return "";
  }
};

TEST_F(Preset, Sets) {
  Graph g = read(kGood);
  g.applyPreset(
      R"({"name": "paper", "help": "h", "graph": "x", "request": {"bounces": 1}, "set": {"source.value": 7, "source.tall": false}})", "p");
  EXPECT_EQ(g.find("source")->params().print(), "value=7 tall=false");
  g.applyPreset(R"({"name": "nothing to set"})", "p");
  EXPECT_EQ(g.find("source")->params().print(), "value=7 tall=false");
}

TEST_F(Preset, ErrorsNameTheirPlaceAndChangeNothing) {
  Graph g = read(kGood);
  EXPECT_EQ(presetError(g, R"({"set": {"source.value": 7, "sorce.value": 7, "source.tall": "maybe"}})"),
            "p.json: set: sorce.value: no node is named sorce; did you mean source?; "
            "set: source.tall = maybe: not true or false; give true or false");
  EXPECT_EQ(g.find("source")->params().print(), "value=12 tall=true");
  EXPECT_EQ(presetError(g, R"({"sets": {}})"), "p.json: sets: unknown key; did you mean set?");
  EXPECT_EQ(presetError(g, R"({"set": []})"), "p.json: set: not an object; write {\"node.param\": value, …}");
  EXPECT_EQ(presetError(g, R"({"set": {"source.value": null}})"),
            "p.json: set.source.value: not a value; write a number, true, false or a name");
  EXPECT_EQ(presetError(g, R"({"set": {"source": 1}})"), "p.json: set: \"source\" names no parameter; write node.param=value");
}

TEST_F(GraphJson, ImportsTakeTheNodesPlace) {
  Graph graph = read(R"({
    "nodes": {"scene_source": {"type": "test.source"}, "source": {"type": "test.source"}, "sink": {"type": "test.sink"}},
    "edges": [["scene_source.out", "source.in"], ["source.out", "sink.in"]],
    "aovs": {"color": "source.out", "other": "scene_source.out"}
  })");
  graph.replaceByImports("source", "host");
  EXPECT_EQ(graph.find("source"), nullptr);
  ASSERT_EQ(graph.edges().size(), 1u) << "edges into the node go with it";
  EXPECT_EQ(graph.edges()[0].from.print(), "host.out");
  EXPECT_EQ(graph.edges()[0].to.print(), "sink.in");
  EXPECT_EQ(graph.aovs().size(), 1u);
  EXPECT_EQ(graph.aovs().count("other"), 1u);
  PlanInput input;
  input.imports = {{"host.out", Shape::buffer(4, 4)}};
  EXPECT_EQ(input.error(graph), "");
  input.imports.clear();
  EXPECT_NE(input.error(graph).find("host"), std::string::npos) << "the host must give it";

  const auto message = [&](const char* node, const char* import) -> std::string {
    try {
      graph.replaceByImports(node, import);
    } catch (const Error& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_EQ(message("sinc", "host"), "no node is named sinc; did you mean sink?");
  EXPECT_EQ(message("sink", "scene_source"), "\"scene_source\" cannot stand for sink; use a name without dots that no node has");
  graph.output("scene_source.out");
  EXPECT_EQ(message("scene_source", "host"), "scene_source.out is an output of the graph; the host has it already: leave it out");
  EXPECT_NE(graph.find("scene_source"), nullptr);
}

}  // namespace
}  // namespace radivox::oracles
