// Graph, preset, bounces, and a widget for every parameter.
#include <imgui.h>
#include <imgui_stdlib.h>

#include <cmath>

#include "engine/error.h"
#include "samples/cli/assets.h"
#include "samples/viewer/panels/panels.h"

namespace radivox::viewer {

namespace {

void explain(const params::Param& param) {
  if (!ImGui::IsItemHovered()) return;
  static const char* const kCost[] = {"a change compiles the graph again", "a change runs the node again",
                                      "a change shows in the next frame"};
  std::string text = param.help + "\ndefault " + param.defaultValue;
  if (param.type == params::Type::UInt || param.type == params::Type::Float) {
    char range[64];
    std::snprintf(range, sizeof range, ", from %g to %g", param.range.min, param.range.max);
    text += range;
  }
  if (!param.sweep.empty()) {
    text += "\nworth trying:";
    for (const std::string& value : param.sweep) text += " " + value;
  }
  ImGui::SetTooltip("%s\n%s; right-click: the default", text.c_str(), kCost[static_cast<size_t>(param.invalidates)]);
}

/// Numbers are taken when editing ends: a graph is not compiled for every digit.
bool drawNumber(const char* label, const params::Param& param, std::string& text) {
  if (param.type == params::Type::UInt) {
    auto value = static_cast<uint32_t>(std::stoul(param.get()));
    const uint32_t step = 1;
    ImGui::InputScalar(label, ImGuiDataType_U32, &value, &step, nullptr, nullptr, ImGuiInputTextFlags_EnterReturnsTrue);
    text = std::to_string(value);
    return ImGui::IsItemDeactivatedAfterEdit() || text != param.get();
  }
  auto value = std::stof(param.get());
  const bool entered = ImGui::InputFloat(label, &value, 0.f, 0.f, "%g", ImGuiInputTextFlags_EnterReturnsTrue);
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.9g", static_cast<double>(value));
  text = buffer;
  return entered || (ImGui::IsItemDeactivatedAfterEdit() && value != std::stof(param.get()));
}

}  // namespace

bool drawParam(const std::string& node, const params::Param& param, const std::function<void(const std::string&)>& set) {
  const std::string label = param.name + "##" + node;
  std::string text = param.get();
  bool changed = false;
  switch (param.type) {
    case params::Type::Bool: {
      bool value = text == "true";
      changed = ImGui::Checkbox(label.c_str(), &value);
      text = value ? "true" : "false";
      break;
    }
    case params::Type::Choice:
      if (ImGui::BeginCombo(label.c_str(), text.c_str())) {
        for (const std::string& choice : param.choices) {
          if (!ImGui::Selectable(choice.c_str(), choice == text)) continue;
          text = choice;
          changed = true;
        }
        ImGui::EndCombo();
      }
      break;
    case params::Type::UInt:
    case params::Type::Float:
      changed = drawNumber(label.c_str(), param, text);
      break;
    default:
      changed = ImGui::InputText(label.c_str(), &text, ImGuiInputTextFlags_EnterReturnsTrue);
      break;
  }
  explain(param);
  if (ImGui::IsItemClicked(ImGuiMouseButton_Right)) {
    text = param.defaultValue;
    changed = true;
  }
  if (changed && text != param.get()) set(text);
  return changed;
}

void drawMethodPanel(App& app) {
  Settings& settings = app.settings;
  const auto guarded = [&app](const std::function<void()>& change) {
    try {
      change();
    } catch (const Error& error) {
      app.say(error.what());
    }
  };
  if (ImGui::BeginCombo("method", settings.graph().c_str())) {
    for (const cli::Asset& graph : cli::graphs()) {
      if (ImGui::Selectable(graph.name.c_str(), graph.name == settings.graph())) guarded([&] { settings.chooseGraph(graph.name); });
    }
    ImGui::EndCombo();
  }
  if (ImGui::BeginCombo("preset", settings.preset().empty() ? "none" : settings.preset().c_str())) {
    for (const cli::Asset& preset : cli::presets()) {
      if (ImGui::Selectable(preset.name.c_str(), preset.name == settings.preset())) guarded([&] { settings.choosePreset(preset.name); });
    }
    ImGui::EndCombo();
  }
  if (ImGui::BeginCombo("indirect bounces", settings.bounces().c_str())) {
    for (const char* bounces : {"0", "1", "2", "4", "8", "all"}) {
      if (ImGui::Selectable(bounces, settings.bounces() == bounces)) settings.setBounces(bounces);
    }
    ImGui::EndCombo();
  }
  ImGui::Separator();
  for (const Settings::Group& group : settings.groups()) {
    if (!ImGui::CollapsingHeader((group.node + "  " + group.type).c_str(), ImGuiTreeNodeFlags_DefaultOpen)) continue;
    ImGui::PushItemWidth(150.f);
    for (const params::Param& param : group.table->all()) {
      drawParam(group.node, param, [&](const std::string& value) { guarded([&] { settings.set(group.node + "." + param.name, value); }); });
    }
    ImGui::PopItemWidth();
  }
}

}  // namespace radivox::viewer
