#include "samples/viewer/panels/gui.h"

#include <imgui.h>

#include <algorithm>
#include <cstring>
#include <utility>

#include "samples/viewer/panels/panels.h"

namespace radivox::viewer {

namespace {

constexpr float kPanelWidth = 390.f;
constexpr float kTurnPerPixel = 0.004f;  // rad

void takeStyle() {
  ImGui::StyleColorsDark();
  ImGuiStyle& style = ImGui::GetStyle();
  style.WindowRounding = 0.f;
  style.WindowBorderSize = 0.f;
  style.FrameRounding = 3.f;
  style.ItemSpacing = {7.f, 4.f};
}

}  // namespace

Gui::Gui() : context_(ImGui::CreateContext()) {
  ImGuiIO& io = ImGui::GetIO();
  io.IniFilename = nullptr;  // nothing is written beside the user's files
  takeStyle();
  unsigned char* texels = nullptr;
  int width = 0, height = 0;
  io.Fonts->GetTexDataAsRGBA32(&texels, &width, &height);
  auto font = std::make_shared<Pixels>();
  font->width = static_cast<uint32_t>(width);
  font->height = static_cast<uint32_t>(height);
  font->rgba.assign(texels, texels + size_t{font->width} * font->height * 4);
  font_ = std::move(font);
  io.Fonts->SetTexID(reinterpret_cast<ImTextureID>(kFontTexture));
  io.BackendFlags |= ImGuiBackendFlags_RendererHasVtxOffset;
}

Gui::~Gui() { ImGui::DestroyContext(context_); }

void Gui::takeKeys(App& app) {
  for (const Press& press : std::exchange(pressed_, {})) {
    if (press.control && press.key == 'Q') quit_ = true;
    if (press.control || ImGui::GetIO().WantTextInput) continue;
    const size_t overlay = static_cast<size_t>(press.key) - '1';
    if (press.key >= '1' && overlay < overlayNames().size()) {
      app.overlay = static_cast<Overlay>(overlay);
      app.aov.clear();
    }
    switch (press.key) {
      case 'F':
        app.frozen = !app.frozen;
        break;
      case 'B':
        app.blocks = !app.blocks;
        break;
      case 'T':
        app.truth = !app.truth && Truth::isAvailable();
        break;
      case 'P':
        app.saveScreenshot();
        break;
      case 'V':
        if (App::canDumpVoxels()) app.dumpVoxels();
        break;
      case 'M':
        app.addBookmark();
        break;
      case 'H':
        app.showsPanels = !app.showsPanels;
        break;
      case 'L':
        app.animate = !app.animate;
        break;
      case 'R':
        app.isRecording() ? app.stopRecording() : app.startRecording();
        break;
      default:
        break;
    }
  }
}

PanelFrame Gui::draw(App& app) {
  const ImGuiIO& io = ImGui::GetIO();
  ImGui::NewFrame();
  controls_ = {};
  const bool typing = io.WantTextInput;
  takeKeys(app);

  const float panelWidth = app.showsPanels ? std::min(kPanelWidth, io.DisplaySize.x * 0.6f) : 0.f;
  const float areaWidth = io.DisplaySize.x - panelWidth;
  app.areaWidth = static_cast<uint32_t>(std::max(areaWidth, 16.f));
  app.areaHeight = static_cast<uint32_t>(std::max(io.DisplaySize.y, 16.f));
  bool hovered = false;
  drawPictures(app, areaWidth, io.DisplaySize.y, hovered);
  if (panelWidth > 0) {
    ImGui::SetNextWindowPos({areaWidth, 0});
    ImGui::SetNextWindowSize({panelWidth, io.DisplaySize.y});
    ImGui::Begin("radivox", nullptr, ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove);
    if (ImGui::BeginTabBar("panels")) {
      const auto tab = [&](const char* name, void (*panel)(App&)) {
        if (!ImGui::BeginTabItem(name)) return;
        ImGui::BeginChild(name);
        panel(app);
        ImGui::EndChild();
        ImGui::EndTabItem();
      };
      tab("View", drawViewPanel);
      tab("Method", drawMethodPanel);
      tab("Lights", drawLightsPanel);
      tab("Camera", drawCameraPanel);
      tab("Graph", drawGraphPanel);
      tab("Face", drawFacePanel);
      ImGui::EndTabBar();
    }
    ImGui::End();
  }

  if (hovered && ImGui::IsMouseClicked(ImGuiMouseButton_Left)) looking_ = true;
  if (!ImGui::IsMouseDown(ImGuiMouseButton_Left)) looking_ = false;
  if (looking_) {
    controls_.turnRight = io.MouseDelta.x * kTurnPerPixel;
    controls_.turnUp = -io.MouseDelta.y * kTurnPerPixel;
  }
  if (!typing && !io.KeyCtrl) {
    const auto axis = [](char plus, char minus) { return (ImGui::IsKeyDown(plus) ? 1.f : 0.f) - (ImGui::IsKeyDown(minus) ? 1.f : 0.f); };
    controls_.along = {axis('D', 'A'), axis('E', 'Q'), axis('W', 'S')};
    controls_.fast = io.KeyShift;
  }
  if (hovered && io.MouseWheel != 0.f) app.walk.speed *= io.MouseWheel > 0 ? 1.25f : 0.8f;
  ImGui::Render();
  return takeFrame(app);
}

PanelFrame Gui::takeFrame(const App& app) const {
  const ImDrawData& data = *ImGui::GetDrawData();
  PanelFrame frame;
  frame.width = static_cast<uint32_t>(data.DisplaySize.x);
  frame.height = static_cast<uint32_t>(data.DisplaySize.y);
  frame.textures[kFontTexture] = font_;
  if (app.picture) frame.textures[kPictureTexture] = app.picture->pixels;
  if (app.truthPicture) frame.textures[kTruthTexture] = app.truthPicture->pixels;
  static_assert(sizeof(ImDrawVert) == sizeof(shared::PanelVertex));
  for (int i = 0; i < data.CmdListsCount; ++i) {
    const ImDrawList& list = *data.CmdLists[i];
    const auto firstVertex = static_cast<uint32_t>(frame.vertices.size()), firstIndex = static_cast<uint32_t>(frame.indices.size());
    frame.vertices.resize(firstVertex + static_cast<size_t>(list.VtxBuffer.Size));
    std::memcpy(&frame.vertices[firstVertex], list.VtxBuffer.Data, static_cast<size_t>(list.VtxBuffer.Size) * sizeof(ImDrawVert));
    frame.indices.insert(frame.indices.end(), list.IdxBuffer.begin(), list.IdxBuffer.end());
    for (const ImDrawCmd& command : list.CmdBuffer) {
      if (command.ElemCount == 0) continue;
      const glm::vec2 low = glm::max(glm::vec2(command.ClipRect.x, command.ClipRect.y), glm::vec2(0.f));
      const glm::vec2 high = glm::max(glm::vec2(command.ClipRect.z, command.ClipRect.w), low);
      PanelFrame::Draw draw;
      draw.clip.offset = {static_cast<int32_t>(low.x), static_cast<int32_t>(low.y)};
      draw.clip.extent = {static_cast<uint32_t>(high.x - low.x), static_cast<uint32_t>(high.y - low.y)};
      draw.texture = std::min(reinterpret_cast<size_t>(command.GetTexID()), kTextureCount - 1);
      draw.firstIndex = firstIndex + command.IdxOffset;
      draw.indexCount = command.ElemCount;
      draw.firstVertex = firstVertex + command.VtxOffset;
      frame.draws.push_back(draw);
    }
  }
  return frame;
}

}  // namespace radivox::viewer
