// How the window looks: dark and quiet, so that the picture is what one sees.
#include "app/viewer/style.h"

namespace gnomon::viewer {

namespace {

float unit_scale = 1;

}  // namespace

void set_style(double scale) {
  unit_scale = static_cast<float>(scale);
  ImGuiStyle style;
  ImGui::StyleColorsDark(&style);
  style.WindowPadding = {10, 8};
  style.FramePadding = {6, 3};
  style.ItemSpacing = {6, 4};
  style.ItemInnerSpacing = {5, 4};
  style.CellPadding = {4, 1};
  style.ScrollbarSize = 11;
  style.GrabMinSize = 9;
  style.WindowBorderSize = style.ChildBorderSize = 0;
  style.PopupBorderSize = 1;
  style.WindowRounding = 0;
  style.FrameRounding = style.GrabRounding = style.PopupRounding = style.ScrollbarRounding = 3;
  const ImVec4 accent(0.33f, 0.58f, 0.80f, 1);
  const auto gray = [](float value, float alpha = 1) { return ImVec4(value * 0.96f, value, value * 1.06f, alpha); };
  const auto set = [&](ImGuiCol what, const ImVec4& color) { style.Colors[what] = color; };
  const auto faded = [](ImVec4 color, float alpha) {
    color.w = alpha;
    return color;
  };
  set(ImGuiCol_Text, gray(0.86f));
  set(ImGuiCol_TextDisabled, ImGui::ColorConvertU32ToFloat4(quiet_text));
  set(ImGuiCol_WindowBg, gray(0.125f));
  set(ImGuiCol_PopupBg, gray(0.145f, 0.98f));
  set(ImGuiCol_Border, gray(0.28f));
  set(ImGuiCol_FrameBg, gray(0.19f));
  set(ImGuiCol_FrameBgHovered, gray(0.24f));
  set(ImGuiCol_FrameBgActive, gray(0.27f));
  set(ImGuiCol_Button, gray(0.23f));
  set(ImGuiCol_ButtonHovered, gray(0.3f));
  set(ImGuiCol_ButtonActive, faded(accent, 0.7f));
  set(ImGuiCol_Header, gray(0.18f));
  set(ImGuiCol_HeaderHovered, gray(0.24f));
  set(ImGuiCol_HeaderActive, gray(0.27f));
  set(ImGuiCol_CheckMark, accent);
  set(ImGuiCol_SliderGrab, faded(accent, 0.85f));
  set(ImGuiCol_SliderGrabActive, accent);
  set(ImGuiCol_Separator, gray(0.22f));
  set(ImGuiCol_ScrollbarBg, gray(0.11f));
  set(ImGuiCol_ScrollbarGrab, gray(0.28f));
  set(ImGuiCol_TextSelectedBg, faded(accent, 0.4f));
  style.ScaleAllSizes(unit_scale);
  ImGui::GetStyle() = style;
}

Lengths lengths() {
  const auto scaled = [](float value) { return value * unit_scale; };
  return {.panel = scaled(panel_width), .strip = scaled(strip_height), .label = scaled(112), .gap = scaled(8)};
}

}  // namespace gnomon::viewer
