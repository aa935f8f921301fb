#pragma once
#include <optional>

#include "analysis/in_order.h"
#include "analysis/rank.h"
#include "report/analysis/analysis_table.h"
#include "report/table/layout.h"

namespace gnomon::analysis {

// What the tables of analyses are made of: columns, cells, and the place of a row.

using Cells = std::vector<Cell>;  ///< of one row, one for each column

/// The column with its name and heading lengthened.
Column lengthened(Column column, const std::string& suffix, const std::string& heading);
/// The column at one value of a parameter. The title says the unit.
Column at_value(Column column, const std::string& value);
/// "wrong in %".
std::string with_unit(const Column& column);

Cell shown_text(std::string_view value, std::string shown);
/// The value of a measurement; null where there is none.
Cell value_of(const std::optional<ValueWithInterval>& measured);
/// One end of an interval; null where there is none.
Cell end(const std::optional<ValueWithInterval>& measured, double ValueWithInterval::*which);
/// "4.1 .. 4.9" in the digits of the column.
std::string interval_text(const Column& column, const ValueWithInterval& measured);

/// Scene, light, view, path, size and truth: for programs, people read them above the rows.
std::vector<Column> place_columns();
/// Their cells; nulls for a row over all places.
Cells place_cells(const std::optional<Place>& place);

/// One group for each place that an item lies in, with the items' rows.
template <class T>
void add_groups(Layout& table, const std::vector<T>& items, auto place, auto cells_of) {
  std::vector<Place> places;
  for (const T& item : items) add_once(places, Place(std::invoke(place, item)));
  for (const Place& here : places) {
    Layout::Group& group = table.groups.emplace_back(Layout::Group{.heading = title(here, places)});
    for (const T& item : items)
      if (std::invoke(place, item) == here) group.rows.push_back({.cells = cells_of(item)});
  }
}

/// Pairs of contenders, a group for each kind of light and quantity; no group where there is nothing to compare. The report's
/// page shows it, too.
Layout rank_table(std::span<const Record> records, const RankOptions& options);

inline constexpr const char* interval_note = "interval: 95 %, hierarchical bootstrap over processes";

// One per kind. People get several tables of maps and sweeps: a map or a list of x each.
using Tables = std::vector<Layout>;
Tables growth_tables(std::span<const Record> records, const AnalysisOptions& options, Format format);
Tables front_tables(std::span<const Record> records, const AnalysisOptions& options, Format format);
Tables best_tables(std::span<const Record> records, const AnalysisOptions& options, Format format);
Tables rank_tables(std::span<const Record> records, const AnalysisOptions& options, Format format);
Tables map_tables(std::span<const Record> records, const AnalysisOptions& options, Format format);
Tables motion_tables(std::span<const Record> records, const AnalysisOptions& options, Format format);
Tables sweep_tables(std::span<const Record> records, const AnalysisOptions& options, Format format);
Tables forecast_tables(std::span<const Record> records, const AnalysisOptions& options, Format format);
Tables enough_tables(std::span<const Record> records, const AnalysisOptions& options, Format format);
Tables masks_tables(std::span<const Record> records, const AnalysisOptions& options, Format format);
Tables seams_tables(std::span<const Record> records, const AnalysisOptions& options, Format format);

}  // namespace gnomon::analysis
