#pragma once
#include "analysis/axis.h"

namespace gnomon {

/// Least squares of ln y = ln coefficient + exponent ln x.
struct PowerLaw {
  double exponent = 0, coefficient = 0;
  double r2 = 0;  ///< share of the variance of ln y that the line explains; 1 where y does not vary
};
/// Positive values, one y per x, at least two different x.
PowerLaw fit_power_law(std::span<const double> x, std::span<const double> y);

/// How the time of one stage grows along one axis: rows of one setting that are equal in everything else.
struct Growth {
  Place place;          ///< scene: the family, "sphere_field:count=*"; what the axis varies is 0 or empty
  std::string setting;  ///< without the parameter that the axis varies
  Role role = Role::contender;
  std::string stage;  ///< "build", "relight", "resolve"; on the axis `lights` also "total"
  struct Point {
    double x = 0;
    ValueWithInterval ms;
  };
  std::vector<Point> points = {};  ///< by x
  /// Points below the clock's resolution, which the fit leaves out.
  std::size_t too_fast = 0;
  std::optional<ValueWithInterval> exponent = {};  ///< nothing: see why_not
  double coefficient = 0, r2 = 0;
  std::string why_not = {};  ///< "too few points", "below the clock"
};

/// A time below this, in milliseconds, is the cost of the call and the clock.
inline constexpr double clock_ms = 0.001;
/// Fewer different x make no line.
inline constexpr std::size_t least_points = 3;

struct Growths {
  std::string axis, unit;  ///< of x
  std::vector<Growth> rows;
  std::size_t single = 0;  ///< series of one point, left out
};

/// `axis` is "triangles", "pixels", "lights" (of one scene: build once, relight and resolve summed over the first, first two,
/// ... in the order of the records), or a numeric parameter of techniques or of scenes. Throws Error with the nearest name when
/// no record has it.
Growths find_growth(std::span<const Record> records, const std::string& axis);

}  // namespace gnomon
