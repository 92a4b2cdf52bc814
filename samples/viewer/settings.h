// Every parameter of a graph, as panels show them and the session takes them: the one description of each, read from a graph of our own that
// never runs.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "samples/cli/job.h"

namespace radivox::viewer {

/// A graph other than its file's name, its parameters' values, and how many bounces. Not to be copied: widgets point into it.
class Settings {
 public:
  /// --graph, --preset, --set, --bounces and --module of `options`. Throws BadInput.
  explicit Settings(const cli::Options& options);

  struct Group {
    std::string node, type;
    params::Table* table = nullptr;
  };
  /// In the graph's order; the lights' options last.
  std::vector<Group> groups() const;
  /// Throws BadInput, and nothing changed.
  void set(const std::string& nodeParam, const std::string& value);
  /// "node.param=value", every one.
  std::vector<std::string> values() const;

  /// The graph as its file has it.
  void chooseGraph(const std::string& name);
  /// The preset's graph, values and bounces; other parameters as the graph's file has them.
  void choosePreset(const std::string& name);
  void setBounces(const std::string& text);  ///< "all" or a number

  const std::string& graph() const { return graph_; }
  const std::string& preset() const { return preset_; }  ///< the last chosen; empty: none
  std::string bounces() const;
  /// AOVs of the graph that are images of their own, by name.
  std::vector<std::string> aovs() const;

 private:
  void load(const cli::Options& options);
  std::vector<std::string> modules_;
  std::string graph_, preset_;
  std::unique_ptr<cli::Job> job_;
};

}  // namespace radivox::viewer
