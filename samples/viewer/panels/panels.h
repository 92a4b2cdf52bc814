// The panels, a function each. All between ImGui's NewFrame and Render.
#pragma once

#include "samples/viewer/app.h"

namespace radivox::viewer {

void drawViewPanel(App& app);    ///< scene, overlays, freeze, screenshots
void drawMethodPanel(App& app);  ///< graph, preset, bounces, every parameter
void drawLightsPanel(App& app);
void drawCameraPanel(App& app);  ///< cameras, bookmarks, paths
void drawGraphPanel(App& app);   ///< what ran and how long, what was left out and why
void drawFacePanel(App& app);    ///< the face under the mouse

/// A widget for a parameter, by its description. True: changed through `set`.
bool drawParam(const std::string& node, const params::Param& param, const std::function<void(const std::string&)>& set);

/// The pictures in the area, rays over them. Sets the app's pointer.
void drawPictures(App& app, float width, float height, bool& hovered);
void drawHelp();

}  // namespace radivox::viewer
