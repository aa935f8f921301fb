#include "analysis/tune_search.h"

#include <gnomon/kit/random.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace gnomon {

namespace {

/// Local steps begin at so many of the best settings: one start often ends where no step is better and the best is elsewhere.
constexpr std::size_t starts = 6;

/// The levels that one step leads to.
std::vector<std::size_t> next_levels(const TuneGrid::Parameter& parameter, std::size_t level) {
  std::vector<std::size_t> next;
  for (std::size_t other = 0; other < parameter.levels; ++other)
    if (other != level && (!parameter.is_ordered || other + 1 == level || other == level + 1)) next.push_back(other);
  return next;
}

/// The settings of the parameter `at` and of those that it controls.
double count_of(const TuneGrid& grid, std::size_t at) {
  double count = 0;
  for (std::size_t level = 0; level < grid.parameters[at].levels; ++level) {
    double product = 1;
    for (std::size_t k = at + 1; k < grid.parameters.size(); ++k) {
      const TuneGrid::Parameter& other = grid.parameters[k];
      if (other.controller == at && std::ranges::find(other.controller_levels, level) != other.controller_levels.end())
        product *= count_of(grid, k);
    }
    count += product;
  }
  return count;
}

class Search {
 public:
  Search(const TuneGrid& grid, const TuneSearchOptions& options, const TuneAsker& ask)
      : grid_(grid), options_(options), asker_(ask) {
    for (std::size_t place = 0; place < options.places; ++place) found_.hardest_first.push_back(place);
  }

  TuneSearch run() {
    const TuneSetting base = grid_.base();
    ask({base}, found_.hardest_first);
    order_places(base);
    if (options_.whole) {
      ask(grid_.all(), found_.hardest_first);
    } else {
      for (const TuneSetting& start : halved(first_settings())) descend(start);
    }
    return std::move(found_);
  }

 private:
  /// Asks what is not known of these. Afterwards `is_over_` where something could not be asked.
  void ask(const std::vector<TuneSetting>& settings, std::span<const std::size_t> places) {
    std::vector<TuneQuestion> questions;
    for (const std::size_t place : places)
      for (const TuneSetting& setting : settings) {
        std::vector<std::optional<TuneAnswer>>& row = found_.answers[setting];
        row.resize(options_.places);
        if (!row[place]) questions.push_back({setting, place});
      }
    if (!options_.whole && found_.asked + questions.size() > options_.most_asked) {
      questions.resize(options_.most_asked - std::min(found_.asked, options_.most_asked));
      is_over_ = true;
    }
    if (questions.empty()) return;
    const std::vector<std::optional<TuneAnswer>> answers = asker_(questions);
    for (std::size_t k = 0; k < questions.size(); ++k) {
      found_.answers[questions[k].setting][questions[k].place] = answers[k];
      found_.asked += answers[k].has_value();
      found_.is_cut_short = found_.is_cut_short || !answers[k];
    }
    is_over_ = is_over_ || found_.is_cut_short;
  }

  TuneStanding standing_of(const TuneSetting& setting, std::span<const std::size_t> places) {
    const std::vector<std::optional<TuneAnswer>>& row = found_.answers[setting];
    std::vector<TuneAnswer> known;
    for (const std::size_t place : places) known.push_back(row[place].value_or(TuneAnswer{.is_there = false}));
    return standing(known, options_.places, options_.over);
  }

  /// Places where the setting is nearest to a limit, or beyond, come first; then those with the greater goal.
  void order_places(const TuneSetting& base) {
    const auto hardness = [&](std::size_t place) {
      const TuneAnswer answer = found_.answers[base][place].value_or(TuneAnswer{});
      return std::pair(-answer.beyond, -answer.goal);
    };
    std::ranges::stable_sort(found_.hardest_first, {}, hardness);
  }

  /// The places in groups of 1, 1, 2, 4, ...: settings are dropped between them.
  std::vector<std::vector<std::size_t>> groups() const {
    const std::vector<std::size_t>& order = found_.hardest_first;
    std::vector<std::vector<std::size_t>> result;
    for (std::size_t at = 0; at < order.size();) {
      const std::size_t size = std::min(std::max<std::size_t>(at, 1), order.size() - at);
      result.emplace_back(order.begin() + static_cast<std::ptrdiff_t>(at),
                          order.begin() + static_cast<std::ptrdiff_t>(at + size));
      at += size;
    }
    return result;
  }

