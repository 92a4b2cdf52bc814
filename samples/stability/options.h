// radivox stability: what the command line says.
#pragma once

#include <string>
#include <vector>

#include "samples/cli/options.h"

namespace radivox::stability {

struct SuiteOptions {
  std::string out;
  std::vector<std::string> methods;  ///< graphs; empty: every one that computes indirect light
  std::string match;                 ///< only cases whose group and name hold this
  std::string timeLimit;
  bool fast = false;
};

/// 0: no case failed; 1: some did, and one line on standard error says how many.
int runStability(const SuiteOptions& options, const cli::Options& common);

}  // namespace radivox::stability
