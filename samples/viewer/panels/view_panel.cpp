// Scene, overlays, freeze, screenshots, messages.
#include <imgui.h>
#include <imgui_stdlib.h>

#include "engine/scene/builtin.h"
#include "samples/viewer/panels/panels.h"

namespace radivox::viewer {

namespace {

void drawSceneChoice(App& app) {
  if (ImGui::BeginCombo("scene", app.scene.c_str())) {
    for (const scene::BuiltinInfo& info : scene::builtinScenes()) {
      const std::string name = "builtin:" + info.name;
      if (ImGui::Selectable(name.c_str(), name == app.scene)) app.open(name);
      if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", info.help.c_str());
    }
    ImGui::EndCombo();
  }
  static std::string path;
  ImGui::InputTextWithHint("##file", "hall.glb, truth.exr or views.json", &path);
  ImGui::SameLine();
  if (ImGui::Button("open") && !path.empty()) app.open(path);
  ImGui::TextDisabled("or drop a file onto the window");
}

void drawOverlayChoice(App& app) {
  const std::vector<std::string>& names = overlayNames();
  for (size_t i = 0; i < names.size(); ++i) {
    const auto overlay = static_cast<Overlay>(i);
    const std::string label = std::to_string(i + 1) + " " + names[i];
    if (ImGui::RadioButton(label.c_str(), app.overlay == overlay && (overlay != Overlay::Picture || app.aov.empty()))) {
      app.overlay = overlay;
      app.aov.clear();
    }
    if (i % 2 == 0) ImGui::SameLine(190.f);
  }
  ImGui::NewLine();
  if (ImGui::BeginCombo("AOV", app.aov.empty() ? "none" : app.aov.c_str())) {
    for (const std::string& name : app.settings.aovs()) {
      if (!ImGui::Selectable(name.c_str(), name == app.aov)) continue;
      app.overlay = Overlay::Picture;
      app.aov = name;
    }
    ImGui::EndCombo();
  }
  ImGui::Checkbox("B on blocks", &app.blocks);
  ImGui::SameLine(190.f);
  ImGui::Checkbox("rays", &app.showsRays);
}

}  // namespace

void drawViewPanel(App& app) {
  drawSceneChoice(app);
  ImGui::Separator();
  drawOverlayChoice(app);
  ImGui::Separator();
  ImGui::Checkbox("F freeze", &app.frozen);
  ImGui::SameLine(190.f);
  if (Truth::isAvailable()) ImGui::Checkbox("T path-traced truth", &app.truth);
  if (ImGui::Button("P screenshot (.png and .exr)")) app.saveScreenshot();
  if (App::canDumpVoxels() && ImGui::Button("V voxels (.vdb)")) app.dumpVoxels();
  ImGui::Separator();
  drawHelp();
  ImGui::Separator();
  for (auto line = app.messages.rbegin(); line != app.messages.rend(); ++line) ImGui::TextWrapped("%s", line->c_str());
}

void drawHelp() {
  ImGui::TextDisabled("W A S D, Q E: walk   Shift: fast   drag: look");
  ImGui::TextDisabled("wheel: pace   H: panels   M: bookmark   R: record");
  ImGui::TextDisabled("L: animate   Ctrl-Q: quit");
}

}  // namespace radivox::viewer
