// The pictures, and what is drawn over them: rays of the face under the mouse, what is under way, messages.
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "samples/viewer/panels/panels.h"
#include "samples/viewer/window/panel_frame.h"

namespace radivox::viewer {

namespace {

constexpr ImU32 kRayColour = IM_COL32(255, 220, 120, 150), kMissColour = IM_COL32(120, 170, 255, 90),
                kTextColour = IM_COL32(255, 255, 255, 230), kShadowColour = IM_COL32(0, 0, 0, 200),
                kErrorColour = IM_COL32(255, 130, 110, 255);

void drawText(ImDrawList& list, ImVec2 at, ImU32 colour, const std::string& text) {
  list.AddText({at.x + 1, at.y + 1}, kShadowColour, text.c_str());
  list.AddText(at, colour, text.c_str());
}

/// A segment in front of the near plane, on the screen. False: behind it.
bool project(const shared::Camera& camera, glm::vec3 from, glm::vec3 to, ImVec2 origin, ImVec2 size, ImVec2& a, ImVec2& b) {
  glm::vec4 p = camera.viewProjection * glm::vec4(from, 1.f), q = camera.viewProjection * glm::vec4(to, 1.f);
  // Reversed z: in front of the near plane is z < w.
  const float fromInside = p.w - p.z, toInside = q.w - q.z;
  if (fromInside <= 0 && toInside <= 0) return false;
  const glm::vec4 crossing = glm::mix(p, q, fromInside / (fromInside - toInside));
  if (fromInside < 0) p = crossing;
  if (toInside < 0) q = crossing;
  if (!(p.w > 0) || !(q.w > 0)) return false;
  const auto toScreen = [&](const glm::vec4& c) {
    return ImVec2(origin.x + (c.x / c.w * 0.5f + 0.5f) * size.x, origin.y + (c.y / c.w * 0.5f + 0.5f) * size.y);
  };
  a = toScreen(p);
  b = toScreen(q);
  return true;
}

void drawRays(const Picture& picture, ImDrawList& list, ImVec2 origin, ImVec2 size) {
  if (!picture.pointed || picture.view.overlay != Overlay::VisibleClusters) return;
  const shared::Camera camera = scene::makeCamera(picture.view.camera, picture.view.width, picture.view.height);
  ImVec2 a, b;
  for (const PointedFace::Ray& ray : picture.pointed->rays) {
    if (!project(camera, picture.pointed->position, ray.end, origin, size, a, b)) continue;
    list.AddLine(a, b, ray.cluster == ~0u ? kMissColour : kRayColour, 1.f);
    if (ray.cluster != ~0u) list.AddCircleFilled(b, 2.f, kRayColour, 6);
  }
}

std::string statusLine(const App& app) {
  char text[200];
  std::string line;
  if (app.picture) {
    std::snprintf(text, sizeof text, "%s %ux%u, %.0f ms", app.picture->preview ? "preview" : "picture", app.picture->pixels->width,
                  app.picture->pixels->height, app.picture->milliseconds);
    line = text;
  }
  if (!app.status.doing.empty()) {
    std::snprintf(text, sizeof text, "%s%s %.0f %%", line.empty() ? "" : "  |  ", app.status.doing.c_str(), app.status.fraction * 100.0);
    line += text;
  }
  if (app.frozen) line += "  |  frozen";
  if (app.isRecording()) line += "  |  recording";
  return line;
}

}  // namespace

void drawPictures(App& app, float width, float height, bool& hovered) {
  ImGui::SetNextWindowPos({0, 0});
  ImGui::SetNextWindowSize({width, height});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(0, 0));
  ImGui::Begin("pictures", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoBringToFrontOnFocus |
                   ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoNav);
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const float half = app.truth ? std::floor(width / 2) : width;
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  hovered = ImGui::IsWindowHovered() && mouse.x >= 0 && mouse.y >= 0;
  if (app.picture) {
    list.AddImage(reinterpret_cast<ImTextureID>(kPictureTexture), {0, 0}, {half, height});
    list.PushClipRect({0, 0}, {half, height}, true);
    if (app.showsRays) drawRays(*app.picture, list, {0, 0}, {half, height});
    list.PopClipRect();
  }
  if (app.truth) {
    if (app.truthPicture) list.AddImage(reinterpret_cast<ImTextureID>(kTruthTexture), {half, 0}, {width, height});
    char text[128];
    std::snprintf(text, sizeof text, "path-traced truth");
    if (app.truthPicture) {
      std::snprintf(text, sizeof text, "path-traced truth, %u samples a pixel, noise %.0f %%", app.truthPicture->samples,
                    std::isfinite(app.truthPicture->noise) ? app.truthPicture->noise * 100 : 100.0);
    }
    drawText(list, {half + 8, 8}, kTextColour, app.truthError().empty() ? text : app.truthError());
    list.AddLine({half, 0}, {half, height}, kShadowColour, 2.f);
  }
  if (hovered && mouse.x < half) {
    const auto area = glm::uvec2(static_cast<uint32_t>(half), app.areaHeight);
    app.pointer = glm::min(glm::uvec2(static_cast<uint32_t>(mouse.x), static_cast<uint32_t>(mouse.y)), area - 1u);
  }
  drawText(list, {8, 8}, kTextColour, statusLine(app));
  if (!app.status.error.empty()) drawText(list, {8, 26}, kErrorColour, app.status.error);
  if (app.picture && !app.picture->remark.empty()) drawText(list, {8, 44}, kErrorColour, app.picture->remark);
  if (app.picture && app.picture->error) {
    char text[160];
    const image::Comparison& e = *app.picture->error;
    std::snprintf(text, sizeof text, "against %s: bias %.4f, RMSE %.4g, relMSE %.4g, PSNR %.1f dB", app.reference.c_str(), e.bias, e.rmse,
                  e.relMse, e.psnr);
    drawText(list, {8, height - 22}, kTextColour, text);
  }
  ImGui::End();
  ImGui::PopStyleVar();
}

}  // namespace radivox::viewer
