#pragma once
#include <optional>

#include "analysis/in_order.h"
#include "report/analysis/analysis_table.h"
#include "report/analysis/grid.h"

namespace gnomon::analysis {

// What the tables of analyses are made of: heads, cells, and the place of a row.

using Audience = Grid::Audience;
using Entries = std::vector<Grid::Entry>;  ///< of one row, one for each head

Grid::Head words(std::string name, std::string heading, Audience audience = Audience::all);
Grid::Head number(std::string name, std::string unit, std::string heading, Audience audience = Audience::all,
                  bool is_exact = false);
/// The column of a quantity, its name and heading lengthened.
Grid::Head of_quantity(const std::string& quantity, const std::string& suffix = "", const std::string& heading = "");

Cell text(const std::string& value);
Cell shown_text(const std::string& value, std::string shown);
/// The value of a measurement; null where there is none.
Cell value_of(const std::optional<ValueWithInterval>& measured);
/// One end of an interval; null where there is none.
Cell end(const std::optional<ValueWithInterval>& measured, double ValueWithInterval::*which);
/// "4.1 .. 4.9" in the digits of the column.
std::string interval_text(const Column& column, const ValueWithInterval& measured);
/// "wrong in %".
std::string with_unit(const std::string& quantity);

/// Scene, light, view, path, size and truth: for programs, people read them above the rows.
void add_place_heads(Grid& grid);
/// Their cells; nulls for a row over all places.
void add_place(Entries& row, const std::optional<Place>& place);

/// One group for each place that an item lies in, with the items' rows.
template <class T>
void add_groups(Grid& grid, const std::vector<T>& items, auto place, auto row_of) {
  std::vector<Place> places;
  for (const T& item : items) add_once(places, Place(std::invoke(place, item)));
  for (const Place& here : places) {
    Grid::Group& group = grid.groups.emplace_back(Grid::Group{.heading = title(here, places), .rows = {}});
    for (const T& item : items)
      if (std::invoke(place, item) == here) group.rows.push_back(row_of(item));
  }
}

inline constexpr const char* interval_note = "interval: 95 %, hierarchical bootstrap over processes";

// One per kind.
Grid growth_grid(std::span<const Record> records, const AnalysisOptions& options);
Grid front_grid(std::span<const Record> records, const AnalysisOptions& options);
Grid best_grid(std::span<const Record> records, const AnalysisOptions& options);
Grid motion_grid(std::span<const Record> records, const AnalysisOptions& options);
// People get several tables of one analysis: a map or a list of x each.
std::string map_text(std::span<const Record> records, const AnalysisOptions& options, Format format, const TableOptions& table);
std::string sweep_text(std::span<const Record> records, const AnalysisOptions& options, Format format,
                       const TableOptions& table);

/// One below the other; in LaTeX each with a label of its own.
std::string render_grids(std::span<const Grid> grids, Format format, const TableOptions& table);

}  // namespace gnomon::analysis
