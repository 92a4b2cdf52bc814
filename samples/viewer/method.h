// A graph at work on a scene: compiled for a view, and brought from view to view with as little rerun as may be.
#pragma once

#include <memory>
#include <optional>
#include <set>
#include <string>

#include "samples/cli/job.h"
#include "samples/viewer/picture.h"
#include "samples/viewer/ports.h"

namespace radivox::viewer {

class Method {
 public:
  enum class Quality {
    Full,     ///< the view's settings; every AOV is kept
    Preview,  ///< each parameter that trades time for quality at its cheapest; the picture alone
  };
  /// Makes the scene's buffers, the plan, and every pipeline. `scene` has the view's lights. Throws Error.
  Method(gpu::Device& device, const scene::Scene& scene, const View& view, const std::vector<std::string>& modules, Quality quality);

  /// Takes over what differs in `view`. False: it needs another plan, and so another Method; this one is as it was.
  bool update(const scene::Scene& scene, const View& view);
  /// Runs what is stale. Throws Error; "interrupted" when cancelled.
  void run(const graph::Progress& progress, const std::function<bool()>& cancelled);

  /// The light of the picture is that of the view it was last run with: what remains is the camera's work.
  bool isLit() const { return lit_; }
  double lastFrameMs() const { return lastFrameMs_; }  ///< of the last run() of a lit method; 0: none yet

  Pixels display();
  float exposure();
  bool isFilmic() const;
  /// The AOV as layers of a file have it. Throws BadInput where the plan has none of that name.
  image::Layer aov(const std::string& name, const scene::Scene& scene);
  /// The voxel grids to a .vdb or .nvdb file. Returns a remark on those that no node has made, empty: all are there. Throws Error,
  /// Unsupported where the build has no modules/vdb.
  std::string dumpVoxels(const std::string& path, const scene::Scene& scene);
  std::vector<std::string> aovNames() const;
  GraphReport report() const;
  Ports ports() const { return Ports(job_->graph, *executor_); }
  gpu::Device& device() const { return device_; }
  const scene::GpuScene& scene() const { return *gpuScene_; }

 private:
  void compile(const scene::Scene& scene);
  void applySettings(const View& view);
  std::string planKey(const View& view) const;
  gpu::Device& device_;
  Quality quality_;
  std::unique_ptr<cli::Job> job_;
  std::set<std::string> fixed_;  ///< parameters that the preview keeps cheap
  std::unique_ptr<scene::GpuScene> gpuScene_;
  scene::Traits traits_;
  std::unique_ptr<graph::Executor> executor_;
  std::string planKey_;
  View view_;
  bool lit_ = false;
  double lastFrameMs_ = 0;
};

}  // namespace radivox::viewer
