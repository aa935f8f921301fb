#pragma once
#include <string>
#include <vector>

#include "analysis/tune_search.h"

namespace gnomon {

/// What there is in a search that parameters may be about. By default all.
struct TuneMatter {
  bool has_holes = true, has_glass = true;  ///< a scene of the search has such meshes
  bool has_motion = true;                   ///< frames follow one another
  bool has_costs = true;                    ///< a time or bytes are the goal, or have a limit
};

/// The settings of a technique that are tuned, as a text names them.
struct TuneSpace {
  struct Parameter {
    std::string name;
    std::vector<std::string> values;  ///< by level
    std::string base;                 ///< the technique's default
    std::string condition = {};       ///< "bias=slope": without it the parameter has no effect
  };
  std::string technique;              ///< id
  std::string fixed;                  ///< "filter=pcf": the same in every setting
  std::vector<Parameter> parameters;  ///< as of `grid`
  TuneGrid grid;
  std::vector<std::string> left_out;  ///< of ID:*: parameters that are no matter of tuning
  /// Without an effect in every setting: "slope_bias (for bias=slope)", "alpha (no caster has holes)".
  std::vector<std::string> skipped;

  /// "a=1,b=2" of what differs from the technique's defaults and has an effect.
  std::string settings(const TuneSetting& setting) const;
  /// The same of the technique's defaults with what is fixed: they need not be in the grid.
  std::string defaults() const;
  /// "shadow_map:a=1,b=2".
  std::string name(const TuneSetting& setting) const;
};

/// Reads `ID:parameter=VALUE,...`. A VALUE is `*`, all levels; `{a,b}`, these; or one that all settings have. `ID` and `ID:*`
/// are all parameters, but for seeds, frames of noise and picked pixels, which no answer should depend on, and other
/// techniques within this one. Whether a parameter has an effect is what its sentence says: "; for bias=slope" at its end, or
/// "Casters with holes: " at its beginning. Throws Error on unknown techniques and parameters, and on values out of range.
TuneSpace tune_space(const std::string& text, const TuneMatter& matter = {});

/// Sorts the questions that follow one another at one place: what spoils early stages of the technique changes the least often,
/// so that a worker that keeps what a setting does not spoil does the least again.
void put_by_stages(const TuneSpace& space, std::vector<TuneQuestion>& questions);

/// At most nine values of a number from `least` to `most`, rising, the default among them: whole numbers where these are few;
/// on a logarithmic scale equal ratios, powers of two where they fit; else equal steps. A default in the lowest eighth of a
/// range says that small values matter: then halves and doubles of it, and the least.
std::vector<double> tune_levels(double least, double most, double base, bool is_whole, bool is_log);

}  // namespace gnomon
