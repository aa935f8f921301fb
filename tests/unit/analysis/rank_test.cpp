#include "analysis/rank.h"

#include <gtest/gtest.h>

#include "analysis_rows.h"
#include "measure/statistics/sign_flip.h"
#include "report/analysis/analysis_table.h"

namespace rank_test {

using namespace analysis_rows;

/// Two settings in so many scenes, the second with `factor` times the error and the cost of the first.
std::vector<Record> pair_of(int places, double factor, double error = 0.01) {
  std::vector<Record> records;
  for (int k = 0; k < places; ++k)
    for (const auto& [setting, times] : {std::pair("a", 1.0), {"b", factor}})
      records.push_back(row(setting, 2 * times, 3 * times, error * times, fmt::format("scene{}", k)));
  return records;
}

const Ranking& by(const std::vector<Ranking>& all, std::optional<Cost> cost) {
  const auto found = std::ranges::find(all, cost, &Ranking::cost);
  EXPECT_TRUE(found != all.end());
  return *found;
}

TEST(rank, fewer_than_six_places_call_no_difference_of_one_pair) {
  const std::vector<Ranking> few = find_ranks(pair_of(5, 2), {});
  const RankedPair& short_of = few.front().pairs.front();
  EXPECT_EQ(few.front().needed_places, 6u);
  EXPECT_EQ(short_of.verdict, PairVerdict::too_few);
  EXPECT_EQ(short_of.p, 2.0 / 32);
  EXPECT_FALSE(short_of.ratio->has_interval);
  const std::vector<Ranking> enough = find_ranks(pair_of(6, 2), {});
  const RankedPair& called = enough.front().pairs.front();
  EXPECT_EQ(called.first, "a");
  EXPECT_EQ(called.verdict, PairVerdict::better);
  EXPECT_EQ(called.p, 2.0 / 64);
  EXPECT_EQ(called.places, 6u);
  EXPECT_EQ(called.scenes, 6u);
  // a has half the error of b at every place: (1 - 2) / (1 + 2) = -1/3, and (1 - 1/3) / (1 + 1/3) = 1/2.
  EXPECT_NEAR(called.ratio->value, 0.5, 1e-12);
  EXPECT_NEAR(called.ratio->low, 0.5, 1e-12);
  EXPECT_NEAR(called.ratio->high, 0.5, 1e-12);
}

TEST(rank, places_count_alike_whatever_their_scale) {
  // a errs half as much as b in eleven places, and three times as much in the one whose errors are a hundred times larger: by
  // the mean over places a would be worse. Relative differences are -1/3 eleven times and 1/2 once. Their sum is -19/6; with j
  // of the eleven turned around, sums as far from 0 are those of j = 0 with either sign of the twelfth, and of j = 1 with the
  // twelfth at -1/2: 1 + 1 + 11 of 4096, and as many on the other side.
  std::vector<Record> records = pair_of(12, 2, 0.001);
  records[22].metrics[Truth::shape]["error"] = 0.3;
  records[23].metrics[Truth::shape]["error"] = 0.1;
  const std::vector<Ranking> ranks = find_ranks(records, {});
  const RankedPair& pair = ranks.front().pairs.front();
  EXPECT_EQ(pair.first, "a");
  EXPECT_NEAR(pair.p, 26.0 / 4096, 1e-12);
  EXPECT_EQ(pair.verdict, PairVerdict::better);
  const double mean = -19.0 / 72;
  EXPECT_NEAR(pair.ratio->value, (1 + mean) / (1 - mean), 1e-12);
}

TEST(rank, times_are_compared_by_the_logarithms_of_their_ratios) {
  // Ratios 1/2 and 1/8: the mean of the logarithms is -ln 4, its deviation ln 2, so t is -2 with one degree of freedom, and
  // P(|T| > 2) = 1 - 2 atan(2) / pi.
  const std::vector<Record> records{row("a", 1, 1, 0.1, "one"), row("b", 2, 2, 0.2, "one"), row("a", 1, 1, 0.1, "two"),
                                    row("b", 8, 8, 0.2, "two")};
  const std::vector<Ranking> ranks = find_ranks(records, {.cost = Cost::light});
  ASSERT_EQ(ranks.size(), 2u);
  const RankedPair& pair = ranks[1].pairs.front();
  EXPECT_NEAR(pair.ratio->value, 0.25, 1e-12);
  EXPECT_NEAR(pair.p, 1 - 2 * std::atan(2.0) / std::numbers::pi, 1e-9);
  EXPECT_EQ(pair.verdict, PairVerdict::not_told_apart);
  EXPECT_LT(pair.ratio->low, 0.001);
  EXPECT_GT(pair.ratio->high, 1);
  EXPECT_EQ(ranks[1].needed_places, 2u);
}

TEST(rank, each_cost_that_was_measured_is_compared) {
  std::vector<Record> records = pair_of(6, 2);
  for (Record& r : records) r.bytes = r.technique == "a" ? 0 : 100;
  const std::vector<Ranking> ranks = find_ranks(records, {});
  ASSERT_EQ(ranks.size(), 5u) << "error, resolve, light, geometry, bytes; nothing moves";
  EXPECT_EQ(by(ranks, Cost::resolve).pairs[0].verdict, PairVerdict::better);
  EXPECT_NEAR(by(ranks, Cost::light).pairs[0].ratio->value, 0.5, 1e-12);
  EXPECT_NEAR(by(ranks, Cost::geometry).pairs[0].ratio->value, 6.0 / 11, 1e-12);  // 1 + 5 to 1 + 10
  // Memory is compared as errors are: who holds nothing has 0 times what others hold.
  EXPECT_EQ(by(ranks, Cost::bytes).pairs[0].ratio->value, 0);
  EXPECT_EQ(by(ranks, Cost::bytes).pairs[0].verdict, PairVerdict::better);
}

TEST(rank, places_that_only_one_of_two_has_are_left_out_and_named) {
  std::vector<Record> records = pair_of(8, 2);
  records[1].status = Status::failed;
  records[1].reason = "it crashed";
  records.push_back(row("c", 1, 1, 0.5, "scene3"));
  const std::vector<Ranking> ranks = find_ranks(records, {});
  const std::vector<RankedPair>& pairs = ranks.front().pairs;
  ASSERT_EQ(pairs.size(), 2u);
  EXPECT_EQ(pairs[0].second, "b");
  EXPECT_EQ(pairs[0].places, 7u);
  ASSERT_EQ(pairs[0].left_out.size(), 1u);
  EXPECT_EQ(pairs[0].left_out[0].scene, "scene0");
  EXPECT_EQ(pairs[0].verdict, PairVerdict::better);  // 2/128 thrice
  EXPECT_EQ(pairs[1].places, 1u);
  EXPECT_EQ(pairs[1].left_out.size(), 7u);
  EXPECT_EQ(pairs[1].verdict, PairVerdict::too_few);
  ASSERT_FALSE(ranks.front().notes.empty());
  EXPECT_EQ(ranks.front().notes[0], "left out of pairs: scene0, point (b: failed, it crashed, and 1 more setting)");
}

TEST(rank, the_best_is_chosen_among_all_pairs_by_error_and_not_by_cost) {
  std::vector<Record> records;
  for (int place = 0; place < 8; ++place)
    for (int k = 1; k <= 4; ++k)
      records.push_back(row(fmt::format("m:k={}", k), k, k, 0.01 * k, fmt::format("scene{}", place)));
  const std::vector<Ranking> best = find_ranks(records, {.cost = Cost::light});
  EXPECT_EQ(best[0].pairs.size(), 3u);
  EXPECT_EQ(best[0].tests, 6u);
  EXPECT_EQ(best[1].tests, 3u);
  EXPECT_EQ(best[0].pairs[0].first, "m:k=1");
  EXPECT_EQ(best[0].pairs[0].second, "m:k=2");
  EXPECT_EQ(best[0].needed_places, 8u);  // 6 * 2/128 is 0.09, 6 * 2/256 is 0.047
  const std::vector<Ranking> all = find_ranks(records, {.cost = Cost::light, .all_pairs = true});
  EXPECT_EQ(all[0].pairs.size(), 6u);
  EXPECT_EQ(all[1].tests, 6u);
  EXPECT_EQ(find_ranks(records, {.error = "relight_ms", .cost = Cost::light})[1].tests, 6u) << "chosen by its times";
}

TEST(rank, errors_below_their_floor_are_alike) {
  std::vector<Record> records;
  for (int k = 0; k < 6; ++k) {
    records.push_back(soft_row("a", 1, 1, 0.0018, fmt::format("scene{}", k)));
    records.push_back(soft_row("b", 1, 1, 0.0001, fmt::format("scene{}", k)));
  }
  const std::vector<Ranking> ranks = find_ranks(records, {});
  EXPECT_EQ(ranks.front().answer, AnswerKind::fraction);
  EXPECT_EQ(ranks.front().pairs[0].ratio->value, 1);
  EXPECT_EQ(ranks.front().pairs[0].verdict, PairVerdict::not_told_apart);
}

TEST(rank, more_may_be_better) {
  std::vector<Record> records = pair_of(6, 2);
  for (Record& r : records) r.metrics[Truth::shape]["ssim"] = r.technique == "a" ? 0.8 : 0.9;
  const std::vector<Ranking> ranks = find_ranks(records, {.error = "ssim"});
  EXPECT_EQ(ranks.front().pairs[0].first, "b");
  EXPECT_GT(ranks.front().pairs[0].ratio->value, 1);
  EXPECT_EQ(ranks.front().pairs[0].verdict, PairVerdict::better);
}

TEST(rank, who_beats_no_constant_mask_is_not_the_best) {
  std::vector<Record> records;
  for (int k = 0; k < 6; ++k) {
    records.push_back(with_constant(row("a", 1, 1, 0.01, fmt::format("scene{}", k)), 0.005));
    records.push_back(with_constant(row("b", 1, 1, 0.02, fmt::format("scene{}", k)), 0.1));
  }
  const std::vector<Ranking> ranks = find_ranks(records, {});
  EXPECT_EQ(ranks.front().pairs[0].first, "b");
  EXPECT_EQ(ranks.front().pairs[0].verdict, PairVerdict::worse);
  EXPECT_EQ(ranks.front().notes, std::vector<std::string>{"a does not beat the best constant mask"});
}

TEST(rank, lights_of_each_kind_are_ranked_apart) {
  std::vector<Record> records = pair_of(6, 2);
  for (const char* setting : {"a", "b"}) records.push_back(soft_row(setting, 1, 1, 0.1));
  const std::vector<Ranking> ranks = find_ranks(records, {.cost = Cost::light});
  ASSERT_EQ(ranks.size(), 4u);
  EXPECT_EQ(ranks[1].answer, AnswerKind::binary);
  EXPECT_EQ(ranks[2].answer, AnswerKind::fraction);
  EXPECT_EQ(ranks[2].pairs[0].places, 1u);
}

TEST(rank, what_cannot_be_compared_is_said) {
  const auto says = [](const std::vector<Record>& records, const AnalysisOptions& options, const char* words) {
    try {
      analyze(records, "rank", options, Format::csv);
      FAIL() << "no error";
    } catch (const Error& error) {
      EXPECT_TRUE(has(error.what(), words)) << error.what();
    }
  };
  std::vector<Record> records = pair_of(2, 2);
  says({records[0]}, {}, "no two contenders finished with the number error at one place");
  says({records[0], records[3]}, {}, "no two contenders finished with the number error at one place");
  says(records, {.only_cost = Cost::motion}, "nothing to rank by motion");
  says(records, {.metric = "eror"}, "there is no eror; did you mean error?");
  for (Record& r : records) r.metrics[Truth::shape]["penumbra_shift"] = 1.0;
  says(records, {.metric = "penumbra_shift"}, "penumbra_shift has no better side");
  EXPECT_TRUE(find_ranks(std::vector{records[0]}, {}).empty());
}

// --- how often it is wrong, and right ---------------------------------------------------------------------------------

/// How many of 1,000 runs of so many settings over 12 places call a pair different by error and by the cost of a moved light.
/// Places differ 50-fold. At each the first setting has `ratio` times what the others have, and the logarithm of a ratio of two
/// settings spreads by 0.15.
std::pair<int, int> called(int settings, double ratio) {
  std::vector<Record> records;
  for (int place = 0; place < 12; ++place)
    for (int k = 0; k < settings; ++k)
      records.push_back(row(fmt::format("m:k={}", k), 1, 1, 0.01, fmt::format("scene{}", place)));
  const double spread = 0.15 / std::numbers::sqrt2;
  Random random(3, static_cast<std::uint64_t>(settings));
  std::pair<int, int> different;
  for (int run = 0; run < 1000; ++run) {
    for (std::size_t k = 0; k < records.size(); ++k) {
      const double scale = std::pow(50, static_cast<double>(k / static_cast<std::size_t>(settings)) / 11);
      const double mine = k % static_cast<std::size_t>(settings) == 0 ? ratio * scale : scale;
      records[k].metrics[Truth::shape]["error"] = 0.001 * mine * std::exp(spread * normal(random));
      records[k].times(Stage::resolve) = {{mine * std::exp(spread * normal(random))}};
      records[k].times(Stage::relight) = {{0.0}};
    }
    const std::vector<Ranking> ranks = find_ranks(records, {.cost = Cost::light});
    const auto is_called = [](const RankedPair& pair) {
      return pair.verdict == PairVerdict::better || pair.verdict == PairVerdict::worse;
    };
    different.first += std::ranges::any_of(ranks[0].pairs, is_called);
    different.second += std::ranges::any_of(ranks[1].pairs, is_called);
  }
  return different;
}

TEST(rank, in_at_most_65_of_1000_runs_of_equal_settings_one_is_called_different) {
  for (const int settings : {2, 5}) {
    const auto [by_error, by_cost] = called(settings, 1);
    RecordProperty("by_error_" + std::to_string(settings), by_error);
    RecordProperty("by_cost_" + std::to_string(settings), by_cost);
    EXPECT_LE(by_error, 65) << settings;
    EXPECT_LE(by_cost, 65) << settings;
  }
}

TEST(rank, a_fifth_more_over_twelve_places_is_found_in_four_of_five_runs) {
  const auto [by_error, by_cost] = called(2, 1.2);
  RecordProperty("by_error", by_error);
  RecordProperty("by_cost", by_cost);
  EXPECT_GE(by_error, 800);
  EXPECT_GE(by_cost, 800);
}

// --- its table --------------------------------------------------------------------------------------------------------

TEST(rank, people_read_verdicts_and_programs_numbers) {
  const std::string text = analyze(pair_of(4, 2), "rank", {}, Format::terminal);
  EXPECT_TRUE(text.starts_with("The best by error against each, over places\n")) << text;
  EXPECT_TRUE(has(text, "too few places, 6 needed")) << text;
  EXPECT_TRUE(has(text, "by error: fewer than 6 places call no difference among 1 pair\n")) << text;
  const Json rows = Json::parse(analyze(pair_of(6, 2), "rank", {.only_cost = Cost::light}, Format::json))["rows"];
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0]["quantity"], "error");
  EXPECT_EQ(rows[1]["quantity"], "light");
  EXPECT_EQ(rows[0]["verdict"], "better");
  EXPECT_EQ(rows[0]["p_holm"], 0.03125);
  EXPECT_EQ(rows[0]["left_out"], 0);
  EXPECT_TRUE(rows[0]["left_out_places"].is_null());
  const std::string many = analyze(pair_of(20, 2), "rank", {}, Format::terminal);
  EXPECT_TRUE(has(many, fmt::format("by error: {} flips were drawn, for there are more than 18 places\n", usual_flips)))
      << many;
}

}  // namespace rank_test
