// radivox report: error against run time.
#pragma once

#include <string>
#include <vector>

#include "samples/cli/options.h"

namespace radivox::report {

struct ReportOptions {
  std::vector<std::string> scenes;
  std::string out;  ///< folder
  std::string size = "640x360";
  std::string timeLimit;             ///< seconds
  std::vector<std::string> methods;  ///< graphs and presets; empty: all
  std::string reference;             ///< "A.exr" or "A.exr,B.exr"; empty: the path tracer
  std::string weights;               ///< "256,512"
  std::string referenceError = "0.03";
  std::string cache;  ///< folder of references; empty: beside compiled pipelines
};

/// `common` has camera, bounces, sets, device and modules.
int runReport(const ReportOptions& options, const cli::Options& common);

}  // namespace radivox::report
