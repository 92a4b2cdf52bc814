// Node types linked in and loaded: the same nodes, refused duplicates and strangers, libraries that live as long as their nodes.
#include "engine/plugin/registry.h"

#include <dlfcn.h>
#include <gtest/gtest.h>

#include "modules/modules.h"
#include "tests/graph/fake_node.h"
#include "tests/oracles/gpu_fixture.h"
#include "tests/oracles/node_harness.h"

namespace radivox::oracles {

void registerTestModule(plugin::Registry& registry);  // module/test_module.cpp

namespace {

const std::string kModules = RADIVOX_TEST_MODULES;
const std::string kTestModule = kModules + "/test_module.so";

std::string errorOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::BadInput);
    return e.what();
  }
  return "";
}

bool isLoaded(const std::string& path) {
  void* handle = dlopen(path.c_str(), RTLD_NOLOAD | RTLD_NOW);
  if (handle != nullptr) dlclose(handle);
  return handle != nullptr;
}

TEST(Registry, LinkedInAndLoadedGiveTheSameNodes) {
  plugin::Registry linked, loaded;
  registerTestModule(linked);
  loaded.load(kTestModule);
  ASSERT_EQ(linked.types().size(), 2u);
  ASSERT_EQ(loaded.types().size(), 2u);
  for (size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(linked.types()[i].name, loaded.types()[i].name);
    EXPECT_EQ(linked.types()[i].help, loaded.types()[i].help);
    EXPECT_EQ(linked.types()[i].origin, "linked in");
    EXPECT_EQ(loaded.types()[i].origin, kTestModule);
    const auto a = linked.types()[i].make(), b = loaded.types()[i].make();
    EXPECT_EQ(a->type(), b->type());
    EXPECT_EQ(a->params().print(), b->params().print());
  }
  // The library's code is its own, not the program's under the same names.
  Dl_info info{};
  const auto node = loaded.make("test_module.plain");
  ASSERT_NE(dladdr(node->type().data(), &info), 0);
  EXPECT_NE(std::string(info.dli_fname).find("test_module.so"), std::string::npos) << info.dli_fname;
  // And so are their plans.
  std::string plans[2];
  for (const plugin::Registry* registry : {&linked, &loaded}) {
    graph::Graph g = graph::Graph::fromJson(R"({"nodes": {"p": {"type": "test_module.plain"}, "s": {"type": "test_module.stepping"}},
                                                "outputs": ["p.out", "s.out"]})",
                                            "test", *registry);
    PlanInput input;
    input.counts = {{"width", 4}};
    plans[registry == &loaded] = input.compile(g).printText(input.counts);
  }
  EXPECT_EQ(plans[0], plans[1]);
  EXPECT_NE(plans[0].find("test_module.stepping"), std::string::npos);
}

TEST(Registry, ModulesOfThisTreeAreLibrariesToo) {
  plugin::Registry linked;
  registerModules(linked);
  plugin::Registry loaded;
  const std::string folder = RADIVOX_BINARY_DIR "/modules/";
  loaded.load(folder + "libradivox_frame.so");
  loaded.load(folder + "libradivox_clustered_voxel.so");
#ifdef RADIVOX_WITH_REFERENCE
  loaded.load(folder + "libradivox_reference.so");
#endif
#ifdef RADIVOX_WITH_VDB
  loaded.load(folder + "libradivox_vdb.so");
#endif
  ASSERT_EQ(loaded.types().size(), linked.types().size());
  EXPECT_GT(loaded.types().size(), 10u);
  for (size_t i = 0; i < linked.types().size(); ++i) {
    EXPECT_EQ(loaded.types()[i].name, linked.types()[i].name);
    EXPECT_EQ(loaded.types()[i].make()->params().print(), linked.types()[i].make()->params().print());
  }
}

TEST(Registry, OtherAbiIsRefusedWithBothTags) {
  plugin::Registry registry;
  const std::string path = kModules + "/test_module_other_abi.so";
  EXPECT_EQ(errorOf([&] { registry.load(path); }), "module " + path + " was built for \"radivox of another day\", this engine is \"" +
                                                       std::string(plugin::abiTag()) + "\"; build the module again with this engine");
  EXPECT_TRUE(registry.types().empty());
  EXPECT_FALSE(isLoaded(path));
}

TEST(Registry, TheTagNamesVersionCompilerAndLibrary) {
  const std::string tag(plugin::abiTag());
  EXPECT_NE(tag.find("radivox abi "), std::string::npos) << tag;
  EXPECT_NE(tag.find(__VERSION__), std::string::npos) << tag;
  EXPECT_NE(tag.find("libstdc++ "), std::string::npos) << tag;
  EXPECT_NE(tag.find("2020"), std::string::npos) << tag;  // __cplusplus
}

