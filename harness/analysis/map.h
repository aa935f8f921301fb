#pragma once
#include "analysis/analysis.h"

namespace gnomon {

struct MapOptions {
  std::string metric = "error";  ///< a quantity
  /// Parameters of the axes; empty: the two numeric ones with the most values. `facet` may stay empty. "scene" and "light" may
  /// be named too.
  std::string x = {}, y = {}, facet = {};
};

/// A quantity over two parameters of one technique, all others fixed: the mean over the places (scene, light, view, path, size)
/// that every setting of the technique finished.
struct Map {
  std::string technique;
  /// What is fixed here and differs between the maps of the technique: name and value.
  std::vector<std::pair<std::string, std::string>> facet;
  std::string x, y;                 ///< parameters; y is empty when there is only one
  std::vector<std::string> xs, ys;  ///< their values in order: numbers by size, words by appearance
  struct Cell {
    std::optional<double> value;
    bool may_be_best = true;  ///< it errs less than the best constant mask of the same places
    bool is_best = false;     ///< no cell of any map of the technique that may be is better
  };
  std::vector<Cell> cells;                ///< xs.size() * ys.size(), row by row of y
  std::size_t places = 0;                 ///< that the means cover
  std::size_t places_with_fractions = 0;  ///< of these, whose answer is a fraction; 0 where lights are an axis
  /// Of the first map of a technique: the places that the means leave out, and whose values are missing there.
  std::vector<std::string> notes = {};

  std::string facet_text() const;  ///< "size=1024, pcf=3"
  const Cell& at(std::size_t x_index, std::size_t y_index) const { return cells[y_index * xs.size() + x_index]; }
};

/// "4 places, 2 of them under lights with area"; of one kind of light "4 places".
std::string places_text(const Map& map);

/// Maps of every technique that has at least two settings. Parameters beside x, y and facet that vary become facets too, so
/// that no cell hides a choice. Throws Error on a metric or parameter that no record has, on one that is
/// named for two axes, and when no technique has two settings.
std::vector<Map> make_maps(std::span<const Record> records, const MapOptions& options);

}  // namespace gnomon
