#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <vector>

namespace gnomon {

// The search of `gnomon tune`: a function of what settings answer at places. It runs nothing and reads no record.

/// One setting of a grid: the level of each parameter.
using TuneSetting = std::vector<std::size_t>;

/// The settings of one technique.
struct TuneGrid {
  struct Parameter {
    std::size_t levels = 1;
    bool is_ordered = true;  ///< a step goes to the next level; else to any other
    std::size_t base = 0;    ///< where the search begins
    /// The parameter has an effect where this earlier one has one of these levels; nothing: everywhere.
    std::optional<std::size_t> controller = {};
    std::vector<std::size_t> controller_levels = {};
  };
  std::vector<Parameter> parameters;

  TuneSetting base() const;
  /// A controller without an effect controls nothing.
  bool has_effect(std::size_t parameter, const TuneSetting& setting) const;
  /// The one form of settings that are the same: parameters without an effect are at their base.
  TuneSetting canonical(TuneSetting setting) const;
  /// How many settings differ, and how many there are when each value of a parameter without an effect counts.
  double count() const;
  double raw_count() const;
  /// All that differ, the first parameter slowest.
  std::vector<TuneSetting> all() const;
  /// Those that differ from this one in `count` parameters, 1 or 2, by one step each.
  std::vector<TuneSetting> steps(const TuneSetting& from, int count) const;
};

/// What a setting measured at one place.
struct TuneAnswer {
  bool is_there = true;  ///< false: not supported or failed; the setting is out
  double goal = 0;       ///< what is to be least, 0 or more
  double beyond =
      -1;           ///< how far it is beyond the limit that is nearest to be broken, as a share of it; 0 or less: it keeps all
  double gain = 1;  ///< how far its error is below that of the best constant mask
};

/// How the goals of several places become one number.
enum class TuneOver { worst, mean };

/// A setting over places.
struct TuneStanding {
  double beyond = -1;  ///< at the worst place; infinite where it has no answer
  double goal = 0;
  bool keeps_limits() const { return beyond <= 0; }
};
/// Of answers at some of `places` places: what the standing over all of them is at least. Where the mean error is no better
/// than that of a constant mask, a limit is broken.
TuneStanding standing(std::span<const TuneAnswer> answers, std::size_t places, TuneOver over);
/// Who keeps all limits is better than who does not; of these the lesser goal, then the larger margin; of the others who is
/// less far beyond.
bool is_better(const TuneStanding& a, const TuneStanding& b);

/// A setting to be measured at a place.
struct TuneQuestion {
  TuneSetting setting;
  std::size_t place = 0;
};
/// Measures them; answers in their order. Nothing: it is not measured, because the time is over.
using TuneAsker = std::function<std::vector<std::optional<TuneAnswer>>(std::span<const TuneQuestion>)>;

/// Grids of at most so many evaluations are run whole; of larger ones a fifth, and at most so many.
inline constexpr double most_evaluations = 2000;
inline std::size_t most_asked(double possible, double most = most_evaluations) {
  return static_cast<std::size_t>(std::min(most, possible / 5));
}

struct TuneSearchOptions {
  std::size_t places = 1;
  TuneOver over = TuneOver::worst;
  bool whole = true;           ///< every setting at every place
  std::size_t most_asked = 0;  ///< evaluations, where it is not whole
  std::uint64_t seed = 1;      ///< of the settings that it begins with, where it is not whole
};

struct TuneSearch {
  /// By setting, its answer at each place.
  std::map<TuneSetting, std::vector<std::optional<TuneAnswer>>> answers;
  std::vector<std::size_t> hardest_first;  ///< places
  std::size_t asked = 0;
  bool is_cut_short = false;  ///< the asker had no time
};

/// Where the whole grid is not asked: halving over places, hardest first, of settings that cover the grid; then from the best
/// six steps to better neighbors, in one parameter or two, for as long as there are any. A neighbor is dropped at the first
/// places that show that it is no better.
TuneSearch search_grid(const TuneGrid& grid, const TuneSearchOptions& options, const TuneAsker& ask);

/// Settings with an answer at every place, best first.
std::vector<TuneSetting> ranked(const TuneSearch& search, std::size_t places, TuneOver over);

}  // namespace gnomon
