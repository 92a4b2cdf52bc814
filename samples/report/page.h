// report.html: one file with all plots, pictures and figures in it.
#pragma once

#include "samples/report/results.h"

namespace radivox::report {

void writePage(const Results& results);

/// samples/report/page.html, put into the binary by the build.
const std::string& pageTemplate();

}  // namespace radivox::report
