// What the picture's colors mean.
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "app/viewer/panels.h"
#include "measure/cause/own_causes.h"
#include "measure/picture/signed_color.h"
#include "measure/score/error_picture.h"

namespace gnomon::viewer {

namespace {

bool is_shown(Layout layout, int side) {
  return layout == Layout::split || layout == Layout::flicker || (layout == Layout::left) == (side == 0);
}

void draw_swatch(ImU32 color) {
  const float size = ImGui::GetFontSize() * 0.8f;
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float top = at.y + (ImGui::GetTextLineHeight() - size) / 2;
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddRectFilled({at.x, top}, {at.x + size, top + size}, color, size / 6);
  // Some colors are nearly those of the panel.
  list.AddRect({at.x, top}, {at.x + size, top + size}, IM_COL32(255, 255, 255, 50), size / 6);
  ImGui::Dummy({size, ImGui::GetTextLineHeight()});
  ImGui::SameLine();
}

/// What the name of a cause or class means; empty of others.
std::string sentence_of(const Composition& composition, const std::string& name) {
  const Paint paint = composition.paint;
  if (paint == Paint::causes)
    for (const ComposeSide& side : composition.sides) {
      const std::vector<CauseInfo> own = side.verdict ? side.verdict->own_causes : std::vector<CauseInfo>();
      const std::vector<ErrorKind> kinds = error_kinds(true, false, own);
      const auto found = std::ranges::find(kinds, name, &ErrorKind::label);
      if (found != kinds.end()) return std::string(with_common(own)[static_cast<std::size_t>(found - kinds.begin())].sentence);
    }
  if (paint == Paint::classes)
    for (const ClassInfo& row : class_infos())
      if (name.starts_with(row.letter)) return std::string(row.sentence);
  return "";
}

/// Of a share, with the point where that of others is.
std::string percent_words(double share) {
  return share > 0 && share < 1e-5 ? std::string("<0.001") : fmt::format("{:.3f}", 100 * share);
}

bool has_layer(const PanelData& shown) {
  const Composition& c = shown.composition;
  return (c.sides[0].layer && is_shown(c.layout, 0)) || (c.sides[1].layer && is_shown(c.layout, 1));
}

/// One line of the table: a color with its meaning, and its share of the pixels of each side.
struct LegendLine {
  LegendEntry entry;
  std::optional<double> share[2];
};
struct PaintLegend {
  std::vector<LegendLine> lines;
  bool has_shares[2] = {};  ///< those of the side are counted
};

/// The colors of both sides that are shown, those of the same name in one line; of errors the largest share first.
PaintLegend join_legends(const PanelData& shown) {
  PaintLegend legend;
  const Paint paint = shown.composition.paint;
  const bool is_of_errors = paint == Paint::kinds || paint == Paint::causes;
  for (int side = 0; side < 2; ++side) {
    if (!is_shown(shown.composition.layout, side)) continue;
    for (const LegendEntry& entry : shown.legends[side]) {
      auto found = std::ranges::find(legend.lines, entry.name, [](const LegendLine& line) { return line.entry.name; });
      if (found == legend.lines.end()) found = legend.lines.insert(found, LegendLine{entry, {}});
      found->share[side] = entry.share;
      legend.has_shares[side] = legend.has_shares[side] || entry.share;
    }
    // A side without wrong pixels has shares, too: zeros.
    if (is_of_errors) legend.has_shares[side] = shown.composition.sides[side].verdict != nullptr;
  }
  const auto larger = [](const LegendLine& line) { return std::max(line.share[0].value_or(0), line.share[1].value_or(0)); };
  if (is_of_errors) std::ranges::stable_sort(legend.lines, std::greater<>(), larger);
  return legend;
}

/// The paint; of a difference what it is to, in as many letters as there is room for.
std::string title_of(const Composition& composition) {
  if (composition.paint != Paint::difference) return std::string(paint_rows[static_cast<int>(composition.paint)].title);
  return composition.difference.against == Against::reference ? "minus reference" : "minus other side";
}

void draw_legend_table(const PaintLegend& legend, const PanelData& shown) {
  const Paint paint = shown.composition.paint;
  const ModeRow& mode = paint_rows[static_cast<int>(paint)];
  // Classes are the frame's, the same on both sides.
  const bool has_shares[2] = {legend.has_shares[0], legend.has_shares[1] && !(paint == Paint::classes && legend.has_shares[0])};
  const int columns = 1 + has_shares[0] + has_shares[1];
  if (!ImGui::BeginTable("legend", columns, ImGuiTableFlags_SizingFixedFit | ImGuiTableFlags_NoSavedSettings)) return;
  ImGui::TableSetupColumn("name", ImGuiTableColumnFlags_WidthStretch);
  const float width = ImGui::CalcTextSize(columns == 3 ? "right %" : "99.999").x;
  for (int k = 1; k < columns; ++k) ImGui::TableSetupColumn("share", ImGuiTableColumnFlags_WidthFixed, width);
  const auto draw_shares = [&](auto&& draw) {
    for (int side = 0; side < 2; ++side)
      if (has_shares[side]) {
        ImGui::TableNextColumn();
        draw(side);
      }
  };
  ImGui::TableNextColumn();
  ImGui::TextDisabled("%s", title_of(shown.composition).c_str());
  std::string sentence(mode.sentence);
  if (columns > 1) sentence += fmt::format("\nShares are {}.", legend.lines[0].entry.of);
  if (paint == Paint::difference)
    sentence += fmt::format("\nThey count differences of more than {:g}.", shown.composition.difference.full / 2);
  Widgets::tooltip(sentence);
  ImGui::PushStyleColor(ImGuiCol_Text, quiet_text);
  draw_shares([&](int side) { Widgets::right(columns == 3 ? fmt::format("{} %", side_name(side)) : "%"); });
  ImGui::PopStyleColor();
  for (const LegendLine& line : legend.lines) {
    ImGui::TableNextColumn();
    draw_swatch(packed(line.entry.color));
    Widgets::wrapped(line.entry.name);
    Widgets::tooltip(sentence_of(shown.composition, line.entry.name));
    // A color that only one of two sides shows has share 0 in the other.
    draw_shares([&](int side) { Widgets::right(percent_words(line.share[side].value_or(0))); });
  }
  ImGui::EndTable();
}

/// As wide as the room is, the numbers below it at their places.
void draw_bar(const LegendBar& bar) {
  const float width = ImGui::GetContentRegionAvail().x - ImGui::GetStyle().ItemSpacing.x, height = 0.8f * ImGui::GetFontSize();
  const ImVec2 at = ImGui::GetCursorScreenPos();
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const float step = width / static_cast<float>(bar.colors.size());
  for (std::size_t k = 0; k < bar.colors.size(); ++k) {
    const float left = at.x + step * static_cast<float>(k);
    list.AddRectFilled({left, at.y}, {left + step + 0.5f, at.y + height}, packed(bar.colors[k]));
  }
  list.AddRect({at.x, at.y}, {at.x + width, at.y + height}, IM_COL32(255, 255, 255, 50));
  for (const LegendBar::Mark& mark : bar.marks) {
    const float x = at.x + width * static_cast<float>(mark.at), wide = ImGui::CalcTextSize(mark.words.c_str()).x;
    list.AddLine({x, at.y + height}, {x, at.y + height + 3}, quiet_text);
    list.AddText({std::clamp(x - wide / 2, at.x, at.x + width - wide), at.y + height + 3}, quiet_text, mark.words.c_str());
  }
  ImGui::Dummy({width, height + 3 + ImGui::GetTextLineHeight()});
}

/// The bar of the first side that is shown and has one; sides differ in their lights at most while something moves.
void draw_bars(const PanelData& shown) {
  for (int side = 0; side < 2; ++side)
    if (is_shown(shown.composition.layout, side))
      if (const auto bar = legend_bar(shown.composition, side)) return draw_bar(*bar);
}

/// A line in its casing.
void draw_ink(const ContourInk& ink, bool is_broad) {
  const float width = 1.6f * ImGui::GetFontSize(), scale = lengths().scale;
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float middle = at.y + ImGui::GetTextLineHeight() / 2;
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const auto line = [&](const Color& color, float wide) {
    list.AddLine({at.x, middle}, {at.x + width, middle}, packed(color), wide * scale);
  };
  line(ink.casing, is_broad ? 5 : 4);
  line(ink.core, is_broad ? 2.6f : 1.6f);
  ImGui::Dummy({width, ImGui::GetTextLineHeight()});
  ImGui::SameLine();
}

/// Whose line is which.
void draw_contour_legend(const PanelData& shown) {
  std::string levels;
  for (const float level : contour_levels) levels += fmt::format("{}{:.2g}", levels.empty() ? "" : ", ", level);
  Widgets::wrapped("Contours at " + levels, quiet_text);
  for (int side = 0; side < 2; ++side) {
    if (!is_shown(shown.composition.layout, side) || shown.state.sides[side].is_reference) continue;
    draw_ink(technique_inks[side], false);
    Widgets::wrapped(fmt::format("{}: {}", side_name(side), shown.titles[side]));
  }
  draw_ink(reference_ink, true);
  Widgets::wrapped("reference");
}

void draw_paint_legend(const PanelData& shown) {
  const PaintLegend legend = join_legends(shown);
  if (!legend.lines.empty()) return draw_legend_table(legend, shown);
  const Paint paint = shown.composition.paint;
  const ModeRow& mode = paint_rows[static_cast<int>(paint)];
  if (paint == Paint::shaded && has_layer(shown)) return;  // the layer has a legend of its own
  ImGui::TextDisabled("%s", title_of(shown.composition).c_str());
  if (paint == Paint::mask) return;  // a bar follows
  const bool is_judged = (paint == Paint::kinds || paint == Paint::causes) && (legend.has_shares[0] || legend.has_shares[1]);
  const auto& frame = shown.state.frame;
  const bool is_soft = frame && frame->has_shares();
  Widgets::wrapped(!is_judged ? std::string(mode.sentence) : is_soft ? "No pixel is off by 1 %." : "No pixel is wrong.");
}

/// Short names share a row.
void draw_swatches(std::span<const LegendEntry> swatches) {
  constexpr int cells = 3;  // of a row
  const float before = ImGui::GetFontSize() * 0.8f + ImGui::GetStyle().ItemSpacing.x;
  const float left = ImGui::GetCursorPosX(), cell = ImGui::GetContentRegionAvail().x / cells;
  int next = 0;
  for (const LegendEntry& swatch : swatches) {
    const float width = before + ImGui::CalcTextSize(swatch.name.c_str()).x + ImGui::GetStyle().ItemSpacing.x;
    const int wanted = std::min(static_cast<int>(std::ceil(width / cell)), cells);
    if (next + wanted > cells) next = 0;
    if (next > 0) ImGui::SameLine(left + static_cast<float>(next) * cell);
    draw_swatch(packed(swatch.color));
    Widgets::wrapped(swatch.name);
    next += wanted;
  }
}

/// Why causes are the common ones, and layers of parts of the error empty, of a technique that knows the parts of other frames.
void draw_missing_parts(const PanelData& shown) {
  for (int side = 0; side < 2; ++side) {
    const ComposeSide& s = shown.composition.sides[side];
    if (!s.verdict || !s.verdict->lacks_parts || !is_shown(shown.composition.layout, side)) continue;
    const bool is_part = s.layer && std::ranges::find(s.verdict->own_causes, s.layer->layer.name, &CauseInfo::name) !=
                                        s.verdict->own_causes.end();
    if (shown.composition.paint != Paint::causes && !is_part) continue;
    Widgets::wrapped(fmt::format("{}: it remembers frames, and the parts of its error are known of the first of a sequence "
                                 "alone. Another size of the picture, or the other truth, begins one.",
                                 side_name(side)),
                     quiet_text);
  }
}

}  // namespace

void draw_legend(const PanelData& shown) {
  draw_paint_legend(shown);
  draw_missing_parts(shown);
  draw_bars(shown);
  if (shown.composition.shows_contours) draw_contour_legend(shown);
  for (int side = 0; side < 2; ++side) {
    const LayerPicture* const layer = shown.composition.sides[side].layer;
    if (!layer || !is_shown(shown.composition.layout, side)) continue;
    ImGui::TextDisabled("%s: %s", side_name(side), layer->layer.name.c_str());
    Widgets::tooltip(layer->layer.sentence);
    draw_swatches(layer_legend(*layer));
    if (layer->layer.legend.empty()) Widgets::wrapped(layer->layer.sentence);
  }
}

}  // namespace gnomon::viewer
