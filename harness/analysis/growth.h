#pragma once
#include "analysis/axis.h"

namespace gnomon {

/// Least squares of ln y = ln coefficient + exponent ln x.
struct PowerLaw {
  double exponent = 0, coefficient = 0;
  double r2 = 0;  ///< share of the variance of ln y that the line explains; 1 where y does not vary
  /// Half of the exponent's 95 % interval by how far the points lie from the line (Student's t); nothing of two points.
  std::optional<double> misfit = {};
};
/// Positive values, one y per x, at least two different x.
PowerLaw fit_power_law(std::span<const double> x, std::span<const double> y);

/// How the time of one stage, or a quantity, grows along one axis: rows of one setting that are equal in everything else.
struct Growth {
  Place place;          ///< scene: the family, "sphere_field:count=*"; what the axis varies is 0 or empty
  std::string setting;  ///< without the parameter that the axis varies
  Role role = Role::contender;
  std::string
      stage;  ///< "build", "relight", "resolve"; on the axis `lights` without rows of several also "total"; or the quantity
  struct Point {
    double x = 0;
    ValueWithInterval value;  ///< of times milliseconds
    double least = 0;         ///< smaller values are noise, and the fit leaves them out
    std::size_t rows = 1;     ///< that it is made of: seeds of one setting, or lights
    bool is_fitted() const { return value.value > 0 && value.value >= least; }
  };
  std::vector<Point> points = {};  ///< by x
  std::size_t left_out = 0;        ///< points that are not fitted
  /// Nothing: see why_not. The interval holds what times differ by from process to process, and that points do not lie on a
  /// line.
  std::optional<ValueWithInterval> exponent = {};
  double coefficient = 0, r2 = 0;
  /// From each fitted point to the next, the least and the greatest; of the line through the upper half of them, the middle one
  /// of an odd number included. With an exponent alone.
  double least_slope = 0, greatest_slope = 0, upper_slope = 0;
  std::string why_not = {};  ///< "too few points", "below the clock", "below the reference"
};

/// A time below this, in milliseconds, is the cost of the call and the clock.
inline constexpr double clock_ms = 0.001;
/// Fewer different x make no line.
inline constexpr std::size_t least_points = 3;
/// An error below so many standard errors of the reference (its target) holds a part of these: at three, which adds their
/// square, 5 %.
inline constexpr double least_reference_errors = 3;

struct Growths {
  std::string axis, unit;  ///< of x
  std::string quantity;    ///< empty: times of stages
  std::vector<Growth> rows;
  std::size_t single = 0;  ///< series of one point, left out
};

/// `axis` is "triangles", "pixels", "lights" (of one scene: how many a row has together; where no row has several, build
/// once, relight and resolve summed over the first, first two, ... in the order of the records), or a numeric parameter of
/// techniques or of scenes. Throws Error with the nearest name when no record has it. With a quantity (see analysis.h) that is
/// what grows, and rows that differ in the `seed` of their technique alone are one point: its value is their median, and they
/// are what the bootstrap draws.
Growths find_growth(std::span<const Record> records, const std::string& axis, const std::string& quantity = "");

}  // namespace gnomon
