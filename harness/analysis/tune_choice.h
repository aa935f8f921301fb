#pragma once
#include <array>
#include <string>

#include "analysis/tune_goal.h"
#include "analysis/tune_space.h"

namespace gnomon {

// What follows from the answers of a search: who is chosen, how that does elsewhere, and what each parameter did.

/// A setting that may be the answer, measured at every place by several processes.
struct TuneFinalist {
  std::vector<TuneAnswer> answers;  ///< by place
  std::vector<Sample> times;        ///< by place, where the goal is a time
  double error = 0;                 ///< at its worst place
  std::size_t changes = 0;          ///< parameters that are not at the technique's default
};

struct TuneDecision {
  std::size_t answer = 0;
  std::optional<std::size_t> runner_up;
  std::vector<std::size_t> tied;  ///< with the answer, which is among them; one where there is no tie
  /// How likely the goal of the answer is the least, within 2 % and within 5 % of the least. Of a goal without noise all 1.
  std::array<double, 3> chances{1, 1, 1};
};
inline constexpr std::array<double, 3> chance_margins{0, 0.02, 0.05};

/// The best of the finalists. Where the goal is a time and the best one's is the least with less than 95 % chance, all whose
/// chance is 5 % or more are tied; without noise those of the same goal are. Of these the one with the least error is the
/// answer, then the one with the fewest changes. There must be a finalist.
TuneDecision decide(std::span<const TuneFinalist> finalists, TuneOver over);

/// A scene that was left out while a setting was chosen by all others.
struct SceneLeftOut {
  std::string scene;
  std::size_t chosen = 0;    ///< index of a setting
  TuneStanding there, best;  ///< at this scene's places: of the chosen one, and of the best for these places alone
};
/// One for each scene; none of one scene. `settings` have their answers by place, `scenes` that of each place.
std::vector<SceneLeftOut> leave_scenes_out(std::span<const std::vector<TuneAnswer>> settings,
                                           std::span<const std::string> scenes, TuneOver over);

/// What a parameter did: for each value the best setting that has it.
struct TuneEffect {
  std::string parameter;
  struct Value {
    std::string text;
    std::optional<TuneStanding> best;  ///< of settings with an answer at every place; nothing where no such one has this value
  };
  std::vector<Value> values;
  std::size_t chosen = 0;      ///< the answer's value
  bool is_at_end = false;      ///< a number, and the answer has its first or last value
  std::string condition = {};  ///< "bias=slope", where the parameter has an effect
};
std::vector<TuneEffect> tune_effects(const TuneSpace& space, const TuneSearch& search, const TuneSetting& answer,
                                     std::size_t places, TuneOver over);

}  // namespace gnomon
