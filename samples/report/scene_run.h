// One scene of the report: its reference, the path tracer's curve, and every setting there is time for.
#pragma once

#include "samples/cli/progress.h"
#include "samples/report/clock.h"
#include "samples/report/options.h"
#include "samples/report/results.h"
#include "samples/report/row_cache.h"

namespace radivox::report {

/// What all scenes share.
struct Session {
  const ReportOptions& options;
  const cli::Options& common;
  cli::Size size;
  uint32_t bounces;
  double referenceError;
  gpu::Device& device;
  const Clock& clock;
  cli::ProgressBar& bar;
  std::string cacheFolder, pictures;
  RowCache cache;
  std::string program;  ///< programKey()
};

/// `shareOfTime`: of what the clock has left. Throws Error, cli::Interrupted; rows measured until then are in the cache.
SceneResults runScene(Session& session, const std::string& source, const std::string& name, double shareOfTime);

}  // namespace radivox::report
