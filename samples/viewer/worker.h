// The session on a thread of its own: views go in, pictures come out, and nobody waits.
#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <thread>

#include "samples/viewer/session.h"

namespace radivox::viewer {

class Worker {
 public:
  /// `wake` is called from the worker's thread when there is something to fetch.
  Worker(SessionOptions options, std::function<void()> wake);
  ~Worker();  ///< ends the work under way at its next step

  /// The newest view counts; those before it that were not shown yet are not.
  void want(const View& view);
  /// Writes the full picture of the newest view, as soon as there is one: .png as a screen shows it, .exr with every AOV.
  void save(const std::string& path);

  struct Status {
    std::string doing;  ///< node or phase; empty: idle
    double fraction = 0;
    bool idle = true;                           ///< the newest view is shown in full (or `error` says why not), and all is written
    std::string error;                          ///< why the newest view is not shown, one line
    std::vector<std::string> saved;             ///< paths written, or lines that say why not, since the last status
    std::shared_ptr<const scene::Scene> scene;  ///< loaded
    std::string sceneName;                      ///< as the view named it
    double firstPictureMs = 0;                  ///< since the worker was made; 0: none yet
    uint64_t pictureCount = 0, previewCount = 0;
  };
  Status status();
  /// The newest picture, once.
  std::optional<Picture> takePicture();
  /// Rethrows what ended the worker (no device, for instance).
  void rethrowFailure();

 private:
  void run(const SessionOptions& options);
  bool showNewest(Session& session);
  void writeFiles(Session& session, const std::vector<std::string>& paths);

  std::function<void()> wake_;
  std::chrono::steady_clock::time_point start_;
  std::mutex mutex_;
  std::condition_variable changed_;
  View wanted_;
  uint64_t wantedVersion_ = 0, shownVersion_ = 0;  ///< versions of wanted_; 0: none
  std::vector<std::string> toSave_;
  std::optional<Picture> picture_;
  Status status_;
  std::exception_ptr failure_;
  bool quit_ = false;
  std::thread thread_;
};

}  // namespace radivox::viewer
