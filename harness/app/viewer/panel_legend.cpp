// What the picture's colors mean.
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "app/viewer/panels.h"
#include "app/viewer/style.h"
#include "report/table/digits.h"

namespace gnomon::viewer {

namespace {

bool is_shown(Layout layout, int side) {
  return layout == Layout::split || layout == Layout::flicker || (layout == Layout::left) == (side == 0);
}

ImU32 color_of(const std::array<std::uint8_t, 3>& c) { return IM_COL32(c[0], c[1], c[2], 255); }

/// sRGB of linear light.
ImU32 color_of(const glm::dvec3& linear) {
  const auto encode = [](double x) {
    x = std::clamp(x, 0.0, 1.0);
    return static_cast<int>(std::lround(255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055)));
  };
  return IM_COL32(encode(linear.r), encode(linear.g), encode(linear.b), 255);
}

void draw_swatch(ImU32 color) {
  const float size = ImGui::GetFontSize() * 0.8f;
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float top = at.y + (ImGui::GetTextLineHeight() - size) / 2;
  ImGui::GetWindowDrawList()->AddRectFilled({at.x, top}, {at.x + size, top + size}, color, size / 6);
  ImGui::Dummy({size, ImGui::GetTextLineHeight()});
  ImGui::SameLine();
}

struct Row {
  LegendEntry entry;
  std::optional<double> share[2];
};

void draw_paint_legend(const Shown& shown) {
  std::vector<Row> rows;
  bool has_shares[2] = {};
  for (int side = 0; side < 2; ++side) {
    if (!is_shown(shown.composition.layout, side)) continue;
    for (const LegendEntry& entry : shown.legends[side]) {
      auto found = std::ranges::find(rows, entry.name, [](const Row& row) { return row.entry.name; });
      if (found == rows.end()) found = rows.insert(found, Row{entry, {}});
      found->share[side] = entry.share;
      has_shares[side] = has_shares[side] || entry.share;
    }
  }
  const std::string title(paint_rows()[static_cast<int>(shown.composition.paint)].title);
  ImGui::TextDisabled("%s", title.c_str());
  Widgets::tooltip(std::string(paint_rows()[static_cast<int>(shown.composition.paint)].sentence));
  for (const Row& row : rows) {
    draw_swatch(color_of(row.entry.color));
    std::string words = row.entry.name;
    // A color that only one of two sides shows has no share in the other.
    const char* before = "  ";
    for (int side = 0; side < 2; ++side)
      if (row.share[side] || has_shares[side])
        words += fmt::format("{}{} %", std::exchange(before, " | "), rounded(100 * row.share[side].value_or(0), 2));
    Widgets::wrapped(words);
  }
  if (rows.empty())
    ImGui::TextWrapped("%s", std::string(paint_rows()[static_cast<int>(shown.composition.paint)].sentence).c_str());
}

}  // namespace

void draw_legend(const Shown& shown) {
  draw_paint_legend(shown);
  for (int side = 0; side < 2; ++side) {
    const LayerPicture* const layer = shown.composition.sides[side].layer;
    if (!layer || !is_shown(shown.composition.layout, side)) continue;
    ImGui::TextDisabled("%s: %s", side_name(side), layer->layer.name.c_str());
    Widgets::tooltip(layer->layer.sentence);
    for (const Swatch& swatch : layer->layer.legend) {
      draw_swatch(color_of(swatch.color));
      Widgets::wrapped(swatch.name);
    }
    if (layer->layer.legend.empty()) Widgets::wrapped(layer->layer.sentence);
  }
}

}  // namespace gnomon::viewer
