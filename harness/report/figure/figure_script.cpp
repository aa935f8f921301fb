#include "report/figure/figure_script.h"

#include "report/table/text_table.h"

namespace gnomon {

namespace {

constexpr std::string_view font = "DejaVu Sans";
constexpr double points_size = 8.5;  // of the text, on paper
constexpr double png_scale = 0.82;   // of gnuplot's points to pixels

/// What gnuplot reads, scales and squares without leaving the range of a double.
constexpr double least_number = 1e-99, greatest_number = 1e99;

bool is_drawable(double value) {
  const double size = std::abs(value);
  return size <= greatest_number && (size == 0 || size >= least_number);
}

std::string quoted_all(std::string_view text, double cm, std::string (*quote)(std::string_view)) {
  std::vector<std::string> lines = FigureScript::lines_of(text, cm);
  for (std::string& line : lines) line = quote(line);
  return joined(lines, ".\"\\n\".");
}

/// A line that gnuplot skips; a backslash at its end would make the next one part of it.
std::string comment(std::string_view name, std::string_view text) {
  std::string line = fmt::format("# {}: ", name);
  for (const char c : text) line += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
  return line + (line.ends_with('\\') ? " \n" : "\n");
}

}  // namespace

double FigureScript::title_cm() const {
  const double cm = options.width_cm - 1;
  const std::size_t lines = line_count(options.title, cm) + line_count(heading, cm);
  return lines == 0 ? 0 : 0.5 + line_cm * static_cast<double>(lines);
}

std::string FigureScript::title_text() const {
  std::vector<std::string> texts;
  for (const std::string& text : {options.title, heading})
    if (!text.empty()) texts.push_back(quoted_lines(text, options.width_cm - 1));
  return texts.empty() ? "" : " title " + joined(texts, ".\"\\n\".");
}

std::vector<std::string> FigureScript::lines_of(std::string_view text, double cm) {
  if (text_cm(text) <= cm) return {std::string(text)};
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

std::string axis_label(const Column& column) {
  return column.heading.ends_with(column.shown_unit) ? column.heading
                                                     : fmt::format("{} ({})", column.heading, column.shown_unit);
}

}  // namespace gnomon