TEST(Registry, DuplicatesAreRefusedWithBothOrigins) {
  plugin::Registry registry;
  registerTestModule(registry);
  EXPECT_EQ(errorOf([&] { registry.load(kTestModule); }),
            "node type test_module.plain comes from two modules: linked in and " + kTestModule + "; load only one");
  EXPECT_EQ(registry.types().size(), 2u);
  EXPECT_NE(errorOf([&] { registerTestModule(registry); }), "");
}

TEST(Registry, AModuleThatFailsLeavesNothing) {
  plugin::Registry registry;
  const std::string path = kModules + "/test_module_failing.so";
  EXPECT_EQ(errorOf([&] { registry.load(path); }),
            "node type failing.first comes from two modules: " + path + " and " + path + "; load only one");
  EXPECT_TRUE(registry.types().empty());
  EXPECT_FALSE(isLoaded(path));
  registry.load(kTestModule);
  registerTestModule(*std::make_unique<plugin::Registry>());
  EXPECT_EQ(registry.types()[0].origin, kTestModule);
}

TEST(Registry, WhatIsNoModuleIsNamed) {
  plugin::Registry registry;
  const std::string missing = errorOf([&] { registry.load("/nowhere/module.so"); });
  EXPECT_NE(missing.find("cannot load module /nowhere/module.so: "), std::string::npos) << missing;
  EXPECT_NE(errorOf([&] { registry.load("module.so"); }).find("cannot load module module.so: ./module.so"), std::string::npos);
  const std::string path = kModules + "/test_module_empty.so";
  EXPECT_EQ(errorOf([&] { registry.load(path); }),
            "module " + path + " has no entry point radivoxModule; put RADIVOX_MODULE(registerNodes) in one of its source files");
  EXPECT_FALSE(isLoaded(path));
}

TEST(Registry, UnknownTypesGetTheNearest) {
  plugin::Registry registry;
  registerTestModule(registry);
  EXPECT_EQ(errorOf([&] { registry.make("test_module.plian"); }), "no node type test_module.plian; did you mean test_module.plain?");
  EXPECT_EQ(errorOf([&] { registry.make("x"); }), "no node type x; load the module that has it");
}

TEST(Registry, NodesKeepTheirLibraryAlive) {
  std::unique_ptr<graph::Node> node;
  {
    plugin::Registry registry;
    registry.load(kTestModule);
    node = registry.make("test_module.plain");
  }
  EXPECT_TRUE(isLoaded(kTestModule));
  EXPECT_EQ(node->type(), "test_module.plain");
  node->params().set("node", "value", "7");
  EXPECT_EQ(node->params().print(), "value=7");
  node.reset();
  EXPECT_FALSE(isLoaded(kTestModule)) << "and not longer";
}

TEST(Registry, ErrorsOfLoadedNodesAreErrors) {
  plugin::Registry registry;
  registry.load(kTestModule);
  graph::Graph g;
  g.add("p", registry.make("test_module.plain"));
  g.output("p.out");
  g.set("p.value", "13");
  EXPECT_EQ(PlanInput().error(g), "test_module.plain cannot count to 13");
}

class LoadedNodeTest : public GpuTest {};

TEST_F(LoadedNodeTest, RunsAfterItsRegistryIsGone) {
  NodeHarness h(device());
  {
    plugin::Registry registry;
    registry.load(kTestModule);
    h.add("plain", registry.make("test_module.plain"));
    h.add("stepping", registry.make("test_module.stepping"));
  }
  h.setCount("width", 8);
  h.output("plain.out");
  h.output("stepping.out");
  h.run();
  EXPECT_EQ(h.download<uint32_t>("plain.out"), std::vector<uint32_t>(8, 5));
  EXPECT_EQ(h.download<uint32_t>("stepping.out"), std::vector<uint32_t>(4, 2));
  EXPECT_EQ(h.figure("stepping", "steps"), 3.0);
  EXPECT_EQ(h.figure("stepping", "frames"), 1.0);
}

TEST(Registry, SweptValuesAreValuesOfTheirParameters) {
  plugin::Registry registry;
  registerModules(registry);
  int swept = 0;
  for (const plugin::NodeType& type : registry.types()) {
    const auto node = registry.make(type.name);
    for (const params::Param& param : node->params().all()) {
      EXPECT_EQ(param.sweep.empty(), param.exact.empty()) << type.name << "." << param.name;
      if (param.sweep.empty()) continue;
      ++swept;
      EXPECT_GE(param.sweep.size(), 2u) << "nothing to trade";
      std::vector<std::string> values = param.sweep;
      values.push_back(param.exact);
      for (const std::string& value : values) {
        EXPECT_EQ(errorOf([&] { node->params().set(type.name, param.name, value); }), "") << type.name << "." << param.name;
      }
    }
  }
  EXPECT_GE(swept, 8);
}

}  // namespace
}  // namespace radivox::oracles
