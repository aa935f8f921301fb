// Bars in pieces, one a setting: cost by stage, and wrong pixels by cause.
#include <array>
#include <map>
#include <numeric>

#include "measure/score/record_causes.h"
#include "report/figure/figure_script.h"
#include "report/table/digits.h"

namespace gnomon {

namespace {

/// One setting with its rows in the places that all settings finished.
struct Bar {
  std::string name;
  Role role = Role::contender;
  std::vector<const Record*> rows;
};

/// What is drawn: a bar for each setting, and over how many places.
struct Bars {
  std::vector<Bar> all;
  std::array<std::size_t, std::size(all_answer_kinds)> places{};  ///< of each kind of answer

  /// ", mean over 5 places"; nothing to say of a single one.
  std::string over_text() const {
    static constexpr std::string_view kinds[] = {"without area of the light", "with area of the light", "of several lights",
                                                 "behind glass"};
    std::size_t sum = 0;
    std::vector<std::string> parts;
    for (std::size_t k = 0; k < places.size(); ++k) {
      sum += places[k];
      if (places[k] > 0) parts.push_back(fmt::format("{} {}", places[k], kinds[k]));
    }
    if (parts.size() < 2) return sum == 1 ? "" : fmt::format(", mean over {} places", sum);
    return ", mean over places: " + joined(parts, ", ");
  }
};

/// The settings of the finished rows for which `has` is true, over the places that all of them share: those of each kind of
/// answer in turn, where a setting of several has a bar for each.
Bars bars_of(std::span<const Record> records, auto has) {
  Bars bars;
  for (const AnswerKind of : all_answer_kinds) {
    const RowsBySetting settings = rows_by_setting(records, [&](const Record& r) { return r.answer == of && has(r); });
    const std::set<Place> common = common_places(settings, &RowsBySetting::value_type::second);
    if (common.empty()) continue;
    const bool is_first = bars.all.empty();
    bars.places[static_cast<std::size_t>(of)] = common.size();
    for (const auto& [key, rows] : settings) {
      const Record& first = *rows.begin()->second;
      Bar& bar = bars.all.emplace_back(Bar{setting_name(first), first.role, {}});
      if (!is_first)
        bar.name += of == AnswerKind::fraction   ? ", light with area"
                    : of == AnswerKind::received ? ", several lights"
                                                 : ", behind glass";
      for (const Place& place : common) bar.rows.push_back(rows.at(place));
    }
  }
  return bars;
}

/// The frame of a figure of horizontal bars, the first on top.
void open_bars(FigureScript& script, std::span<const Bar> bars) {
  const FigureOptions& options = script.options;
  if (bars.size() > 60)
    throw Error("{} settings are more than the 60 that one figure holds; --filter chooses among them", bars.size());
  std::size_t longest = 0;
  for (const Bar& bar : bars) longest = std::max(longest, display_width(bar.name));
  const double legend_cm = script.legend_cm(), title_cm = options.title.empty() ? 0.2 : 0.9;
  script.height_cm = static_cast<double>(bars.size()) * 0.55 + 1.5 + legend_cm + title_cm;
  const double h = script.height_cm;
  script.add("set multiplot{}", options.title.empty() ? "" : " title " + FigureScript::quoted(options.title));
  script.add("set lmargin at screen {:.4f}; set rmargin at screen {:.4f}",
             std::min(0.55, (static_cast<double>(longest) * 0.165 + 0.4) / options.width_cm), 1 - 0.9 / options.width_cm);
  script.add("set bmargin at screen {:.4f}; set tmargin at screen {:.4f}", (legend_cm + 1.2) / h, 1 - title_cm / h);
  script.add("unset key; set yrange [{}:0.4]; unset grid; set grid x back lt 1 lw 0.5 lc rgb '#e2e2e2'",
             static_cast<double>(bars.size()) + 0.6);
  std::vector<std::string> names;
  for (std::size_t i = 0; i < bars.size(); ++i)
    names.push_back(fmt::format("{} {}", FigureScript::quoted_tic(bars[i].name), i + 1));
  script.add("set ytics ({}) scale 0", joined(names, ", "));
  script.add("set style fill solid 1 noborder");
}

std::string box_line(double from, double to, std::size_t bar) {
  const auto row = static_cast<double>(bar + 1);
  return fmt::format("{}\t{}\t{}\t{}\t{}\t{}", (from + to) / 2, row, from, to, row - 0.32, row + 0.32);
}

/// Causes of the error of one setting.
struct CauseShares {
  std::map<std::string, double, std::less<>> by_cause;  ///< each place counting by its error; their sum is 1, or 0
  double error = 0;                                     ///< mean over the places
};

CauseShares shares_of(const Bar& bar, std::span<const CauseInfo> causes) {
  CauseShares shares;
  for (const Record* row : bar.rows) {
    shares.error += *row->metric("error") / static_cast<double>(bar.rows.size());
    for (const CauseInfo& info : causes)
      shares.by_cause[std::string(info.name)] += quantity(*row, fmt::format("cause.{}", info.name)).value_or(0);
  }
  double sum = 0;
  for (const auto& [cause, share] : shares.by_cause) sum += share;
  if (sum > 0)
    for (auto& [cause, share] : shares.by_cause) share /= sum;
  return shares;
}

/// A piece of every bar: a stage or a cause.
struct Piece {
  std::string name, color;
  std::vector<double> lengths = {};  ///< one a bar
};

/// "build, relight and resolve".
std::string with_and(std::vector<std::string> words) {
  const std::string last = words.back();
  words.pop_back();
  return words.empty() ? last : fmt::format("{} and {}", joined(words, ", "), last);
}

/// The boxes of each piece behind those of the pieces before it.
PlotCommand plot_pieces(std::span<const Piece> pieces, FigureScript& script) {
  PlotCommand plot;
  std::vector<double> ends(pieces.front().lengths.size(), 0);
  for (const Piece& piece : pieces) {
    std::vector<std::string> lines;
    for (std::size_t k = 0; k < ends.size(); ++k) {
      if (piece.lengths[k] > 0) lines.push_back(box_line(ends[k], ends[k] + piece.lengths[k], k));
      ends[k] += piece.lengths[k];
    }
    if (lines.empty()) continue;
    plot.add("{} using 1:2:3:4:5:6 with boxxyerror lc rgb '{}' notitle", script.data(lines), piece.color);
    script.legend.push_back({fmt::format("with points pt 5 ps 1.15 lc rgb '{}'", piece.color), piece.name});
  }
  return plot;
}

}  // namespace

void draw_stages(std::span<const Record> records, FigureScript& script) {
  static constexpr std::array colors{"#cc79a7", "#e69f00", "#d55e00", "#56b4e9", "#009e73"};  // by stage
  static_assert(colors.size() == std::size(all_stages));
  const std::span<const TimedPart> parts = parts_of(script.options.bars);
  if (parts.empty())
    throw Error("--cost {} has no stages: bars are of resolve, light, geometry or motion", name(script.options.bars));
  Bars places = bars_of(records, [&](const Record& r) { return sample_of(r, parts).is_timed(); });
  std::vector<Bar>& bars = places.all;
  std::erase_if(bars, [](const Bar& bar) { return bar.role == Role::baseline; });
  std::vector<Piece> pieces;
  std::vector<std::string> names;
  for (const TimedPart part : parts) {
    names.push_back(with_blanks(name(part)));
    pieces.push_back({names.back(), colors[static_cast<std::size_t>(part.stage)]});
  }
  if (bars.empty()) throw Error("there is nothing to draw: no place has {} of every setting", with_and(names));

  std::vector<std::string> totals;
  for (const Bar& bar : bars) {
    std::vector<Sample> samples;
    for (const Record* row : bar.rows) samples.push_back(sample_of(*row, parts));
    const ValueWithInterval total = bootstrap(samples, [](std::span<const double> values) {
      return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
    });
    totals.push_back(fmt::format("{}\t{}\t{}\t{}", total.value, totals.size() + 1, total.low, total.high));
    for (std::size_t k = 0; k < parts.size(); ++k) {
      double& mean = pieces[k].lengths.emplace_back(0);
      for (const Record* row : bar.rows)
        mean += *median_of_medians(times_of(*row, parts[k])) / static_cast<double>(bar.rows.size());
    }
  }
  PlotCommand plot = plot_pieces(pieces, script);
  plot.add("{} using 1:2:3:4 with xerrorbars pt -1 lw 1.2 lc rgb '#222222' notitle", script.data(totals));
  script.legend.push_back({"with lines lw 1.2 lc rgb '#222222'", "95 % interval of the sum"});
  open_bars(script, bars);
  script.add("set xrange [0:*]; set xlabel {}", FigureScript::quoted("time (ms)" + places.over_text()));
  plot.into(script);
  close_panels(script);
}

void draw_causes(std::span<const Record> records, FigureScript& script) {
  Bars places = bars_of(records, [](const Record& r) { return r.causes && r.metric("error"); });
  std::vector<Bar>& bars = places.all;
  std::erase_if(bars, [](const Bar& bar) { return bar.role != Role::contender; });
  if (bars.empty()) throw Error("there is nothing to draw: no place has the causes of every setting");
  std::vector<CauseShares> shares;
  const std::vector<CauseInfo> causes = causes_of(records);
  for (const Bar& bar : bars) shares.push_back(shares_of(bar, causes));
  std::vector<Piece> pieces;
  for (const CauseInfo& info : causes) {
    pieces.push_back({with_blanks(info.name), fmt::format("#{:02x}{:02x}{:02x}", info.color[0], info.color[1], info.color[2])});
    for (const CauseShares& bar : shares) pieces.back().lengths.push_back(bar.by_cause.find(info.name)->second * 100);
  }
  const PlotCommand plot = plot_pieces(pieces, script);
  if (plot.is_empty()) throw Error("there is nothing to draw: no setting has a wrong pixel with a cause");
  open_bars(script, bars);
  script.add("set rmargin at screen {:.4f}", 1 - 2.2 / script.options.width_cm);
  for (std::size_t k = 0; k < bars.size(); ++k)
    script.add("set label {} at 101.5,{} left textcolor rgb '#222222'",
               FigureScript::quoted(measured(100 * shares[k].error) + " %"), k + 1);
  const auto is_hard_row = [](const Record* row) { return !has_cause_errors(row->answer); };
  const bool is_hard = std::ranges::all_of(bars, [&](const Bar& bar) { return std::ranges::all_of(bar.rows, is_hard_row); });
  script.add("set label 'error' at 101.5,0.2 left textcolor rgb '#666666'");
  script.add("set yrange [{}:-0.2]", static_cast<double>(bars.size()) + 0.6);
  script.add("set xrange [0:100]; set xlabel {}",
             FigureScript::quoted((is_hard ? "share of the wrong pixels (%)" : "share of the error (%)") + places.over_text()));
  plot.into(script);
  close_panels(script);
}

}  // namespace gnomon
