// The strip below the picture: numbers of both sides, what the colors mean, the magnifier, and the last message.
#include <imgui.h>

#include <algorithm>

#include "app/viewer/panels.h"
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

namespace {

/// Left: what was done or went wrong last. Right: how fast the window is, and how small the frames are.
void draw_status(const Session& session, const PanelData& shown) {
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

constexpr int around = magnifier_reach;

/// A square of pixels around the middle one; what lies outside the picture stays dark.
void draw_pixels(const PanelData& shown, float pixel) {
  const float side = pixel * (2 * around + 1);
  const ImVec2 at = ImGui::GetCursorScreenPos();
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddRectFilled(at, {at.x + side, at.y + side}, IM_COL32(12, 12, 14, 255));
  const int width = shown.composition.width, height = shown.composition.height;
  const glm::ivec2 first = glm::max(shown.pixel - around, glm::ivec2(0));
  const glm::ivec2 end = glm::min(shown.pixel + around + 1, glm::ivec2(width, height));
  if (shown.pixel.x >= 0 && first.x < end.x && first.y < end.y) {
    const glm::vec2 low = glm::vec2(first - shown.pixel + around) * pixel, high = glm::vec2(end - shown.pixel + around) * pixel;
    list.AddImage(reinterpret_cast<ImTextureID>(static_cast<std::intptr_t>(shown.texture)), {at.x + low.x, at.y + low.y},
                  {at.x + high.x, at.y + high.y}, {first.x / static_cast<float>(width), first.y / static_cast<float>(height)},
                  {end.x / static_cast<float>(width), end.y / static_cast<float>(height)});
    const ImVec2 corner(at.x + around * pixel, at.y + around * pixel);
    const float line = lengths().scale;
    const auto frame = [&](float beside, ImU32 color) {
      list.AddRect({corner.x - beside, corner.y - beside}, {corner.x + pixel + beside, corner.y + pixel + beside}, color, 0, 0,
                   line);
    };
    frame(line, IM_COL32(0, 0, 0, 255));
    frame(2 * line, picked_color);
  }
  ImGui::Dummy({side, side});
}

void draw_facts(const PanelData& shown, const Session& session) {
  const SideState& side = shown.state.sides[shown.side];
  const bool is_explained = session.picked() && side.explained && side.explained == session.selection().picked;
  const std::vector<PixelFact> facts =
      pixel_facts(shown.composition, shown.side, shown.pixel.x, shown.pixel.y, shown.state.reference.get(),
                  is_explained ? side.explanation.get() : nullptr);
  Widgets::wrapped(fmt::format("{}: {}; pixel {} {}{}", side_name(shown.side), shown.titles[shown.side], shown.pixel.x,
                               shown.pixel.y, session.picked() ? ", picked" : ""),
                   quiet_text);
  Widgets::tooltip("A click in the picture picks its pixel, Escape drops it.");
  if (is_explained && side.depth_curve) draw_depth_curve(*side.depth_curve, shown.side);
  const auto draw_name = [](const PixelFact& fact) { Widgets::wrapped(fact.name, quiet_text); };
  // The meaning of a class is a tooltip only: who looks at many pixels has read it.
  const auto draw_value = [](const PixelFact& fact) {
    const std::size_t end = fact.name == "class" ? fact.value.find(". ") : std::string::npos;
    Widgets::wrapped(fact.value.substr(0, end));
    if (end != std::string::npos) Widgets::tooltip(fact.value.substr(end + 2));
  };
  // Where there is no room for two columns, each value is below its name.
  if (ImGui::GetContentRegionAvail().x < 13 * ImGui::GetFontSize()) {
    for (const PixelFact& fact : facts) {
      draw_name(fact);
      ImGui::Indent(ImGui::GetFontSize() * 0.6f);
      draw_value(fact);
      ImGui::Unindent(ImGui::GetFontSize() * 0.6f);
    }
    return;
  }
  if (!ImGui::BeginTable("facts", 2, ImGuiTableFlags_SizingStretchProp | ImGuiTableFlags_NoSavedSettings)) return;
  float widest = 0;
  for (const PixelFact& fact : facts) widest = std::max(widest, ImGui::CalcTextSize(fact.name.c_str()).x);
  ImGui::TableSetupColumn("name", ImGuiTableColumnFlags_WidthFixed, std::min(widest, ImGui::GetFontSize() * 5.5f));
  ImGui::TableSetupColumn("value", ImGuiTableColumnFlags_WidthStretch);
  for (const PixelFact& fact : facts) {
    ImGui::TableNextColumn();
    draw_name(fact);
    ImGui::TableNextColumn();
    draw_value(fact);
  }
  ImGui::EndTable();
}

/// The pixels around one, about ten times as large, and its facts.
void draw_magnifier(const PanelData& shown, const Session& session) {
  // As large as its place lets it be, in whole pixels.
  const ImVec2 room = ImGui::GetContentRegionAvail();
  const double unit = pixels_per_unit();
  const double most = std::min<double>(room.y, room.x * 0.45) * unit / (2 * around + 1);
  const auto pixel = static_cast<float>(std::max(2.0, std::floor(most)) / unit);
  draw_pixels(shown, pixel);
  ImGui::SameLine(0, lengths().gap);
  if (ImGui::BeginChild("facts", {0, 0})) {
    if (shown.pixel.x < 0)
      Widgets::wrapped("The pixel under the mouse is shown here; a click in the picture picks one.", quiet_text);
    else
      draw_facts(shown, session);
  }
  ImGui::EndChild();
}

}  // namespace

void draw_strip(const PixelRect& place, const Session& session, const PanelData& shown) {
  if (begin_panel("strip", place)) {
    const float status = ImGui::GetTextLineHeightWithSpacing() + ImGui::GetStyle().ItemSpacing.y;
    const ImVec2 room = ImGui::GetContentRegionAvail();
    const float height = std::max(room.y - status, 1.f), gap = lengths().gap;
    // Where there is no room for all three, the magnifier takes the place of the legend while it has a pixel to show.
    const bool is_narrow = room.x < 56 * ImGui::GetFontSize();
    // So do a curve of errors and a profile, which take the magnifier's place everywhere.
    const SampleCurve* const curve = shown.state.curve.get();
    const bool with_plot = curve || session.profile;
    const bool with_magnifier = with_plot || (session.shows_magnifier && !(is_narrow && shown.pixel.x < 0));
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
      part("magnifier", magnifier, [&] {
        curve             ? draw_sample_curve(*curve)
        : session.profile ? draw_profile(shown, *session.profile)
                          : draw_magnifier(shown, session);
      });
    }
    ImGui::Separator();
    draw_status(session, shown);
  }
  ImGui::End();
}

}  // namespace gnomon::viewer
