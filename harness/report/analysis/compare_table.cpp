#include "report/analysis/compare_table.h"

#include <gnomon/error.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "measure/counted.h"
#include "measure/score/metrics.h"
#include "report/table/digits.h"
#include "report/table/layout.h"
#include "report/table/text_table.h"

namespace gnomon {

namespace {

/// "1.30 [1.21, 1.40]".
std::string interval_text(const Estimate& ratio) {
  return fmt::format("{} [{}, {}]", rounded(ratio.value, 3), rounded(ratio.low, 3), rounded(ratio.high, 3));
}

std::string ratio_text(const StageChange& stage) {
  if (!stage.ratio) return "-";
  return stage.verdict == Verdict::not_judged ? rounded(stage.ratio->value, 3) : interval_text(*stage.ratio);
}

/// Base, contender and their difference with the metric's unit, with as many digits as it takes to distinguish them.
std::array<std::string, 3> metric_texts(const MetricChange& change) {
  const auto infos = metric_infos();
  const auto info = std::ranges::find(infos, change.metric, &MetricInfo::name);
  const bool is_share = info != infos.end() && info->unit.empty();
  const double scale = is_share ? 100 : 1;
  const std::string unit = is_share ? " %" : info != infos.end() ? fmt::format(" {}", info->unit) : "";
  const auto text = [&](std::optional<double> value, auto round) { return value ? round(scale * *value) + unit : "-"; };
  std::string base = text(change.base, measured), contender = text(change.contender, measured);
  constexpr int most_digits = 17;  // of a double
  for (int digits = 3; base == contender && digits <= most_digits; ++digits) {
    const auto round = [&](double value) { return rounded(value, digits); };
    base = text(change.base, round);
    contender = text(change.contender, round);
  }
  std::string difference = "-";
  if (change.base && change.contender) {
    const double step = *change.contender - *change.base;
    difference = fmt::format("{}{}{}", step > 0 ? "+" : "", rounded(scale * step, 2), unit);
  }
  return {base, contender, difference};
}

/// One line for people: what was compared and how it came out.
struct Line {
  const Record* record = nullptr;  ///< nullptr: over all scenes
  std::string technique = "", what = "";
  std::array<std::string, 3> values = {};  ///< base, contender, change
  std::string verdict = "";
  std::string note = "";  ///< instead of `what` and what follows

