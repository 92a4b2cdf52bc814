// Pictures of a moving view without a display.
#pragma once

#include "samples/viewer/session.h"
#include "samples/viewer/view_command.h"
#include "samples/viewer/views_file.h"

namespace radivox::viewer {

constexpr double kFramesPerSecond = 30;

/// What the command line asks for to begin with. Throws BadInput.
struct Start {
  View view;
  ViewsFile views;
  uint32_t frames = 1;
  SessionOptions session;
};
Start startOf(const ViewOptions& view, const cli::Options& options);

/// "frame_####.png" → "frame_0007.png"; a name without # is that of every frame, so that the last one stays.
std::string frameName(const std::string& pattern, uint32_t frame);

int runHeadless(const ViewOptions& view, const cli::Options& options);

}  // namespace radivox::viewer
