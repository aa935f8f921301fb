#include "analysis/tune_search.h"

#include <gnomon/kit/random.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace tune_search_test {

using namespace gnomon;

/// Numbers of any setting at any place, and how often they were asked.
struct Asked {
  std::function<TuneAnswer(const TuneSetting&, std::size_t)> numbers;
  std::size_t count = 0;
  std::vector<std::optional<TuneAnswer>> operator()(std::span<const TuneQuestion> questions) {
    std::vector<std::optional<TuneAnswer>> answers;
    for (const TuneQuestion& question : questions) answers.emplace_back(numbers(question.setting, question.place));
    count += questions.size();
    return answers;
  }
};

TuneSearch search(const TuneGrid& grid, const TuneSearchOptions& options, Asked& asked) {
  return search_grid(grid, options, [&](std::span<const TuneQuestion> questions) { return asked(questions); });
}

TuneGrid grid_of(std::initializer_list<std::size_t> levels) {
  TuneGrid grid;
  for (const std::size_t count : levels) grid.parameters.push_back({.levels = count});
  return grid;
}

/// Bytes a = 1 .. 9, error (b - at)^2 + 1/a: what is least is known on paper.
struct Known {
  TuneGrid grid = grid_of({9, 9});
  static double error(const TuneSetting& s, std::size_t place) {
    const double a = 1 + static_cast<double>(s[0]), b = static_cast<double>(s[1]) - (place == 0 ? 3 : 5);
    return b * b + 1 / a;
  }
};

TEST(tune_search, the_least_error_is_in_the_valley_with_most_bytes) {
  Asked asked{[](const TuneSetting& s, std::size_t place) { return TuneAnswer{.goal = Known::error(s, place)}; }};
  const TuneSearch found = search(Known().grid, {.places = 1}, asked);
  EXPECT_EQ(asked.count, 81u);
  EXPECT_EQ(found.asked, 81u);
  EXPECT_EQ(ranked(found, 1, TuneOver::worst).front(), (TuneSetting{8, 3}));
}

TEST(tune_search, the_fewest_bytes_keep_the_limit_just) {
  // Error at most 0.3 needs b = 3 and 1/a <= 0.3, so a = 4, level 3.
  Asked asked{[](const TuneSetting& s, std::size_t place) {
    return TuneAnswer{.goal = 1 + static_cast<double>(s[0]), .beyond = Known::error(s, place) / 0.3 - 1};
  }};
  const TuneSearch found = search(Known().grid, {.places = 1}, asked);
  EXPECT_EQ(ranked(found, 1, TuneOver::worst).front(), (TuneSetting{3, 3}));
}

TEST(tune_search, mean_and_worst_are_least_elsewhere_where_places_differ) {
  // Four places like the first and one like the second: the mean of (b - 3)^2 and (b - 5)^2 is 0.8 at b = 3 and 1 at b = 4, the
  // worst 4 and 1.
  Asked asked{[](const TuneSetting& s, std::size_t place) { return TuneAnswer{.goal = Known::error(s, place == 4 ? 1 : 0)}; }};
  const TuneSearch worst = search(Known().grid, {.places = 5}, asked);
  EXPECT_EQ(ranked(worst, 5, TuneOver::worst).front(), (TuneSetting{8, 4}));
  EXPECT_EQ(ranked(worst, 5, TuneOver::mean).front(), (TuneSetting{8, 3}));
}

TEST(tune_search, where_no_setting_keeps_the_limit_the_nearest_miss_is_first) {
  Asked asked{[](const TuneSetting& s, std::size_t place) {
    return TuneAnswer{.goal = 1 + static_cast<double>(s[0]), .beyond = Known::error(s, place) / 0.01 - 1};
  }};
  const TuneSearch found = search(Known().grid, {.places = 1}, asked);
  EXPECT_EQ(ranked(found, 1, TuneOver::worst).front(), (TuneSetting{8, 3}));  // 1/9 is the least error
}

TEST(tune_search, a_setting_without_an_answer_at_one_place_is_out) {
  Asked asked{[](const TuneSetting& s, std::size_t place) {
    return TuneAnswer{.is_there = !(place == 1 && s == TuneSetting{8, 3}), .goal = Known::error(s, 0)};
  }};
  const TuneSearch found = search(Known().grid, {.places = 2}, asked);
  const std::vector<TuneSetting> order = ranked(found, 2, TuneOver::worst);
  EXPECT_EQ(order.size(), 80u);
  EXPECT_EQ(order.front(), (TuneSetting{7, 3}));
}

