#include "analysis/tune_choice.h"

#include <gtest/gtest.h>

#include "analysis_rows.h"
#include "error_words.h"

namespace tune_choice_test {

using namespace gnomon;
using namespace gnomon::error_words;
using analysis_rows::row;

/// One process for each of these milliseconds, of one repetition each.
Sample sample(std::initializer_list<double> milliseconds) {
  ProcessTimes times;
  for (const double ms : milliseconds) times.push_back({ms});
  return Sample({times});
}

const std::vector<std::vector<Sample>> three{
    {sample({10, 10.4, 10.2, 10.9, 10.1})}, {sample({10.3, 10.2, 10.6, 10.1, 10.5})}, {sample({12, 12.3, 11.8, 12.1, 12.6})}};

TEST(tune_choice, limits_are_read_in_their_units) {
  const std::vector<TuneLimit> limits = tune_limits("error<=1%,MiB<=8,ssim>=0.98,light_ms<=5");
  ASSERT_EQ(limits.size(), 4u);
  EXPECT_EQ(limits[0].number.name, "error");
  EXPECT_DOUBLE_EQ(limits[0].bound, 0.01);
  EXPECT_EQ(limits[1].number.name, "bytes");
  EXPECT_EQ(limits[1].bound, 8 * 1024 * 1024);
  EXPECT_TRUE(limits[2].is_least);
  EXPECT_EQ(limits[3].number.cost, Cost::light);
  EXPECT_DOUBLE_EQ(limits[0].beyond(0.015), 0.5);
  EXPECT_DOUBLE_EQ(limits[0].beyond(0.005), -0.5);
  EXPECT_NEAR(limits[2].beyond(0.97), 0.01 / 0.98, 1e-12);
  EXPECT_LE(limits[2].beyond(0.99), 0);
  EXPECT_EQ(tuned_number("cost=resolve").name, "resolve_ms");
  EXPECT_TRUE(tuned_number("cost=light").is_time());
  EXPECT_FALSE(tuned_number("cost=bytes").is_time());
}

TEST(tune_choice, bad_limits_are_refused_with_the_nearest_names) {
  expect_words(error_of([] { tune_limits("eror<=1%"); }), {"eror", "error"});
  expect_words(error_of([] { tune_limits("error=1%"); }), {"NAME<=NUMBER"});
  expect_words(error_of([] { tune_limits("error<=one"); }), {"'one'", "number"});
  expect_words(error_of([] { tune_limits("error<=1"); }), {"100 %", "error<=1%"});
  expect_words(error_of([] { tune_limits("resolve_ms<=5%"); }), {"resolve_ms", "no percentage"});
  expect_words(error_of([] { tune_limits("error<=1%,"); }), {"NAME<=NUMBER"});
  expect_words(error_of([] { tuned_number("cost=lihgt"); }), {"lihgt", "light"});
  expect_words(error_of([] { tuned_number("ssim"); }), {"ssim is not better when lower"});
}

TEST(tune_choice, a_row_answers_with_its_goal_and_its_nearest_limit) {
  const TuneGoal goal{.least = tuned_number("cost=light"), .each = tune_limits("error<=1%,resolve_ms<=4")};
  const Record record = analysis_rows::with_constant(row("map:a=1", 3, 2, 0.008), 0.1);
  const TuneAnswer answer = tune_answer(record, goal);
  EXPECT_TRUE(answer.is_there);
  EXPECT_DOUBLE_EQ(answer.goal, 5);        // relight 3 and resolve 2
  EXPECT_NEAR(answer.beyond, -0.2, 1e-9);  // of 0.01; resolve has half to spare
  EXPECT_NEAR(answer.gain, 0.092, 1e-9);
  Record failed = record;
  failed.status = Status::failed;
  EXPECT_FALSE(tune_answer(failed, goal).is_there);
}

TEST(tune_choice, chances_come_from_the_medians_of_processes) {
  // Exact, from the distribution of the median of five draws: the first is within 0, 2 and 5 % of the least with these chances.
  constexpr double exact[] = {0.7438, 0.9270, 0.9605};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::vector<double> chances = chances_of_least(three, TuneOver::worst, chance_margins[k], 20000);
    EXPECT_NEAR(chances[0], exact[k], 0.012) << chance_margins[k];
    EXPECT_EQ(chances[2], 0) << chance_margins[k];
  }
}

