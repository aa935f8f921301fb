#include "report/figure/figure_script.h"

#include "report/table/text_table.h"

namespace gnomon {

namespace {

constexpr std::string_view font = "DejaVu Sans";
constexpr double points_size = 8.5;  // of the text, on paper
constexpr double png_scale = 0.82;   // of gnuplot's points to pixels
constexpr double line_cm = 0.4;      // from a line of text to the next one

/// Characters of the text per centimeter.
constexpr double characters_per_cm = 5.6;

/// What gnuplot reads, scales and squares without leaving the range of a double.
constexpr double least_number = 1e-99, greatest_number = 1e99;

bool is_drawable(double value) {
  const double size = std::abs(value);
  return size <= greatest_number && (size == 0 || size >= least_number);
}

/// The text's lines, each at most so many centimeters long.
std::vector<std::string> lines_of(std::string_view text, double cm) {
  if (FigureScript::text_cm(text) <= cm) return {std::string(text)};
  const std::size_t most = std::max<std::size_t>(8, static_cast<std::size_t>(cm * characters_per_cm));
  // Names may go on behind what joins their parts, within a part that is longer than a line behind what joins its words.
  std::vector<std::string> lines{""};
  while (!text.empty()) {
    const auto until = [&](std::string_view ends) {
      const std::size_t end = text.find_first_of(ends);
      return text.substr(0, end == text.npos ? end : end + 1);
    };
    std::string_view part = until(" ,:");
    if (display_width(part) > most) part = until(" ,:_");
    text.remove_prefix(part.size());
    const std::size_t shown = display_width(part) - (part.ends_with(' ') ? 1 : 0);
    if (!lines.back().empty() && display_width(lines.back()) + shown > most) lines.emplace_back();
    const std::vector<std::string> cut = shown > most ? wrap(part, most) : std::vector{std::string(part)};
    lines.back() += cut.front();
    lines.insert(lines.end(), cut.begin() + 1, cut.end());
  }
  for (std::string& line : lines) line.erase(line.find_last_not_of(' ') + 1);
  return lines;
}

std::string quoted_all(std::string_view text, double cm, std::string (*quote)(std::string_view)) {
  std::vector<std::string> lines = lines_of(text, cm);
  for (std::string& line : lines) line = quote(line);
  return joined(lines, ".\"\\n\".");
}

/// The legend as it is drawn: an entry that is longer than the figure's width goes on in rows without a mark.
std::vector<FigureScript::LegendEntry> legend_lines(const FigureScript& script) {
  constexpr double mark_cm = 1.1;
  std::vector<FigureScript::LegendEntry> all;
  for (const FigureScript::LegendEntry& entry : script.legend)
    for (bool is_first = true; std::string & line : lines_of(entry.text, script.options.width_cm - mark_cm - 0.7))
      all.push_back({std::exchange(is_first, false) ? entry.style : "with points pt 0 lc rgb '#ffffff'", std::move(line)});
  return all;
}

std::size_t legend_rows(const FigureScript& script) {
  const std::vector<FigureScript::LegendEntry> lines = legend_lines(script);
  double longest_cm = 0;
  for (const FigureScript::LegendEntry& entry : lines) longest_cm = std::max(longest_cm, FigureScript::text_cm(entry.text));
  // Rows that go on must follow what they go on from.
  const std::size_t most = lines.size() > script.legend.size() ? 1 : std::max<std::size_t>(1, lines.size());
  const std::size_t columns =
      std::clamp<std::size_t>(static_cast<std::size_t>(script.options.width_cm / (longest_cm + 1.1)), 1, most);
  return (lines.size() + columns - 1) / columns;
}

/// A line that gnuplot skips; a backslash at its end would make the next one part of it.
std::string comment(std::string_view name, std::string_view text) {
  std::string line = fmt::format("# {}: ", name);
  for (const char c : text) line += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
  return line + (line.ends_with('\\') ? " \n" : "\n");
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

double FigureScript::title_cm() const {
  return options.title.empty() ? 0 : 0.5 + line_cm * static_cast<double>(line_count(options.title, options.width_cm - 1));
}

std::string FigureScript::title_text() const {
  return options.title.empty() ? "" : " title " + quoted_lines(options.title, options.width_cm - 1);
}

std::string FigureScript::quoted(std::string_view text) {
  // gnuplot 5.4 takes quotes at the beginning for an empty text: they go into a text of their own.
  std::string safe;
  for (; text.starts_with("'"); text.remove_prefix(1)) safe += safe.empty() ? "\"\\047" : "\\047";
  safe += safe.empty() ? "'" : "\".'";
  for (const char c : text) {
    if (c == '\'') safe += '\'';
    safe += c == '\n' || c == '\r' ? ' ' : c;
  }
  return safe + "'";
}

std::string FigureScript::quoted_tic(std::string_view text) {
  std::string format;
  for (const char c : text) format += c == '%' ? "%%" : std::string(1, c);
  return quoted(format);
}

std::string FigureScript::quoted_lines(std::string_view text, double cm) { return quoted_all(text, cm, quoted); }

std::string FigureScript::quoted_tic_lines(std::string_view text, double cm) { return quoted_all(text, cm, quoted_tic); }

std::size_t FigureScript::line_count(std::string_view text, double cm) { return text.empty() ? 0 : lines_of(text, cm).size(); }

double FigureScript::text_cm(std::string_view text) { return static_cast<double>(display_width(text)) / characters_per_cm; }

std::string FigureScript::data(const std::vector<std::string>& lines) {
  const std::string name = fmt::format("$d{}", ++blocks_);
  body_ += name + " << EOD\n";
  for (const std::string& line : lines) {
    for (std::string_view rest = line; !rest.empty();) {
      const std::string_view field = rest.substr(0, rest.find('\t'));
      rest.remove_prefix(std::min(rest.size(), field.size() + 1));
      const std::optional<double> value = number_from(field);
      if (!value || !is_drawable(*value))
        throw Error("a figure cannot draw {}: it draws 0 and sizes from {} to {}; --filter leaves rows out", field,
                    least_number, greatest_number);
    }
    body_ += line + '\n';
  }
  body_ += "EOD\n";
  return name;
}

void FigureScript::name_curve(std::string_view name) { names_ += comment("Curve", name); }

std::string FigureScript::text(const std::filesystem::path& out) const {
  const std::string ending = out.extension().string(), name = out.filename().string();
  std::string terminal;
  const double width = options.width_cm, height = height_cm;
  if (ending == ".svg") {
    // 50 units a centimeter; 1 point is 1/72 inch.
    terminal = fmt::format("svg noenhanced size {:.0f},{:.0f} font '{},{:.1f}' background '#ffffff' linewidth 1.4", width * 50,
                           height * 50, font, points_size / 72 * 2.54 * 50);
  } else if (ending == ".pdf") {
    terminal =
        fmt::format("pdfcairo noenhanced size {:.2f}cm,{:.2f}cm font '{},{}' linewidth 1", width, height, font, points_size);
  } else if (ending == ".png") {
    terminal =
        fmt::format("pngcairo noenhanced size {:.0f},{:.0f} font '{},{}' linewidth 2 pointscale 1.6 background '#ffffff'",
                    width * 100, height * 100, font, points_size / 72 * 2.54 * 100 * png_scale);
  } else {
    throw Error("--out {} ends in neither .svg, .pdf nor .png", out.string());
  }
  std::string text = "# Made by gnomon figure; needs gnuplot 5.4.\n";
  text += comment("Shows", options.title.empty() ? shows : options.title + ": " + shows) + names_;
  text += fmt::format("set encoding utf8\nset terminal {}\nset output {}\n", terminal,
                      quoted((name.starts_with('|') ? "./" : "") + name));  // with a bar in front it would be a command
  text +=
      "set datafile separator tab\n"
      "set border 3 lw 0.8 lc rgb '#444444'\n"
      "set tics nomirror out scale 0.6 textcolor rgb '#222222'\n"
      "set grid back lt 1 lw 0.5 lc rgb '#e2e2e2'\n"
      "set format '%g'\n"
      "set errorbars small\n";
  return text + body_;
}

void PlotCommand::into(FigureScript& script) const {
  for (const std::string& name : names_) script.name_curve(name);
  if (is_empty()) script.name_curve("nothing");
  // An empty panel has no values that a range could come from.
  script.add("plot {}", is_empty() ? "[1:2][1:2] NaN notitle" : joined(curves_, ", \\\n  "));
}

std::size_t PanelGrid::x_labels(std::size_t characters) const {
  const double label_cm = static_cast<double>(characters) / characters_per_cm + 0.25;
  return std::max<std::size_t>(2, static_cast<std::size_t>(width_cm / label_cm));
}

std::size_t PanelGrid::y_labels() const { return std::max<std::size_t>(2, static_cast<std::size_t>(height_cm / 0.6)); }

PanelGrid panel_grid(const PanelFrame& frame, double figure_cm) {
  constexpr double least_width = 3.2, least_height = 3.4, greatest_height = 6.5;  // narrower ones have no room for an axis
  const double names_cm = std::max(0.0, longest_cm(frame.y_names) - 0.9);
  // Room for the name of an axis beside tics as long as 0.0001: what lies off the page is not drawn.
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
  grid.width_cm = width_with(left + line_cm * static_cast<double>(std::max<std::size_t>(lines, 1) - 1));
  grid.do_names_turn = (longest_cm(frame.x_names) + 0.2) * static_cast<double>(frame.x_names.size()) > grid.width_cm;
  return grid;
}

namespace {

double title_room_cm(const PanelGrid& grid) { return grid.width_cm + 0.8 * grid.between_cm; }

}  // namespace

PanelGrid open_panels(FigureScript& script, const PanelFrame& frame) {
  const double w = script.options.width_cm;
  const std::size_t count = std::max<std::size_t>(frame.titles.size(), 1);
  const PanelGrid grid = panel_grid(frame, w);
  std::size_t title_lines = 1;
  for (const std::string& title : frame.titles)
    title_lines = std::max(title_lines, FigureScript::line_count(title, title_room_cm(grid)));
  const std::size_t label_lines = std::max<std::size_t>(1, FigureScript::line_count(frame.x_label, grid.width_cm + 1));
  const double above = 0.7 + line_cm * static_cast<double>(title_lines - 1);
  const double below =
      1.2 + line_cm * static_cast<double>(label_lines - 1) + (grid.do_names_turn ? longest_cm(frame.x_names) * 0.71 : 0);
  const std::size_t rows = (count + grid.columns - 1) / grid.columns;
  script.height_cm = script.title_cm() + static_cast<double>(rows) * (above + grid.height_cm + below) + script.legend_cm();
  const double h = script.height_cm;
  script.add("set multiplot layout {},{} margins {:.4f},{:.4f},{:.4f},{:.4f} spacing {:.4f},{:.4f}{}", rows, grid.columns,
             1 - (right_cm + static_cast<double>(grid.columns) * (grid.width_cm + grid.between_cm) - grid.between_cm) / w,
             1 - right_cm / w, strip(script) + below / h, 1 - (script.title_cm() + above) / h,
             grid.columns > 1 ? grid.between_cm / w : 0.0, rows > 1 ? (above + below) / h : 0.0, script.title_text());
  script.add("unset key");
  if (!frame.x_label.empty())
    script.add("set xlabel {} offset 0,0.4", FigureScript::quoted_lines(frame.x_label, grid.width_cm + 1));
  return grid;
}

void open_panel(FigureScript& script, const PanelGrid& grid, std::string_view title, std::string_view y_label) {
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

double shown_number(double value, const Column& column) {
  const double shown = value * column.shown_scale;
  for (const double number : {value, shown})
    if (!is_drawable(number))
      throw Error("a figure cannot draw {} = {}: it draws 0 and sizes from {} to {}; --filter leaves rows out", column.name,
                  value, least_number, greatest_number);
  const bool is_signed =
      column.shown_unit != "%" && column.unit != "ms" && column.unit != "byte" && better(column.name) != "lower";
  if (!is_signed) require_not_negative(value, column.name);
  return shown;
}

void require_not_negative(double value, std::string_view name) {
  if (value < 0)
    throw Error("a figure cannot draw {} = {}: its axis has no place below 0; --filter leaves rows out", name, value);
}

void require_drawable(std::span<const Record> records, const Column& column) {
  for (const Record& r : records)
    if (r.status == Status::ok && r.role != Role::baseline)
      if (const std::optional<double> value = quantity(r, column.name)) shown_number(*value, column);
}

void require_drawable_times(std::span<const Record> records) {
  for (const char* const time : {"build_ms", "update_ms", "relight_ms", "resolve_ms"})
    require_drawable(records, quantity_column(time));
}

void require_panels(std::size_t panels, std::string_view what) {
  if (panels > most_panels)
    throw Error("{} {} are more than the {} that one figure holds; --filter chooses among them", panels, what, most_panels);
}

std::string axis_label(const Column& column) {
  return column.heading.ends_with(column.shown_unit) ? column.heading
                                                     : fmt::format("{} ({})", column.heading, column.shown_unit);
}

}  // namespace gnomon
