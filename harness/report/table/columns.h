#pragma once
#include <cmath>
#include <functional>
#include <variant>

#include "analysis/told_apart.h"
#include "measure/record/record.h"
#include "report/table/text_table.h"

namespace gnomon {

/// What a column says of one record, in the column's unit; monostate is null: not measured, not defined, not reported.
struct Cell {
  std::variant<std::monostate, double, std::string> value = {};
  std::string shown = {};   ///< for people, where that differs from the value
  bool is_flagged = false;  ///< needs a second look; the legend says why
  bool is_best = false;     ///< among those that compete with it
  bool is_floored = false;  ///< as near to its best as the reference's own noise may take it

  const double* number() const { return std::get_if<double>(&value); }
};

/// Who sees a column: people read tables, programs read CSV and JSON.
enum class Audience { all, people, programs };

/// One column of every format: programs get value and unit, people get value * shown_scale in shown_unit under the heading.
struct Column {
  std::string name;  ///< in CSV, JSON and --columns
  std::string unit;  ///< "" for text, counts and shares of 1
  std::string heading, shown_unit;
  double shown_scale = 1;
  Align alignment = Align::right;
  bool is_exact = false;    ///< shown with all its digits: sizes, counts, parameters
  std::string better = "";  ///< "lower", "higher", or "" when neither is
  std::string sentence = "";
  std::function<Cell(const Record&)> cell = {};  ///< empty in tables whose rows are no records
  /// Of a time its logarithm, nothing where there are too few processes. Empty function where the column has no times.
  std::function<std::optional<LogTime>(const Record&)> log_time = {};
  Audience audience = Audience::all;
  int spare = 0;  ///< where there is no room the columns with the highest go first; those with 0 stay
};

/// A plain function, so that a list of columns costs one std::function type and not one for each of its lambdas.
using CellOf = Cell (*)(const Record&);
Column text_column(std::string name, std::string heading, CellOf cell = nullptr);
Column number_column(std::string name, const std::string& unit, std::string heading, CellOf cell = nullptr);
/// A share of 1, shown in percent.
Column share_column(std::string name, std::string heading, CellOf cell = nullptr);
/// Rays per second, shown in millions.
Column ray_column(std::string name, std::string heading, CellOf cell = nullptr);
/// A number that is shown with all its digits.
Column whole_column(std::string name, const std::string& unit, std::string heading, CellOf cell = nullptr);
Column for_people(Column column);
Column for_programs(Column column);
Column spare(Column column, int rank);

/// Empty text is null.
Cell text_cell(std::string_view text);
/// The number of something; 0 is null: there is none.
Cell count_cell(std::size_t count);
/// Nothing, NaN and infinity are null.
template <class T>
Cell number(const std::optional<T>& value) {
  return value && std::isfinite(static_cast<double>(*value)) ? Cell{.value = static_cast<double>(*value)} : Cell{};
}

/// Every column that the records can fill: identity, times of stages and of motion with their intervals, memory, metrics
/// against the headline truth
/// (`wrong_rate`) and against each (`shape.wrong_rate`, `mesh.wrong_rate`), causes of wrong pixels (`cause.acne`; those of a
/// technique's own where its rows occur), pixel classes (`class.T`), and one for each parameter (`parameter.resolution`) and
/// count (`count.texels`) that occurs.
std::vector<Column> all_columns(std::span<const Record> records);
/// Of these the times.
void add_times(std::vector<Column>& columns);
/// Of these the metrics, against the headline truth and against each.
void add_metrics(std::vector<Column>& columns);
/// Of a row of several lights the error of the one that is worst.
void add_worst_light(std::vector<Column>& columns);

/// "best constant mask 12.3 %": what a place's errors are read against.
std::string constant_text(double error);
inline constexpr const char* constant_note =
    "error of the best mask of one value everywhere; a row that does not beat it is never called best";

inline constexpr const char* floor_note = "error that the reference's noise alone makes; a smaller error cannot be told from 0";

/// Below this share of tested pixels an error speaks for too small a part of the picture; such cells are flagged.
inline constexpr double least_tested_share = 0.90;

/// A name for people: "edge resolution" of "edge_resolution".
std::string with_blanks(std::string_view name);

/// What made most of the wrong pixels wrong (of the error, under a light with area): "acne 78 %, crack 22 %"; empty when
/// nothing has a cause. What rounds to nothing is left out.
std::string top_causes(const Record& record, std::size_t most = 2);

/// The cell for people: rounded as it deserves, "-" for null.
std::string shown(const Column& column, const Cell& cell);

/// The names of the columns with this heading as tables print it: line breaks and the unit behind it do not count.
std::vector<std::string> names_with_heading(std::span<const Column> columns, std::string_view heading);

/// The columns with these names or headings, in this order. Throws Error with the names where several columns have a heading,
/// and with the nearest names where none has.
std::vector<Column> select(const std::vector<Column>& columns, std::span<const std::string> names);

}  // namespace gnomon
