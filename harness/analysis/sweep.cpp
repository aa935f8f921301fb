#include "analysis/sweep.h"

#include "analysis/in_order.h"

namespace gnomon {

namespace {

/// The quantity with its interval, where it is a time.
std::optional<ValueWithInterval> measured_quantity(const Record& record, std::string_view wanted) {
  if (const std::span<const TimedPart> parts = parts_of_time(wanted); !parts.empty()) {
    const Sample sample = sample_of(record, parts);
    return sample.is_timed() ? std::optional(sample.estimate()) : std::nullopt;
  }
  const std::optional<double> value = quantity(record, wanted);
  return value ? std::optional(ValueWithInterval(*value)) : std::nullopt;
}

/// The numeric parameters that have two values in some series: what may be named instead.
std::vector<std::string> swept_parameters(std::span<const Record> records) {
  std::vector<std::string> swept;
  for (std::string& parameter : numeric_parameters(records)) {
    const std::vector<AxisSeries> all = join_series(records, parameter, [](const Record&) { return true; });
    const bool varies = std::ranges::any_of(all, [](const AxisSeries& series) {
      return std::ranges::any_of(series.rows, [&](const auto& row) { return row.first != series.rows.front().first; });
    });
    if (varies) swept.push_back(std::move(parameter));
  }
  return swept;
}

std::string what_is_swept(std::span<const Record> records) {
  const std::vector<std::string> swept = swept_parameters(records);
  return swept.empty() ? "no parameter is swept in these records; " + how_to_sweep("PARAMETER")
                       : fmt::format("swept are: {}", joined(swept, ", "));
}

Sweep sweep_of(const AxisSeries& series, std::string_view quantity, std::size_t& repeated) {
  Sweep sweep{.place = series.place, .setting = series.setting, .role = series.role};
  for (const auto& [x, record] : series.rows) {
    if (std::ranges::find(sweep.points, x, &Sweep::Point::x) != sweep.points.end()) {
      ++repeated;
      continue;
    }
    const bool is_measured = record->status == Status::ok;
    sweep.points.push_back({x, is_measured ? measured_quantity(*record, quantity) : std::nullopt, record->status});
  }
  std::ranges::sort(sweep.points, {}, &Sweep::Point::x);
  return sweep;
}

}  // namespace

std::vector<double> Sweeps::xs(const Place& place) const {
  std::set<double> all;
  for (const Sweep& sweep : rows)
    if (sweep.place == place)
      for (const Sweep::Point& point : sweep.points) all.insert(point.x);
  return {all.begin(), all.end()};
}

Sweeps find_sweeps(std::span<const Record> records, const std::string& parameter, const std::string& quantity) {
  if (parameter.empty()) throw Error("sweep wants --x PARAMETER; {}", what_is_swept(records));
  const std::vector<std::string> names = numeric_parameters(records);
  // A scene has more parameters than its reference names.
  const bool is_known = index_of(names, parameter) < names.size() || std::ranges::any_of(records, [&](const Record& r) {
                          return scene_parameter(r.scene, parameter).has_value();
                        });
  if (!is_known && names.empty())
    throw Error("there is no parameter {}: nothing in these records has a numeric one", parameter);
  if (!is_known) require_word("there is no numeric parameter", parameter, names);
  require_quantity(records, quantity);

  Sweeps sweeps{.parameter = parameter, .unit = parameter_unit(records, parameter), .quantity = quantity};
  for (const AxisSeries& series : join_series(records, parameter, [](const Record&) { return true; })) {
    std::size_t repeated = 0;
    Sweep sweep = sweep_of(series, quantity, repeated);
    if (sweep.points.size() < 2) {
      ++sweeps.single;
      continue;
    }
    sweeps.repeated += repeated;
    add_once(sweeps.places, sweep.place);
    sweeps.rows.push_back(std::move(sweep));
  }
  if (sweeps.rows.empty())
    throw Error("there is no sweep of {} in these records: no setting has two values of it in one place; {}", parameter,
                what_is_swept(records));
  const bool has_value = std::ranges::any_of(sweeps.rows, [](const Sweep& sweep) {
    return std::ranges::any_of(sweep.points, [](const auto& point) { return point.value.has_value(); });
  });
  if (!has_value) throw Error("there is nothing to show: no row of the sweep of {} has a {}", parameter, quantity);
  return sweeps;
}

}  // namespace gnomon