  std::string light() const {
    if (!record) return "";
    return record->path.empty() ? record->light : record->light + " on " + record->path;
  }
  std::string heading() const {
    if (!record) return "over all scenes";
    return fmt::format("{}, light {}, {}x{}", record->scene, light(), record->width, record->height);
  }
};

std::string presence(const RowChange& row) {
  const Record& record = row.record();
  const std::string why = record.reason.empty() ? "" : ": " + record.reason;
  if (!row.base) return fmt::format("new in the contender, {}{}", name(record.status), why);
  if (!row.contender) return fmt::format("missing in the contender; it was {}{}", name(record.status), why);
  return "";
}

bool is_called(Verdict verdict) { return verdict == Verdict::faster || verdict == Verdict::slower; }

std::string with_mark(std::string text, bool is_regression) { return is_regression ? text + " !" : text; }

void add_row(std::vector<Line>& lines, const RowChange& row, bool all) {
  const Record& record = row.record();
  const std::size_t before = lines.size();
  const auto add = [&](Line line) {
    line.record = &record;
    line.technique = setting_name(record);
    lines.push_back(std::move(line));
  };
  if (const std::string text = presence(row); !text.empty()) add({.note = text});
  for (const std::string& note : row.notes) add({.note = row.is_regression ? "! " + note : note});
  for (const StageChange& stage : row.stages) {
    if (!is_called(stage.verdict) && !all) continue;
    const auto time = [](std::optional<double> ms) { return ms ? milliseconds(*ms) : "-"; };
    std::string verdict = with_mark(std::string(name(stage.verdict)), stage.is_regression);
    if (!stage.why.empty()) verdict += ": " + stage.why;
    add({.what = fmt::format("{} ms", gnomon::name(stage.stage)),
         .values = {time(stage.base_ms), time(stage.contender_ms), ratio_text(stage)},
         .verdict = verdict});
  }
  for (const MetricChange& change : row.metrics)
    add({.what = change.truth == record.truth ? change.metric : fmt::format("{}.{}", name(change.truth), change.metric),
         .values = metric_texts(change),
         .verdict = with_mark("changed", change.is_regression) +
                    (change.floor ? fmt::format(", floor {} %", measured(100 * *change.floor)) : "")});
  for (const CountChange& change : row.counts)
    add({.what = change.unit.empty() ? change.name : fmt::format("{}, {}", change.name, change.unit),
         .values = {exact(change.base), exact(change.contender),
                    change.base != 0 ? rounded(change.contender / change.base, 3) : "-"},
         .verdict = "changed"});
  if (all && lines.size() == before) add({.note = fmt::format("{} in both runs", name(record.status))});
}

/// All rows together come first and always; contenders and rows when they differ.
std::vector<Line> lines_of(const Comparison& comparison, const CompareTableOptions& options) {
  std::vector<Line> lines;
  for (const OverallChange& change : comparison.overall)
    if (options.all || change.contender.empty() || is_called(change.verdict))
      lines.push_back({.technique = change.contender.empty() ? "all rows" : change.contender,
                       .what = fmt::format("{} ms", name(change.stage)),
                       .values = {"-", "-", interval_text(change.ratio)},
                       .verdict = with_mark(std::string(name(change.verdict)), change.is_regression)});
  if (options.over_all) return lines;
  for (const RowChange& row : comparison.rows) add_row(lines, row, options.all);
  return lines;
}

/// What differences would have been found, and how smaller ones are.
std::string least_ratios(const Comparison& comparison) {
  std::string text = fmt::format("times that are {} times as long in one row", rounded(comparison.least_ratio, 3));
  const auto all_rows = std::ranges::find(comparison.overall, "", &OverallChange::contender);
  if (all_rows != comparison.overall.end()) text += fmt::format(", {} times in all rows", rounded(all_rows->least_ratio, 3));
  text += ", four times in five";
  if (comparison.side_by_side) return text;
  const auto row = std::ranges::find_if(comparison.rows, [](const RowChange& r) { return r.base && r.contender; });
  const std::string suite = row->contender->suite;
  return text + fmt::format("; less is found by gnomon compare --live PROGRAM {}, where PROGRAM is that of the base",
                            suite.empty() || suite == "adhoc" ? "--scene ... --technique ..." : "--suite " + suite);
}

/// Remarks about the whole comparison: topic and text.
std::vector<std::pair<std::string, std::string>> remarks(const Comparison& comparison) {
  std::vector<std::pair<std::string, std::string>> lines = comparison.differences;
  if (!comparison.refusal.empty())
    lines.emplace_back("times", fmt::format("not judged: {}; --force judges them all the same", comparison.refusal));
  if (comparison.counts().judged == 0) return lines;
  if (comparison.side_by_side) lines.emplace_back("times", "taken side by side, in pairs: what disturbs both cancels");
  lines.emplace_back(
      "drift", fmt::format("{} % {}, read off the spread of all times; intervals are {} times as wide for it",
                           rounded(100 * std::expm1(comparison.between), 2),
                           comparison.side_by_side ? "between the two" : "from run to run", rounded(comparison.inflation, 2)));
  lines.emplace_back("could find", least_ratios(comparison));
  return lines;
}

std::string legend_text(const Comparison& comparison) {
  std::string text =
      "change: contender / base of times, with its 95 % interval, and of counts, contender - base of errors; !: regression";
  const bool has_floor = std::ranges::any_of(comparison.rows, [](const RowChange& row) {
    return std::ranges::any_of(row.metrics, [](const MetricChange& change) { return change.floor.has_value(); });
  });
  if (has_floor) text += "; floor: what the reference's own noise makes";
  return text;
}

std::string terminal_text(const Comparison& comparison, const CompareTableOptions& options) {
  std::string text;
  const auto add = [&](const std::string& line) { text += wrapped_line(line, options.width); };
  add(fmt::format("base: {}", options.base));
  add(fmt::format("contender: {}", options.contender));
  for (const auto& [topic, what] : remarks(comparison)) add(fmt::format("{}: {}", topic, what));
  const std::vector<Line> lines = lines_of(comparison, options);
  if (lines.empty()) return text + '\n';
  TextTable table({{"technique", ""},
                   {"what", ""},
                   {"base", "", Align::right, 1},
                   {"contender", "", Align::right, 1},
                   {"change", "", Align::right},
                   {"verdict", ""}});
  std::string group;
  for (const Line& line : lines) {
    if (const std::string now = line.heading(); now != group) table.add_heading(group = now);
    if (line.note.empty())
      table.add_row({line.technique, line.what, line.values[0], line.values[1], line.values[2], line.verdict});
    else
      table.add_row({line.technique}, line.note);
  }
  text += fmt::format("\n{}\n", table.text(options.width));
  add(legend_text(comparison));
  return text;
}

std::string markdown(const Comparison& comparison, const CompareTableOptions& options) {
  std::string text;
  const std::vector<Line> lines = lines_of(comparison, options);
  if (!lines.empty())
    text =
        "| scene | light | technique | what | base | contender | change | verdict |\n"
        "| --- | --- | --- | --- | ---: | ---: | ---: | --- |\n";
  for (const Line& line : lines) {
    std::vector<std::string> cells{line.record ? line.record->scene : "all", line.light(), line.technique, line.what};
    cells.insert(cells.end(), line.values.begin(), line.values.end());
    cells.push_back(line.note.empty() ? line.verdict : line.note);
    for (const std::string& cell : cells) text += fmt::format("| {} ", markdown_text(cell));
    text += "|\n";
  }
  if (!lines.empty()) text += '\n';
  text += fmt::format("- base: {}\n- contender: {}\n", markdown_text(options.base), markdown_text(options.contender));
  for (const auto& [topic, what] : remarks(comparison)) text += fmt::format("- {}: {}\n", topic, markdown_text(what));
  if (!lines.empty()) text += fmt::format("- {}\n", legend_text(comparison));
  return text + '\n';
}

}  // namespace

std::string summary_line(const Comparison& comparison) {
  const Comparison::Counts n = comparison.counts();
  std::string text = counted(n.matched, "row{s}") + " matched";
  if (n.missing) text += fmt::format(", {} missing", n.missing);
  if (n.added) text += fmt::format(", {} new", n.added);
  if (n.status) text += fmt::format(", {} of another status", n.status);
  text += fmt::format("; {} judged: {} slower, {} faster; {} with other errors", counted(n.judged, "time{s}"), n.slower,
                      n.faster, counted(n.changed_rows, "row{s}"));
  if (n.rows_of_other_work > 0) text += fmt::format(", {} with other work", n.rows_of_other_work);
  if (n.overall > 0) text += fmt::format("; over all scenes {} slower, {} faster", n.overall_slower, n.overall_faster);
  return text + fmt::format("; {}", n.regressions == 0 ? "no regression" : counted(n.regressions, "regression{s}"));
}

std::string render_comparison(const Comparison& comparison, Format format, const CompareTableOptions& options) {
  if (format == Format::csv) return comparison_csv(comparison);
  if (format == Format::json) return comparison_json(comparison, options);
  if (format == Format::latex) throw Error("a comparison has no format tex; there are: terminal, md, csv, json");
  if (format == Format::markdown) return markdown(comparison, options) + summary_line(comparison) + '\n';
  return terminal_text(comparison, options) + wrapped_line(summary_line(comparison), options.width);
}

}  // namespace gnomon
