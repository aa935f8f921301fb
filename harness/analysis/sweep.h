#pragma once
#include "analysis/axis.h"

namespace gnomon {

/// A quantity of one setting against a parameter, all else fixed.
struct Sweep {
  Place place;          ///< scene: the family, "composite:object=cone,light_x=*", where the parameter is of scenes
  std::string setting;  ///< without the parameter, where it is of techniques
  Role role = Role::contender;
  struct Point {
    double x = 0;
    std::optional<ValueWithInterval> value;  ///< nothing: not supported, failed, or not defined there
    Status status = Status::ok;
  };
  std::vector<Point> points = {};  ///< by x, each once
};

struct Sweeps {
  std::string parameter, unit;  ///< of x
  std::string quantity;
  std::vector<Sweep> rows = {};    ///< of two or more x each
  std::size_t single = 0;          ///< series of one x, left out
  std::size_t repeated = 0;        ///< rows at an x that their series has already, left out
  std::vector<Place> places = {};  ///< of the rows, in their order

  /// Every x that a row of this place has, in order.
  std::vector<double> xs(const Place& place) const;
};

/// `parameter` is a numeric one of techniques or of scenes, `quantity` as in analysis.h; times have their intervals. Throws
/// Error with the nearest name when no record has the parameter or the quantity, and when nothing was swept: no setting has two
/// values of the parameter in one place, or none of their rows has the quantity.
Sweeps find_sweeps(std::span<const Record> records, const std::string& parameter, const std::string& quantity);

}  // namespace gnomon
