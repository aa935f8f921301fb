#include "analysis/growth.h"

#include <cassert>
#include <cmath>
#include <numeric>

#include "analysis/in_order.h"
#include "measure/statistics/distributions.h"

namespace gnomon {

namespace {

/// A point's value is the sum of some samples: of one row's stage, or of several rows' stages on the axis `lights`, or the
/// seeds of one setting.
struct Points {
  struct Sum {
    double x = 0;
    std::vector<std::size_t> terms;  ///< samples
    double least = clock_ms;         ///< see Growth::Point
    std::size_t rows = 1;
  };
  std::vector<Sample> samples;
  std::vector<Sum> sums;
  const char* below = "below the clock";  ///< said of a series with too few values of `least` and more
};

/// The slopes of a series whose fitted points these are, rising in x.
void add_slopes(Growth& growth, std::span<const double> xs, std::span<const double> ys) {
  growth.least_slope = INFINITY;
  growth.greatest_slope = -INFINITY;
  for (std::size_t k = 1; k < xs.size(); ++k) {
    if (xs[k] == xs[k - 1]) continue;
    const double slope = std::log(ys[k] / ys[k - 1]) / std::log(xs[k] / xs[k - 1]);
    growth.least_slope = std::min(growth.least_slope, slope);
    growth.greatest_slope = std::max(growth.greatest_slope, slope);
  }
  std::size_t first = xs.size() / 2;
  while (xs[first] == xs.back()) --first;  // several rows of one x make no line
  growth.upper_slope = fit_power_law(xs.subspan(first), ys.subspan(first)).exponent;
}

Growth fit(const AxisSeries& series, std::string stage, Points points) {
  Growth growth{.place = series.place, .setting = series.setting, .role = series.role, .stage = std::move(stage)};
  std::ranges::stable_sort(points.sums, {}, &Points::Sum::x);
  const auto sum_of = [](std::span<const double> values, const std::vector<std::size_t>& terms) {
    double sum = 0;
    for (const std::size_t term : terms) sum += values[term];
    return sum;
  };
  std::vector<double> xs;
  std::vector<std::vector<std::size_t>> fitted;
  for (const auto& [x, terms, least, rows] : points.sums) {
    std::vector<Sample> summed;
    for (const std::size_t term : terms) summed.push_back(points.samples[term]);
    const ValueWithInterval value =
        bootstrap(summed, [](std::span<const double> values) { return std::accumulate(values.begin(), values.end(), 0.0); });
    growth.points.push_back({x, value, least, rows});
    if (!growth.points.back().is_fitted()) {
      ++growth.left_out;
      continue;
    }
    xs.push_back(x);
    fitted.push_back(terms);
  }
  if (std::set<double>(xs.begin(), xs.end()).size() < least_points) {
    growth.why_not = growth.left_out > 0 ? points.below : "too few points";
    return growth;
  }
  std::vector<double> ys(xs.size());
  const auto law = [&](std::span<const double> values) {
    for (std::size_t k = 0; k < fitted.size(); ++k) ys[k] = std::max(sum_of(values, fitted[k]), 1e-9);
    return fit_power_law(xs, ys);
  };
  growth.exponent = bootstrap(points.samples, [&](std::span<const double> values) { return law(values).exponent; });
  std::vector<double> values;
  for (const Sample& sample : points.samples) values.push_back(sample.value());
  const PowerLaw best = law(values);
  growth.coefficient = best.coefficient;
  growth.r2 = best.r2;
  // How far points lie from the line says how sure its slope is, with or without several processes.
  ValueWithInterval& exponent = *growth.exponent;
  exponent = {exponent.value, std::min(exponent.low, exponent.value - *best.misfit),
              std::max(exponent.high, exponent.value + *best.misfit)};
  add_slopes(growth, xs, ys);
  return growth;
}

void add_stages(const std::vector<AxisSeries>& all, Growths& growths) {
  for (const AxisSeries& series : all) {
    for (const TimedPart part : repeated_parts) {
      Points points;
      for (const auto& [x, record] : series.rows) {
        Sample sample({times_of(*record, part)});
        if (!sample.is_timed()) continue;
        points.sums.push_back({.x = x, .terms = {points.samples.size()}});
        points.samples.push_back(std::move(sample));
      }
      if (!points.sums.empty()) growths.rows.push_back(fit(series, std::string(name(part)), std::move(points)));
    }
  }
}

void add_lights(const std::vector<AxisSeries>& all, Growths& growths) {
  for (const AxisSeries& series : all) {
    for (const char* what : {"relight", "resolve", "total"}) {
      const std::string_view stage = what;
      Points points;
      std::vector<std::size_t> terms;
      if (stage == "total") {
        points.samples.push_back(Sample({series.rows.front().second->times(Stage::build)}));
        terms.push_back(0);
      }
      for (const auto& [x, record] : series.rows) {
        std::vector<ProcessTimes> times;
        if (stage != "resolve") times.push_back(record->times(Stage::relight));
        if (stage != "relight") times.push_back(record->times(Stage::resolve));
        terms.push_back(points.samples.size());
        points.samples.push_back(Sample(std::move(times)));
        points.sums.push_back({.x = x, .terms = terms});
      }
      const bool is_timed = std::ranges::all_of(points.samples, [](const Sample& s) { return s.is_timed(); });
      if (is_timed) growths.rows.push_back(fit(series, std::string(stage), std::move(points)));
    }
  }
}

/// Three times what the reference's own noise makes of the quantity; of a record without floors three times the target error of
/// each pixel's reference. 0 for a quantity that depends on no reference.
double least_of(const Record& record, const std::string& quantity) {
  if (const auto floor = noise_floor(record, quantity)) return least_reference_errors * *floor;
  const bool is_error = quantity == "error" || quantity.ends_with("error_mean") || quantity.ends_with("error_rms");
  return is_error && record.answer == AnswerKind::fraction && record.lights.front().reference
             ? least_reference_errors * record.lights.front().reference->target
             : 0;
}

/// The records as if the `seed` of their techniques were none of their settings.
std::vector<Record> without_seeds(std::span<const Record> records) {
  std::vector<Record> plain(records.begin(), records.end());
  for (Record& r : plain) {
    if (!r.parameters.erase("seed")) continue;
    std::vector<std::string> settings;
    for (const auto& [key, value] : split_settings(r.settings))
      if (key != "seed") settings.push_back(fmt::format("{}={}", key, value));
    r.settings = joined(settings, ",");
    if (r.label && r.label->find("seed=") != std::string::npos) r.label.reset();
  }
  return plain;
}

void add_quantity(const std::vector<AxisSeries>& all, Growths& growths) {
  for (const AxisSeries& series : all) {
    std::map<double, ProcessTimes> values;  // by x, of each row
    std::map<double, double> least;
    for (const auto& [x, record] : series.rows)
      if (const std::optional<double> value = quantity(*record, growths.quantity)) {
        values[x].push_back({*value});
        least[x] = std::max(least[x], least_of(*record, growths.quantity));
      }
    if (values.size() < 2) {
      ++growths.single;
      continue;
    }
    Points points{.samples = {}, .sums = {}, .below = "below the reference"};
    for (auto& [x, of_rows] : values) {
      points.sums.push_back({x, {points.samples.size()}, least[x], of_rows.size()});
      points.samples.emplace_back(std::vector<ProcessTimes>{std::move(of_rows)});
    }
    growths.rows.push_back(fit(series, growths.quantity, std::move(points)));
  }
}

/// Why a run has no row of growth, and what it would take.
std::string why_no_growth(std::span<const Record> records, const std::string& axis, std::size_t single) {
  if (std::ranges::none_of(records, [](const Record& r) { return r.status == Status::ok; })) return "no row was measured";
  if (axis == "lights") return "no setting was timed under two lights of one scene; run it with more than one --light";
  const std::string what =
      single > 0 ? "no setting was timed at two values of it" : "no row that was measured has a positive one";
  if (axis == "triangles") return what + "; sweep a parameter that changes how many a scene has: sphere_field:count={4,16,64}";
  if (axis == "pixels") return what + "; run the same rows at several sizes";
  return fmt::format("{}; {}", what, how_to_sweep(axis));
}

}  // namespace

PowerLaw fit_power_law(std::span<const double> x, std::span<const double> y) {
  assert(x.size() == y.size() && x.size() >= 2);
  const auto n = static_cast<double>(x.size());
  double mean_x = 0, mean_y = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    mean_x += std::log(x[i]) / n;
    mean_y += std::log(y[i]) / n;
  }
  double xx = 0, xy = 0, yy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double dx = std::log(x[i]) - mean_x, dy = std::log(y[i]) - mean_y;
    xx += dx * dx;
    xy += dx * dy;
    yy += dy * dy;
  }
  assert(xx > 0);
  const double exponent = xy / xx;
  // What float noise leaves of a constant is no variance.
  const bool is_constant = yy <= n * 1e-24;
  PowerLaw law{exponent, std::exp(mean_y - exponent * mean_x), is_constant ? 1 : xy * xy / (xx * yy)};
  if (x.size() > 2) law.misfit = student_quantile(0.025, n - 2) * std::sqrt(std::max(0.0, yy - exponent * xy) / (n - 2) / xx);
  return law;
}

