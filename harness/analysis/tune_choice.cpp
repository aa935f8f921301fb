#include "analysis/tune_choice.h"

#include <algorithm>
#include <numeric>

#include "analysis/in_order.h"

namespace gnomon {

namespace {

constexpr double surely_least = 0.95;

/// Indices of items, best first by their standings.
std::vector<std::size_t> best_first(const std::vector<TuneStanding>& standings) {
  std::vector<std::size_t> order(standings.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return is_better(standings[a], standings[b]); });
  return order;
}

/// A setting's standing at some of the places.
TuneStanding standing_at(const std::vector<TuneAnswer>& answers, const std::vector<std::size_t>& places, TuneOver over) {
  std::vector<TuneAnswer> there;
  for (const std::size_t place : places) there.push_back(answers[place]);
  return standing(there, there.size(), over);
}

}  // namespace

TuneDecision decide(std::span<const TuneFinalist> finalists, TuneOver over) {
  std::vector<TuneStanding> standings;
  for (const TuneFinalist& finalist : finalists) standings.push_back(standing(finalist.answers, finalist.answers.size(), over));
  const std::vector<std::size_t> order = best_first(standings);
  const std::size_t best = order.front();
  TuneDecision decision{.answer = best, .runner_up = {}, .tied = {best}};
  std::vector<std::size_t> feasible;
  for (const std::size_t k : order)
    if (standings[k].keeps_limits()) feasible.push_back(k);
  const auto is_timed = [&](std::size_t k) { return !finalists[k].times.empty(); };
  std::vector<std::vector<Sample>> times;
  if (feasible.size() > 1 && std::ranges::all_of(feasible, is_timed)) {
    for (const std::size_t k : feasible) times.push_back(finalists[k].times);
    const std::vector<double> chances = chances_of_least(times, over, 0);
    for (std::size_t k = 1; k < feasible.size() && chances.front() < surely_least; ++k)
      if (chances[k] >= 1 - surely_least) decision.tied.push_back(feasible[k]);
  } else {
    for (std::size_t k = 1; k < feasible.size(); ++k)
      if (standings[feasible[k]].goal == standings[best].goal) decision.tied.push_back(feasible[k]);
  }
  decision.answer = *std::ranges::min_element(
      decision.tied, {}, [&](std::size_t k) { return std::pair(finalists[k].error, finalists[k].changes); });
  const auto other = std::ranges::find_if(order, [&](std::size_t k) { return k != decision.answer; });
  if (other != order.end()) decision.runner_up = *other;
  if (!times.empty())
    for (std::size_t k = 0; k < chance_margins.size(); ++k)
      decision.chances[k] = chances_of_least(times, over, chance_margins[k])[index_of(feasible, decision.answer)];
  return decision;
}

std::vector<SceneLeftOut> leave_scenes_out(std::span<const std::vector<TuneAnswer>> settings,
                                           std::span<const std::string> scenes, TuneOver over) {
  std::vector<std::string> different;
  for (const std::string& scene : scenes) add_once(different, scene);
  std::vector<SceneLeftOut> result;
  if (different.size() < 2 || settings.empty()) return result;
  for (const std::string& scene : different) {
    std::vector<std::size_t> here, elsewhere;
    for (std::size_t place = 0; place < scenes.size(); ++place) (scenes[place] == scene ? here : elsewhere).push_back(place);
    std::vector<TuneStanding> there, others;
    for (const std::vector<TuneAnswer>& answers : settings) {
      there.push_back(standing_at(answers, here, over));
      others.push_back(standing_at(answers, elsewhere, over));
    }
    const std::size_t chosen = best_first(others).front();
    result.push_back({scene, chosen, there[chosen], there[best_first(there).front()]});
  }
  return result;
}

std::vector<TuneEffect> tune_effects(const TuneSpace& space, const TuneSearch& search, const TuneSetting& answer,
                                     std::size_t places, TuneOver over) {
  const std::vector<TuneSetting> order = ranked(search, places, over);
  std::vector<TuneEffect> effects;
  for (std::size_t k = 0; k < space.parameters.size(); ++k) {
    const TuneSpace::Parameter& parameter = space.parameters[k];
    TuneEffect effect{.parameter = parameter.name, .values = {}, .chosen = answer[k], .condition = parameter.condition};
    effect.is_at_end = space.grid.parameters[k].is_ordered && parameter.values.size() > 1 &&
                       (answer[k] == 0 || answer[k] + 1 == parameter.values.size());
    for (std::size_t level = 0; level < parameter.values.size(); ++level) {
      TuneEffect::Value& value = effect.values.emplace_back(TuneEffect::Value{parameter.values[level], {}});
      const auto first = std::ranges::find_if(order, [&](const TuneSetting& setting) { return setting[k] == level; });
      if (first == order.end()) continue;
      std::vector<TuneAnswer> answers;
      for (const std::optional<TuneAnswer>& one : search.answers.at(*first)) answers.push_back(*one);
      value.best = standing(answers, places, over);
    }
    effects.push_back(std::move(effect));
  }
  return effects;
}

}  // namespace gnomon
