#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "analysis/growth.h"
#include "measure/frame/classify.h"
#include "measure/json.h"
#include "measure/picture/signed_color.h"
#include "measure/row/kept_row.h"
#include "measure/score/error_picture.h"
#include "measure/score/metrics.h"
#include "measure/score/record_causes.h"
#include "report/html/html_parts.h"

namespace gnomon {

namespace {

/// What must be done again before a new mask is there, by what has happened.
struct Event {
  Cost cost;
  const char* heading;
};
constexpr Event events[] = {
    {Cost::resolve, "camera moves"}, {Cost::light, "light moves"}, {Cost::geometry, "geometry changes"}};

Json finite(double value) { return std::isfinite(value) ? Json(value) : Json(); }

/// [value, low, high] in milliseconds, [value] without an interval, null without a time.
Json time_json(const Record& record, std::span<const Stage> stages) {
  const Sample sample = sample_of(record, stages);
  if (!sample.is_timed()) return {};
  const ValueWithInterval time = sample.estimate();
  if (!std::isfinite(time.value)) return {};
  return time.has_interval ? Json::array({time.value, finite(time.low), finite(time.high)}) : Json::array({time.value});
}

Json column_json(const Column& column, bool is_headline) {
  return {{"name", column.name},         {"unit", column.unit},
          {"heading", column.heading},   {"shown_unit", column.shown_unit},
          {"scale", column.shown_scale}, {"is_left", column.alignment == Align::left},
          {"better", column.better},     {"sentence", column.sentence},
          {"is_headline", is_headline}};
}

Json value_json(const Cell& cell) {
  if (const double* number = cell.number()) return finite(*number);
  if (const auto* text = std::get_if<std::string>(&cell.value)) return *text;
  return {};
}

/// What each cause holds of the error, in the order of the page's; null where the run did not look for causes.
Json causes_json(const Record& record, std::span<const CauseInfo> causes) {
  const auto shares = cause_shares(record);
  if (!shares) return {};
  Json list = Json::array();
  for (const CauseInfo& info : causes) {
    const auto found = shares->find(std::string(info.name));
    list.push_back(found == shares->end() ? 0 : found->second);
  }
  return list;
}

Json row_json(const Layout& layout, const Layout::Row& row, std::size_t group, const std::string& family,
              std::span<const CauseInfo> causes) {
  const Record& r = *row.record;
  Json values = Json::array(), texts = Json::array(), best = Json::array(), floored = Json::array(), flagged = Json::array();
  for (std::size_t k = 0; k < layout.columns.size(); ++k) {
    values.push_back(value_json(row.cells[k]));
    // Text is sent once.
    const std::string text = shown(layout.columns[k], row.cells[k]);
    const bool is_same = values.back().is_string() && values.back() == text;
    texts.push_back(is_same ? Json() : Json(text));
    if (row.cells[k].is_best) best.push_back(k);
    if (row.cells[k].is_floored) floored.push_back(k);
    if (row.cells[k].is_flagged) flagged.push_back(k);
  }
  Json stages = Json::object(), costs = Json::object();
  for (const Stage stage : all_stages) stages[std::string(name(stage))] = time_json(r, std::span(&stage, 1));
  for (const Event& event : events) costs[std::string(name(event.cost))] = time_json(r, stages_of(event.cost));
  Json frames = Json::object();
  for (const auto& [metric, series] : r.frames) {
    Json& out = frames[metric] = Json::array();
    for (const std::optional<double>& value : series) out.push_back(value ? finite(*value) : Json());
  }
  const auto tested = r.classes.find("T");
  return {
      {"group", group},
      {"title", setting_name(r)},
      {"scene", r.scene},
      {"family", family},
      {"light", r.light},
      {"view", r.view},
      {"path", r.path},
      {"technique", r.technique},
      {"settings", r.settings},
      {"role", name(r.role)},
      {"status", name(r.status)},
      {"support", r.support ? Json(name(*r.support)) : Json()},
      {"reason", r.reason},
      {"parameters", r.parameters},
      {"values", std::move(values)},
      {"texts", std::move(texts)},
      {"best", std::move(best)},
      {"floored", std::move(floored)},
      {"flagged", std::move(flagged)},
      {"stages", std::move(stages)},
      {"costs", std::move(costs)},
      {"causes", causes_json(r, causes)},
      {"estimates",
       r.answer == AnswerKind::fraction && r.lights.front().reference ? Json(name(estimates_of(r.lights.front()))) : Json()},
      {"tested", tested == r.classes.end() ? Json() : Json(tested->second)},
      {"frames", std::move(frames)}};
}

Json pairs_json(const Remarks& pairs) {
  Json lines = Json::array();
  for (const auto& [topic, text] : pairs) lines.push_back({topic, text});
  return lines;
}

}  // namespace

std::vector<CauseInfo> page_causes(const Layout& layout) {
  std::vector<const Record*> records;
  for (const Layout::Group& group : layout.groups)
    for (const Layout::Row& row : group.rows) records.push_back(row.record);
  return causes_of(records);
}

Json report_data(const Layout& layout, std::span<const Record> records) {
  Json data = {{"schema", "gnomon-report-1"}};
  const std::vector<std::string> names = headline_columns(records, true);
  const std::set<std::string> headline(names.begin(), names.end());
  for (const Column& column : layout.columns) data["columns"].push_back(column_json(column, headline.contains(column.name)));
  data["stages"] = stage_names;
  data["groups"] = data["rows"] = Json::array();
  const std::vector<CauseInfo> causes = page_causes(layout);
  const std::map<std::string, std::string> families = scene_families(records);
  for (std::size_t group = 0; group < layout.groups.size(); ++group) {
    const Record& first = *layout.groups[group].rows.front().record;
    data["groups"].push_back({{"heading", layout.groups[group].heading},
                              {"scene", first.scene},
                              {"light", first.light},
                              {"answer", name(first.answer)},
                              {"view", first.view},
                              {"path", first.path},
                              {"width", first.width},
                              {"height", first.height},
                              {"truth", name(first.truth)}});
    for (const Layout::Row& row : layout.groups[group].rows)
      data["rows"].push_back(row_json(layout, row, group, families.at(row.record->scene), causes));
  }
  for (const Event& event : events)
    data["costs"].push_back(
        {{"name", name(event.cost)}, {"heading", fmt::format("{}: {}", event.heading, sentence(event.cost))}});
  for (const CauseInfo& info : causes)
    data["causes"].push_back({{"name", info.name}, {"sentence", info.sentence}, {"color", info.color}});
  for (const ClassInfo& info : class_infos())
    data["classes"].push_back({{"name", info.letter}, {"word", info.word}, {"sentence", info.sentence}, {"color", info.color}});
  for (const ErrorStep& step : error_steps) data["error_steps"].push_back({step.least, step.weight});
  data["signed"] = {{"colors", signed_colors()}, {"scales", difference_scales}};
  Json levels = Json::array();
  for (const float level : contour_levels)
    levels.push_back(std::stod(fmt::format("{}", level)));  // 0.02, not its nearest float
  const auto ink = [](const ContourInk& ink) { return Json{{"core", ink.core}, {"casing", ink.casing}}; };
  data["contours"] = {
      {"levels", levels}, {"reference", ink(reference_ink)}, {"techniques", {ink(technique_inks[0]), ink(technique_inks[1])}}};
  data["legend"] = pairs_json(legend(layout, {"best", "floor", "flag"}));
  data["provenance"] = pairs_json(provenance(records));
  for (const MetricInfo& info : metric_infos())
    data["metrics"].push_back({{"name", info.name}, {"unit", info.unit}, {"better", info.better}, {"sentence", info.sentence}});
  return data;
}

std::string script_text(const Json& json) {
  const std::string text = json_text(json);
  std::string safe;
  safe.reserve(text.size());
  for (const char c : text)
    if (c == '<')
      safe += "\\u003c";
    else
      safe += c;
  return safe;
}

std::string html_text(std::string_view text) {
  static constexpr std::pair<char, std::string_view> entities[] = {
      {'<', "&lt;"}, {'>', "&gt;"}, {'&', "&amp;"}, {'"', "&quot;"}};
  std::string safe;
  for (const char& c : text) {
    const auto found = std::ranges::find(entities, c, &std::pair<char, std::string_view>::first);
    safe += found == std::end(entities) ? std::string_view(&c, 1) : found->second;
  }
  return safe;
}

}  // namespace gnomon
