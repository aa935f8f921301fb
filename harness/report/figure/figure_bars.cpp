// Bars in pieces, one a setting: cost by stage, and wrong pixels by cause.
#include <array>
#include <map>
#include <numeric>

#include "measure/score/record_causes.h"
#include "report/figure/figure_axis.h"
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

/// The frame of a figure of horizontal bars, the first on top; `right_cm` of it are for numbers behind them. Names that are
/// longer than a good third of the figure go on in further lines, for which all bars get room. Returns what lies within.
PanelGrid open_bars(FigureScript& script, std::span<const Bar> bars, const std::string& x_label, double right_cm) {
  const double width = script.options.width_cm, most_cm = 0.4 * width - 0.4;
  if (bars.size() > 60)
    throw Error("{} settings are more than the 60 that one figure holds; --filter chooses among them", bars.size());
  std::size_t lines = 1;
  double longest_cm = 0;
  for (const Bar& bar : bars) {
    lines = std::max(lines, FigureScript::line_count(bar.name, most_cm));
    longest_cm = std::max(longest_cm, FigureScript::text_cm(bar.name));
  }
  const double left_cm = std::min(longest_cm, most_cm) + 0.5, bar_cm = std::max(0.55, 0.4 * static_cast<double>(lines) + 0.1);
  const std::size_t label_lines = FigureScript::line_count(x_label, width - left_cm);
  const double bottom_cm = script.legend_cm() + 0.8 + 0.4 * static_cast<double>(label_lines),
               title_cm = script.title_cm() + 0.3;
  script.height_cm = static_cast<double>(bars.size()) * bar_cm + 0.3 + bottom_cm + title_cm;
  const double h = script.height_cm;
  script.add("set multiplot{}", script.title_text());
  script.add("set lmargin at screen {:.4f}; set rmargin at screen {:.4f}", left_cm / width, 1 - right_cm / width);
  script.add("set bmargin at screen {:.4f}; set tmargin at screen {:.4f}", bottom_cm / h, 1 - title_cm / h);
  script.add("unset key; set yrange [{}:0.4]; unset grid; set grid x back lt 1 lw 0.5 lc rgb '#e2e2e2'",
             static_cast<double>(bars.size()) + 0.6);
  std::vector<std::string> names;
  for (std::size_t i = 0; i < bars.size(); ++i)
    names.push_back(fmt::format("{} {}", FigureScript::quoted_tic_lines(bars[i].name, most_cm), i + 1));
  script.add("set ytics ({}) scale 0", joined(names, ", "));
  script.add("set xlabel {}", FigureScript::quoted_lines(x_label, width - left_cm));
  script.add("set style fill solid 1 noborder");
  return {.width_cm = width - left_cm - right_cm};
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
  std::string name;
  std::string_view color = {};
  std::vector<double> lengths = {};  ///< one a bar

  double sum() const { return std::accumulate(lengths.begin(), lengths.end(), 0.0); }
};

/// The pieces that are there, each in a color of series: where they are more than the colors the largest, then all others in
/// one.
std::vector<Piece> with_colors(std::vector<Piece> pieces) {
  std::erase_if(pieces, [&](const Piece& piece) { return piece.sum() == 0; });
  if (const std::size_t most = figure_colors.size(); pieces.size() > most) {
    std::vector<double> sums;
    for (const Piece& piece : pieces) sums.push_back(piece.sum());
    std::ranges::sort(sums, std::greater());
    std::vector<Piece> kept;
    Piece rest{.name = fmt::format("{} other causes", pieces.size() - most + 1)};
    rest.lengths.resize(pieces.front().lengths.size());
    for (Piece& piece : pieces) {
      if (kept.size() + 1 < most && piece.sum() >= sums[most - 2])
        kept.push_back(std::move(piece));
      else
        std::ranges::transform(rest.lengths, piece.lengths, rest.lengths.begin(), std::plus());
    }
    kept.push_back(std::move(rest));
    pieces = std::move(kept);
  }
  for (std::size_t k = 0; k < pieces.size(); ++k) pieces[k].color = figure_colors[k];
  return pieces;
}

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
    plot.add(piece.name, "{} using 1:2:3:4:5:6 with boxxyerror lc rgb '{}' notitle", script.data(lines), piece.color);
    script.legend.push_back({fmt::format("with points pt 5 ps 1.15 lc rgb '{}'", piece.color), piece.name});
  }
  return plot;
}

}  // namespace

