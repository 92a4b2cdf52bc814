#include "samples/viewer/worker.h"

#include <chrono>
#include <filesystem>

#include "engine/error.h"

namespace radivox::viewer {

Worker::Worker(SessionOptions options, std::function<void()> wake) : wake_(std::move(wake)), start_(std::chrono::steady_clock::now()) {
  thread_ = std::thread([this, options = std::move(options)] {
    try {
      run(options);
    } catch (...) {
      const std::lock_guard lock(mutex_);
      failure_ = std::current_exception();
    }
    wake_();
  });
}

Worker::~Worker() {
  {
    const std::lock_guard lock(mutex_);
    quit_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void Worker::want(const View& view) {
  {
    const std::lock_guard lock(mutex_);
    wanted_ = view;
    ++wantedVersion_;
    status_.error.clear();
  }
  changed_.notify_all();
}

void Worker::save(const std::string& path) {
  {
    const std::lock_guard lock(mutex_);
    toSave_.push_back(path);
  }
  changed_.notify_all();
}

Worker::Status Worker::status() {
  const std::lock_guard lock(mutex_);
  Status status = status_;
  status.idle = status_.doing.empty() && shownVersion_ == wantedVersion_ && toSave_.empty();
  status_.saved.clear();
  return status;
}

std::optional<Picture> Worker::takePicture() {
  const std::lock_guard lock(mutex_);
  return std::exchange(picture_, std::nullopt);
}

void Worker::rethrowFailure() {
  const std::lock_guard lock(mutex_);
  if (failure_) std::rethrow_exception(failure_);
}

void Worker::run(const SessionOptions& options) {
  Session session(options);
  bool failedBefore = false;
  while (true) {
    std::vector<std::string> paths;
    {
      std::unique_lock lock(mutex_);
      status_.doing.clear();
      changed_.wait(lock, [&] { return quit_ || wantedVersion_ != shownVersion_ || !toSave_.empty(); });
      if (quit_) return;
      if (wantedVersion_ == shownVersion_) paths = std::exchange(toSave_, {});
    }
    try {
      if (!paths.empty()) {
        writeFiles(session, paths);
      } else if (showNewest(session)) {
        failedBefore = false;
      }
    } catch (const Error& error) {
      // A device that is lost may come back, once.
      if (error.code() == ErrorCode::DeviceFailed) {
        if (failedBefore) throw;
        failedBefore = true;
        session.reset();
        continue;
      }
      const std::lock_guard lock(mutex_);
      status_.error = error.what();
      shownVersion_ = wantedVersion_;
    }
    wake_();
  }
}

bool Worker::showNewest(Session& session) {
  View view;
  uint64_t version = 0;
  {
    const std::lock_guard lock(mutex_);
    view = wanted_;
    version = wantedVersion_;
  }
  Hooks hooks;
  hooks.newest = [this] {
    const std::lock_guard lock(mutex_);
    return wanted_;
  };
  hooks.publish = [this](Picture picture) {
    {
      const std::lock_guard lock(mutex_);
      if (status_.firstPictureMs == 0)
        status_.firstPictureMs = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count();
      ++(picture.preview ? status_.previewCount : status_.pictureCount);
      picture_ = std::move(picture);
    }
    wake_();
  };
  hooks.progress = [this](std::string_view what, double fraction) {
    const std::lock_guard lock(mutex_);
    status_.doing = what;
    status_.fraction = fraction;
  };
  hooks.stop = [this] {
    const std::lock_guard lock(mutex_);
    return quit_;
  };
  hooks.sceneLoaded = [this, &view](std::shared_ptr<const scene::Scene> scene) {
    {
      const std::lock_guard lock(mutex_);
      status_.scene = std::move(scene);
      status_.sceneName = view.scene;
    }
    wake_();
  };
  const bool done = session.show(view, hooks);
  const std::lock_guard lock(mutex_);
  // A view that moves is done with its preview, until the next one.
  if (done || (view.moving && version == wantedVersion_)) shownVersion_ = version;
  return done;
}

void Worker::writeFiles(Session& session, const std::vector<std::string>& paths) {
  for (const std::string& path : paths) {
    std::string line = path;
    try {
      const std::string remark = session.save(path);
      if (!remark.empty()) line += ", " + remark;
    } catch (const Error& error) {
      line = error.what();
    }
    const std::lock_guard lock(mutex_);
    status_.saved.push_back(line);
  }
}

}  // namespace radivox::viewer
