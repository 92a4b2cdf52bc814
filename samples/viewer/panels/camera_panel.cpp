// Cameras of the scene, bookmarks, recorded paths.
#include <imgui.h>

#include "samples/viewer/panels/panels.h"

namespace radivox::viewer {

void drawCameraPanel(App& app) {
  const scene::CameraDescription& camera = app.walk.camera();
  ImGui::Text("at %.3f %.3f %.3f m", static_cast<double>(camera.position.x), static_cast<double>(camera.position.y),
              static_cast<double>(camera.position.z));
  ImGui::SliderFloat("pace, m/s", &app.walk.speed, 0.01f, 100.f, "%.2f", ImGuiSliderFlags_Logarithmic);
  if (app.loaded) {
    ImGui::Separator();
    ImGui::TextDisabled("cameras of the scene");
    for (size_t i = 0; i < app.loaded->cameras.size(); ++i) {
      const std::string label = std::to_string(i) + " " + app.loaded->cameras[i].name;
      if (ImGui::Selectable(label.c_str())) app.jumpTo(app.loaded->cameras[i]);
    }
  }
  ImGui::Separator();
  if (ImGui::Button("M bookmark")) app.addBookmark();
  for (size_t i = 0; i < app.views.bookmarks.size(); ++i) {
    ImGui::PushID(static_cast<int>(i));
    if (ImGui::SmallButton("x")) {
      app.views.bookmarks.erase(app.views.bookmarks.begin() + static_cast<std::ptrdiff_t>(i));
      app.saveViews();
      ImGui::PopID();
      break;
    }
    ImGui::SameLine();
    if (ImGui::Selectable(app.views.bookmarks[i].name.c_str())) app.jumpTo(app.views.bookmarks[i].camera);
    ImGui::PopID();
  }
  ImGui::Separator();
  if (ImGui::Button(app.isRecording() ? "R stop recording" : "R record a path"))
    app.isRecording() ? app.stopRecording() : app.startRecording();
  if (app.isPlaying()) {
    ImGui::SameLine();
    if (ImGui::Button("stop")) app.stopPlaying();
  }
  for (size_t i = 0; i < app.views.paths.size(); ++i) {
    char label[160];
    std::snprintf(label, sizeof label, "%s, %.1f s##path%zu", app.views.paths[i].name.c_str(), app.views.paths[i].seconds(), i);
    if (ImGui::Selectable(label)) app.play(i);
  }
  ImGui::TextDisabled("kept in %s", app.viewsPath.c_str());
}

}  // namespace radivox::viewer
