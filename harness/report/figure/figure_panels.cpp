// Where panels and the legend below them lie on a figure.
#include "report/figure/figure_script.h"

namespace gnomon {

namespace {

/// The legend as it is drawn: an entry that is longer than the figure's width goes on in rows without a mark.
std::vector<FigureScript::LegendEntry> legend_lines(const FigureScript& script) {
  constexpr double mark_cm = 1.1;
  std::vector<FigureScript::LegendEntry> all;
  for (const FigureScript::LegendEntry& entry : script.legend)
    for (bool is_first = true; std::string & line : FigureScript::lines_of(entry.text, script.options.width_cm - mark_cm - 0.7))
      all.push_back({std::exchange(is_first, false) ? entry.style : "with points pt 0 lc rgb '#ffffff'", std::move(line)});
  return all;
}

std::size_t legend_rows(const FigureScript& script) {
  const std::vector<FigureScript::LegendEntry> lines = legend_lines(script);
  double longest_cm = 0;
  for (const FigureScript::LegendEntry& entry : lines) longest_cm = std::max(longest_cm, FigureScript::text_cm(entry.text));
  // Rows that go on must follow what they go on from.
  const std::size_t most = lines.size() > script.legend.size() ? 1 : std::max<std::size_t>(1, lines.size());
  constexpr double column_cm = 1.6;  // of a column beside its text: the mark, and what gnuplot leaves free
  const std::size_t columns =
      std::clamp<std::size_t>(static_cast<std::size_t>(script.options.width_cm / (longest_cm + column_cm)), 1, most);
  return (lines.size() + columns - 1) / columns;
}

/// The bottom strip as a share of the figure.
double strip(const FigureScript& script) { return script.legend_cm() / script.height_cm; }

constexpr double right_cm = 0.6;  // of the panels

double longest_cm(const std::vector<std::string>& words) {
  double longest = 0;
  for (const std::string& word : words) longest = std::max(longest, FigureScript::text_cm(word));
  return longest;
}

}  // namespace

double FigureScript::legend_cm() const { return legend.empty() ? 0 : 0.46 * static_cast<double>(legend_rows(*this)) + 0.7; }

std::size_t PanelGrid::x_labels(std::size_t characters) const {
  const double label_cm = static_cast<double>(characters) / characters_per_cm + 0.25;
  return std::max<std::size_t>(2, static_cast<std::size_t>(width_cm / label_cm));
}

std::size_t PanelGrid::y_labels() const { return std::max<std::size_t>(2, static_cast<std::size_t>(height_cm / 0.6)); }

PanelGrid panel_grid(const PanelFrame& frame, double figure_cm) {
  constexpr double least_width = 3.2, least_height = 3.4, greatest_height = 6.5;  // narrower ones have no room for an axis
  const double names_cm = std::max(0.0, longest_cm(frame.y_names) - 0.7);
  // Room for the name of an axis beside tics as long as 0.01: what lies off the page is not drawn.
  const double left = frame.is_bare ? right_cm : 2.1 + names_cm;
  PanelGrid grid{.columns = std::clamp<std::size_t>(frame.titles.size(), 1, frame.most_columns),
                 .between_cm = frame.is_bare ? 0.3 : 1.9 + names_cm};
  const auto width_with = [&](double left_cm) {
    const auto count = static_cast<double>(grid.columns);
    return (figure_cm - left_cm - right_cm - grid.between_cm * (count - 1)) / count;
  };
  while (grid.columns > 1 && width_with(left) < least_width) --grid.columns;
  const double by_width = frame.height_per_width * width_with(left);
  grid.height_cm = frame.height_cm > 0 ? frame.height_cm
                   : frame.is_bare     ? by_width
                                       : std::clamp(by_width, least_height, greatest_height);
  const std::size_t lines = FigureScript::line_count(frame.y_label, grid.height_cm);
  const double more_lines_cm = line_cm * static_cast<double>(std::max<std::size_t>(lines, 1) - 1);
  grid.between_cm += more_lines_cm;
  grid.width_cm = width_with(left + more_lines_cm);
  for (const std::vector<std::string>& names : frame.x_names)
    grid.do_names_turn.push_back((longest_cm(names) + 0.2) * static_cast<double>(names.size()) > grid.width_cm);
  return grid;
}

namespace {

double title_room_cm(const PanelGrid& grid) { return grid.width_cm + grid.between_cm - 0.35; }

/// That a row of panels takes above and below its axes.
struct RowMargins {
  double above_cm, below_cm;
};

RowMargins row_margins(const PanelFrame& frame, const PanelGrid& grid, std::size_t row) {
  std::size_t title_lines = 1;
  double turned_cm = 0;
  const std::size_t end = std::min(frame.titles.size(), (row + 1) * grid.columns);
  for (std::size_t k = row * grid.columns; k < end; ++k) {
    title_lines = std::max(title_lines, FigureScript::line_count(frame.titles[k], title_room_cm(grid)));
    if (grid.is_turned(k)) turned_cm = std::max(turned_cm, 0.71 * longest_cm(frame.x_names[k % frame.x_names.size()]));
  }
  const double title_cm = line_cm * static_cast<double>(title_lines - 1);
  if (frame.is_bare) return {0.7 + title_cm, 0.15};
  const std::size_t label_lines = std::max<std::size_t>(1, FigureScript::line_count(frame.x_label, grid.width_cm + 1));
  return {0.7 + title_cm, (frame.x_label.empty() ? 0.8 : 1.2) + line_cm * static_cast<double>(label_lines - 1) + turned_cm};
}

}  // namespace

PanelGrid open_panels(FigureScript& script, const PanelFrame& frame) {
  const std::size_t count = std::max<std::size_t>(frame.titles.size(), 1);
  PanelGrid grid = panel_grid(frame, script.options.width_cm);
  const std::size_t rows = (count + grid.columns - 1) / grid.columns;
  // From the last row up.
  script.height_cm = script.legend_cm();
  for (std::size_t row = rows; row-- > 0;) {
    const auto [above_cm, below_cm] = row_margins(frame, grid, row);
    grid.bottoms_cm.insert(grid.bottoms_cm.begin(), script.height_cm + below_cm);
    script.height_cm += below_cm + grid.height_cm + above_cm;
  }
  script.height_cm += script.title_cm();
  script.add("# Panels: {} row{} of {}", rows, rows > 1 ? "s" : "", grid.columns);
  script.add("set multiplot{}", script.title_text());
  script.add("unset key");
  if (!frame.x_label.empty())
    script.add("set xlabel {} offset 0,0.4", FigureScript::quoted_lines(frame.x_label, grid.width_cm + 1));
  return grid;
}

void open_panel(FigureScript& script, const PanelGrid& grid, std::size_t k, std::string_view title, std::string_view y_label) {
  const double w = script.options.width_cm, h = script.height_cm;
  const double bottom_cm = grid.bottoms_cm[k / grid.columns];
  const auto after = static_cast<double>(grid.columns - 1 - k % grid.columns);  // panels that follow in its row
  const double end_cm = w - right_cm - after * (grid.width_cm + grid.between_cm);
  script.add("set lmargin at screen {:.4f}; set rmargin at screen {:.4f}", (end_cm - grid.width_cm) / w, end_cm / w);
  script.add("set bmargin at screen {:.4f}; set tmargin at screen {:.4f}", bottom_cm / h, (bottom_cm + grid.height_cm) / h);
  script.add("set title {} offset 0,-0.6", FigureScript::quoted_lines(title, title_room_cm(grid)));
  const std::size_t lines = std::max<std::size_t>(1, FigureScript::line_count(y_label, grid.height_cm));
  script.add("set ylabel {}{}", FigureScript::quoted_lines(y_label, grid.height_cm),
             lines > 1 ? fmt::format(" offset -{},0", 2 * (lines - 1)) : "");
}

void close_panels(FigureScript& script) {
  if (!script.legend.empty()) {
    script.add(
        "unset title; unset xlabel; unset ylabel; unset label; unset tics; unset border; unset grid; unset logscale; unset "
        "object");
    // The key's frame is the whole figure, or gnuplot would drop the entries for which it sees no room.
    script.add("set origin 0,0; set size 1,1");
    script.add("set lmargin at screen 0.01; set rmargin at screen 0.99; set bmargin at screen 0; set tmargin at screen 1");
    script.add("set key at screen 0.5,{:.4f} center center vertical maxrows {} Left reverse samplen 1.2 spacing 1.15",
               strip(script) / 2, legend_rows(script));
    PlotCommand plot;
    plot.add("legend", "[0:1][0:1] NaN notitle");
    for (const FigureScript::LegendEntry& entry : legend_lines(script))
      plot.add(entry.text, "keyentry {} title {}", entry.style, FigureScript::quoted(entry.text));
    plot.into(script);
  }
  script.add("unset multiplot");
}

void require_panels(std::size_t panels, std::string_view what) {
  if (panels > most_panels)
    throw Error("{} {} are more than the {} that one figure holds; --filter chooses among them", panels, what, most_panels);
}

}  // namespace gnomon
