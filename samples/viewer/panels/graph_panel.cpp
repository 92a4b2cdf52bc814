// What ran and how long, what was left out and why; the face under the mouse.
#include <imgui.h>

#include <algorithm>

#include "samples/viewer/panels/panels.h"

namespace radivox::viewer {

namespace {

void drawNodes(const graph::FrameStats& stats) {
  if (!ImGui::BeginTable("nodes", 4, ImGuiTableFlags_RowBg | ImGuiTableFlags_SizingFixedFit)) return;
  ImGui::TableSetupColumn("node", ImGuiTableColumnFlags_WidthStretch);
  for (const char* column : {"GPU ms", "wall ms", "runs"}) ImGui::TableSetupColumn(column);
  ImGui::TableHeadersRow();
  for (const graph::NodeStats& node : stats.nodes) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::TextColored(node.ranLastFrame ? ImVec4(1, 1, 1, 1) : ImVec4(0.55f, 0.55f, 0.55f, 1), "%s", node.name.c_str());
    if (ImGui::IsItemHovered()) {
      std::string text = node.type + (node.ranLastFrame ? "\nran for this picture" : "\nnothing it reads has changed");
      for (const auto& [name, value] : node.figures) text += "\n" + name + " " + std::to_string(value);
      ImGui::SetTooltip("%s", text.c_str());
    }
    ImGui::TableNextColumn();
    ImGui::Text("%.2f", node.gpuMs);
    ImGui::TableNextColumn();
    ImGui::Text("%.2f", node.wallMs);
    ImGui::TableNextColumn();
    ImGui::Text("%u", node.runCount);
  }
  ImGui::EndTable();
}

void drawVector(const char* name, const glm::vec3& v) {
  ImGui::Text("%s %.4g %.4g %.4g", name, static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z));
}

}  // namespace

void drawGraphPanel(App& app) {
  if (!app.picture || !app.picture->report) return;
  const GraphReport& report = *app.picture->report;
  ImGui::TextWrapped("%s on %s", report.graph.c_str(), report.device.c_str());
  ImGui::Text("%s: %.1f ms, %.1f MiB on the device", app.picture->preview ? "preview" : "picture", app.picture->milliseconds,
              static_cast<double>(report.stats.memory.current) / (1024.0 * 1024.0));
  for (const std::string& note : report.notes) ImGui::TextWrapped("%s", note.c_str());
  drawNodes(report.stats);
  if (!report.stats.culled.empty() && ImGui::CollapsingHeader("left out", ImGuiTreeNodeFlags_DefaultOpen)) {
    for (const graph::CulledNode& node : report.stats.culled) ImGui::TextWrapped("%s: %s", node.name.c_str(), node.reason.c_str());
  }
  if (ImGui::CollapsingHeader("counts", ImGuiTreeNodeFlags_DefaultOpen)) {
    for (const auto& [name, value] : report.stats.counts) ImGui::Text("%s %llu", name.c_str(), static_cast<unsigned long long>(value));
  }
  if (ImGui::CollapsingHeader("plan")) ImGui::TextUnformatted(report.plan.c_str());
}

void drawFacePanel(App& app) {
  const std::shared_ptr<const PointedFace> face = app.picture ? app.picture->pointed : nullptr;
  if (!face) {
    ImGui::TextWrapped("Choose the overlay visible_clusters and point at a surface.");
    return;
  }
  static const char* const kDirections[] = {"+x", "-x", "+y", "-y", "+z", "-z"};
  ImGui::Text("face %u: voxel %u %u %u, %s", face->id, face->voxel.x, face->voxel.y, face->voxel.z, kDirections[face->direction % 6]);
  ImGui::Text("area %.4g m2, cluster %u", static_cast<double>(face->area), face->cluster);
  drawVector("position, m  ", face->position);
  drawVector("normal       ", face->normal);
  drawVector("albedo       ", face->albedo);
  if (face->direct) drawVector("E_direct, W/m2", *face->direct);
  if (face->indirect) drawVector("E_indirect, W/m2", *face->indirect);
  ImGui::Separator();
  ImGui::Text("%u rays: %zu clusters, %zu faces of their own, %u leave, %u end on backs", face->rayCount, face->clusters.size(),
              face->faces.size(), face->misses, face->absorbed);
  std::vector<std::pair<uint32_t, uint32_t>> byRays;
  for (const auto& [cluster, rays] : face->clusters) byRays.emplace_back(rays, cluster);
  std::sort(byRays.rbegin(), byRays.rend());
  for (const auto& [rays, cluster] : byRays) {
    const float share = static_cast<float>(rays) / static_cast<float>(std::max(face->rayCount, 1u));
    char text[64];
    std::snprintf(text, sizeof text, "cluster %u: F = %.4f", cluster, static_cast<double>(share));
    ImGui::ProgressBar(share, ImVec2(-1, 0), text);
  }
}

}  // namespace radivox::viewer
