// gnomon tune --replay: what the search finds of grids whose every evaluation was kept.
#include "analysis/tune_replay.h"
#include "app/app.h"
#include "app/tune_run.h"
#include "report/table/text_table.h"

namespace gnomon::app {

namespace {

constexpr double near_best = 1.05;  // that the last line counts

/// "0.21 %, 5.3 MiB", or how far it is beyond the limits.
std::string goal_text(const TuneStanding& standing, const TuneGoal& goal) {
  if (!standing.keeps_limits()) return fmt::format("{:.0f} % beyond", 100 * standing.beyond);
  return goal.least.name == "error" ? fmt::format("{:.3g} %", 100 * standing.goal)
                                    : fmt::format("{:.3g} MiB", standing.goal / (1024 * 1024));
}

}  // namespace

void print_replays(std::span<const std::string> files, const TuneGoal& goal, std::uint64_t seed, std::size_t width) {
  TextTable table({{"grid", ""},
                   {"possible", "", Align::right},
                   {"asked", "", Align::right},
                   {"share", "%", Align::right},
                   {"found", "", Align::right},
                   {"best", "", Align::right},
                   {"found / best", "", Align::right},
                   {"setting found", ""}});
  std::size_t near = 0;
  double asked = 0, possible = 0;
  for (const std::string& file : files) {
    const KeptGrid kept = read_kept_grid(file_text(file), file);
    const TuneReplay one = replay(kept, goal, seed);
    near += one.ratio() <= near_best;
    asked += static_cast<double>(one.asked);
    possible += kept.possible();
    table.add_row({std::filesystem::path(file).stem().string(), fmt::format("{:.0f}", kept.possible()),
                   fmt::format("{}", one.asked), fmt::format("{:.1f}", 100 * static_cast<double>(one.asked) / kept.possible()),
                   goal_text(one.found_standing, goal), goal_text(one.best_standing, goal), fmt::format("{:.4g}", one.ratio()),
                   kept.space.name(one.found)});
  }
  fmt::print("{}\n{} of {} grids within 5 % of the best, {:.1f} % of the evaluations asked, seed {}\n", table.text(width), near,
             files.size(), 100 * asked / possible, seed);
}

}  // namespace gnomon::app
