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
#include "report/analysis/analysis_table_parts.h"
#include "report/html/html_parts.h"

namespace gnomon {

namespace {

/// A change of the scene, and the stages that run again after it.
struct Event {
  Cost cost;
  const char* heading;
};
constexpr Event events[] = {{Cost::resolve, "camera moves"},
                            {Cost::light, "light moves"},
                            {Cost::motion, "geometry moves"},
                            {Cost::geometry, "another scene"}};

Json finite(double value) { return std::isfinite(value) ? Json(value) : Json(); }

/// [value, low, high] in milliseconds, [value] without an interval, null without a time.
Json time_json(const Record& record, std::span<const TimedPart> parts) {
  const Sample sample = sample_of(record, parts);
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

/// The share of the error of each cause, in the page's order; null where the run did not find causes.
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
  for (const TimedPart& part : all_parts) {
    const bool is_told = (part != Stage::update && !part.is_moving) || moves_geometry(r);
    if (is_told) stages[std::string(name(part))] = time_json(r, std::span(&part, 1));
  }
  for (const Event& event : events)
    if (event.cost != Cost::motion || moves_geometry(r))
      costs[std::string(name(event.cost))] = time_json(r, parts_of(event.cost));
  Json frames = Json::object();
  for (const auto& [metric, series] : r.frames) {
    Json& out = frames[metric] = Json::array();
    for (const std::optional<double>& value : series) out.push_back(value ? finite(*value) : Json());
  }
  const auto tested = r.classes.find("T");
  const bool has_estimate = r.answer == AnswerKind::fraction && r.lights.front().reference;
  Json json = {{"group", group}, {"title", setting_name(r)}, {"scene", r.scene}, {"family", family}, {"light", r.light}};
  json.update({{"view", r.view}, {"path", r.path}, {"technique", r.technique}, {"settings", r.settings}});
  json.update({{"role", name(r.role)}, {"status", name(r.status)}, {"support", r.support ? Json(name(*r.support)) : Json()}});
  json.update({{"reason", r.reason}, {"parameters", r.parameters}});
  json["values"] = std::move(values);
  json["texts"] = std::move(texts);
  json.update({{"best", best}, {"floored", floored}, {"flagged", flagged}, {"stages", stages}, {"costs", costs}});
  json["causes"] = causes_json(r, causes);
  json["estimates"] = has_estimate ? Json(name(estimates_of(r.lights.front()))) : Json();
  json["tested"] = tested == r.classes.end() ? Json() : Json(tested->second);
  json["frames"] = std::move(frames);
  return json;
}

/// The best contender by error against each, as people read it; null where there are no two to compare.
Json rank_json(std::span<const Record> records) {
  const auto has_error = [](const Record& r) { return quantity(r, "error").has_value(); };
  if (std::ranges::none_of(records, has_error)) return {};
  const Layout table = analysis::rank_table(records, {});
  if (table.groups.empty()) return {};
  const auto is_shown = [&](std::size_t k) { return table.columns[k].audience != Audience::programs; };
  Json json = {{"title", table.title}, {"notes", table.notes}};
  for (std::size_t k = 0; k < table.columns.size(); ++k)
    if (is_shown(k))
      json["columns"].push_back(
          {{"heading", table.columns[k].heading}, {"is_left", table.columns[k].alignment == Align::left}});
  for (const Layout::Group& group : table.groups) {
    Json rows = Json::array();
    for (const Layout::Row& row : group.rows) {
      Json& texts = rows.emplace_back(Json::array());
      for (std::size_t k = 0; k < row.cells.size(); ++k)
        if (is_shown(k)) texts.push_back(shown(table.columns[k], row.cells[k]));
    }
    json["groups"].push_back({{"heading", group.heading}, {"rows", std::move(rows)}});
  }
  return json;
}

/// The text with each of these characters replaced by another text.
std::string replaced(std::string_view text, std::initializer_list<std::pair<char, std::string_view>> replacements) {
  std::string result;
  result.reserve(text.size());
  for (const char& c : text) {
    const auto found = std::ranges::find(replacements, c, &std::pair<char, std::string_view>::first);
    result += found == replacements.end() ? std::string_view(&c, 1) : found->second;
  }
  return result;
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
  for (const TimedPart part : all_parts) data["stages"].push_back(name(part));
  data["groups"] = data["rows"] = Json::array();
  const std::vector<CauseInfo> causes = page_causes(layout);
  const std::map<std::string, std::string> families = scene_families(records);
  for (std::size_t group = 0; group < layout.groups.size(); ++group) {
    const auto& [heading, rows] = layout.groups[group];
    const Record& first = *rows.front().record;
    Json json = {{"heading", heading}, {"scene", first.scene}, {"light", first.light}, {"answer", name(first.answer)}};
    json.update({{"view", first.view}, {"path", first.path}, {"width", first.width}, {"height", first.height}});
    json["truth"] = name(first.truth);
    data["groups"].push_back(std::move(json));
    for (const Layout::Row& row : rows)
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
  data["ranks"] = rank_json(records);
  data["legend"] = legend(layout, {"best", "floor", "flag"});
  data["provenance"] = provenance(records);
  for (const MetricInfo& info : metric_infos())
    data["metrics"].push_back({{"name", info.name}, {"unit", info.unit}, {"better", info.better}, {"sentence", info.sentence}});
  return data;
}

std::string script_text(const Json& json) { return replaced(json_text(json), {{'<', "\\u003c"}}); }

std::string html_text(std::string_view text) {
  return replaced(text, {{'<', "&lt;"}, {'>', "&gt;"}, {'&', "&amp;"}, {'"', "&quot;"}});
}

}  // namespace gnomon
