// Where the command keeps compiled pipelines between runs.
#pragma once

#include <string>

namespace radivox::cli {

/// $RADIVOX_PIPELINE_CACHE if it is set (empty: none is kept), else radivox/pipelines under $XDG_CACHE_HOME or ~/.cache. The folder is made.
/// Empty where there is no such place: a cache that cannot be kept is no error.
std::string pipelineCacheFile();

}  // namespace radivox::cli
