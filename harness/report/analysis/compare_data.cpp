// The two forms of a comparison for programs: everything, unrounded.
#include <cmath>

#include "measure/json.h"
#include "report/analysis/compare_table.h"
#include "report/table/digits.h"
#include "report/table/layout.h"

namespace gnomon {

namespace {

std::string number_text(std::optional<double> value) { return value && std::isfinite(*value) ? exact(*value) : ""; }

Json or_null(std::optional<double> value) { return value && std::isfinite(*value) ? Json(*value) : Json(nullptr); }

/// The ratio or an end of its interval, which times that were not judged do not have.
std::optional<double> ratio_of(const StageChange& s, double Estimate::*part) {
  if (!s.ratio || (s.verdict == Verdict::not_judged && part != &Estimate::value)) return std::nullopt;
  return (*s.ratio).*part;
}

Json row_json(const RowChange& row) {
  const Record& r = row.record();
  Json json{{"job", r.job},   {"scene", r.scene},         {"light", r.light},      {"view", r.view},
            {"path", r.path}, {"technique", r.technique}, {"settings", r.settings}};
  json["label"] = r.label ? Json(*r.label) : Json(nullptr);
  json["base_status"] = row.base ? Json(name(row.base->status)) : Json(nullptr);
  json["contender_status"] = row.contender ? Json(name(row.contender->status)) : Json(nullptr);
  json["notes"] = row.notes;
  json["differs"] = row.differs();
  json["regression"] = row.regressed();
  Json& times = json["times"] = Json::array();
  for (const StageChange& s : row.stages)
    times.push_back({{"stage", name(s.stage)},
                     {"base_ms", or_null(s.base_ms)},
                     {"contender_ms", or_null(s.contender_ms)},
                     {"ratio", or_null(ratio_of(s, &Estimate::value))},
                     {"low", or_null(ratio_of(s, &Estimate::low))},
                     {"high", or_null(ratio_of(s, &Estimate::high))},
                     {"p", or_null(s.p)},
                     {"false_discovery", or_null(s.false_discovery)},
                     {"verdict", name(s.verdict)},
                     {"why", s.why},
                     {"regression", s.is_regression}});
  Json& metrics = json["metrics"] = Json::array();
  for (const MetricChange& m : row.metrics)
    metrics.push_back({{"metric", m.metric},
                       {"truth", name(m.truth)},
                       {"base", or_null(m.base)},
                       {"contender", or_null(m.contender)},
                       {"floor", or_null(m.floor)},
                       {"regression", m.is_regression}});
  Json& counts = json["counts"] = Json::array();
  for (const CountChange& c : row.counts)
    counts.push_back({{"count", c.name}, {"unit", c.unit}, {"base", c.base}, {"contender", c.contender}});
  return json;
}

}  // namespace

/// A line `together` has a contender, or none for all rows, as its technique.
std::string comparison_csv(const Comparison& comparison) {
  std::string text =
      "job,scene,light,view,path,technique,settings,kind,name,truth,base,contender,ratio,low,high,p,false_discovery,verdict,"
      "regression,note\r\n";
  for (const OverallChange& c : comparison.overall)
    text += fmt::format(",,,,,{},,together,{},,,,{},{},{},{},{},{},{},\r\n", csv_field(c.contender), name(c.stage),
                        exact(c.ratio.value), exact(c.ratio.low), exact(c.ratio.high), exact(c.p), exact(c.false_discovery),
                        name(c.verdict), c.is_regression);
  for (const RowChange& row : comparison.rows) {
    const Record& r = row.record();
    const auto line = [&](std::vector<std::string> cells) {
      cells.insert(cells.begin(), {r.job, r.scene, r.light, r.view, r.path, r.technique, r.settings});
      for (std::string& cell : cells) cell = csv_field(cell);
      text += fmt::format("{}\r\n", joined(cells, ","));
    };
    const auto yes = [](bool is) { return std::string(is ? "true" : "false"); };
    const auto status = [](const Record* record) { return record ? std::string(name(record->status)) : ""; };
    const std::string presence = !row.base ? "new" : !row.contender ? "missing" : "matched";
    line({"row", "status", "", status(row.base), status(row.contender), "", "", "", "", "", presence, yes(row.is_regression),
          joined(row.notes, "; ")});
    for (const StageChange& s : row.stages)
      line({"time", std::string(name(s.stage)), "", number_text(s.base_ms), number_text(s.contender_ms),
            number_text(ratio_of(s, &Estimate::value)), number_text(ratio_of(s, &Estimate::low)),
            number_text(ratio_of(s, &Estimate::high)), number_text(s.p), number_text(s.false_discovery),
            std::string(name(s.verdict)), yes(s.is_regression), s.why});
    for (const MetricChange& m : row.metrics)
      line({"metric", m.metric, std::string(name(m.truth)), number_text(m.base), number_text(m.contender), "", "", "", "", "",
            "changed", yes(m.is_regression), m.floor ? fmt::format("floor {}", exact(*m.floor)) : ""});
    for (const CountChange& c : row.counts)
      line({"count", c.name, "", exact(c.base), exact(c.contender), c.base != 0 ? exact(c.contender / c.base) : "", "", "", "",
            "", "changed", yes(false), c.unit});
  }
  return text;
}

std::string comparison_json(const Comparison& comparison, const CompareTableOptions& options) {
  const CompareOptions& o = comparison.options;
  const Comparison::Counts n = comparison.counts();
  Json json;
  json["schema"] = "gnomon-compare-1";
  json["base"] = options.base;
  json["contender"] = options.contender;
  json["options"] = {{"floor", o.floor},
                     {"fdr", o.fdr},
                     {"threshold", o.threshold},
                     {"error_threshold", o.error_threshold},
                     {"force", o.force}};
  Json& differences = json["differences"] = Json::object();
  for (const auto& [topic, text] : comparison.differences) differences[topic] = text;
  json["refusal"] = comparison.refusal;
  json["side_by_side"] = comparison.side_by_side;
  json["drift"] = comparison.between;
  json["inflation"] = comparison.inflation;
  json["least_ratio"] = comparison.least_ratio;
  Json& together = json["over_all_scenes"] = Json::array();
  for (const OverallChange& c : comparison.overall)
    together.push_back({{"contender", c.contender.empty() ? Json(nullptr) : Json(c.contender)},
                        {"stage", name(c.stage)},
                        {"times", c.times},
                        {"ratio", c.ratio.value},
                        {"low", c.ratio.low},
                        {"high", c.ratio.high},
                        {"p", c.p},
                        {"false_discovery", c.false_discovery},
                        {"verdict", name(c.verdict)},
                        {"least_ratio", c.least_ratio},
                        {"regression", c.is_regression}});
  json["counts"] = {{"matched", n.matched},
                    {"missing", n.missing},
                    {"new", n.added},
                    {"status_changed", n.status},
                    {"times_judged", n.judged},
                    {"slower", n.slower},
                    {"faster", n.faster},
                    {"over_all_scenes_slower", n.overall_slower},
                    {"over_all_scenes_faster", n.overall_faster},
                    {"rows_with_changed_metrics", n.changed_rows},
                    {"changed_metrics", n.changed_metrics},
                    {"rows_of_other_work", n.rows_of_other_work},
                    {"regressions", n.regressions}};
  Json& rows = json["rows"] = Json::array();
  for (const RowChange& row : comparison.rows) rows.push_back(row_json(row));
  return json_text(json, 2) + '\n';
}

}  // namespace gnomon
