#include "engine/graph/node.h"

namespace radivox::graph {
namespace {

Port& append(std::deque<Port>& ports, std::string name, Access access, Shape shape, std::string meaning, uint32_t use) {
  Port& port = ports.emplace_back();
  port.name = std::move(name);
  port.access = access;
  port.shape = std::move(shape);
  port.meaning = std::move(meaning);
  port.use = use;
  return port;
}

}  // namespace

Port& Declaration::read(std::string name, std::string meaning, uint32_t use) {
  return append(ports, std::move(name), Access::Read, {}, std::move(meaning), use);
}

Port& Declaration::readIf(bool wanted, std::string name, std::string meaning, std::string reason, uint32_t use) {
  Port& port = read(std::move(name), std::move(meaning), use);
  port.optional = true;
  port.unwanted = !wanted;
  port.unwantedReason = std::move(reason);
  return port;
}

Port& Declaration::write(std::string name, Shape shape, std::string meaning, uint32_t use) {
  return append(ports, std::move(name), Access::Write, std::move(shape), std::move(meaning), use);
}

Port& Declaration::modify(std::string name, std::string meaning, uint32_t use) {
  return append(ports, std::move(name), Access::Modify, {}, std::move(meaning), use);
}

Port& Declaration::scratch(std::string name, Shape shape, std::string meaning, uint32_t use) {
  return append(ports, std::move(name), Access::Scratch, std::move(shape), std::move(meaning), use);
}

Port& Declaration::readBack(std::string name, Shape shape, std::string meaning) {
  return append(ports, std::move(name), Access::ReadBack, std::move(shape), std::move(meaning), UseCompute | UseTransfer);
}

void Declaration::publishCount(std::string name, std::string port, uint64_t byteOffset) {
  publishedCounts.push_back({std::move(name), std::move(port), byteOffset});
}

}  // namespace radivox::graph