Growths find_growth(std::span<const Record> records, const std::string& axis, const std::string& quantity) {
  std::vector<std::string> axes = numeric_parameters(records);
  axes.insert(axes.begin(), {"triangles", "pixels", "lights"});
  require_word("there is no axis", axis, axes);
  Growths growths{.axis = axis, .unit = axis == "pixels" ? "px" : "", .quantity = quantity, .rows = {}, .single = 0};
  std::vector<Record> plain;
  const bool sums_lights =
      axis == "lights" && std::ranges::find(records, AnswerKind::received, &Record::answer) == records.end();
  if (!quantity.empty()) {
    require_quantity(records, quantity);
    if (sums_lights)
      throw Error("with lights, one a row, times are summed; {} does not grow with them: run rows of several lights", quantity);
    if (axis != "seed") plain = without_seeds(records);
  }
  std::vector<AxisSeries> all =
      join_series(plain.empty() ? records : plain, axis, [](const Record& r) { return r.status == Status::ok; });
  // No logarithm, no point.
  for (AxisSeries& series : all) std::erase_if(series.rows, [](const auto& row) { return !(row.first > 0); });
  std::erase_if(all, [](const AxisSeries& series) { return series.rows.empty(); });

  if (quantity.empty()) growths.single = std::erase_if(all, [](const AxisSeries& series) { return series.rows.size() < 2; });
  (!quantity.empty() ? add_quantity : sums_lights ? add_lights : add_stages)(all, growths);
  if (growths.rows.empty())
    throw Error("there is no growth with {} in these records: {}", axis, why_no_growth(records, axis, growths.single));
  return growths;
}

}  // namespace gnomon
