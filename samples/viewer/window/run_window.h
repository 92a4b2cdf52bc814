// The window: GLFW's events in, frames out. And its panels without one.
#pragma once

#include "samples/viewer/view_command.h"

namespace radivox::viewer {

/// Until it is closed. Throws Error(Unsupported) where there is no display.
int runWindow(const ViewOptions& view, const cli::Options& options);
/// Full pictures with the panels around them, to --out.
int runHeadlessPanels(const ViewOptions& view, const cli::Options& options);

}  // namespace radivox::viewer
