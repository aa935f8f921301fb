// The best contender within a budget of time, memory or error.
#include <cmath>
#include <limits>

#include "analysis/front.h"

namespace gnomon {

namespace {

/// 1, 2, 5, 10, ... x 10^k within a factor of 2.5 of both ends, so that the first budget shuts out a contender and the last one
/// admits all.
std::vector<double> round_numbers(double least, double greatest, std::size_t most) {
  std::vector<double> numbers;
  if (!(least > 0 && least <= greatest) || !std::isfinite(greatest)) return numbers;  // nothing above 0: there is no least
  constexpr int greatest_power = std::numeric_limits<double>::max_exponent10;
  for (int k = static_cast<int>(std::floor(std::log10(least))); k <= greatest_power && std::pow(10, k) <= greatest * 10; ++k)
    for (const double digit : {1.0, 2.0, 5.0}) {
      // Exact powers of ten, also below 1: 2 x 10^-1 is 2 / 10, which is the double that 0.2 reads as.
      const double number = k < 0 ? digit / std::pow(10, -k) : digit * std::pow(10, k);
      const bool covers_all = !numbers.empty() && numbers.back() >= greatest;
      if (number >= least && std::isfinite(number) && !covers_all) numbers.push_back(number);
    }
  while (numbers.size() > most) {
    // Every other one goes, the last stays.
    std::vector<double> kept;
    for (std::size_t i = (numbers.size() - 1) % 2; i < numbers.size(); i += 2) kept.push_back(numbers[i]);
    numbers = std::move(kept);
  }
  return numbers;
}

/// Of those who meet a budget of error, those whose time is not told apart from the winner's.
void keep_not_told_apart(const std::vector<Candidate>& all, Best& best) {
  std::vector<Contrast> contrasts;
  for (const std::size_t k : best.also)
    if (all[k].log_time && all[*best.winner].log_time)
      contrasts.push_back({*all[k].log_time, *all[*best.winner].log_time, best.also.size() + 1});
  const std::vector<bool> told = told_apart(contrasts);
  std::size_t next = 0;
  std::erase_if(best.also, [&](std::size_t k) { return all[k].log_time && all[*best.winner].log_time && told[next++]; });
}

}  // namespace

Budgets round_budgets(std::span<const Field> fields, std::size_t most) {
  struct Range {
    double least = INFINITY, greatest = 0;
    void add(double value) {
      if (value <= 0) return;
      least = std::min(least, value);
      greatest = std::max(greatest, value);
    }
  };
  Range times, memories, errors;
  for (const Field& field : fields)
    for (const Candidate& c : field.candidates) {
      if (!c.may_be_best()) continue;
      if (c.time) times.add(c.time->value);
      if (c.bytes) memories.add(*c.bytes / (1024 * 1024));
      errors.add(c.error);
    }
  Budgets budgets{round_numbers(times.least, times.greatest, most), round_numbers(memories.least, memories.greatest, most),
                  round_numbers(errors.least, errors.greatest, most)};
  for (double& memory : budgets.memories) memory *= 1024 * 1024;
  return budgets;
}

std::vector<Best> find_best(const Field& field, const Budgets& budgets, std::string_view direction) {
  std::vector<Best> rows;
  const std::vector<Candidate>& all = field.candidates;
  // The winner among those that `keeps` allows, by `beats`; `ties` says who is as good.
  const auto choose = [&](std::string what, double budget, auto keeps, auto beats, auto ties) {
    Best best{.what = std::move(what), .budget = budget, .winner = {}, .also = {}};
    const auto competes = [&](const Candidate& c) { return c.may_be_best() && keeps(c); };
    for (std::size_t i = 0; i < all.size(); ++i)
      if (competes(all[i]) && (!best.winner || beats(all[i], all[*best.winner]))) best.winner = i;
    for (std::size_t i = 0; best.winner && i < all.size(); ++i)
      if (i != *best.winner && competes(all[i]) && ties(all[i], all[*best.winner])) best.also.push_back(i);
    rows.push_back(std::move(best));
  };
  const auto time_of = [](const Candidate& c) { return c.time ? c.time->value : INFINITY; };
  const auto lower_error = [&](const Candidate& a, const Candidate& b) {
    const double mine = a.ranked_error(), other = b.ranked_error();
    return mine != other ? is_better(direction, mine, other) : time_of(a) < time_of(b);
  };
  const auto same_error = [](const Candidate& a, const Candidate& b) { return a.ranked_error() == b.ranked_error(); };
  for (const double budget : budgets.times)
    choose(
        "time", budget, [&](const Candidate& c) { return time_of(c) <= budget; }, lower_error, same_error);
  for (const double budget : budgets.memories)
    choose(
        "memory", budget, [&](const Candidate& c) { return c.bytes && *c.bytes <= budget; }, lower_error, same_error);
  for (const double budget : budgets.errors) {
    choose(
        "error", budget, [&](const Candidate& c) { return c.time && !is_better(direction, budget, c.error); },
        [&](const Candidate& a, const Candidate& b) { return time_of(a) < time_of(b); },
        [](const Candidate& a, const Candidate& b) { return a.time->value == b.time->value || (a.log_time && b.log_time); });
    keep_not_told_apart(all, rows.back());
  }
  return rows;
}

}  // namespace gnomon
