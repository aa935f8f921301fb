#pragma once
#include "report/analysis/analysis_table_parts.h"

namespace gnomon::analysis {

// What tables share that show candidates of fields: fronts, budgets, and what is enough.

/// The fields of the records; on request only those over all places, where there is but one place that one.
std::vector<Field> fields_of(std::span<const Record> records, const AnalysisOptions& options);
/// The table of all fields, a group each, without rows yet.
Layout table_of(std::span<const Field> fields, std::string title, std::vector<Column> columns);
/// The column of a cost in milliseconds or bytes.
Column cost_column(Cost cost);
/// Whether errors have one that the reference's own noise makes.
bool has_floor(std::span<const Field> fields);
/// The floor, where a field has one, follows the error; people read the best constant mask above the rows.
void add_error_columns(std::vector<Column>& columns, const Column& error, std::span<const Field> fields);
void add_error_cells(Cells& cells, const Field& field, const Candidate* candidate, bool with_floor);
void add_error_notes(Layout& table, const Column& error, std::span<const Field> fields);
/// "error ≤ 0.5 %".
std::string error_budget_text(const Column& error, double budget, std::string_view direction);

}  // namespace gnomon::analysis