TEST(tune_search, who_does_not_beat_a_constant_mask_keeps_no_limit) {
  const TuneAnswer answers[] = {{.goal = 1, .gain = 0.1}, {.goal = 1, .gain = -0.2}};
  EXPECT_FALSE(standing(answers, 2, TuneOver::worst).keeps_limits());
  EXPECT_TRUE(standing({answers, 1}, 1, TuneOver::worst).keeps_limits());
}

TEST(tune_search, parameters_without_effect_are_at_their_base) {
  // b counts where a is 1; c where b is 0. Of 3 x 4 x 2: a = 0 and a = 2 one each, a = 1: b = 0 with both c, and three b.
  TuneGrid grid;
  grid.parameters = {{.levels = 3},
                     {.levels = 4, .base = 2, .controller = 0, .controller_levels = {1}},
                     {.levels = 2, .base = 1, .controller = 1, .controller_levels = {0}}};
  EXPECT_EQ(grid.canonical({0, 3, 0}), (TuneSetting{0, 2, 1}));
  EXPECT_EQ(grid.canonical({1, 0, 0}), (TuneSetting{1, 0, 0}));
  EXPECT_EQ(grid.count(), 7);
  EXPECT_EQ(grid.raw_count(), 24);
  const std::vector<TuneSetting> all = grid.all();
  EXPECT_EQ(all.size(), 7u);
  EXPECT_EQ(std::set(all.begin(), all.end()).size(), 7u);
  // From {1, 1, 1}: a to 0 and to 2, b to 0 and to 2; c has no effect.
  EXPECT_EQ(grid.steps({1, 1, 1}, 1).size(), 4u);
}

TEST(tune_search, an_asker_without_time_ends_the_search) {
  std::size_t left = 100;
  const TuneAsker ask = [&](std::span<const TuneQuestion> questions) {
    std::vector<std::optional<TuneAnswer>> answers;
    for (const TuneQuestion& question : questions) {
      std::optional<TuneAnswer>& answer = answers.emplace_back();
      if (left == 0) continue;
      answer = TuneAnswer{.goal = Known::error(question.setting, 0)};
      --left;
    }
    return answers;
  };
  const TuneSearch found = search_grid(Known().grid, {.places = 2}, ask);
  EXPECT_TRUE(found.is_cut_short);
  EXPECT_EQ(found.asked, 100u);
  EXPECT_FALSE(ranked(found, 2, TuneOver::worst).empty());
}

/// A technique like a shadow map: resolution, two biases, a filter's kind and its radius. Errors fall as a power of the
/// resolution; too little bias makes acne, too much lifts shadows, and how much is right depends on filter and place; time is
/// that of texels and taps. Places differ tenfold.
struct Synthetic {
  struct Place {
    double edge, power, need, slope, weight;
  };
  std::vector<Place> places;
  TuneGrid grid;
  TuneOver over = TuneOver::worst;
  int kind = 0;  ///< least error; least time, least bytes within an error; least error within time and bytes

  explicit Synthetic(int number) : kind(number % 4) {
    Random random(100 + static_cast<std::uint64_t>(number));
    constexpr std::size_t counts[] = {2, 3, 4, 6, 8, 12};
    for (std::size_t k = 0; k < counts[number % 6]; ++k) {
      Place& p = places.emplace_back();
      p.edge = random.uniform(0.5, 3);
      p.power = random.uniform(0.7, 1.2);
      p.need = random.uniform(0.4, 1.6);
      p.slope = random.uniform(0.3, 2);
      p.weight = random.uniform(0.3, 3);
    }
    grid = places.size() < 8 ? grid_of({8, 9, 7, 4, 3}) : grid_of({6, 7, 5, 3, 2});
    grid.parameters[0].base = places.size() < 8 ? 4 : 2;
    grid.parameters[1].base = 3;
    grid.parameters[2].base = 2;
    grid.parameters[4].is_ordered = false;
    if (number % 3 == 0) over = TuneOver::mean;
  }
  double count() const { return grid.count() * static_cast<double>(places.size()); }

