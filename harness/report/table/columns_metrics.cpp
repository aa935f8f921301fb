#include <algorithm>

#include "measure/score/metrics.h"
#include "report/table/columns.h"
#include "report/table/digits.h"

namespace gnomon {

namespace {

/// "false_dark_rate" -> "false dark": the unit says that it is a rate. "displacement" is too wide for two columns of a table.
std::string heading_of(std::string metric) {
  if (metric == "constant_error") return "constant";
  if (metric == "other_error_mean") return "other error";
  if (metric.starts_with("flicker_1_")) return "flicker 1/" + metric.substr(10);  // at a lag of so much of a second
  if (metric.ends_with("_rate")) metric.resize(metric.size() - 5);
  if (const std::size_t rate = metric.find("_rate_"); rate != metric.npos) metric.erase(rate, 5);
  if (metric.starts_with("displacement")) metric.replace(0, 12, "displ.");
  // "wrong_edge_0_1" -> "wrong edge 0..1", "wrong_edge_8_up" -> "wrong edge 8..up".
  const std::size_t last = metric.rfind('_');
  const auto is_digit = [&](std::size_t i) { return i < metric.size() && metric[i] >= '0' && metric[i] <= '9'; };
  if (last != metric.npos && is_digit(last - 1) && (is_digit(last + 1) || metric.ends_with("_up")))
    metric.replace(last, 1, "..");
  return with_blanks(metric);
}

/// A metric without unit is a share of 1 and shown in percent. `truth`: nothing for the record's headline truth.
Column metric_column(const MetricInfo& info, std::optional<Truth> truth) {
  const std::string metric(info.name);
  Column column = info.unit.empty() ? share_column(metric, heading_of(metric))
                                    : number_column(metric, std::string(info.unit), heading_of(metric));
  if (truth) {
    column.name = fmt::format("{}.{}", name(*truth), metric);
    column.heading += fmt::format(" ({})", name(*truth));
  }
  column.better = info.better;
  column.sentence = info.sentence;
  const std::string floor_name = metric + "_floor";
  const double best = info.unit == "ratio" ? 1 : 0;
  column.cell = [metric, floor_name, best, truth](const Record& r) {
    Cell cell = number(r.metric(truth.value_or(r.truth), metric));
    cell.is_flagged = metric == "tested_share" && cell.number() && *cell.number() < least_tested_share;
    if (const auto floor = r.metric(truth.value_or(r.truth), floor_name); cell.number() && floor)
      cell.is_floored = std::abs(*cell.number() - best) <= *floor;
    return cell;
  };
  return column;
}

}  // namespace

std::string constant_text(double error) { return fmt::format("best constant mask {} %", measured(100 * error)); }

void add_metrics(std::vector<Column>& columns) {
  for (const std::optional<Truth> truth : {std::optional<Truth>(), std::optional(Truth::shape), std::optional(Truth::mesh)})
    for (const MetricInfo& info : metric_infos()) columns.push_back(metric_column(info, truth));
}

void add_worst_light(std::vector<Column>& columns) {
  columns.push_back(share_column("light_error_max", "worst light", [](const Record& r) {
    std::optional<double> worst;
    if (r.answer != AnswerKind::received) return number(worst);
    for (const Record::LightFacts& light : r.lights)
      if (const auto error = light.metrics.find("error"); error != light.metrics.end() && error->second)
        worst = std::max(worst.value_or(0), *error->second);
    return number(worst);
  }));
  columns.back().better = "lower";
  columns.back().sentence = "The largest error of one light's mask.";
}

}  // namespace gnomon
