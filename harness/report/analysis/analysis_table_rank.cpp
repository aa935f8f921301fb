#include <cmath>

#include "analysis/rank.h"
#include "measure/statistics/sign_flip.h"
#include "report/analysis/analysis_table_parts.h"

namespace gnomon::analysis {

namespace {

/// "by error", "by relight + resolve under lights with area".
std::string ranking_heading(const Ranking& ranking, const Column& error, bool is_mixed) {
  return fmt::format("by {}{}", ranking.cost ? sentence(*ranking.cost) : error.heading,
                     is_mixed ? fmt::format(" under {}", lights_text(ranking.answer)) : "");
}

std::vector<Column> rank_columns() {
  return {for_programs(text_column("answer", "answer")),
          for_programs(text_column("quantity", "quantity")),
          text_column("setting", "technique"),
          text_column("against", "against"),
          number_column("ratio", "", "ratio"),
          spare(for_people(text_column("ratio_interval", "interval")), 1),
          for_programs(number_column("ratio_low", "", "ratio_low")),
          for_programs(number_column("ratio_high", "", "ratio_high")),
          for_programs(number_column("p", "", "p")),
          spare(number_column("p_holm", "", "p (Holm)"), 2),
          spare(whole_column("places", "", "places"), 3),
          spare(whole_column("scenes", "", "scenes"), 4),
          spare(whole_column("left_out", "", "left out"), 5),
          for_programs(text_column("left_out_places", "places left out")),
          for_programs(whole_column("tests", "", "tests")),
          for_programs(whole_column("needed_places", "", "places needed")),
          text_column("verdict", "verdict")};
}

Cell ratio_cell(double ratio) { return std::isfinite(ratio) ? Cell{.value = ratio} : Cell{.shown = "inf"}; }
Cell whole_cell(std::size_t count) { return {.value = static_cast<double>(count)}; }
Cell chance_cell(double chance) {
  return {.value = chance, .shown = chance < 0.001 ? "<0.001" : fmt::format("{:.3f}", chance)};
}

std::string verdict_text(const Ranking& ranking, const RankedPair& pair) {
  if (pair.places == 0) return "no place in common";
  if (pair.verdict != PairVerdict::too_few) return std::string(name(pair.verdict));
  return fmt::format("{}, {} needed", name(pair.verdict), ranking.needed_places);
}

Cells rank_cells(const Ranking& ranking, const RankedPair& pair, const std::string& error, std::span<const Place> places) {
  std::vector<std::string> left_out;
  for (const Place& place : pair.left_out) left_out.push_back(title(place, places));
  const auto& ratio = pair.ratio;
  const Column digits = number_column("ratio", "", "ratio");
  const auto end_cell = [&](double ValueWithInterval::*which) {
    return ratio && ratio->has_interval ? ratio_cell((*ratio).*which) : Cell{};
  };
  return {text_cell(name(ranking.answer)),
          text_cell(ranking.cost ? name(*ranking.cost) : std::string_view(error)),
          text_cell(pair.first),
          text_cell(pair.second),
          ratio ? ratio_cell(ratio->value) : Cell{},
          text_cell(ratio ? interval_text(digits, *ratio) : "-"),
          end_cell(&ValueWithInterval::low),
          end_cell(&ValueWithInterval::high),
          Cell{.value = pair.p},
          chance_cell(pair.family_rate),
          whole_cell(pair.places),
          whole_cell(pair.scenes),
          whole_cell(pair.left_out.size()),
          text_cell(joined(left_out, "; ")),
          whole_cell(ranking.tests),
          whole_cell(ranking.needed_places),
          shown_text(name(pair.verdict), verdict_text(ranking, pair))};
}

/// What the words of the table mean.
std::vector<std::string> rank_notes(std::span<const Ranking> rankings, const Column& error, bool is_mixed) {
  std::vector<std::string> notes = {
      "ratio: what technique has over what against has, at a typical place; of errors and memory the ratio whose relative "
      "difference (a - b) / (a + b) is the mean over places, of times the geometric mean",
      "interval: 95 %, of this pair alone",
      "p (Holm): the chance of any false call among all pairs of the group, were this one called; called at 0.05 and less"};
  notes.emplace_back(
      "errors and memory have no noise: the signs of their differences are flipped; times: Student's t of logarithms");
  for (const Ranking& ranking : rankings) {
    const std::string which = ranking_heading(ranking, error, is_mixed);
    const auto is_short = [](const RankedPair& pair) { return pair.verdict == PairVerdict::too_few; };
    if (std::ranges::any_of(ranking.pairs, is_short))
      notes.push_back(fmt::format("{}: fewer than {} places call no difference among {} pair{}", which, ranking.needed_places,
                                  ranking.tests, ranking.tests == 1 ? "" : "s"));
    if (ranking.drawn > 0)
      notes.push_back(
          fmt::format("{}: {} flips were drawn, for there are more than {} places", which, ranking.drawn, most_flipped));
    for (const std::string& note : ranking.notes) add_once(notes, note);
  }
  return notes;
}

}  // namespace

Layout rank_table(std::span<const Record> records, const RankOptions& options) {
  const std::vector<Ranking> rankings = find_ranks(records, options);
  const Column error = quantity_column(options.error);
  Layout table;
  table.title = options.all_pairs ? "Contenders in pairs over places"
                                  : fmt::format("The best by {} against each, over places", error.heading);
  table.columns = rank_columns();
  const bool is_mixed = std::ranges::any_of(rankings, [&](const Ranking& r) { return r.answer != rankings.front().answer; });
  std::vector<Place> places;
  for (const Record& record : records) add_once(places, place_of(record));
  for (const Ranking& ranking : rankings) {
    Layout::Group& group = table.groups.emplace_back(Layout::Group{.heading = ranking_heading(ranking, error, is_mixed)});
    for (const RankedPair& pair : ranking.pairs)
      group.rows.push_back({.cells = rank_cells(ranking, pair, options.error, places)});
  }
  table.notes = rank_notes(rankings, error, is_mixed);
  return table;
}

Tables rank_tables(std::span<const Record> records, const AnalysisOptions& options, Format) {
  Layout table = rank_table(records, {.error = options.metric, .cost = options.only_cost, .all_pairs = options.all_pairs});
  if (table.groups.empty())
    throw Error("there is nothing to rank: no two contenders finished with the number {} at one place", options.metric);
  return {std::move(table)};
}

}  // namespace gnomon::analysis
