#pragma once
#include "analysis/axis.h"

namespace gnomon {

/// y = fixed + each * x by least squares of what points differ by, each relative to its own y: small costs count as much as
/// large ones.
struct CostLine {
  double fixed = 0, each = 0;
  /// Half of the 95 % interval of one more point at x (Student's t of how far the points lie from the line).
  double half_width(double x) const;
  double at(double x) const { return fixed + each * x; }

  std::size_t points = 0;
  double relative_variance = 0, middle = 0, weights = 0, spread = 0;  ///< of the fit
};
/// Three points or more, positive values, two or more different x.
CostLine fit_cost_line(std::span<const double> x, std::span<const double> y);

/// What rows of one setting would cost beyond what was measured.
struct Forecast {
  Place place;
  std::string setting;  ///< without the parameter that the axis varies
  Role role = Role::contender;
  std::vector<double> xs = {};  ///< measured, rising
  ValueWithInterval last = {};  ///< cost at the greatest of them
  double fixed = 0, each = 0;   ///< of the line; with a value
  /// Nothing: see why_not. The interval is of one more row: it holds what processes differ by, and how far rows lie from a
  /// line. No end is below 0.
  std::optional<ValueWithInterval> value = {};
  /// Of the greatest x from the others alone: what such a forecast is worth. Nothing where these are too few.
  std::optional<ValueWithInterval> foretold = {};
  std::string why_not = {};  ///< "too few points", "below the clock", "no cost"

  bool is_foretold() const { return foretold && foretold->low <= last.value && last.value <= foretold->high; }
};

struct Forecasts {
  std::string axis, unit;  ///< of x
  Cost cost = Cost::light;
  double to = 0;  ///< where costs are forecast
  std::vector<Forecast> rows;
  std::size_t single = 0;  ///< series of one point, left out
};

/// Costs along an axis of find_growth, at `to`; by default at four times the greatest x. By `lights` the rows must have several
/// together. Throws Error where `to` lies among what was measured, and where no series has two points.
Forecasts find_forecasts(std::span<const Record> records, const std::string& axis, Cost cost, std::optional<double> to = {});

}  // namespace gnomon
