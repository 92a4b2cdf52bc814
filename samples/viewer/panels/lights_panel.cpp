// Lights: move, turn, colour, animate.
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "samples/viewer/panels/panels.h"

namespace radivox::viewer {

namespace {

/// A colour whose largest channel is 1, and how much of it.
void drawIntensity(glm::vec3& intensity, bool directional) {
  float strength = std::max({intensity.x, intensity.y, intensity.z});
  glm::vec3 colour = strength > 0 ? intensity / strength : glm::vec3(1.f);
  bool changed = ImGui::ColorEdit3("colour", &colour.x, ImGuiColorEditFlags_Float);
  changed = ImGui::DragFloat(directional ? "W/m2" : "W/sr", &strength, std::max(strength, 0.1f) * 0.01f, 0.f, 1e6f, "%.4g") || changed;
  if (changed) intensity = colour * std::max(strength, 0.f);
}

void drawDirection(glm::vec3& direction) {
  float height = glm::degrees(std::asin(std::clamp(-direction.y, -1.f, 1.f)));
  float turn = glm::degrees(std::atan2(-direction.x, -direction.z));
  bool changed = ImGui::SliderFloat("comes from, degrees up", &height, -90.f, 90.f, "%.1f");
  changed = ImGui::SliderFloat("round", &turn, -180.f, 180.f, "%.1f") || changed;
  if (!changed) return;
  const float up = glm::radians(std::clamp(height, -89.99f, 89.99f)), round = glm::radians(turn);
  direction = -glm::normalize(glm::vec3(std::cos(up) * std::sin(round), std::sin(up), std::cos(up) * std::cos(round)));
}

void drawLamp(Lamp& lamp, float pace) {
  scene::PunctualLight& light = lamp.light;
  const bool directional = light.type == shared::kLightDirectional;
  ImGui::Checkbox("on", &lamp.on);
  if (!directional) ImGui::DragFloat3("position, m", &light.position.x, pace, 0.f, 0.f, "%.3g");
  if (light.type != shared::kLightPoint) drawDirection(light.direction);
  drawIntensity(light.intensity, directional);
  if (light.type == shared::kLightSpot) {
    float outer = glm::degrees(light.outerConeAngle), inner = glm::degrees(light.innerConeAngle);
    bool changed = ImGui::SliderFloat("cone, degrees", &outer, 1.f, 89.f, "%.1f");
    changed = ImGui::SliderFloat("inner cone", &inner, 0.f, outer, "%.1f") || changed;
    if (changed) {
      light.outerConeAngle = glm::radians(outer);
      light.innerConeAngle = glm::radians(std::min(inner, outer - 0.1f));
    }
  }
  int motion = static_cast<int>(lamp.motion);
  if (ImGui::Combo(
          "moves", &motion,
          [](void*, int i, const char** name) {
            *name = motionNames()[static_cast<size_t>(i)].c_str();
            return true;
          },
          nullptr, static_cast<int>(motionNames().size())))
    lamp.motion = static_cast<Motion>(motion);
  if (lamp.motion == Motion::Still) return;
  ImGui::SliderFloat("period, s", &lamp.period, 0.5f, 60.f, "%.1f", ImGuiSliderFlags_Logarithmic);
  ImGui::SliderFloat("reach, m", &lamp.reach, 0.01f, 20.f, "%.2f", ImGuiSliderFlags_Logarithmic);
}

}  // namespace

void drawLightsPanel(App& app) {
  ImGui::Checkbox("L animate", &app.animate);
  ImGui::SameLine(190.f);
  if (ImGui::Button("as in the scene") && app.loaded) app.lamps = Lamps::of(*app.loaded);
  ImGui::ColorEdit3("sky, W/(m2 sr)", &app.lamps.sky.x, ImGuiColorEditFlags_Float | ImGuiColorEditFlags_HDR);
  app.lamps.sky = glm::max(app.lamps.sky, glm::vec3(0.f));
  for (size_t i = 0; i < app.lamps.lamps.size(); ++i) {
    Lamp& lamp = app.lamps.lamps[i];
    static const char* const kTypes[] = {"directional", "point", "spot"};
    const std::string label = std::to_string(i) + " " + lamp.light.name + " (" + kTypes[std::min(lamp.light.type, 2u)] + ")";
    ImGui::PushID(static_cast<int>(i));
    if (ImGui::CollapsingHeader(label.c_str(), ImGuiTreeNodeFlags_DefaultOpen)) drawLamp(lamp, app.walk.speed * 0.01f);
    ImGui::PopID();
  }
  ImGui::Separator();
  const auto add = [&](const char* label, uint32_t type) {
    if (!ImGui::Button(label)) return;
    Lamp lamp;
    lamp.light.name = "added";
    lamp.light.type = type;
    lamp.light.position = app.walk.camera().position;
    lamp.light.direction = app.walk.camera().orientation * glm::vec3(0, 0, -1);
    lamp.light.intensity = glm::vec3(type == shared::kLightDirectional ? 1.f : app.walk.speed * app.walk.speed * 5.f);
    app.lamps.lamps.push_back(lamp);
  };
  add("add a point light here", shared::kLightPoint);
  add("add a spot light here", shared::kLightSpot);
  add("add a sun along the view", shared::kLightDirectional);
  if (!app.lamps.lamps.empty() && ImGui::Button("remove the last")) app.lamps.lamps.pop_back();
  if (ImGui::Button("keep with the views")) app.saveViews();
}

}  // namespace radivox::viewer
