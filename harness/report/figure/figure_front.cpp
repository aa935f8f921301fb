// Error against cost: every setting a mark with its interval, the front a staircase.
#include <algorithm>
#include <cmath>

#include "report/figure/figure_script.h"

namespace gnomon {

namespace {

constexpr std::size_t most_named = 16;  // settings with a color of their own

/// Color and mark: of the setting while they are few, of its technique otherwise.
struct Series {
  std::string name;
  std::vector<std::size_t> members;  ///< candidates
};

}  // namespace

void draw_front(std::span<const Record> records, const FigureOptions& options, FigureScript& script) {
  const std::string& metric = options.analysis.metric;
  const Cost cost = options.analysis.cost;
  const std::vector<Field> fields = find_fields(records, {.error = metric, .cost = cost});
  const Field& field = fields.back();  // over all places, or the only one
  const std::vector<FrontEntry> stands = find_front(field, better(metric));
  const Column error = quantity_column(metric), size = quantity_column(cost == Cost::bytes ? "bytes" : "resolve_ms");

  std::vector<std::size_t> shown;
  for (std::size_t i = 0; i < field.candidates.size(); ++i) {
    const Candidate& c = field.candidates[i];
    if (c.role != Role::baseline && c.cost && c.cost->value > 0) shown.push_back(i);
  }
  if (shown.empty()) throw Error("there is nothing to draw: no contender has {} and {}", metric, sentence(cost));
  double least_error = INFINITY, greatest_error = 0, least_cost = INFINITY, greatest_cost = 0;
  bool has_zero = false;
  for (const std::size_t i : shown) {
    const Candidate& c = field.candidates[i];
    has_zero = has_zero || c.error <= 0;
    if (c.error > 0) least_error = std::min(least_error, c.error * error.shown_scale);
    greatest_error = std::max(greatest_error, c.error * error.shown_scale);
    least_cost = std::min(least_cost, c.cost->low * size.shown_scale);
    greatest_cost = std::max(greatest_cost, c.cost->high * size.shown_scale);
  }
  // No error at all has no place on a logarithmic axis: it gets one below the least, named 0.
  const bool is_log = greatest_error > 0 && better(metric) != "higher";
  const double zero = is_log ? least_error / 4 : 0;
  const auto height = [&](const Candidate& c) {
    const double value = c.error * error.shown_scale;
    return is_log && value <= 0 ? zero : value;
  };

  std::vector<Series> series;
  const bool is_named = shown.size() <= most_named;
  for (const std::size_t i : shown) {
    const Candidate& c = field.candidates[i];
    const std::string& name = is_named ? c.setting : c.technique;
    const auto known = std::find_if(series.begin(), series.end(), [&](const Series& s) { return s.name == name; });
    (known == series.end() ? series.emplace_back(Series{name, {}}) : *known).members.push_back(i);
  }

  Legend legend;
  std::string plot;
  // The front below everything: a staircase from the top to the right edge.
  std::vector<std::size_t> front;
  for (const std::size_t i : shown)
    if (stands[i].standing == Standing::front) front.push_back(i);
  std::sort(front.begin(), front.end(),
            [&](std::size_t a, std::size_t b) { return field.candidates[a].cost->value < field.candidates[b].cost->value; });
  const double right = greatest_cost * 1.3, left = least_cost / 1.3;
  const double top = is_log ? greatest_error * 2 : greatest_error * 1.08;
  if (!front.empty()) {
    std::vector<std::string> lines;
    const auto x = [&](std::size_t i) { return field.candidates[i].cost->value * size.shown_scale; };
    lines.push_back(fmt::format("{}\t{}", x(front.front()), better(metric) == "higher" ? 0 : top));
    for (const std::size_t i : front) lines.push_back(fmt::format("{}\t{}", x(i), height(field.candidates[i])));
    lines.push_back(fmt::format("{}\t{}", right, height(field.candidates[front.back()])));
    plot += fmt::format("{} using 1:2 with steps lw 1.6 lc rgb '#bbbbbb' notitle", script.data(lines));
    legend.entries.push_back({"with lines lw 1.6 lc rgb '#bbbbbb'", "front"});
  }
  for (std::size_t k = 0; k < series.size(); ++k) {
    std::vector<std::string> lines;
    const bool is_aside = field.candidates[series[k].members.front()].role != Role::contender;
    for (const std::size_t i : series[k].members) {
      const Candidate& c = field.candidates[i];
      lines.push_back(fmt::format("{}\t{}\t{}\t{}", c.cost->value * size.shown_scale, height(c), c.cost->low * size.shown_scale,
                                  c.cost->high * size.shown_scale));
    }
    const std::string style =
        is_aside ? "pt 2 ps 0.9 lw 1.4 lc rgb '#555555'"
                 : fmt::format("pt {} ps {} lc rgb '{}'", series_mark(k), is_named ? 1.0 : 0.6, series_color(k));
    plot += fmt::format(",{} using 1:2:3:4 with xerrorbars {} notitle", script.data(lines), style);
    legend.entries.push_back({"with points " + style, series[k].name + (is_aside ? " (reference)" : "")});
  }

  // Too many to name them all: those on the front are numbered.
  std::vector<std::string> labels;
  for (std::size_t k = 0; !is_named && k < front.size() && front.size() <= most_named; ++k) {
    const Candidate& c = field.candidates[front[k]];
    labels.push_back(fmt::format("set label '{}' at {},{} right offset -0.3,-0.7 textcolor rgb '#222222'", k + 1,
                                 c.cost->value * size.shown_scale, height(c)));
    legend.entries.push_back({"with points pt 0 lc rgb '#ffffff'", fmt::format("{}: {}", k + 1, c.setting)});
  }

  open_panels(script, 1, 1, options.width_cm * 0.55, legend, options);
  const std::string over = field.place ? "" : fmt::format(", geometric mean over {} places", field.places);
  script.add("set xlabel {}", FigureScript::quoted(fmt::format("{} ({}){}", sentence(cost), size.shown_unit, over)));
  script.add("set ylabel {}", FigureScript::quoted(axis_label(error) + (field.place ? "" : ", mean")));
  script.add("set logscale x; set xtics {}; set xrange [{}:{}]", log_tics(left, right, 8), left, right);
  if (is_log) {
    const double bottom = has_zero ? zero / 1.5 : least_error / 2;
    script.add("set logscale y; set ytics {}; set yrange [{}:{}]", log_tics(has_zero ? least_error / 1.5 : bottom, top, 8),
               bottom, top);
    if (has_zero) script.add("set ytics add ('0' {})", zero);
  } else {
    script.add("set yrange [0:{}]", better(metric) == "higher" ? "*" : fmt::format("{}", top > 0 ? top : 1));
  }
  for (const std::string& label : labels) script.add("{}", label);
  if (plot.starts_with(",")) plot.erase(0, 1);
  script.add("plot {}", plot);
  close_panels(script, legend, options);
}

}  // namespace gnomon
