#include "report/analysis/analysis_table_parts.h"

namespace gnomon::analysis {

namespace {

Place place_of_motion(const PathErrors& motion) { return place_of(*motion.record); }

bool has_over_time(std::span<const PathErrors> motions) { return std::ranges::any_of(motions, &PathErrors::has_over_time); }

void add_over_time_columns(Layout& table) {
  int later = 0;  // what comes later goes first where there is no room
  for (const std::string& metric : names_over_time()) table.columns.push_back(spare(quantity_column(metric), later++));
}

void add_over_time_cells(Cells& cells, const PathErrors& motion) {
  for (const std::optional<double>& value : motion.over_time) cells.push_back(value ? Cell{.value = *value} : Cell{});
}

/// For people, beside the table of the frames, which would be too wide with it.
Layout over_time_table(const std::vector<PathErrors>& motions) {
  Layout table;
  table.title = "Along paths: errors over time";
  table.columns = place_columns();
  table.columns.push_back(text_column("setting", "technique"));
  table.columns.push_back(quantity_column("error"));  // a mask that never changes has no flicker
  add_over_time_columns(table);
  std::vector<PathErrors> shown;
  std::ranges::copy_if(motions, std::back_inserter(shown), &PathErrors::has_over_time);
  add_groups(table, shown, place_of_motion, [](const PathErrors& motion) {
    Cells cells = place_cells(place_of_motion(motion));
    cells.push_back(text_cell(setting_name(*motion.record)));
    const std::optional<double> error = motion.record->metric("error");
    cells.push_back(error ? Cell{.value = *error} : Cell{});
    add_over_time_cells(cells, motion);
    return cells;
  });
  table.notes = {
      "flicker: root mean square of what the error changes by in 1/60, 1/15 and 1/4 s; temporal sd: its standard deviation",
      "flips per second and pixel: false: the reference does not flip that way within 0.1 s; late: it does, in another frame",
      "steady: share of the pixels tested in the first frame that show one surface point and are tested in all frames; where "
      "the camera moves, share of the tested pixels that flicker 1/60 compares"};
  return table;
}

}  // namespace

Tables motion_tables(std::span<const Record> records, const AnalysisOptions& options, Format format) {
  const std::vector<PathErrors> motions = find_motion(records, options.metric);
  const Column error = quantity_column(options.metric), instability = quantity_column("instability");
  const bool is_for_programs = format == Format::csv || format == Format::json;
  const bool in_one_table = is_for_programs && has_over_time(motions);
  Layout table;
  table.title = fmt::format("Along paths: instability, and {} of every frame", with_unit(error));
  table.columns = place_columns();
  table.columns.insert(table.columns.end(),
                       {text_column("setting", "technique"), spare(whole_column("frames", "", "frames"), 3),
                        lengthened(instability, "_mean", "mean"), spare(lengthened(instability, "_max", "max"), 4),
                        spare(whole_column("instability_frame", "", "at frame"), 5), lengthened(error, "_mean", "mean"),
                        spare(lengthened(error, "_min", "min"), 2), lengthened(error, "_max", "max"),
                        spare(whole_column(options.metric + "_frame", "", "worst at frame"), 1)});
  if (in_one_table) add_over_time_columns(table);
  add_groups(table, motions, place_of_motion, [&](const PathErrors& motion) {
    Cells cells = place_cells(place_of_motion(motion));
    cells.push_back(text_cell(setting_name(*motion.record)));
    cells.push_back({.value = static_cast<double>(motion.frames)});
    const auto add = [&](const std::optional<PathErrors::Range>& range,
                         std::initializer_list<double PathErrors::Range::*> parts) {
      for (const auto part : parts) cells.push_back(range ? Cell{.value = (*range).*part} : Cell{});
      cells.push_back(range ? Cell{.value = static_cast<double>(range->worst)} : Cell{});
    };
    add(motion.instability, {&PathErrors::Range::mean, &PathErrors::Range::greatest});
    add(motion.error, {&PathErrors::Range::mean, &PathErrors::Range::least, &PathErrors::Range::greatest});
    if (in_one_table) add_over_time_cells(cells, motion);
    return cells;
  });
  table.notes = {"instability: share of the tested pixels that flip from one frame to the next where the reference does not",
                 "frames are counted from 0"};
  Tables tables{std::move(table)};
  if (!is_for_programs && has_over_time(motions)) tables.push_back(over_time_table(motions));
  return tables;
}

}  // namespace gnomon::analysis
