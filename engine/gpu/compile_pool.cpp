#include "engine/gpu/compile_pool.h"

#include <algorithm>
#include <system_error>
#include <utility>

namespace radivox::gpu {

CompilePool::~CompilePool() { finish(); }

std::future<VkPipeline> CompilePool::run(Task task) {
  std::packaged_task<VkPipeline()> packaged(std::move(task));
  std::future<VkPipeline> result = packaged.get_future();
  std::unique_lock lock(mutex_);
  if (idle_ <= queue_.size() && threads_.size() < std::max(1u, std::thread::hardware_concurrency())) {
    try {
      threads_.emplace_back([this] { work(); });
    } catch (const std::system_error&) {  // no more threads: those that there are will do
    }
  }
  if (threads_.empty()) {
    lock.unlock();
    packaged();
    return result;
  }
  queue_.push(std::move(packaged));
  some_.notify_one();
  return result;
}

void CompilePool::finish() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  some_.notify_all();
  for (std::thread& thread : threads_) thread.join();
  threads_.clear();
  ends_ = false;
}

void CompilePool::work() {
  std::unique_lock lock(mutex_);
  while (true) {
    ++idle_;
    some_.wait(lock, [this] { return ends_ || !queue_.empty(); });
    --idle_;
    if (queue_.empty()) return;
    std::packaged_task<VkPipeline()> task = std::move(queue_.front());
    queue_.pop();
    lock.unlock();
    task();
    lock.lock();
  }
}

}  // namespace radivox::gpu
