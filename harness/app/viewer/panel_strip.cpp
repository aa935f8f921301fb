// The strip below the picture: numbers of both sides, what the colors mean, the magnifier, and the last message.
#include <imgui.h>

#include <algorithm>

#include "app/viewer/panels.h"
#include "app/viewer/style.h"
#include "app/viewer/window.h"

namespace gnomon::viewer {

Arrangement arrange(glm::ivec2 window, double scale, bool with_panels) {
  constexpr int least = 16;  // pixels that are left of a picture
  const int panel = with_panels ? std::min(static_cast<int>(std::lround(panel_width * scale)), window.x - least) : 0;
  const int strip = with_panels ? std::min(static_cast<int>(std::lround(strip_height * scale)), window.y - least) : 0;
  const glm::ivec2 rest = glm::max(window - glm::ivec2(panel, strip), glm::ivec2(least));
  return {.controls = {0, 0, panel, window.y}, .picture = {panel, 0, rest.x, rest.y}, .strip = {panel, rest.y, rest.x, strip}};
}

bool begin_panel(const char* name, const PixelRect& place) {
  const auto scale = static_cast<float>(pixels_per_unit());
  ImGui::SetNextWindowPos({place.x / scale, place.y / scale});
  ImGui::SetNextWindowSize({place.width / scale, place.height / scale});
  return ImGui::Begin(name, nullptr,
                      ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                          ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoNav);
}

void end_panel() { ImGui::End(); }

namespace {

/// Left: what was done or went wrong last. Right: how fast the window is, and how small the frames are.
void draw_status(const Session& session, const Shown& shown) {
  std::string words = shown.frames_per_second > 1 ? fmt::format("{:.0f} frames/s", shown.frames_per_second)
                      : shown.state.is_finished   ? "at rest"
                                                  : "computing";
  if (const auto& frame = shown.state.frame; frame && !frame->is_full())
    words = fmt::format("{} x {} pixels   {}", frame->gbuffer.width, frame->gbuffer.height, words);
  const float width = ImGui::CalcTextSize(words.c_str()).x;
  const float room = ImGui::GetContentRegionAvail().x;
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float for_message = room - width - 2 * lengths().gap;
  ImGui::PushClipRect(at, {at.x + for_message, at.y + ImGui::GetTextLineHeightWithSpacing()}, true);
  ImGui::PushStyleColor(ImGuiCol_Text, session.is_warning() ? warning_text : ImGui::GetColorU32(ImGuiCol_Text));
  if (session.message().empty())
    ImGui::TextDisabled("F1 lists all keys");
  else
    ImGui::TextUnformatted(session.message().c_str());
  ImGui::PopStyleColor();
  ImGui::PopClipRect();
  Widgets::tooltip(session.message());
  ImGui::SameLine(std::max(0.f, room - width) + ImGui::GetStyle().WindowPadding.x);
  ImGui::TextDisabled("%s", words.c_str());
}

}  // namespace

void draw_strip(const PixelRect& place, const Session& session, const Shown& shown) {
  if (begin_panel("strip", place)) {
    const float status = ImGui::GetTextLineHeightWithSpacing() + ImGui::GetStyle().ItemSpacing.y;
    const ImVec2 room = ImGui::GetContentRegionAvail();
    const float height = std::max(room.y - status, 1.f), gap = lengths().gap;
    // Where there is no room for all three, the magnifier takes the place of the legend while it has a pixel to show.
    const bool is_narrow = room.x < 56 * ImGui::GetFontSize();
    const bool with_magnifier = session.shows_magnifier && !(is_narrow && shown.pixel.x < 0);
    const bool with_legend = !(is_narrow && with_magnifier);
    // One side's numbers lie beside each other, and its legend is narrow.
    const bool is_single = shown.state.sides[0].is_reference || shown.state.sides[1].is_reference;
    const float numbers = room.x * (is_narrow ? 0.55f : !with_magnifier ? 0.5f : is_single ? 0.39f : 0.35f);
    const float magnifier = !with_magnifier ? 0 : with_legend ? room.x * 0.39f : room.x - numbers - gap;
    const float legend = room.x - numbers - gap - (with_magnifier ? magnifier + gap : 0);
    const auto part = [&](const char* name, float width, auto&& draw) {
      if (ImGui::BeginChild(name, {width, height})) draw();
      ImGui::EndChild();
    };
    part("numbers", numbers, [&] { draw_numbers(shown, session); });
    if (with_legend) {
      ImGui::SameLine(0, gap);
      part("legend", legend, [&] { draw_legend(shown); });
    }
    if (with_magnifier) {
      ImGui::SameLine(0, gap);
      part("magnifier", magnifier, [&] { draw_magnifier(shown, session); });
    }
    ImGui::Separator();
    draw_status(session, shown);
  }
  end_panel();
}

}  // namespace gnomon::viewer
