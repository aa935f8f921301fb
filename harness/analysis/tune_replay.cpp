#include "analysis/tune_replay.h"

#include <gnomon/registry.h>

#include <algorithm>
#include <cmath>

#include "measure/run/suite.h"

namespace gnomon {

namespace {

constexpr std::string_view error_column = "error at ", bytes_column = "bytes at ";

/// Whether the goal is of numbers that a kept grid has.
void check_is_kept(const TuneNumber& number) {
  if (number.name != "error" && number.name != "bytes")
    throw Error("a kept grid has error and bytes of each setting, and no {}", number.name);
}

double number_of(const TuneNumber& number, const KeptGrid::Numbers& numbers) {
  return number.name == "error" ? numbers.error : numbers.bytes;
}

TuneAnswer answer_of(const std::optional<KeptGrid::Numbers>& numbers, const TuneGoal& goal) {
  if (!numbers) return {.is_there = false};
  TuneAnswer answer{.goal = number_of(goal.least, *numbers)};
  for (const TuneLimit& limit : goal.each)
    answer.beyond = std::max(answer.beyond, limit.beyond(number_of(limit.number, *numbers)));
  return answer;
}

/// Reads lines into a grid.
class TableReader {
 public:
  TableReader(std::string_view text, const std::string& name) {
    kept_.name = name;
    read_lines(text);
  }

  KeptGrid kept() {
    if (rows_.empty()) throw Error("{}: there is no setting in it", kept_.name);
    read_head();
    kept_.space = tune_space(space_text());
    if (!kept_.space.skipped.empty())
      throw Error("{}: parameters without an effect are no part of a grid: {}", kept_.name, joined(kept_.space.skipped, ", "));
    for (std::size_t line = 0; line < rows_.size(); ++line) add(rows_[line], line + 2);
    for (const TuneSetting& setting : kept_.space.grid.all())
      if (!kept_.numbers.contains(setting)) throw Error("{} lacks {}", kept_.name, kept_.space.name(setting));
    return std::move(kept_);
  }

 private:
  void read_lines(std::string_view text) {
    for (std::size_t at = 0, end = 0; at < text.size(); at = end + 1) {
      end = std::min(text.find('\n', at), text.size());
      std::vector<std::string> cells = parts_outside_braces(text.substr(at, end - at));
      if (at == 0)
        head_ = std::move(cells);
      else
        rows_.push_back(std::move(cells));
    }
  }

  void read_head() {
    const std::size_t colon = head_.front().find(':');
    if (colon == std::string::npos) throw Error("{}:1: '{}' is not ID:parameter", kept_.name, head_.front());
    id_ = head_.front().substr(0, colon);
    head_.front().erase(0, colon + 1);
    std::size_t at = 0;
    while (at < head_.size() && !head_[at].starts_with(error_column)) parameters_.push_back(head_[at++]);
    for (; at + 1 < head_.size(); at += 2) {
      const std::string place = head_[at].substr(std::min(error_column.size(), head_[at].size()));
      if (head_[at] != std::string(error_column) + place || head_[at + 1] != std::string(bytes_column) + place)
        throw Error("{}:1: '{}' and '{}' are not 'error at PLACE' and 'bytes at PLACE'", kept_.name, head_[at], head_[at + 1]);
      kept_.places.push_back(place);
    }
    if (kept_.places.empty() || at != head_.size()) throw Error("{}:1: each place needs an error and bytes", kept_.name);
    for (std::size_t line = 0; line < rows_.size(); ++line)
      if (rows_[line].size() != head_.size())
        throw Error("{}:{}: {} values under {} headings", kept_.name, line + 2, rows_[line].size(), head_.size());
  }

  /// "shadow_map:resolution={64,128},bias={constant,slope}", of the values that there are.
  std::string space_text() const {
    std::vector<std::string> items;
    for (std::size_t k = 0; k < parameters_.size(); ++k) {
      std::vector<std::string> values;
      for (const std::vector<std::string>& row : rows_)
        if (std::ranges::find(values, row[k]) == values.end()) values.push_back(row[k]);
      const std::string text = joined(values, ",");
      items.push_back(parameters_[k] + "=" + (values.size() > 1 ? "{" + text + "}" : text));
    }
    return fmt::format("{}:{}", id_, joined(items, ","));
  }

  double number(const std::string& text, std::size_t line) const {
    const std::optional<double> value = number_from(text);
    if (!value || !(*value >= 0)) throw Error("{}:{}: '{}' is no number of 0 or more", kept_.name, line, text);
    return *value;
  }