TEST(tune_choice, of_times_that_tie_the_least_error_is_chosen) {
  const auto finalist = [&](std::size_t k, double ms, double error) {
    return TuneFinalist{.answers = {{.goal = ms, .beyond = error / 0.01 - 1}}, .times = three[k], .error = error};
  };
  const std::vector<TuneFinalist> finalists{finalist(0, 10.2, 0.009), finalist(1, 10.3, 0.004), finalist(2, 12.1, 0.001)};
  const TuneDecision decision = decide(finalists, TuneOver::worst);
  EXPECT_EQ(decision.answer, 1u);  // the third is told apart from both
  EXPECT_EQ(decision.tied, (std::vector<std::size_t>{0, 1}));
  EXPECT_EQ(decision.runner_up, 0u);
  EXPECT_NEAR(decision.chances[0], 0.366, 0.03);
}

TEST(tune_choice, without_noise_equal_goals_tie_and_fewer_changes_decide) {
  const auto finalist = [](double goal, double error, std::size_t changes) {
    return TuneFinalist{.answers = {{.goal = goal, .beyond = -0.5}}, .times = {}, .error = error, .changes = changes};
  };
  const std::vector<TuneFinalist> finalists{finalist(4, 0.005, 3), finalist(4, 0.005, 1), finalist(8, 0.001, 0)};
  const TuneDecision decision = decide(finalists, TuneOver::worst);
  EXPECT_EQ(decision.answer, 1u);
  EXPECT_EQ(decision.tied, (std::vector<std::size_t>{0, 1}));
  EXPECT_EQ(decision.chances[0], 1);
}

TEST(tune_choice, the_nearest_miss_is_chosen_where_nobody_keeps_the_limits) {
  std::vector<TuneFinalist> finalists(2);
  finalists[0].answers = {{.goal = 1, .beyond = 0.5}};
  finalists[1].answers = {{.goal = 9, .beyond = 0.1}};
  EXPECT_EQ(decide(finalists, TuneOver::worst).answer, 1u);
}

TEST(tune_choice, a_scene_is_left_out_in_turn) {
  // Two settings at places of scenes a, a, b. The first is best for a, the second for b, where the first breaks the limit.
  const std::vector<std::vector<TuneAnswer>> settings{{{.goal = 1}, {.goal = 1}, {.goal = 2, .beyond = 0.5}},
                                                      {{.goal = 3}, {.goal = 3}, {.goal = 4}}};
  const std::vector<std::string> scenes{"a", "a", "b"};
  const std::vector<SceneLeftOut> left = leave_scenes_out(settings, scenes, TuneOver::worst);
  ASSERT_EQ(left.size(), 2u);
  EXPECT_EQ(left[0].scene, "a");  // b alone chooses the second
  EXPECT_EQ(left[0].chosen, 1u);
  EXPECT_EQ(left[0].there.goal, 3);
  EXPECT_EQ(left[0].best.goal, 1);
  EXPECT_EQ(left[1].chosen, 0u);
  EXPECT_DOUBLE_EQ(left[1].there.beyond, 0.5);
  EXPECT_EQ(left[1].best.goal, 4);
  const std::vector<std::string> one{"a", "a", "a"};
  EXPECT_TRUE(leave_scenes_out(settings, one, TuneOver::worst).empty());
}

TEST(tune_choice, effects_are_the_best_of_each_value) {
  const TuneSpace space = tune_space("shadow_map:resolution={256,512,1024},depth_bias={0.5,1}");
  const TuneAsker ask = [](std::span<const TuneQuestion> questions) {
    std::vector<std::optional<TuneAnswer>> answers;
    for (const TuneQuestion& q : questions)
      answers.emplace_back(TuneAnswer{.goal = 10 - 2 * static_cast<double>(q.setting[0]) + static_cast<double>(q.setting[1])});
    return answers;
  };
  const TuneSearch found = search_grid(space.grid, {.places = 1}, ask);
  const std::vector<TuneEffect> effects = tune_effects(space, found, {2, 0}, 1, TuneOver::worst);
  ASSERT_EQ(effects.size(), 2u);
  EXPECT_EQ(effects[0].values[0].best->goal, 10);
  EXPECT_EQ(effects[0].values[2].best->goal, 6);
  EXPECT_EQ(effects[1].values[1].best->goal, 7);
  EXPECT_TRUE(effects[0].is_at_end);
}

}  // namespace tune_choice_test
