#include "report/analysis/analysis_table_parts.h"

namespace gnomon::analysis {

Grid motion_grid(std::span<const Record> records, const AnalysisOptions& options) {
  const std::vector<Motion> motions = find_motion(records, options.metric);
  Grid grid;
  grid.title = fmt::format("Along paths: instability, and {} of every frame", with_unit(options.metric));
  add_place_heads(grid);
  grid.heads.push_back(words("setting", "technique"));
  grid.heads.push_back(number("frames", "", "frames", Audience::all, true));
  grid.heads.push_back(of_quantity("instability", "_mean", "mean"));
  grid.heads.push_back(of_quantity("instability", "_max", "max"));
  grid.heads.push_back(number("instability_frame", "", "at frame", Audience::all, true));
  grid.heads.push_back(of_quantity(options.metric, "_mean", "mean"));
  grid.heads.push_back(of_quantity(options.metric, "_min", "min"));
  grid.heads.push_back(of_quantity(options.metric, "_max", "max"));
  grid.heads.push_back(number(options.metric + "_frame", "", "worst at frame", Audience::all, true));
  const auto place = [](const Motion& motion) { return place_of(*motion.record); };
  add_groups(grid, motions, place, [&](const Motion& motion) {
    Entries row;
    add_place(row, place(motion));
    row.push_back({text(setting_name(*motion.record))});
    row.push_back({{.value = static_cast<double>(motion.frames)}});
    const auto add = [&](const std::optional<Motion::Range>& range, std::initializer_list<double Motion::Range::*> parts) {
      for (const auto part : parts) row.push_back({range ? Cell{.value = (*range).*part} : Cell{}});
      row.push_back({range ? Cell{.value = static_cast<double>(range->worst)} : Cell{}});
    };
    add(motion.instability, {&Motion::Range::mean, &Motion::Range::greatest});
    add(motion.error, {&Motion::Range::mean, &Motion::Range::least, &Motion::Range::greatest});
    return row;
  });
  grid.notes.emplace_back(
      "instability: share of the tested pixels that flip from one frame to the next where the reference does not");
  grid.notes.emplace_back("frames are counted from 0");
  return grid;
}

}  // namespace gnomon::analysis