  TuneAnswer operator()(const TuneSetting& s, std::size_t place) const {
    const Place& p = places[place];
    const auto doubled = [](double first, std::size_t level) {
      return level == 0 ? 0 : first * std::pow(2, static_cast<double>(level) - 1);
    };
    const double coarse = std::pow(2, 4 - static_cast<double>(s[0])), bias = doubled(0.0625, s[1]), slope = doubled(0.25, s[2]);
    const double radius = 1 + static_cast<double>(s[3]), filter = static_cast<double>(s[4]);
    const double smooth = filter == 0   ? 1
                          : filter == 1 ? 0.7 + 0.1 * std::pow(radius - 2, 2)
                                        : 0.8 + 0.05 * std::pow(radius - 3, 2);
    const double need = p.need * (filter > 0 ? 1 + 0.4 * radius : 1);
    const double error = 0.004 * p.edge * std::pow(coarse, p.power) * smooth +
                         0.3 * std::exp(-4 * (bias + p.slope * slope) / need) + 0.002 * p.weight * (bias + slope / 2) * coarse;
    const double taps = filter == 0 ? 1 : std::pow(2 * radius + 1, 2) * (filter == 1 ? 1 : 0.6);
    const double ms = 0.5 + 0.6 * p.weight / (coarse * coarse) + 0.05 * taps * (1 + 0.1 * p.edge) + 0.02 * slope;
    const double mebibytes = 4 / (coarse * coarse);
    if (kind == 0) return {.goal = error};
    if (kind == 1) return {.goal = ms, .beyond = error / 0.01 - 1};
    if (kind == 2) return {.goal = mebibytes, .beyond = error / 0.02 - 1};
    return {.goal = error, .beyond = std::max(ms / 4, mebibytes / 16) - 1};
  }
  TuneStanding best() const {
    std::optional<TuneStanding> best;
    for (const TuneSetting& setting : grid.all()) {
      std::vector<TuneAnswer> answers;
      for (std::size_t place = 0; place < places.size(); ++place) answers.push_back((*this)(setting, place));
      const TuneStanding one = standing(answers, places.size(), over);
      if (!best || is_better(one, *best)) best = one;
    }
    return *best;
  }
};

TEST(tune_search, a_fifth_of_a_large_grid_finds_what_the_whole_one_has) {
  int near = 0;
  for (int number = 0; number < 12; ++number) {
    const Synthetic synthetic(number);
    ASSERT_GT(synthetic.count(), 2000) << number;
    Asked asked{[&](const TuneSetting& s, std::size_t place) { return synthetic(s, place); }};
    const std::size_t places = synthetic.places.size();
    const auto most = static_cast<std::size_t>(std::min(2000.0, synthetic.count() / 5));
    const TuneSearch found =
        search(synthetic.grid, {.places = places, .over = synthetic.over, .whole = false, .most_asked = most}, asked);
    EXPECT_LE(asked.count, most) << number;
    EXPECT_EQ(asked.count, found.asked) << number;
    const std::vector<TuneSetting> order = ranked(found, places, synthetic.over);
    ASSERT_FALSE(order.empty()) << number;
    std::vector<TuneAnswer> answers;
    for (std::size_t place = 0; place < places; ++place) answers.push_back(synthetic(order.front(), place));
    const TuneStanding mine = standing(answers, places, synthetic.over), best = synthetic.best();
    near += best.keeps_limits() ? mine.keeps_limits() && mine.goal <= 1.05 * best.goal : mine.beyond <= 1.05 * best.beyond;
  }
  EXPECT_GE(near, 11);
}

TEST(tune_search, the_same_seed_asks_the_same) {
  const Synthetic synthetic(2);
  std::vector<std::vector<TuneSetting>> orders;
  for (const std::uint64_t seed : {7u, 7u, 8u}) {
    Asked asked{[&](const TuneSetting& s, std::size_t place) { return synthetic(s, place); }};
    const TuneSearch found = search(synthetic.grid, {.places = 4, .whole = false, .most_asked = 800, .seed = seed}, asked);
    orders.push_back(ranked(found, 4, synthetic.over));
  }
  EXPECT_EQ(orders[0], orders[1]);
  EXPECT_NE(orders[0], orders[2]);
}

}  // namespace tune_search_test
