// radivox view: a window on a scene, or its pictures without one.
#pragma once

#include <string>

#include "samples/cli/options.h"

namespace radivox::viewer {

/// What `radivox view` takes beside SCENE, --graph, --preset, --set, --bounces, --camera, --size, --device, --module, --frames, --out,
/// --stats and --validate.
struct ViewOptions {
  bool headless = false;
  bool panels = false;  ///< headless: the window's panels around the picture
  bool truth = false;   ///< path-traced truth beside the picture
  bool blocks = false;
  std::string overlay = "picture";
  std::string reference;  ///< .exr for overlay error
  std::string point;      ///< "X,Y": the pixel that the mouse points at
  std::string views;      ///< bookmarks, paths and lights
  std::string play;       ///< a path in it
};

int runView(const ViewOptions& view, const cli::Options& options);

}  // namespace radivox::viewer
