// Time of each stage against an axis, both logarithmic, with the fitted lines and their exponents.
#include <algorithm>
#include <cmath>

#include "report/figure/figure_script.h"

namespace gnomon {

void draw_growth(std::span<const Record> records, const FigureOptions& options, FigureScript& script) {
  const std::string axis = options.analysis.x.empty() ? "triangles" : options.analysis.x;
  const Growths growths = find_growth(records, axis);
  std::vector<Place> places;
  std::vector<std::string> settings, stages;
  const auto add = [](auto& list, const auto& value) {
    if (std::find(list.begin(), list.end(), value) == list.end()) list.push_back(value);
  };
  const auto is_drawn = [](const Growth& g) {
    return g.role != Role::baseline && g.points.size() >= 2 && (g.exponent || g.too_fast == 0);
  };
  double first_x = INFINITY, last_x = 0;
  double least = INFINITY, greatest = 0;
  for (const Growth& growth : growths.rows) {
    if (!is_drawn(growth)) continue;
    add(places, growth.place);
    add(settings, growth.setting);
    add(stages, growth.stage);
    for (const Growth::Point& point : growth.points) {
      if (point.ms.value < clock_ms) continue;
      first_x = std::min(first_x, point.x);
      last_x = std::max(last_x, point.x);
      least = std::min(least, point.ms.low);
      greatest = std::max(greatest, point.ms.high);
    }
  }
  if (stages.empty()) throw Error("there is nothing to draw: no setting has times at two values of {}", axis);
  static constexpr std::string_view stage_order[] = {"build", "relight", "resolve", "total"};
  std::sort(stages.begin(), stages.end(), [](const std::string& a, const std::string& b) {
    return std::find(std::begin(stage_order), std::end(stage_order), a) <
           std::find(std::begin(stage_order), std::end(stage_order), b);
  });

  // Color tells the setting, shape the place; of a single setting color tells the place too.
  const auto style_of = [&](const Growth& growth) {
    const auto setting =
        static_cast<std::size_t>(std::find(settings.begin(), settings.end(), growth.setting) - settings.begin());
    const auto place = static_cast<std::size_t>(std::find(places.begin(), places.end(), growth.place) - places.begin());
    static constexpr int marks[] = {7, 5, 9, 11, 13, 6, 4, 8, 10, 12};
    const std::size_t color = settings.size() > 1 ? setting : place;
    return std::pair(series_color(color), places.size() > 1 ? marks[place % std::size(marks)] : series_mark(setting));
  };
  Legend legend;
  for (const Growth& growth : growths.rows) {
    if (!is_drawn(growth)) continue;
    const auto [color, mark] = style_of(growth);
    Legend::Entry entry{fmt::format("with linespoints pt {} lc rgb '{}'", mark, color),
                        growth.setting + (places.size() > 1 ? fmt::format(" ({})", title(growth.place, places)) : "")};
    const bool is_known =
        std::any_of(legend.entries.begin(), legend.entries.end(), [&](const auto& e) { return e.text == entry.text; });
    if (!is_known) legend.entries.push_back(std::move(entry));
  }

  // The data first: a multiplot takes none.
  std::vector<std::string> plots(stages.size());
  struct Label {
    double y;  ///< where the line ends
    std::string text, color;
  };
  std::vector<std::vector<Label>> labels(stages.size());
  for (const Growth& growth : growths.rows) {
    if (!is_drawn(growth)) continue;
    const auto panel = static_cast<std::size_t>(std::find(stages.begin(), stages.end(), growth.stage) - stages.begin());
    const auto [color, mark] = style_of(growth);
    std::vector<std::string> lines;
    for (const Growth::Point& point : growth.points)
      if (point.ms.value >= clock_ms)
        lines.push_back(fmt::format("{}\t{}\t{}\t{}", point.x, point.ms.value, point.ms.low, point.ms.high));
    std::string& plot = plots[panel];
    plot += fmt::format("{}{} using 1:2:3:4 with yerrorbars pt {} ps 0.7 lc rgb '{}' notitle", plot.empty() ? "" : ", \\\n  ",
                        script.data(lines), mark, color);
    if (!growth.exponent) continue;
    const double from = growth.points.front().x, to = growth.points.back().x, exponent = growth.exponent->value;
    const auto at = [&](double x) { return growth.coefficient * std::pow(x, exponent); };
    plot += fmt::format(", \\\n  {} using 1:2 with lines lw 1.2 lc rgb '{}' notitle",
                        script.data({fmt::format("{}\t{}", from, at(from)), fmt::format("{}\t{}", to, at(to))}), color);
    // Never "-0.00".
    labels[panel].push_back({at(to), fmt::format("{:.2f}", std::abs(exponent) < 0.005 ? 0.0 : exponent), color});
  }
  const double bottom = least / 1.6, top = greatest * 1.6;
  const std::size_t columns = open_panels(script, stages.size(), 3, options.width_cm / 2.3, legend, options);
  const double left = first_x / std::pow(last_x / first_x, 0.06), right = last_x * std::pow(last_x / first_x, 0.3);
  std::vector<double> xs;
  for (const Growth& growth : growths.rows)
    for (const Growth::Point& point : growth.points)
      if (is_drawn(growth)) xs.push_back(point.x);
  const std::string at_values = value_tics(std::move(xs), stages.size() > 2 ? 0.2 : 0.1);
  script.add("set logscale xy; set xtics {}; set ytics {}", at_values.empty() ? log_tics(left, last_x, 4) : at_values,
             log_tics(bottom, top, 8));
  script.add("set xrange [{}:{}]", left, right);
  script.add("set yrange [{}:{}]", bottom, top);
  script.add("set xlabel {}", FigureScript::quoted(axis == "pixels" ? "pixels" : axis));
  for (std::size_t panel = 0; panel < stages.size(); ++panel) {
    script.add("set title {} offset 0,-0.6", FigureScript::quoted(stages[panel]));
    script.add("set ylabel {}", panel % columns == 0 ? "'time (ms)'" : "''");
    script.add("unset label");
    // Exponents stand where their lines end, pushed apart upward where they would cover one another.
    // More than a few would stand far from their lines; the table has them all.
    std::vector<Label>& ends = labels[panel];
    if (ends.size() > 8) ends.clear();
    std::sort(ends.begin(), ends.end(), [](const Label& a, const Label& b) { return a.y < b.y; });
    const double step = std::pow(top / bottom, 0.062);
    double room = top / std::pow(step, static_cast<double>(ends.size()));
    for (std::size_t k = 0; k < ends.size(); ++k, room *= step) {
      if (k > 0) ends[k].y = std::max(ends[k].y, ends[k - 1].y * step);
      script.add("set label {} at {},{} left offset 0.8,0 textcolor rgb '{}'", FigureScript::quoted(ends[k].text), last_x,
                 std::min(ends[k].y, room), ends[k].color);
    }
    script.add("plot {}", plots[panel]);
  }
  close_panels(script, legend, options);
}

}  // namespace gnomon
