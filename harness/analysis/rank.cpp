#include "analysis/rank.h"

#include <cmath>

#include "analysis/missing_places.h"
#include "measure/statistics/distributions.h"
#include "measure/statistics/sign_flip.h"

namespace gnomon {

namespace {

constexpr double most_false_pairs = 0.05;

/// A setting and its rows, one for each place of the kind of light; nullptr where it has none.
struct Competitor {
  std::string setting;
  std::vector<const Record*> rows;
  bool may_be_best = true;
  double standing = INFINITY;  ///< mean over the others of its errors relative to theirs; below 0 where they are better
};

using Numbers = std::vector<std::optional<double>>;  ///< one for each place

/// (a - b) / (|a| + |b|): from -1 to 1 on any scale, 0 where both are 0.
double relative_difference(double a, double b) {
  const double size = std::abs(a) + std::abs(b);
  return size > 0 ? (a - b) / size : 0;
}

/// Of two numbers with this relative difference.
double ratio_of(double relative) { return relative < 1 ? (1 + relative) / (1 - relative) : INFINITY; }

/// The error of a row, or its cost. An error below its floor counts as the floor.
std::optional<double> value_of(const Record& record, std::optional<Cost> cost, const std::string& error) {
  if (!cost) {
    const std::optional<double> value = quantity(record, error), floor = noise_floor(record, error);
    return value && floor ? std::max(value, floor) : value;
  }
  if (*cost == Cost::bytes) return quantity(record, "bytes");
  const Sample sample = sample_of(record, parts_of(*cost));
  return sample.is_timed() ? std::optional(std::max(sample.value(), least_time)) : std::nullopt;
}

std::vector<Numbers> numbers_of(const std::vector<Competitor>& competitors, std::optional<Cost> cost,
                                const std::string& error) {
  std::vector<Numbers> all;
  for (const Competitor& competitor : competitors) {
    Numbers& values = all.emplace_back();
    for (const Record* row : competitor.rows) values.push_back(row ? value_of(*row, cost, error) : std::nullopt);
  }
  return all;
}

/// What `of` says of both values at each place that both have.
template <class Of>
std::vector<double> differences_of(const Numbers& a, const Numbers& b, const Of& of) {
  std::vector<double> differences;
  for (std::size_t k = 0; k < a.size(); ++k)
    if (a[k] && b[k]) differences.push_back(of(*a[k], *b[k]));
  return differences;
}

/// Whether its mean error is below that of the best constant masks, or a record does not say.
bool beats_constants(const Competitor& competitor) {
  double sum = 0;
  for (const Record* row : competitor.rows) {
    const std::optional<double> gain = row ? gain_over_constant(*row) : 0;
    if (!gain) return true;
    sum += *gain;
  }
  return sum > 0;
}

/// The best first.
std::vector<Competitor> competitors_of(const RowsBySetting& settings, std::span<const Place> places, const std::string& error) {
  std::vector<Competitor> competitors;
  for (const auto& [key, rows] : settings) {
    Competitor& competitor = competitors.emplace_back(Competitor{.setting = setting_name(*rows.begin()->second), .rows = {}});
    for (const Place& place : places) {
      const auto found = rows.find(place);
      competitor.rows.push_back(found == rows.end() ? nullptr : found->second);
    }
    competitor.may_be_best = beats_constants(competitor);
  }
  const std::vector<Numbers> errors = numbers_of(competitors, {}, error);
  const double sign = better(error) == "higher" ? -1 : 1;
  for (std::size_t k = 0; k < competitors.size(); ++k) {
    std::vector<double> means;
    for (std::size_t other = 0; other < competitors.size(); ++other) {
      if (other == k) continue;
      const std::vector<double> differences = differences_of(errors[k], errors[other], relative_difference);
      if (!differences.empty()) means.push_back(sign * mean_of(differences).value);
    }
    if (!means.empty()) competitors[k].standing = mean_of(means).value;
  }
  std::ranges::stable_sort(competitors, {}, [](const Competitor& c) { return std::pair(!c.may_be_best, c.standing); });
  return competitors;
}

/// How far the first of a pair is from the second.
struct Effect {
  double difference = 0;
  ValueWithInterval ratio;
  double p = 1;
  std::size_t drawn = 0;
};

Effect effect_of_flips(std::span<const double> differences, std::size_t flips) {
  const SignFlips test = flip_signs(differences, flips);
  const double ratio = ratio_of(test.mean);
  const auto with_interval = [&] { return ValueWithInterval(ratio, ratio_of(test.center->low), ratio_of(test.center->high)); };
  return {test.mean, test.center ? with_interval() : ValueWithInterval(ratio), test.p, test.drawn};
}

Effect effect_of_times(std::span<const double> log_ratios) {
  const LogTime mean = mean_of(log_ratios);
  if (log_ratios.size() < 2) return {.difference = mean.value, .ratio = ValueWithInterval(std::exp(mean.value))};
  const double deviation = std::sqrt(mean.variance), half = student_quantile(0.025, mean.freedom) * deviation;
  const ValueWithInterval ratio(std::exp(mean.value), std::exp(mean.value - half), std::exp(mean.value + half));
  const double p = deviation > 0 ? 2 * student_tail(std::abs(mean.value) / deviation, mean.freedom) : mean.value == 0 ? 1 : 0;
  return {mean.value, ratio, p, 0};
}

/// How many places it takes until the flip of all signs alone, one of two in 2^n, calls one of so many differences.
std::size_t least_flipped(std::size_t tests) {
  std::size_t places = 1;
  while (std::ldexp(static_cast<double>(tests), 1 - static_cast<int>(places)) > most_false_pairs) ++places;
  return places;
}

bool is_cost(std::string_view error) { return !parts_of_time(error).empty() || error == "bytes" || error == "peak_bytes"; }

/// The pair with the places that it shares and those that only one of it has.
RankedPair pair_of(const Competitor& first, const Competitor& second, const Numbers& a, const Numbers& b,
                   std::span<const Place> places) {
  RankedPair pair{.first = first.setting, .second = second.setting};
  std::set<std::string> scenes;
  for (std::size_t k = 0; k < places.size(); ++k) {
    if (a[k].has_value() != b[k].has_value()) pair.left_out.push_back(places[k]);
    if (!a[k] || !b[k]) continue;
    ++pair.places;
    scenes.insert(places[k].scene);
  }
  pair.scenes = scenes.size();
  return pair;
}

Ranking rank_by(std::optional<Cost> cost, const std::vector<Competitor>& competitors, std::span<const Place> places,
                const RankOptions& options) {
  const bool is_time = cost && *cost != Cost::bytes;
  const std::vector<Numbers> values = numbers_of(competitors, cost, options.error);
  const std::size_t count = competitors.size(), all_pairs = count * (count - 1) / 2;
  Ranking ranking{.cost = cost};
  // The best of many equal ones is the best by chance, and then differs from some by more than two equal ones do.
  const bool is_chosen_by_it = !cost || is_cost(options.error);
  ranking.tests = options.all_pairs || is_chosen_by_it ? all_pairs : count - 1;
  if (!is_time) ranking.needed_places = least_flipped(ranking.tests);
  const auto flips = static_cast<std::size_t>(2 / most_false_pairs) * ranking.tests;  // the least p calls one of the tests

  std::vector<double> differences, p_values;
  for (std::size_t i = 0; i < (options.all_pairs ? count : 1); ++i)
    for (std::size_t j = i + 1; j < count; ++j) {
      RankedPair& pair = ranking.pairs.emplace_back(pair_of(competitors[i], competitors[j], values[i], values[j], places));
      Effect effect;
      if (is_time)
        effect = effect_of_times(differences_of(values[i], values[j], [](double a, double b) { return std::log(a / b); }));
      else
        effect = effect_of_flips(differences_of(values[i], values[j], relative_difference), std::max(flips, usual_flips));
      if (pair.places > 0) pair.ratio = effect.ratio;
      pair.p = effect.p;
      ranking.drawn = std::max(ranking.drawn, effect.drawn);
      differences.push_back(effect.difference);
      p_values.push_back(effect.p);
    }
  const std::vector<double> rates = family_rates(p_values, ranking.tests);
  const bool is_higher_better = !cost && better(options.error) == "higher";
  for (std::size_t k = 0; k < rates.size(); ++k) {
    RankedPair& pair = ranking.pairs[k];
    pair.family_rate = rates[k];
    if (rates[k] <= most_false_pairs)
      pair.verdict = (differences[k] > 0) == is_higher_better ? PairVerdict::better : PairVerdict::worse;
    else if (pair.places < ranking.needed_places)
      pair.verdict = PairVerdict::too_few;
  }
  return ranking;
}

/// The rankings of one kind of light; none where no two share a place.
std::vector<Ranking> ranks_of(std::span<const Record> records, const RowsBySetting& settings, const RankOptions& options) {
  std::vector<Place> places;
  for (const auto& [key, rows] : settings)
    for (const auto& [place, row] : rows) add_once(places, place);
  const std::vector<Competitor> competitors = competitors_of(settings, places, options.error);
  std::vector<std::optional<Cost>> wanted{std::nullopt};
  if (options.cost)
    wanted.push_back(options.cost);
  else
    wanted.insert(wanted.end(), {Cost::resolve, Cost::light, Cost::geometry, Cost::motion, Cost::bytes});
  std::vector<Ranking> rankings;
  for (const std::optional<Cost> cost : wanted) {
    Ranking ranking = rank_by(cost, competitors, places, options);
    if (std::ranges::any_of(ranking.pairs, [](const RankedPair& pair) { return pair.places > 0; }))
      rankings.push_back(std::move(ranking));
  }
  if (rankings.empty()) return rankings;
  std::vector<std::string>& notes = rankings.front().notes;
  notes = missing_places(records, settings, places, "left out of pairs");
  for (const Competitor& competitor : competitors)
    if (!competitor.may_be_best) notes.push_back(fmt::format("{} does not beat the best constant mask", competitor.setting));
  return rankings;
}

}  // namespace

std::string_view name(PairVerdict verdict) {
  static constexpr std::string_view names[] = {"better", "worse", "not told apart", "too few places"};
  return names[static_cast<int>(verdict)];
}

std::vector<Ranking> find_ranks(std::span<const Record> records, const RankOptions& options) {
  require_quantity(records, options.error);
  if (better(options.error).empty()) throw Error("{} has no better side: rank cannot compare by it", options.error);
  std::vector<Ranking> all;
  for (const AnswerKind of : all_answer_kinds) {
    const auto competes = [&](const Record& r) {
      return r.role == Role::contender && r.answer == of && quantity(r, options.error).has_value();
    };
    const RowsBySetting settings = rows_by_setting(records, competes);
    if (settings.size() < 2) continue;
    for (Ranking& ranking : ranks_of(records, settings, options)) {
      ranking.answer = of;
      all.push_back(std::move(ranking));
    }
  }
  if (options.cost && std::ranges::none_of(all, [](const Ranking& ranking) { return ranking.cost.has_value(); }))
    throw Error("there is nothing to rank by {}: no two contenders have that cost at one place", name(*options.cost));
  return all;
}

}  // namespace gnomon
