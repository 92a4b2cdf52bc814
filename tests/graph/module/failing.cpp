// A module whose second node is taken already: nothing of it may stay registered.
#include "engine/plugin/registry.h"

namespace radivox::oracles {

static void registerFailing(plugin::Registry& registry) {
  registry.add("failing.first", "never seen", [] { return std::unique_ptr<graph::Node>(); });
  registry.add("failing.first", "the same name again", [] { return std::unique_ptr<graph::Node>(); });
}

}  // namespace radivox::oracles

RADIVOX_MODULE(radivox::oracles::registerFailing);