void draw_stages(std::span<const Record> records, FigureScript& script) {
  const std::span<const TimedPart> parts = parts_of(script.options.bars);
  if (parts.empty())
    throw Error("--cost {} has no stages: bars are of resolve, light, geometry or motion", name(script.options.bars));
  require_drawable_times(records);
  Bars places = bars_of(records, [&](const Record& r) { return sample_of(r, parts).is_timed(); });
  std::vector<Bar>& bars = places.all;
  std::erase_if(bars, [](const Bar& bar) { return bar.role == Role::baseline; });
  std::vector<Piece> pieces;
  std::vector<std::string> names;
  for (const TimedPart part : parts) {
    names.push_back(with_blanks(name(part)));
    pieces.push_back({names.back(), figure_colors[static_cast<std::size_t>(part.stage)]});
  }
  if (bars.empty()) throw Error("there is nothing to draw: no place has {} of every setting", with_and(names));

  std::vector<std::string> totals;
  double greatest = 0;
  for (const Bar& bar : bars) {
    std::vector<Sample> samples;
    for (const Record* row : bar.rows) samples.push_back(sample_of(*row, parts));
    const ValueWithInterval total = bootstrap(samples, [](std::span<const double> values) {
      return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
    });
    totals.push_back(fmt::format("{}\t{}\t{}\t{}", total.value, totals.size() + 1, total.low, total.high));
    greatest = std::max(greatest, total.high);
    for (std::size_t k = 0; k < parts.size(); ++k) {
      double& mean = pieces[k].lengths.emplace_back(0);
      for (const Record* row : bar.rows)
        mean += *median_of_medians(times_of(*row, parts[k])) / static_cast<double>(bar.rows.size());
    }
  }
  PlotCommand plot = plot_pieces(pieces, script);
  const std::string interval_style = fmt::format("lw 1.2 lc rgb '{}'", ink_color), interval = "95 % interval of the sum";
  plot.add(interval, "{} using 1:2:3:4 with xerrorbars pt -1 {} notitle", script.data(totals), interval_style);
  script.legend.push_back({"with lines " + interval_style, interval});
  script.shows = "time of " + with_and(names) + places.over_text();
  const PanelGrid grid = open_bars(script, bars, "time (ms)" + places.over_text(), 0.9);
  script.add("set xrange [0:*]; set xtics {}", linear_step(0, greatest, grid.x_labels()));
  plot.into(script);
  close_panels(script);
}

void draw_causes(std::span<const Record> records, FigureScript& script) {
  require_drawable(records, quantity_column("error"));
  Bars places = bars_of(records, [](const Record& r) { return r.causes && r.metric("error"); });
  std::vector<Bar>& bars = places.all;
  std::erase_if(bars, [](const Bar& bar) { return bar.role != Role::contender; });
  if (bars.empty()) throw Error("there is nothing to draw: no place has the causes of every setting");
  std::vector<CauseShares> shares;
  const std::vector<CauseInfo> causes = causes_of(records);
  for (const Bar& bar : bars) shares.push_back(shares_of(bar, causes));
  std::vector<Piece> pieces;
  for (const CauseInfo& info : causes) {
    pieces.push_back({with_blanks(info.name)});
    for (const CauseShares& bar : shares) pieces.back().lengths.push_back(bar.by_cause.find(info.name)->second * 100);
  }
  pieces = with_colors(std::move(pieces));
  if (pieces.empty()) throw Error("there is nothing to draw: no setting has a wrong pixel with a cause");
  const PlotCommand plot = plot_pieces(pieces, script);
  const auto is_hard_row = [](const Record* row) { return !has_cause_errors(row->answer); };
  const bool is_hard = std::ranges::all_of(bars, [&](const Bar& bar) { return std::ranges::all_of(bar.rows, is_hard_row); });
  const std::string share = is_hard ? "share of the wrong pixels (%)" : "share of the error (%)";
  script.shows = share + " by cause" + places.over_text();
  const PanelGrid grid = open_bars(script, bars, share + places.over_text(), 2.2);
  for (std::size_t k = 0; k < bars.size(); ++k)
    script.add("set label {} at 101.5,{} left textcolor rgb '#222222'",
               FigureScript::quoted(measured(100 * shares[k].error) + " %"), k + 1);
  script.add("set label 'error' at 101.5,0.2 left textcolor rgb '#666666'");
  script.add("set yrange [{}:-0.2]", static_cast<double>(bars.size()) + 0.6);
  script.add("set xrange [0:100]; set xtics {}", linear_step(0, 100, grid.x_labels(3)));
  plot.into(script);
  close_panels(script);
}

}  // namespace gnomon
