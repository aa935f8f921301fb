#include "analysis/mask_differences.h"
#include "report/analysis/analysis_table_parts.h"

namespace gnomon::analysis {

Tables masks_tables(std::span<const Record> records, const AnalysisOptions& options, Format) {
  Progress progress;
  const MaskDifferences found = compare_masks(records, options.folder, progress);
  Layout table;
  table.title = "Masks against the first row of their place, over the tested pixels";
  table.columns = place_columns();
  table.columns.push_back(text_column("base", "base"));
  table.columns.push_back(text_column("setting", "technique"));
  for (const auto& [name, heading] : {std::pair("changed_share", "changed"),
                                      {"difference_mean", "mean"},
                                      {"difference_rms", "rms"},
                                      {"difference_max", "greatest"}})
    table.columns.push_back(share_column(name, heading));
  add_groups(
      table, found.pairs, [](const MaskDifference& pair) { return place_of(*pair.base); },
      [](const MaskDifference& pair) {
        Cells cells = place_cells(place_of(*pair.base));
        cells.push_back(text_cell(setting_name(*pair.base)));
        cells.push_back(text_cell(setting_name(*pair.other)));
        for (const double value : {pair.changed, pair.mean, pair.rms, pair.greatest}) cells.push_back({.value = value});
        return cells;
      });
  table.notes = {"changed: share of the tested pixels that differ by more than 1/256; mean, rms, greatest: of the difference"};
  table.notes.insert(table.notes.end(), found.notes.begin(), found.notes.end());
  return {std::move(table)};
}

}  // namespace gnomon::analysis
