#include "engine/plugin/registry.h"

#include <dlfcn.h>

#include "engine/error.h"

namespace radivox::plugin {
namespace {

/// A node from a loaded library. The engine owns this wrapper's code, so the library may go once the wrapper is gone.
class LoadedNode final : public graph::Node {
 public:
  LoadedNode(std::shared_ptr<void> library, std::unique_ptr<graph::Node> node) : library_(std::move(library)), node_(std::move(node)) {}
  std::string_view type() const override { return node_->type(); }
  params::Table& params() override { return node_->params(); }
  void declare(graph::Declaration& declaration) override { node_->declare(declaration); }
  void prepare(graph::PrepareContext& context) override { node_->prepare(context); }
  uint32_t stepCount(graph::RecordContext& context) override { return node_->stepCount(context); }
  void record(graph::RecordContext& context) override { node_->record(context); }
  void stepDone(graph::RecordContext& context) override { node_->stepDone(context); }
  void frameDone(graph::RecordContext& context) override { node_->frameDone(context); }

 private:
  std::shared_ptr<void> library_;  // first: outlives node_
  std::unique_ptr<graph::Node> node_;
};

/// A maker from a loaded library; its code lives there too.
struct LoadedMaker {
  std::shared_ptr<void> library;  // first: outlives make
  std::function<std::unique_ptr<graph::Node>()> make;
  std::unique_ptr<graph::Node> operator()() const { return std::make_unique<LoadedNode>(library, make()); }
};

/// Likewise a case.
struct LoadedCase {
  std::shared_ptr<void> library;  // first: outlives run
  std::function<void(stability::Bench&, stability::Row&)> run;
  void operator()(stability::Bench& bench, stability::Row& row) const { run(bench, row); }
};

}  // namespace

std::string_view abiTag() { return RADIVOX_ABI_TAG; }

void Registry::add(std::string name, std::string help, std::function<std::unique_ptr<graph::Node>()> make) {
  for (const NodeType& type : types_) {
    if (type.name != name) continue;
    throw Error(ErrorCode::BadInput,
                "node type " + name + " comes from two modules: " + type.origin + " and " + origin_ + "; load only one");
  }
  if (library_ != nullptr) make = LoadedMaker{library_, std::move(make)};
  types_.push_back({std::move(name), std::move(help), std::move(make), origin_});
}

void Registry::addStabilityCase(stability::Case stabilityCase) {
  for (const stability::Case& known : stabilityCases_) {
    if (known.method != stabilityCase.method || known.group != stabilityCase.group || known.name != stabilityCase.name) continue;
    throw Error(ErrorCode::BadInput,
                "stability case " + known.group + ": " + known.name + " is there twice (" + origin_ + "); give it another name");
  }
  if (library_ != nullptr) stabilityCase.run = LoadedCase{library_, std::move(stabilityCase.run)};
  stabilityCases_.push_back(std::move(stabilityCase));
}

void Registry::load(const std::string& path) {
  // A name without a slash would be looked up in the system's folders.
  const std::string file = path.find('/') == std::string::npos ? "./" + path : path;
  void* handle = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (handle == nullptr) {
    const char* why = dlerror();
    throw Error(ErrorCode::BadInput, "cannot load module " + path + ": " + (why != nullptr ? why : "unknown reason"));
  }
  const std::shared_ptr<void> library(handle, [](void* h) { dlclose(h); });
  using EntryFunction = const ModuleEntry* (*)();
  const auto entryFunction = reinterpret_cast<EntryFunction>(dlsym(handle, "radivoxModule"));
  if (entryFunction == nullptr) {
    throw Error(ErrorCode::BadInput,
                "module " + path + " has no entry point radivoxModule; put RADIVOX_MODULE(registerNodes) in one of its source files");
  }
  const ModuleEntry* entry = entryFunction();
  if (entry->abiTag != abiTag()) {
    throw Error(ErrorCode::BadInput, "module " + path + " was built for \"" + entry->abiTag + "\", this engine is \"" +
                                         std::string(abiTag()) + "\"; build the module again with this engine");
  }
  const size_t before = types_.size(), casesBefore = stabilityCases_.size();
  origin_ = path;
  library_ = library;
  const auto leave = [&] {
    origin_ = "linked in";
    library_.reset();
  };
  try {
    entry->registerNodes(*this);
  } catch (...) {
    types_.resize(before);
    stabilityCases_.resize(casesBefore);
    leave();
    throw;
  }
  leave();
}

std::unique_ptr<graph::Node> Registry::make(std::string_view type) const {
  std::vector<std::string> names;
  for (const NodeType& known : types_) {
    if (known.name == type) return known.make();
    names.push_back(known.name);
  }
  const std::string near = params::nearestName(type, names);
  throw Error(ErrorCode::BadInput,
              "no node type " + std::string(type) + (near.empty() ? "; load the module that has it" : "; did you mean " + near + "?"));
}

}  // namespace radivox::plugin
