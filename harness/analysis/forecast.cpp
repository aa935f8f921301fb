#include "analysis/forecast.h"

#include <cassert>
#include <cmath>

#include "analysis/growth.h"
#include "measure/statistics/distributions.h"

namespace gnomon {

double CostLine::half_width(double x) const {
  const double from_middle = x - middle, y = at(x);
  const double variance = relative_variance * (y * y + 1 / weights + (spread > 0 ? from_middle * from_middle / spread : 0));
  return student_quantile(0.025, static_cast<double>(points - 2)) * std::sqrt(variance);
}

CostLine fit_cost_line(std::span<const double> x, std::span<const double> y) {
  assert(x.size() == y.size() && x.size() > 2);
  CostLine line{.points = x.size()};
  double middle_y = 0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    const double weight = 1 / (y[k] * y[k]);
    line.weights += weight;
    line.middle += weight * x[k];
    middle_y += weight * y[k];
  }
  line.middle /= line.weights;
  middle_y /= line.weights;
  double both = 0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    const double weight = 1 / (y[k] * y[k]), dx = x[k] - line.middle;
    line.spread += weight * dx * dx;
    both += weight * dx * (y[k] - middle_y);
  }
  assert(line.spread > 0);
  line.each = both / line.spread;
  const auto [least, greatest] = std::ranges::minmax(x);
  if (std::abs(line.each) * (greatest - least) < 1e-12 * middle_y) line.each = 0;  // what rounding leaves of a constant
  line.fixed = middle_y - line.each * line.middle;
  for (std::size_t k = 0; k < x.size(); ++k) line.relative_variance += std::pow(line.at(x[k]) / y[k] - 1, 2);
  line.relative_variance /= static_cast<double>(x.size() - 2);
  return line;
}

namespace {

/// Rows of one series, rising in x.
struct MeasuredCosts {
  std::vector<double> xs, ys;
  std::vector<Sample> samples;  ///< none of bytes
};

/// The cost at `to` by the first `count` points; fewer than three make no line.
std::optional<ValueWithInterval> foretell(const MeasuredCosts& costs, std::size_t count, double to) {
  const std::span xs = std::span(costs.xs).first(count);
  if (std::set<double>(xs.begin(), xs.end()).size() < least_points) return std::nullopt;
  const CostLine line = fit_cost_line(xs, std::span(costs.ys).first(count));
  const double value = line.at(to), half = line.half_width(to);
  ValueWithInterval found{value, value - half, value + half};
  if (!costs.samples.empty()) {
    std::vector<double> positive(count);
    const ValueWithInterval by_processes =
        bootstrap(std::span(costs.samples).first(count), [&](std::span<const double> values) {
          for (std::size_t k = 0; k < count; ++k) positive[k] = std::max(values[k], 1e-9);
          return fit_cost_line(xs, positive).at(to);
        });
    found.low = std::min(found.low, by_processes.low);
    found.high = std::max(found.high, by_processes.high);
  }
  for (double* const end : {&found.value, &found.low, &found.high}) *end = std::max(*end, 0.0);
  return found;
}

Forecast forecast_of(const AxisSeries& series, Cost cost, double to) {
  Forecast forecast{.place = series.place, .setting = series.setting, .role = series.role};
  std::vector<std::pair<double, const Record*>> rows = series.rows;
  std::ranges::stable_sort(rows, {}, &std::pair<double, const Record*>::first);
  MeasuredCosts costs;
  for (const auto& [x, record] : rows) {
    const ValueWithInterval value = *cost_of(*record, cost);
    costs.xs.push_back(x);
    costs.ys.push_back(value.value);
    if (cost != Cost::bytes) costs.samples.push_back(sample_of(*record, parts_of(cost)));
    forecast.last = value;
  }
  forecast.xs = costs.xs;
  const double least = std::ranges::min(costs.ys);
  if (cost == Cost::bytes ? least <= 0 : least < clock_ms) {
    forecast.why_not = cost == Cost::bytes ? "no cost" : "below the clock";
    return forecast;
  }
  forecast.value = foretell(costs, costs.xs.size(), to);
  if (!forecast.value) {
    forecast.why_not = "too few points";
    return forecast;
  }
  const CostLine line = fit_cost_line(costs.xs, costs.ys);
  forecast.fixed = line.fixed;
  forecast.each = line.each;
  const auto before = static_cast<std::size_t>(std::ranges::lower_bound(costs.xs, costs.xs.back()) - costs.xs.begin());
  forecast.foretold = foretell(costs, before, costs.xs.back());
  return forecast;
}

}  // namespace

Forecasts find_forecasts(std::span<const Record> records, const std::string& axis, Cost cost, std::optional<double> to) {
  std::vector<std::string> axes = numeric_parameters(records);
  axes.insert(axes.begin(), {"triangles", "pixels", "lights"});
  require_word("there is no axis", axis, axes);
  if (axis == "lights" && std::ranges::find(records, AnswerKind::received, &Record::answer) == records.end())
    throw Error("a forecast by lights needs rows of several lights together; run with --light 'a+b' or a pattern, '*+16'");
  Forecasts found{.axis = axis, .unit = axis == "pixels" ? "px" : "", .cost = cost, .to = 0, .rows = {}, .single = 0};
  std::vector<AxisSeries> all =
      join_series(records, axis, [&](const Record& r) { return r.status == Status::ok && cost_of(r, cost).has_value(); });
  std::erase_if(all, [](const AxisSeries& series) { return series.rows.empty(); });
  found.single = std::erase_if(all, [](const AxisSeries& series) { return series.rows.size() < 2; });
  if (all.empty())
    throw Error("there is nothing to forecast: no setting was measured at two values of {}; {}", axis, how_to_sweep(axis));
  double greatest = 0;
  for (const AxisSeries& series : all)
    for (const auto& [x, record] : series.rows) greatest = std::max(greatest, x);
  found.to = to.value_or(4 * greatest);
  if (found.to <= greatest)
    throw Error("--to {} is not beyond {}, the most {} that were measured; there is nothing to forecast", found.to, greatest,
                axis);
  for (const AxisSeries& series : all) found.rows.push_back(forecast_of(series, cost, found.to));
  return found;
}

}  // namespace gnomon