  /// As many as half of the evaluations allow: the base, each of its changes in one parameter, and places of a sequence of low
  /// discrepancy (Roberts 2018: multiples of the powers of 1/x, x^(d+1) = x + 1), which begins at a place of the seed.
  std::vector<TuneSetting> first_settings() const {
    double cost = 0, share = 1;
    for (const std::vector<std::size_t>& group : groups()) {
      cost += share * static_cast<double>(group.size());
      share /= 2;
    }
    const auto most = static_cast<std::size_t>(std::max(8.0, static_cast<double>(options_.most_asked) / 2 / cost));
    std::vector<TuneSetting> settings;
    std::set<TuneSetting> known;
    const auto add = [&](const TuneSetting& setting) {
      const bool is_new = known.insert(grid_.canonical(setting)).second;
      if (is_new) settings.push_back(grid_.canonical(setting));
      return is_new;
    };
    add(grid_.base());
    const std::vector<TuneGrid::Parameter>& parameters = grid_.parameters;
    std::vector<TuneSetting> single;
    for (std::size_t k = 0; k < parameters.size(); ++k)
      for (std::size_t level = 0; level < parameters[k].levels; ++level) {
        single.push_back(grid_.base());
        single.back()[k] = level;
      }
    if (single.size() <= most / 2) std::ranges::for_each(single, add);
    double root = 1.5;
    for (int k = 0; k < 60; ++k) root = std::pow(1 + root, 1 / (static_cast<double>(parameters.size()) + 1));
    Random random(options_.seed);
    std::vector<double> at(parameters.size());
    for (double& coordinate : at) coordinate = random.uniform(0, 1);
    for (int misses = 0; settings.size() < most && misses < 1000;) {
      TuneSetting setting(parameters.size());
      for (std::size_t k = 0; k < parameters.size(); ++k) {
        at[k] = std::fmod(at[k] + std::pow(root, -(static_cast<double>(k) + 1)), 1.0);
        setting[k] =
            std::min(static_cast<std::size_t>(at[k] * static_cast<double>(parameters[k].levels)), parameters[k].levels - 1);
      }
      misses = add(setting) ? 0 : misses + 1;
    }
    return settings;
  }

  /// The best few: after each group of places the worse half goes.
  std::vector<TuneSetting> halved(std::vector<TuneSetting> alive) {
    std::vector<std::size_t> so_far;
    for (const std::vector<std::size_t>& group : groups()) {
      ask(alive, group);
      so_far.insert(so_far.end(), group.begin(), group.end());
      std::map<TuneSetting, TuneStanding> standings;
      for (const TuneSetting& setting : alive) standings.emplace(setting, standing_of(setting, so_far));
      std::ranges::stable_sort(
          alive, [&](const TuneSetting& a, const TuneSetting& b) { return is_better(standings.at(a), standings.at(b)); });
      const bool is_last = so_far.size() == options_.places;
      const std::size_t kept = is_last ? starts : std::max(starts, (alive.size() + 1) / 2);
      alive.resize(std::min(alive.size(), kept));
    }
    return alive;
  }

  /// The best of these that is better than `center`, asked place by place for as long as it may be.
  std::optional<TuneSetting> better_one(std::vector<TuneSetting> alive, const TuneSetting& center) {
    const TuneStanding mark = standing_of(center, found_.hardest_first);
    std::vector<std::size_t> so_far;
    for (const std::vector<std::size_t>& group : groups()) {
      if (is_over_ || alive.empty()) return std::nullopt;
      ask(alive, group);
      so_far.insert(so_far.end(), group.begin(), group.end());
      std::erase_if(alive, [&](const TuneSetting& setting) {
        const TuneStanding least = standing_of(setting, so_far);
        return least.beyond > std::max(mark.beyond, 0.0) || (mark.keeps_limits() && least.goal > mark.goal);
      });
    }
    const auto best = std::ranges::min_element(alive, [&](const TuneSetting& a, const TuneSetting& b) {
      return is_better(standing_of(a, found_.hardest_first), standing_of(b, found_.hardest_first));
    });
    if (best == alive.end() || !is_better(standing_of(*best, found_.hardest_first), mark)) return std::nullopt;
    return *best;
  }

  void descend(TuneSetting center) {
    while (!is_over_) {
      std::optional<TuneSetting> next = better_one(grid_.steps(center, 1), center);
      // Along a limit no single step is better: one parameter breaks it, the other alone costs.
      if (!next) next = better_one(grid_.steps(center, 2), center);
      if (!next) return;
      center = std::move(*next);
    }
  }

