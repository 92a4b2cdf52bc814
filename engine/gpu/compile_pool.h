// Private to engine/gpu: threads that compile pipelines, several at a time, while a graph is prepared.
#pragma once

#include <vulkan/vulkan.h>

#include <condition_variable>
#include <functional>
#include <future>
#include <mutex>
#include <queue>
#include <thread>
#include <vector>

namespace radivox::gpu {

/// For one thread at a time, as the device whose it is.
class CompilePool {
 public:
  using Task = std::function<VkPipeline()>;
  CompilePool() = default;
  ~CompilePool();  ///< finish()
  CompilePool(const CompilePool&) = delete;
  CompilePool& operator=(const CompilePool&) = delete;
  /// The future throws what the task throws. Threads start as they are needed, one a core at most; where none can start, the task runs here.
  std::future<VkPipeline> run(Task task);
  void finish();  ///< runs what is queued, and ends the threads

 private:
  void work();
  std::mutex mutex_;
  std::condition_variable some_;
  std::queue<std::packaged_task<VkPipeline()>> queue_;
  std::vector<std::thread> threads_;
  size_t idle_ = 0;
  bool ends_ = false;
};

}  // namespace radivox::gpu
