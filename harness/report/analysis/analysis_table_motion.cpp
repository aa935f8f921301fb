#include "report/analysis/analysis_table_parts.h"

namespace gnomon::analysis {

Tables motion_tables(std::span<const Record> records, const AnalysisOptions& options, Format) {
  const std::vector<PathErrors> motions = find_motion(records, options.metric);
  const Column error = quantity_column(options.metric), instability = quantity_column("instability");
  Layout table;
  table.title = fmt::format("Along paths: instability, and {} of every frame", with_unit(error));
  table.columns = place_columns();
  table.columns.insert(
      table.columns.end(),
      {text_column("setting", "technique"), whole_column("frames", "", "frames"), lengthened(instability, "_mean", "mean"),
       lengthened(instability, "_max", "max"), whole_column("instability_frame", "", "at frame"),
       lengthened(error, "_mean", "mean"), lengthened(error, "_min", "min"), lengthened(error, "_max", "max"),
       whole_column(options.metric + "_frame", "", "worst at frame")});
  const auto place = [](const PathErrors& motion) { return place_of(*motion.record); };
  add_groups(table, motions, place, [&](const PathErrors& motion) {
    Cells cells = place_cells(place(motion));
    cells.push_back(text_cell(setting_name(*motion.record)));
    cells.push_back({.value = static_cast<double>(motion.frames)});
    const auto add = [&](const std::optional<PathErrors::Range>& range,
                         std::initializer_list<double PathErrors::Range::*> parts) {
      for (const auto part : parts) cells.push_back(range ? Cell{.value = (*range).*part} : Cell{});
      cells.push_back(range ? Cell{.value = static_cast<double>(range->worst)} : Cell{});
    };
    add(motion.instability, {&PathErrors::Range::mean, &PathErrors::Range::greatest});
    add(motion.error, {&PathErrors::Range::mean, &PathErrors::Range::least, &PathErrors::Range::greatest});
    return cells;
  });
  table.notes = {"instability: share of the tested pixels that flip from one frame to the next where the reference does not",
                 "frames are counted from 0"};
  return {table};
}

}  // namespace gnomon::analysis
