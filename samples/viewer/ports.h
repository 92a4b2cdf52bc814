// Resources of a running graph by the type of the node that makes them, whatever the graph calls its nodes.
#pragma once

#include <string_view>
#include <vector>

#include "engine/graph/executor.h"

namespace radivox::viewer {

class Ports {
 public:
  Ports(const graph::Graph& graph, const graph::Executor& executor) : graph_(graph), executor_(executor) {}
  /// Null where no node of that type is in the plan, or it does not make the port.
  const gpu::Buffer* buffer(std::string_view type, std::string_view port) const;
  gpu::Image* image(std::string_view type, std::string_view port) const;
  std::vector<const gpu::Buffer*> grown(std::string_view type, std::string_view port) const;
  /// Of the first node of the type; null: the graph has none.
  graph::Node* node(std::string_view type) const;
  uint64_t count(const std::string& name) const;  ///< 0 when unknown

 private:
  std::vector<std::string> endpoints(std::string_view type, std::string_view port) const;
  const graph::Graph& graph_;
  const graph::Executor& executor_;
};

}  // namespace radivox::viewer
