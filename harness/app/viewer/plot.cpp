// A plot in a panel: axes, curves with bands.
#include "app/viewer/plot.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "app/viewer/widgets.h"

namespace gnomon::viewer {

namespace {

/// The curves' part of the panel, and how values become places.
struct Area {
  PlotAxis x_axis, y_axis;
  ImVec2 low, high;  ///< upper left, lower right

  static double share(const PlotAxis& axis, double value) {
    return axis.is_log ? std::log(value / axis.low) / std::log(axis.high / axis.low)
                       : (value - axis.low) / (axis.high - axis.low);
  }
  float x(double value) const { return low.x + (high.x - low.x) * static_cast<float>(share(x_axis, value)); }
  float y(double value) const { return high.y - (high.y - low.y) * static_cast<float>(share(y_axis, value)); }
};

/// The plotted names at their colors, in a row.
void draw_names(std::span<const PlotCurve> curves) {
  bool is_first = true;
  for (const PlotCurve& curve : curves) {
    const float font = ImGui::GetFontSize(), wide = font + ImGui::CalcTextSize(curve.name.c_str()).x;
    if (!is_first) ImGui::SameLine(0, font);
    if (!is_first && ImGui::GetContentRegionAvail().x < wide) ImGui::NewLine();
    is_first = false;
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float middle = at.y + ImGui::GetTextLineHeight() / 2;
    ImDrawList& list = *ImGui::GetWindowDrawList();
    if (!curve.half_band.empty())
      list.AddRectFilled({at.x, middle - 0.3f * font}, {at.x + 0.8f * font, middle + 0.3f * font},
                         (curve.color & 0x00ffffff) | 0x50000000);
    list.AddLine({at.x, middle}, {at.x + 0.8f * font, middle}, curve.color, curve.is_thin ? 1.f : 2.f);
    ImGui::Dummy({0.8f * font, ImGui::GetTextLineHeight()});
    ImGui::SameLine(0, 0.2f * font);
    ImGui::TextUnformatted(curve.name.c_str());
  }
}

void draw_axes(const Area& area, std::span<const PlotTick> across, std::span<const PlotTick> upward) {
  ImDrawList& list = *ImGui::GetWindowDrawList();
  constexpr ImU32 grid = IM_COL32(255, 255, 255, 28);
  const float font = ImGui::GetFontSize();
  list.AddRectFilled(area.low, area.high, IM_COL32(12, 12, 14, 255));
  float free_from = area.low.x - font;
  for (const PlotTick& tick : across) {
    const float x = area.x(tick.value), wide = ImGui::CalcTextSize(tick.words.c_str()).x;
    list.AddLine({x, area.low.y}, {x, area.high.y}, grid);
    const float left = std::clamp(x - wide / 2, area.low.x - font / 2, area.high.x - wide);
    if (left < free_from) continue;
    list.AddText({left, area.high.y + 1}, quiet_text, tick.words.c_str());
    free_from = left + wide + font / 2;
  }
  for (const PlotTick& tick : upward) {
    const float y = area.y(tick.value), wide = ImGui::CalcTextSize(tick.words.c_str()).x;
    list.AddLine({area.low.x, y}, {area.high.x, y}, grid);
    list.AddText({area.low.x - wide - 0.3f * font, y - font / 2}, quiet_text, tick.words.c_str());
  }
  list.AddRect(area.low, area.high, IM_COL32(255, 255, 255, 60));
}

void draw_curve(const Area& area, const PlotCurve& curve) {
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const float scale = lengths().scale;
  const std::size_t count = std::min(curve.x.size(), curve.y.size());
  const auto is_drawn = [&](std::size_t k) {
    return k < count && std::isfinite(curve.y[k]) && (!area.y_axis.is_log || curve.y[k] > 0);
  };
  const auto place = [&](std::size_t k, double off = 0) { return ImVec2(area.x(curve.x[k]), area.y(curve.y[k] + off)); };
  for (std::size_t k = 0; k + 1 < std::min(count, curve.half_band.size()); ++k)
    if (is_drawn(k) && is_drawn(k + 1) && curve.half_band[k] > 0 && curve.half_band[k + 1] > 0)
      list.AddQuadFilled(place(k, curve.half_band[k]), place(k + 1, curve.half_band[k + 1]),
                         place(k + 1, -curve.half_band[k + 1]), place(k, -curve.half_band[k]),
                         (curve.color & 0x00ffffff) | 0x50000000);
  for (std::size_t k = 0; k < count; ++k) {
    if (!is_drawn(k)) continue;
    if (is_drawn(k + 1)) list.AddLine(place(k), place(k + 1), curve.color, (curve.is_thin ? 1 : 1.6f) * scale);
    if (curve.has_points) list.AddCircleFilled(place(k), 3 * scale, curve.color);
  }
}

}  // namespace

std::vector<PlotTick> plot_ticks(const PlotAxis& axis, int count) {
  std::vector<PlotTick> ticks;
  const auto add = [&](double value) { ticks.push_back({value, fmt::format("{:g}", value)}); };
  constexpr double slack = 1e-9;
  if (axis.is_log) {
    const int first = static_cast<int>(std::floor(std::log10(axis.low))),
              last = static_cast<int>(std::ceil(std::log10(axis.high)));
    const auto is_inside = [&](double value) { return value >= axis.low * (1 - slack) && value <= axis.high * (1 + slack); };
    for (const bool is_fine : {false, true}) {
      if (ticks.size() >= 2) break;
      ticks.clear();
      for (int power = first; power <= last; ++power)
        for (const double times : {1.0, 2.0, 5.0})
          if ((times == 1 || is_fine) && is_inside(times * std::pow(10, power))) add(times * std::pow(10, power));
    }
    return ticks;
  }
  const double rough = (axis.high - axis.low) / std::max(count, 1), power = std::pow(10, std::floor(std::log10(rough)));
  double step = 10 * power;
  for (const double times : {5.0, 2.0, 1.0})
    if (times * power >= rough * (1 - slack)) step = times * power;
  for (double k = std::ceil(axis.low / step - slack); k * step <= axis.high + slack * step; ++k) add(k == 0 ? 0 : k * step);
  return ticks;
}

void draw_plot(const PlotAxis& x, const PlotAxis& y, std::span<const PlotCurve> curves) {
  draw_names(curves);
  const float font = ImGui::GetFontSize();
  const ImVec2 at = ImGui::GetCursorScreenPos(), room = ImGui::GetContentRegionAvail();
  const std::vector<PlotTick> upward = plot_ticks(y, std::max(2, static_cast<int>(room.y / (2.5f * font))));
  float widest = 0;
  for (const PlotTick& tick : upward) widest = std::max(widest, ImGui::CalcTextSize(tick.words.c_str()).x);
  const Area area{
      x, y, {at.x + widest + 0.6f * font, at.y + 1.1f * font}, {at.x + room.x - 0.4f * font, at.y + room.y - 2.3f * font}};
  if (area.high.x - area.low.x < 2 * font || area.high.y - area.low.y < font) return;
  draw_axes(area, plot_ticks(x, std::max(2, static_cast<int>(room.x / (4 * font)))), upward);
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddText({at.x, at.y}, quiet_text, y.title.c_str());
  const float wide = ImGui::CalcTextSize(x.title.c_str()).x;
  list.AddText({area.high.x - wide, area.high.y + 1.1f * font}, quiet_text, x.title.c_str());
  list.PushClipRect(area.low, area.high, true);
  for (const PlotCurve& curve : curves) draw_curve(area, curve);
  list.PopClipRect();
}

}  // namespace gnomon::viewer
