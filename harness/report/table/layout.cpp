#include "report/table/layout.h"

#include <algorithm>
#include <set>

#include "analysis/in_order.h"
#include "report/table/digits.h"

namespace gnomon {

namespace {

std::string group_heading(const Record& r) {
  std::string text = fmt::format("scene {}", r.scene);
  if (r.scene_facts) text += fmt::format(" ({} triangles)", r.scene_facts->triangles);
  if (!r.light.empty()) text += fmt::format(", light {}", r.light);
  if (!r.light_kind.empty() && r.light_kind != r.light) text += fmt::format(" ({})", r.light_kind);
  if (!r.view.empty()) text += fmt::format(", view {}", r.view);
  if (!r.path.empty()) text += fmt::format(", path {}", r.path);
  if (r.width > 0) text += fmt::format(", {} x {}", r.width, r.height);
  return text + fmt::format(", {} truth", name(r.truth));
}

/// Marks the best contenders of one column in one group; nothing when there is no choice or no difference. Where the column
/// has intervals, whoever's overlaps that of the best is marked too: the data does not tell them apart.
void mark_best(const Column& column, std::size_t index, const std::vector<std::vector<Cell>>& cells, Layout::Group& group) {
  if (column.better.empty()) return;
  struct Competitor {
    std::size_t row;
    Estimate estimate;
  };
  std::vector<Competitor> competitors;
  for (std::size_t row = 0; row < group.rows.size(); ++row) {
    const Record& record = *group.rows[row].record;
    const double* value = cells[row][index].number();
    if (!value || record.status != Status::ok || record.role != Role::contender) continue;
    const std::optional<Estimate> interval = column.interval ? column.interval(record) : std::nullopt;
    competitors.push_back({row, interval.value_or(Estimate{*value, *value, *value})});
  }
  if (competitors.empty()) return;
  const auto by_value = [](const Competitor& a, const Competitor& b) { return a.estimate.value < b.estimate.value; };
  const auto [least, greatest] = std::minmax_element(competitors.begin(), competitors.end(), by_value);
  const Estimate best = column.better == "lower" ? least->estimate : greatest->estimate;
  const auto is_best = [&](const Competitor& c) { return c.estimate.low <= best.high && c.estimate.high >= best.low; };
  if (std::all_of(competitors.begin(), competitors.end(), is_best)) return;
  for (const Competitor& c : competitors) group.rows[c.row].entries[index].is_best = is_best(c);
}

/// The different values of a context key, in order of appearance.
std::string distinct(std::span<const Record> records, const char* key) {
  std::vector<std::string> values;
  for (const Record& r : records) {
    const auto found = r.context.find(key);
    if (found == r.context.end() || found->is_null()) continue;
    add_once(values, plain_text(*found));
  }
  return joined(values, "; ");
}

/// Older records do not have it: a column of nothing would stand beside their wrong rates.
bool has_snapping_floor(std::span<const Record> records) {
  return std::ranges::any_of(records, [](const Record& r) { return r.metric("snapping_floor").has_value(); });
}

/// "5 processes x 3 repetitions", every combination that occurs in a stage after setup.
std::string repetition_plan(std::span<const Record> records) {
  std::vector<std::string> plans;
  for (const Record& r : records)
    for (const Stage stage : {Stage::build, Stage::relight, Stage::resolve}) {
      std::size_t repetitions = 0;
      for (const std::vector<double>& process : r.times(stage)) repetitions = std::max(repetitions, process.size());
      if (repetitions == 0) continue;
      add_once(plans, fmt::format("{} x {}", r.times(stage).size(), repetitions));
    }
  return joined(plans, ", ");
}

}  // namespace

std::vector<std::string> headline_columns(std::span<const Record> records, bool with_group) {
  std::set<std::string> views, paths;
  std::set<std::pair<int, int>> sizes;
  std::set<Truth> truths;
  for (const Record& r : records) {
    views.insert(r.view);
    paths.insert(r.path);
    sizes.insert({r.width, r.height});
    truths.insert(r.truth);
  }
  std::vector<std::string> names;
  if (with_group) {
    names = {"scene", "light"};
    if (views.size() > 1) names.emplace_back("view");
    if (paths.size() > 1 || (!paths.empty() && !paths.begin()->empty())) names.emplace_back("path");
    if (sizes.size() > 1) names.insert(names.end(), {"width", "height"});
    if (truths.size() > 1) names.emplace_back("truth");
  }
  names.insert(names.end(), {"technique", "support", "setup_ms", "build_ms", "relight_ms", "resolve_ms", "bytes", "peak_bytes",
                             "wrong_rate"});
  if (has_snapping_floor(records)) names.emplace_back("snapping_floor");
  names.insert(names.end(), {"wrong_rate_all", "false_dark_rate", "false_lit_rate"});
  if (std::any_of(records.begin(), records.end(), [](const Record& r) { return !top_causes(r).empty(); }))
    names.emplace_back("causes");
  names.insert(names.end(), {"displacement_mean", "displacement_p95", "tested_share"});
  return names;
}

std::vector<std::string> paper_columns(std::span<const Record> records) {
  std::vector<std::string> names = {"technique", "support", "build_ms", "relight_ms", "resolve_ms", "bytes", "wrong_rate"};
  if (has_snapping_floor(records)) names.emplace_back("snapping_floor");
  names.insert(names.end(), {"false_dark_rate", "false_lit_rate", "displacement_mean", "tested_share"});
  return names;
}

std::vector<std::pair<std::string, std::string>> provenance(std::span<const Record> records) {
  std::vector<std::pair<std::string, std::string>> lines;
  const auto add = [&](const char* topic, std::string text) {
    lines.emplace_back(topic, text.empty() ? "-" : std::move(text));
  };
  add("renderer", distinct(records, "gl_renderer"));
  add("processor", distinct(records, "processor"));
  add("threads", distinct(records, "threads"));
  add("version", distinct(records, "version"));
  add("commit", distinct(records, "commit"));
  add("processes x repetitions", repetition_plan(records));
  std::vector<std::string> notes;
  for (const Record& r : records)
    for (const std::string& note : r.notes) add_once(notes, fmt::format("{}: {}", r.scene, note));
  for (const std::string& note : notes) add("note", note);
  return lines;
}

std::vector<std::pair<std::string, std::string>> legend(const Layout& layout, std::string_view best, std::string_view flag) {
  bool has_best = false, has_flag = false, has_null = false;
  for (const Layout::Group& group : layout.groups)
    for (const Layout::Row& row : group.rows)
      for (const Layout::Entry& entry : row.entries) {
        has_best |= entry.is_best;
        has_flag |= entry.is_flagged;
        has_null |= entry.text == "-";
      }
  const auto has_column = [&](std::string_view unit) {
    return std::any_of(layout.columns.begin(), layout.columns.end(), [&](const Column& c) { return c.unit == unit; });
  };
  std::vector<std::pair<std::string, std::string>> lines;
  const bool has_intervals =
      std::any_of(layout.columns.begin(), layout.columns.end(), [](const Column& c) { return c.interval != nullptr; });
  if (has_best)
    lines.emplace_back(best, has_intervals
                                 ? "best contender of its group; of times, all whose 95 % interval overlaps the best one's"
                                 : "best contender of its group");
  if (has_flag)
    lines.emplace_back(flag,
                       fmt::format("less than {} % of the pixels facing the light are tested: read the wrong rate with care",
                                   exact(100 * least_tested_share)));
  if (has_null) lines.emplace_back("-", "not measured or not defined");
  if (has_column("ms")) lines.emplace_back("ms", "median of the medians of the processes");
  if (std::ranges::any_of(layout.columns, [](const Column& c) { return c.name == "snapping_floor"; }))
    lines.emplace_back("snapping floor",
                       "what a shift by 1/512 pixel turns over, in every row of a group alike: up to it a rasterizer is right");
  return lines;
}

Layout lay_out(std::span<const Record> records, std::span<const std::string> columns) {
  Layout layout;
  layout.columns = select(all_columns(records), columns);

  std::vector<std::vector<std::vector<Cell>>> cells;  // by group, row, column
  for (const Record& record : records) {
    auto place = std::find_if(layout.groups.begin(), layout.groups.end(), [&](const Layout::Group& group) {
      return place_of(*group.rows.front().record) == place_of(record);
    });
    if (place == layout.groups.end()) {
      layout.groups.push_back({group_heading(record), {}});
      cells.emplace_back();
      place = layout.groups.end() - 1;
    }
    Layout::Row row{.record = &record, .entries = {}};
    std::vector<Cell> row_cells;
    for (const Column& column : layout.columns) {
      const Cell cell = column.cell(record);
      row.entries.push_back({shown(column, cell), false, cell.is_flagged});
      row_cells.push_back(cell);
    }
    if (!record.reason.empty()) {
      add_once(layout.notes, record.reason);
      row.note = index_of(layout.notes, record.reason) + 1;
    }
    place->rows.push_back(std::move(row));
    cells[static_cast<std::size_t>(place - layout.groups.begin())].push_back(std::move(row_cells));
  }
  for (std::size_t group = 0; group < layout.groups.size(); ++group)
    for (std::size_t column = 0; column < layout.columns.size(); ++column)
      mark_best(layout.columns[column], column, cells[group], layout.groups[group]);

  layout.provenance = provenance(records);
  return layout;
}

}  // namespace gnomon