  const TuneGrid& grid_;
  const TuneSearchOptions& options_;
  const TuneAsker& asker_;
  TuneSearch found_;
  bool is_over_ = false;
};

}  // namespace

TuneSetting TuneGrid::base() const {
  TuneSetting setting;
  for (const Parameter& parameter : parameters) setting.push_back(parameter.base);
  return setting;
}

bool TuneGrid::has_effect(std::size_t parameter, const TuneSetting& setting) const {
  const Parameter& one = parameters[parameter];
  if (!one.controller) return true;
  const std::vector<std::size_t>& levels = one.controller_levels;
  return has_effect(*one.controller, setting) && std::ranges::find(levels, setting[*one.controller]) != levels.end();
}

TuneSetting TuneGrid::canonical(TuneSetting setting) const {
  for (std::size_t k = 0; k < parameters.size(); ++k)  // controllers come first
    if (!has_effect(k, setting)) setting[k] = parameters[k].base;
  return setting;
}

double TuneGrid::count() const {
  double count = 1;
  for (std::size_t k = 0; k < parameters.size(); ++k)
    if (!parameters[k].controller) count *= count_of(*this, k);
  return count;
}

double TuneGrid::raw_count() const {
  double count = 1;
  for (const Parameter& parameter : parameters) count *= static_cast<double>(parameter.levels);
  return count;
}

std::vector<TuneSetting> TuneGrid::all() const {
  std::vector<TuneSetting> settings{base()};
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    std::vector<TuneSetting> longer;
    for (const TuneSetting& begin : settings)
      for (std::size_t level = 0; level < parameters[k].levels; ++level) {
        if (level != parameters[k].base && !has_effect(k, begin)) continue;
        longer.push_back(begin);
        longer.back()[k] = level;
      }
    settings = std::move(longer);
  }
  return settings;
}

std::vector<TuneSetting> TuneGrid::steps(const TuneSetting& from, int count) const {
  std::set<TuneSetting> found;
  const auto add_steps = [&](const TuneSetting& of, std::size_t first, const auto& take) {
    for (std::size_t k = first; k < parameters.size(); ++k)
      for (const std::size_t level : next_levels(parameters[k], of[k])) {
        TuneSetting next = of;
        next[k] = level;
        take(next, k + 1);
      }
  };
  add_steps(from, 0, [&](const TuneSetting& one, std::size_t behind) {
    if (count == 1)
      found.insert(canonical(one));
    else
      add_steps(one, behind, [&](const TuneSetting& two, std::size_t) { found.insert(canonical(two)); });
  });
  found.erase(canonical(from));
  return {found.begin(), found.end()};
}

TuneStanding standing(std::span<const TuneAnswer> answers, std::size_t places, TuneOver over) {
  TuneStanding result;
  double gain = 0;
  for (const TuneAnswer& answer : answers) {
    result.beyond = std::max(result.beyond, answer.is_there ? answer.beyond : INFINITY);
    result.goal =
        over == TuneOver::worst ? std::max(result.goal, answer.goal) : result.goal + answer.goal / static_cast<double>(places);
    gain += answer.gain;
  }
  if (answers.size() == places && gain <= 0) result.beyond = std::max(result.beyond, 1.0);
  return result;
}

bool is_better(const TuneStanding& a, const TuneStanding& b) {
  if (a.keeps_limits() != b.keeps_limits()) return a.keeps_limits();
  if (!a.keeps_limits()) return a.beyond < b.beyond;
  return a.goal != b.goal ? a.goal < b.goal : a.beyond < b.beyond;
}

TuneSearch search_grid(const TuneGrid& grid, const TuneSearchOptions& options, const TuneAsker& ask) {
  return Search(grid, options, ask).run();
}

std::vector<TuneSetting> ranked(const TuneSearch& search, std::size_t places, TuneOver over) {
  std::vector<std::pair<TuneStanding, TuneSetting>> complete;
  for (const auto& [setting, row] : search.answers) {
    std::vector<TuneAnswer> answers;
    for (const std::optional<TuneAnswer>& answer : row)
      if (answer && answer->is_there) answers.push_back(*answer);
    if (answers.size() == places) complete.emplace_back(standing(answers, places, over), setting);
  }
  std::ranges::stable_sort(complete, [](const auto& a, const auto& b) { return is_better(a.first, b.first); });
  std::vector<TuneSetting> settings;
  for (auto& [standing, setting] : complete) settings.push_back(std::move(setting));
  return settings;
}

}  // namespace gnomon
