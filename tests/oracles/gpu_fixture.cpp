#include "tests/oracles/gpu_fixture.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <mutex>

namespace radivox::oracles {

namespace {

std::mutex& messageMutex() {
  static std::mutex mutex;
  return mutex;
}

std::vector<std::string>& messageList() {
  static std::vector<std::string> messages;
  return messages;
}

std::unique_ptr<gpu::Device> makeDevice() {
  gpu::DeviceOptions options;
  options.validation = true;
  options.onMessage = [](const std::string& message) {
    std::lock_guard lock(messageMutex());
    messageList().push_back(message);
  };
  if (const char* index = std::getenv("RADIVOX_DEVICE")) options.index = std::atoi(index);
  try {
    return gpu::Device::create(options);
  } catch (const Error& error) {
    const bool layerMissing = std::string(error.what()).find("VK_LAYER_KHRONOS_validation") != std::string::npos;
    if (!layerMissing || std::getenv("RADIVOX_REQUIRE_VALIDATION") != nullptr) throw;
    std::fprintf(stderr, "tests run without validation: %s\n", error.what());
    options.validation = false;
    return gpu::Device::create(options);
  }
}

}  // namespace

gpu::Device& sharedDevice() {
  // A device that closes names the handles that were left to it: those fail the program, since no test is running any more.
  struct Holder {
    Holder() {
      messageMutex();  // made before the device, hence gone after it
      messageList();
      device = makeDevice();
    }
    ~Holder() {
      const size_t before = validationMessages().size();
      device.reset();
      const auto messages = validationMessages();
      for (size_t i = before; i < messages.size(); ++i) std::fprintf(stderr, "closing the device: %s\n", messages[i].c_str());
      if (messages.size() > before) std::_Exit(1);
    }
    std::unique_ptr<gpu::Device> device;
  };
  static const Holder holder;
  return *holder.device;
}

std::vector<std::string> validationMessages() {
  std::lock_guard lock(messageMutex());
  return messageList();
}

SilenceCheck::~SilenceCheck() {
  const uint32_t count = device_.validationMessageCount() - before_;
  if (count == 0) return;
  std::string text;
  const auto messages = validationMessages();
  for (size_t i = messages.size() - std::min<size_t>(messages.size(), count); i < messages.size(); ++i) text += "\n" + messages[i];
  ADD_FAILURE() << count << " validation messages:" << text;
}

void runCommands(gpu::Device& device, const std::function<void(gpu::Commands&)>& record) {
  gpu::DescriptorPool pool(device);
  device.submitAndWait([&](VkCommandBuffer handle) {
    gpu::Commands commands(device, handle, pool);
    record(commands);
  });
}

void GpuTest::SetUp() {
  silence_ = std::make_unique<SilenceCheck>(device());
  bytesBefore_ = device().memoryUse().current;
}

void GpuTest::TearDown() {
  EXPECT_EQ(device().memoryUse().current, bytesBefore_) << "the test left device memory behind";
  silence_.reset();
}

}  // namespace radivox::oracles
