#pragma once
#include "analysis/tune_goal.h"
#include "analysis/tune_space.h"

namespace gnomon {

// A grid whose every evaluation was kept: a search on it asks the file, and what the best setting is was seen.

/// Errors and bytes of each setting of a technique at each place. Neither has noise.
struct KeptGrid {
  struct Numbers {
    double error = 0, bytes = 0;
  };
  std::string name;  ///< of messages: the file
  TuneSpace space;
  std::vector<std::string> places = {};
  /// By setting and place; nothing: no answer.
  std::map<TuneSetting, std::vector<std::optional<Numbers>>> numbers = {};
  /// Evaluations.
  double possible() const { return space.grid.count() * static_cast<double>(places.size()); }
};

/// The table that read_kept_grid reads; errors have four digits.
std::string kept_grid_text(const KeptGrid& kept);

/// Reads a table of kept_grid_text. The first line has `ID:` with a parameter behind it, the other parameters,
/// then for each place `error at PLACE` and `bytes at PLACE`. Each line below is a setting: values, then numbers, which are
/// empty where there is no answer. A parameter of one value
/// is that of all settings. Throws Error with `name` and line on what is no such table, on values that the technique
/// does not allow, and where a setting of the grid is missing.
KeptGrid read_kept_grid(std::string_view text, const std::string& name);

struct TuneReplay {
  std::size_t asked = 0;
  TuneSetting found, best;
  TuneStanding found_standing, best_standing;
  /// How far the found setting is from the best one: the ratio of their goals, or of how far they are beyond the limits where
  /// the best one breaks them. 1: as good. Infinite where only the best one keeps them.
  double ratio() const;
};

/// Searches the grid as a grid of more than most_evaluations is searched, whatever its size. `goal` counts errors and bytes
/// alone; throws Error on another number.
TuneReplay replay(const KeptGrid& kept, const TuneGoal& goal, std::uint64_t seed);

}  // namespace gnomon
