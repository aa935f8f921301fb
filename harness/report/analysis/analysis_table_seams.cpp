#include "analysis/seams.h"
#include "report/analysis/analysis_table_parts.h"

namespace gnomon::analysis {

Tables seams_tables(std::span<const Record> records, const AnalysisOptions&, Format format) {
  const std::vector<SeamErrors> rows = find_seams(records);
  const std::vector<std::string> bins = seam_bin_names();
  const bool is_for_programs = format == Format::csv || format == Format::json;
  const Column error = quantity_column("error");
  Layout table;
  table.title = fmt::format("{} by distance in px to the nearest seam", with_unit(error));
  table.columns = place_columns();
  table.columns.push_back(text_column("setting", "technique"));
  table.columns.push_back(error);
  for (const std::string& bin : bins) {
    std::string range = bin;
    range.replace(range.find('_'), 1, "..");
    const int far = static_cast<int>(table.columns.size());  // the farthest go first where there is no room
    table.columns.push_back(spare(at_value(quantity_column(fmt::format("error_seam_{}", bin)), range), far));
  }
  if (is_for_programs)
    for (const std::string& bin : bins) table.columns.push_back(quantity_column(fmt::format("seam_share_{}", bin)));
  table.columns.push_back(spare(share_column("near_share", "near"), 1));
  table.columns.push_back(share_column("near_part", "of the error"));
  add_groups(
      table, rows, [](const SeamErrors& row) { return place_of(*row.record); },
      [&](const SeamErrors& row) {
        Cells cells = place_cells(place_of(*row.record));
        cells.push_back(text_cell(setting_name(*row.record)));
        cells.push_back(number(row.record->metric("error")));
        for (const auto& value : row.errors) cells.push_back(number(value));
        if (is_for_programs)
          for (const auto& value : row.shares) cells.push_back(number(value));
        cells.push_back(number(row.near_share));
        cells.push_back(number(row.near_part));
        return cells;
      });
  table.notes = {"seam: where two slices, faces or pages of a technique's images meet on one surface",
                 "near: share of the tested pixels up to 8 px from a seam; of the error: the part of it that they make"};
  return {std::move(table)};
}

}  // namespace gnomon::analysis
