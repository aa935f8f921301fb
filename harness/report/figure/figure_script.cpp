#include "report/figure/figure_script.h"

#include <limits>

namespace gnomon {

namespace {

constexpr std::string_view font = "DejaVu Sans";
constexpr double points_size = 8.5;  // of the text, on paper

/// Characters of the text per centimeter of a legend.
constexpr double characters_per_cm = 5.6;

std::size_t legend_rows(const FigureScript& script) {
  std::size_t longest = 0;
  for (const FigureScript::LegendEntry& entry : script.legend) longest = std::max(longest, display_width(entry.text));
  const double column_cm = static_cast<double>(longest) / characters_per_cm + 1.1;
  const std::size_t entries = script.legend.size();
  const std::size_t columns = std::clamp<std::size_t>(static_cast<std::size_t>(script.options.width_cm / column_cm), 1,
                                                      std::max<std::size_t>(1, entries));
  return (entries + columns - 1) / columns;
}

/// The bottom strip as a share of the figure.
double strip(const FigureScript& script) { return script.legend_cm() / script.height_cm; }

}  // namespace

double FigureScript::legend_cm() const { return legend.empty() ? 0 : 0.46 * static_cast<double>(legend_rows(*this)) + 0.7; }

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

std::string FigureScript::data(const std::vector<std::string>& lines) {
  const std::string name = fmt::format("$d{}", ++blocks_);
  body_ += name + " << EOD\n";
  for (const std::string& line : lines) body_ += line + '\n';
  body_ += "EOD\n";
  return name;
}

std::string FigureScript::text(const std::filesystem::path& out) const {
  const std::string ending = out.extension().string(), name = out.filename().string();
  std::string terminal;
  const double width = options.width_cm, height = height_cm + (options.title.empty() ? 0 : 0.8);
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
                    width * 100, height * 100, font, points_size / 72 * 2.54 * 100 * 0.56);
  } else {
    throw Error("--out {} ends in neither .svg, .pdf nor .png", out.string());
  }
  std::string text =
      fmt::format("# Made by gnomon figure; needs gnuplot 5.4.\nset encoding utf8\nset terminal {}\nset output {}\n", terminal,
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
  script.add("plot {}", is_empty() ? "NaN notitle" : joined(curves_, ", \\\n  "));
}

std::string series_color(std::size_t index) {
  static constexpr std::string_view colors[] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                "#e69f00", "#56b4e9", "#7a5c00", "#555555"};
  return std::string(colors[index % std::size(colors)]);
}

int series_mark(std::size_t index) {
  static constexpr int marks[] = {7, 5, 9, 11, 13};
  return marks[(index + index / 8) % std::size(marks)];
}

std::size_t open_panels(FigureScript& script, std::size_t panels, std::size_t most_columns, double panel_cm) {
  const FigureOptions& options = script.options;
  const std::size_t columns = std::min(panels, most_columns), rows = (panels + columns - 1) / columns;
  script.height_cm = static_cast<double>(rows) * panel_cm + script.legend_cm();
  // Room on the left for an axis title beside tics as long as 0.0001: what lies off the page is not drawn.
  const double h = script.height_cm, w = options.width_cm, top = options.title.empty() ? 0.7 : 1.3;
  script.add("set multiplot layout {},{} margins {:.4f},{:.4f},{:.4f},{:.4f} spacing {:.4f},{:.4f}{}", rows, columns, 2.1 / w,
             1 - 0.6 / w, strip(script) + 1.2 / h, 1 - top / h, columns > 1 ? 1.7 / w : 0.0, rows > 1 ? 1.9 / h : 0.0,
             options.title.empty() ? "" : " title " + FigureScript::quoted(options.title));
  script.add("unset key");
  return columns;
}

void open_panel(FigureScript& script, std::string_view title, std::string_view y_label) {
  script.add("set title {} offset 0,-0.6", FigureScript::quoted(title));
  script.add("set ylabel {}", FigureScript::quoted(y_label));
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
    plot.add("[0:1][0:1] NaN notitle");
    for (const FigureScript::LegendEntry& entry : script.legend)
      plot.add("keyentry {} title {}", entry.style, FigureScript::quoted(entry.text));
    plot.into(script);
  }
  script.add("unset multiplot");
}

std::string short_number(double value) {
  static constexpr std::pair<double, const char*> suffixes[] = {{1e9, "G"}, {1e6, "M"}, {1e4, "k"}};
  for (const auto& [least, suffix] : suffixes)
    if (value >= least) return fmt::format("{:.3g}{}", value / (least == 1e4 ? 1e3 : least), suffix);
  return fmt::format("{:.4g}", value);
}

std::string log_tics(double least, double greatest, std::size_t most) {
  // The densest of these that keeps the number of labels.
  using Digits = std::initializer_list<int>;
  // What a double can hold, however small or large the ends of an axis come out.
  constexpr int least_power = -324, greatest_power = std::numeric_limits<double>::max_exponent10;
  const int first =
      static_cast<int>(std::min<double>(greatest_power, std::max<double>(least_power, std::floor(std::log10(least)))));
  const Digits dense{1, 2, 3, 5, 7}, usual{1, 2, 5}, sparse{1, 3}, powers{1};
  std::string text;
  for (const Digits& digits : {dense, usual, sparse, powers}) {
    std::vector<std::string> tics;
    std::size_t labels = 0;
    for (int k = first; k <= greatest_power && std::pow(10, k) <= greatest; ++k)
      for (int digit = 1; digit <= 9; ++digit) {
        const double at = k < 0 ? digit / std::pow(10, -k) : digit * std::pow(10, k);
        if (at < least * 0.999 || at > greatest * 1.001 || !std::isfinite(at)) continue;
        const bool is_labeled = std::ranges::find(digits, digit) != digits.end();
        labels += is_labeled;
        tics.push_back(is_labeled ? fmt::format("{} {}", FigureScript::quoted(short_number(at)), at)
                                  : fmt::format("'' {} 1", at));
      }
    text = fmt::format("({})", joined(tics, ", "));
    if (labels <= most) break;
  }
  return text;
}

std::string value_tics(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
  if (values.empty() || values.front() <= 0) return "";
  for (std::size_t i = 1; i < values.size(); ++i)
    if (std::log(values[i] / values[i - 1]) < share * std::log(values.back() / values.front())) return "";
  std::vector<std::string> tics;
  for (const double value : values) tics.push_back(fmt::format("{} {}", FigureScript::quoted(short_number(value)), value));
  return fmt::format("({})", joined(tics, ", "));
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
