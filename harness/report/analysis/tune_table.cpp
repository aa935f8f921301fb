#include "report/analysis/tune_table.h"

#include "report/analysis/analysis_table.h"
#include "report/table/digits.h"

namespace gnomon {

namespace {

Column column_of(const TuneNumber& number) {
  if (number.cost && *number.cost != Cost::bytes) return number_column(number.name, "ms", std::string(name(*number.cost)));
  return quantity_column(number.name);
}

std::string cell_text(const TuneNumber& number, const std::optional<double>& value) {
  return value ? shown(column_of(number), {.value = *value}) : "-";
}

/// Whether every setting was asked at every place, so that what is said of all is so.
bool is_whole(const TuneReport& report) { return static_cast<double>(report.asked) >= report.possible; }

/// Where places are told apart by what they differ in: those that decided and those that were held out.
std::vector<Place> all_places(const TuneReport& report) {
  std::vector<Place> all = report.places;
  all.insert(all.end(), report.held.begin(), report.held.end());
  return all;
}

/// The goal, the numbers with limits, error and light cost, each once.
std::vector<TuneNumber> numbers_of(const TuneGoal& goal) {
  std::vector<TuneNumber> numbers{goal.least};
  const auto add = [&](const TuneNumber& number) {
    if (std::ranges::find(numbers, number.name, &TuneNumber::name) == numbers.end()) numbers.push_back(number);
  };
  for (const TuneLimit& limit : goal.each) add(limit.number);
  add({"error"});
  add({"light_ms", Cost::light});
  return numbers;
}

/// The number over the places that ran: the goal as it counts, all others at their worst.
std::optional<double> over_places(const TuneNumber& number, const TuneRow& row, const TuneGoal& goal) {
  std::vector<double> values;
  for (const Record* record : row.rows)
    if (const auto value = record ? number.of(*record) : std::nullopt) values.push_back(*value);
  if (values.empty()) return std::nullopt;
  if (number.name == goal.least.name && goal.over == TuneOver::mean) {
    double sum = 0;
    for (const double value : values) sum += value;
    return sum / static_cast<double>(values.size());
  }
  return better(number.name) == "higher" ? *std::ranges::min_element(values) : *std::ranges::max_element(values);
}

/// Where a limit is nearest to be broken, or most broken.
struct Margin {
  std::optional<std::size_t> place;
  double value = 0, beyond = 0;
};
Margin margin_of(const TuneLimit& limit, std::span<const Record* const> rows) {
  Margin margin;
  for (std::size_t place = 0; place < rows.size(); ++place) {
    const auto value = rows[place] ? limit.number.of(*rows[place]) : std::nullopt;
    if (!value || (margin.place && limit.beyond(*value) <= margin.beyond)) continue;
    margin = {place, *value, limit.beyond(*value)};
  }
  return margin;
}

/// "keeps them", or what it breaks first and where.
std::string limits_text(const TuneRow& row, const TuneReport& report) {
  std::size_t there = 0;
  for (const Record* record : row.rows) {
    if (record && record->status != Status::ok)
      return fmt::format("{} at {}", name(record->status), title(place_of(*record), all_places(report)));
    there += record != nullptr;
  }
  for (const TuneLimit& limit : report.goal.each)
    if (const Margin margin = margin_of(limit, row.rows); margin.place && margin.beyond > 0)
      return fmt::format("breaks {} at {}", limit.text, title(report.places[*margin.place], all_places(report)));
  if (there < row.rows.size()) return fmt::format("worse at the first {} place{}", there, there == 1 ? "" : "s");
  return report.goal.each.empty() ? "" : "keeps all";
}

TextTable::Column heading(const TuneNumber& number, const std::string& which) {
  const Column column = column_of(number);
  return {column.heading + (which.empty() ? "" : ", " + which), column.shown_unit, Align::right};
}

std::string settings_table(const TuneReport& report, std::size_t width) {
  const std::vector<TuneNumber> numbers = numbers_of(report.goal);
  std::vector<TextTable::Column> columns{{"", ""}, {"setting", ""}};
  for (const TuneNumber& number : numbers) {
    const bool is_mean = &number == &numbers.front() && report.goal.over == TuneOver::mean;
    columns.push_back(heading(number, is_mean ? "mean" : "worst"));
  }
  columns.push_back({"limits", ""});
  TextTable table(columns);
  for (const TuneRow& row : report.rows) {
    std::vector<std::string> cells{row.what, row.name};
    for (const TuneNumber& number : numbers) cells.push_back(cell_text(number, over_places(number, row, report.goal)));
    cells.push_back(limits_text(row, report));
    table.add_row(cells);
  }
  return table.text(width);
}

/// Every number of the answer at every place.
std::string places_table(const TuneReport& report, std::span<const Place> places, std::span<const Record* const> answer,
                         std::span<const Record* const> base, std::size_t width) {
  const std::vector<TuneNumber> numbers = numbers_of(report.goal);
  std::vector<TextTable::Column> columns{{"place", ""}};
  for (const TuneNumber& number : numbers) columns.push_back(heading(number, ""));
  columns.push_back({"limits", ""});
  if (!base.empty()) columns.push_back(heading(report.goal.least, "default"));
  TextTable table(columns);
  for (std::size_t k = 0; k < places.size(); ++k) {
    std::vector<std::string> cells{title(places[k], all_places(report))}, broken;
    for (const TuneNumber& number : numbers)
      cells.push_back(cell_text(number, answer[k] ? number.of(*answer[k]) : std::nullopt));
    for (const TuneLimit& limit : report.goal.each)
      if (margin_of(limit, answer.subspan(k, 1)).beyond > 0) broken.push_back(limit.text);
    const bool is_ok = answer[k] && answer[k]->status == Status::ok;
    cells.push_back(!is_ok ? "no answer" : broken.empty() ? "keeps all" : "breaks " + joined(broken, ", "));
    if (!base.empty()) cells.push_back(cell_text(report.goal.least, base[k] ? report.goal.least.of(*base[k]) : std::nullopt));
    table.add_row(cells);
  }
  return table.text(width);
}

std::string margins_text(const TuneReport& report) {
  std::string text;
  for (const TuneLimit& limit : report.goal.each) {
    const Margin margin = margin_of(limit, report.rows.front().rows);
    if (!margin.place) {
      text += fmt::format("{}: no place has this number; the limit is not applied\n", limit.text);
      continue;
    }
    text += fmt::format("{}: {} at {}, {:.0f} % {}\n", limit.text, number_text(limit.number, margin.value),
                        title(report.places[*margin.place], all_places(report)), 100 * std::abs(margin.beyond),
                        margin.beyond > 0 ? "beyond it" : "to spare");
  }
  return text;
}

std::string effects_table(const TuneReport& report, std::size_t width) {
  TextTable table({{"parameter", ""}, {"answer", ""}, {fmt::format("best {} with each value", report.goal.least.name), ""}});
  bool has_broken = false;
  for (const TuneEffect& effect : report.effects) {
    std::vector<std::string> values;
    for (const TuneEffect::Value& value : effect.values) {
      const bool is_broken = value.best && !value.best->keeps_limits();
      has_broken = has_broken || is_broken;
      values.push_back(fmt::format("{}: {}{}", value.text, value.best ? number_text(report.goal.least, value.best->goal) : "-",
                                   is_broken ? " !" : ""));
    }
    std::string answer = effect.values[effect.chosen].text;
    if (effect.is_at_end) answer += " (an end of its range)";
    table.add_row({effect.parameter, answer, joined(values, ", ")});
  }
  return table.text(width) +
         (!has_broken        ? ""
          : is_whole(report) ? "!: breaks a limit, whatever the other parameters\n"
                             : "!: breaks a limit in all settings with it that were measured at every place\n") +
         "-: no setting with this value was measured at every place\n";
}

std::string scenes_table(const TuneReport& report, std::size_t width) {
  const std::string number = report.goal.least.name;
  TextTable table({{"scene left out", ""},
                   {"chosen by the others", ""},
                   {number + " there", "", Align::right},
                   {"best there", "", Align::right},
                   {"limits there", ""}});
  for (const SceneLeftOut& left : report.scenes_left_out)
    table.add_row({left.scene, report.compared[left.chosen], number_text(report.goal.least, left.there.goal),
                   number_text(report.goal.least, left.best.goal),
                   left.there.keeps_limits() ? "kept"
                                             : fmt::format("broken by {:.0f} %{}", 100 * left.there.beyond,
                                                           left.best.keeps_limits() ? "" : "; nobody keeps them")});
  return table.text(width);
}

std::string held_out_text(const TuneReport& report, std::size_t width) {
  std::string text;
  if (!report.scenes_left_out.empty()) {
    text += fmt::format("Each scene left out in turn, among the {} setting{} that were measured at every place:\n\n{}",
                        report.compared.size(), report.compared.size() == 1 ? "" : "s", scenes_table(report, width));
    constexpr std::size_t least_scenes = 5;
    if (report.scenes_left_out.size() < least_scenes)
      text +=
          fmt::format("\nFewer than {} scenes say little of another one: the answer holds for those named.\n", least_scenes);
  }
  if (!report.held.empty())
    text += fmt::format("{}Held out by seed {}, so that they chose nothing:\n\n{}", text.empty() ? "" : "\n", report.seed,
                        places_table(report, report.held, report.answer_held, report.default_held, width));
  if (report.scenes_left_out.empty())
    text += fmt::format("{}One scene says nothing of other scenes.\n", report.held.empty() ? "Nothing was held out. " : "\n");
  return text;
}

/// What was looked for, and how sure it is that this is it.
std::string head_text(const TuneReport& report) {
  const TuneGoal& goal = report.goal;
  std::vector<std::string> limits;
  for (const TuneLimit& limit : goal.each) limits.push_back(limit.text);
  const std::string where = fmt::format("{} place{}", report.places.size(), report.places.size() == 1 ? "" : "s");
  std::string text = fmt::format("{}\n\n", report.rows.front().name);
  if (!report.is_feasible)
    return fmt::format("no setting{} keeps {} at each of {}; the nearest miss:\n\n{}",
                       is_whole(report) ? "" : fmt::format(" of the {} that were measured there", report.compared.size()),
                       limits.empty() ? "below a constant mask" : joined(limits, ", "), where, text);
  text += fmt::format("least {} ({} over {}){}\n", goal.least.name, goal.over == TuneOver::worst ? "worst" : "mean", where,
                      limits.empty() ? "" : ", with " + joined(limits, ", ") + " at each");
  if (!report.tied.empty())
    text += fmt::format("tie: {}; the answer is the one with the least error\n", joined(report.tied, "; "));
  if (report.chances)
    text += fmt::format("chance that it is the least of the finalists: {:.0f} %; within 2 %: {:.0f} %; within 5 %: {:.0f} %\n",
                        100 * (*report.chances)[0], 100 * (*report.chances)[1], 100 * (*report.chances)[2]);
  return text;
}

std::string foot_text(const TuneReport& report) {
  std::string text = fmt::format("{} evaluations of {:.0f} possible ({:.0f} %){}, seed {}\n", report.asked, report.possible,
                                 100 * static_cast<double>(report.asked) / report.possible,
                                 report.is_cut_short ? ", cut short by the budget" : "", report.seed);
  for (const std::string& note : report.notes) text += fmt::format("note: {}\n", note);
  std::vector<Record> rows;
  for (const Record* record : report.rows.front().rows)
    if (record) rows.push_back(*record);
  for (const char* key : {"commit", "processor", "threads", "gl_renderer"})
    text += fmt::format("{}: {}\n", with_blanks(key), joined(context_values(rows, key), "; "));
  return text;
}

}  // namespace

std::string number_text(const TuneNumber& number, double value) {
  if (!std::isfinite(value)) return "-";  // it was not measured, for the setting breaks a limit
  const Column column = column_of(number);
  const bool has_unit = !column.shown_unit.empty() && column.shown_unit != "ratio" && column.shown_unit != "index";
  return shown(column, {.value = value}) + (has_unit ? " " + column.shown_unit : "");
}

std::string tune_text(const TuneReport& report, std::size_t width) {
  std::string text = head_text(report);
  const std::string margins = margins_text(report);
  if (!margins.empty()) text += "\n" + margins;
  text += "\n" + settings_table(report, width);
  text += "\n" + places_table(report, report.places, report.rows.front().rows, {}, width);
  if (!report.effects.empty()) text += "\n" + effects_table(report, width);
  text += "\n" + held_out_text(report, width);
  return text + "\n" + foot_text(report);
}

}  // namespace gnomon