  void add(const std::vector<std::string>& row, std::size_t line) {
    TuneSetting setting;
    for (const TuneSpace::Parameter& parameter : kept_.space.parameters) {
      const auto column = static_cast<std::size_t>(std::ranges::find(parameters_, parameter.name) - parameters_.begin());
      const auto level = std::ranges::find(parameter.values, row[column]);
      if (level == parameter.values.end())
        throw Error("{}:{}: the technique writes {} = {} in another way", kept_.name, line, parameter.name, row[column]);
      setting.push_back(static_cast<std::size_t>(level - parameter.values.begin()));
    }
    std::vector<std::optional<KeptGrid::Numbers>> numbers;
    for (std::size_t at = parameters_.size(); at < row.size(); at += 2) {
      std::optional<KeptGrid::Numbers>& there = numbers.emplace_back();
      if (!row[at].empty()) there = {number(row[at], line), number(row[at + 1], line)};
    }
    kept_.numbers.emplace(kept_.space.grid.canonical(setting), std::move(numbers));
  }

  KeptGrid kept_;
  std::string id_;
  std::vector<std::string> head_, parameters_;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace

std::string kept_grid_text(const KeptGrid& kept) {
  const TuneSpace& space = kept.space;
  std::vector<std::string> head, fixed;
  for (const std::string& item : parts_outside_braces(space.fixed))
    if (!item.empty()) {
      head.push_back(item.substr(0, item.find('=')));
      fixed.push_back(item.substr(item.find('=') + 1));
    }
  for (const TuneSpace::Parameter& parameter : space.parameters) head.push_back(parameter.name);
  for (const std::string& place : kept.places)
    for (const std::string_view column : {error_column, bytes_column}) head.push_back(std::string(column) + place);
  std::string text = fmt::format("{}:{}\n", space.technique, joined(head, ","));
  for (const auto& [setting, numbers] : kept.numbers) {
    std::vector<std::string> cells = fixed;
    for (std::size_t k = 0; k < space.parameters.size(); ++k) cells.push_back(space.parameters[k].values[setting[k]]);
    for (const std::optional<KeptGrid::Numbers>& there : numbers) {
      cells.push_back(there ? fmt::format("{:.4g}", there->error) : "");
      cells.push_back(there ? fmt::format("{:.0f}", there->bytes) : "");
    }
    text += joined(cells, ",") + "\n";
  }
  return text;
}

KeptGrid read_kept_grid(std::string_view text, const std::string& name) { return TableReader(text, name).kept(); }

double TuneReplay::ratio() const {
  if (best_standing.keeps_limits() != found_standing.keeps_limits()) return INFINITY;
  const bool is_kept = best_standing.keeps_limits();
  const double mine = is_kept ? found_standing.goal : found_standing.beyond;
  const double best = is_kept ? best_standing.goal : best_standing.beyond;
  return mine == best ? 1 : mine / best;
}

TuneReplay replay(const KeptGrid& kept, const TuneGoal& goal, std::uint64_t seed) {
  check_is_kept(goal.least);
  for (const TuneLimit& limit : goal.each) check_is_kept(limit.number);
  const auto standing_of = [&](const TuneSetting& setting) {
    std::vector<TuneAnswer> answers;
    for (const std::optional<KeptGrid::Numbers>& numbers : kept.numbers.at(setting))
      answers.push_back(answer_of(numbers, goal));
    return standing(answers, answers.size(), goal.over);
  };
  TuneReplay result;
  for (const TuneSetting& setting : kept.space.grid.all()) {
    const TuneStanding one = standing_of(setting);
    if (!result.best.empty() && !is_better(one, result.best_standing)) continue;
    result.best = setting;
    result.best_standing = one;
  }
  const TuneAsker ask = [&](std::span<const TuneQuestion> questions) {
    std::vector<std::optional<TuneAnswer>> answers;
    for (const TuneQuestion& question : questions)
      answers.emplace_back(answer_of(kept.numbers.at(question.setting)[question.place], goal));
    return answers;
  };
  const TuneSearchOptions options{
      .places = kept.places.size(), .over = goal.over, .whole = false, .most_asked = most_asked(kept.possible()), .seed = seed};
  const TuneSearch search = search_grid(kept.space.grid, options, ask);
  result.asked = search.asked;
  const std::vector<TuneSetting> order = ranked(search, kept.places.size(), goal.over);
  if (order.empty()) throw Error("{}: the search found no setting with an answer at every place", kept.name);
  result.found = order.front();
  result.found_standing = standing_of(result.found);
  return result;
}

}  // namespace gnomon
