#include "analysis/analysis.h"

#include <gnomon/registry.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

#include "analysis/front.h"
#include "analysis/map.h"
#include "analysis/seams.h"
#include "analysis_rows.h"
#include "measure/score/metrics.h"
#include "report/analysis/analysis_table.h"

namespace analysis_test {

using namespace analysis_rows;

// --- samples ----------------------------------------------------------------------------------------------------------

TEST(sample, value_is_the_sum_of_the_medians_of_process_medians) {
  // Medians 2, 5, 3 have the median 3; 10, 30, 20 have 20.
  const Sample sample({{{1, 2, 9}, {5}, {3, 3}}, {{10}, {30}, {20}}});
  EXPECT_TRUE(sample.has_processes());
  EXPECT_EQ(sample.value(), 23);
}

TEST(sample, stages_of_the_same_processes_are_drawn_together) {
  // A process is slow in both stages or in none: medians are 2 or 20, sums 4 or 40. Independent draws would give 22 too.
  const Sample sample({{{2}, {20}, {2}}, {{2}, {20}, {2}}});
  Random random(7);
  for (int k = 0; k < 200; ++k) {
    const double drawn = sample.draw(random);
    EXPECT_TRUE(drawn == 4 || drawn == 40) << drawn;
  }
}

TEST(sample, one_process_has_no_interval_and_no_time_is_no_sample) {
  const Sample alone({{{1, 2, 3}}});
  const ValueWithInterval measured = bootstrap({&alone, 1}, [](std::span<const double> values) { return values[0]; });
  EXPECT_EQ(measured.value, 2);
  EXPECT_FALSE(measured.has_interval);
  EXPECT_FALSE(Sample({{{1}}, {}}).is_timed());
}

RC_GTEST_PROP(sample, draws_lie_between_the_least_and_the_greatest_time, ()) {
  ProcessTimes times;
  double least = INFINITY, greatest = 0;
  for (int process = 0; process < *rc::gen::inRange(2, 6); ++process) {
    times.emplace_back();
    for (int k = 0; k < *rc::gen::inRange(1, 5); ++k) {
      times.back().push_back(*rc::gen::inRange(1, 1000) / 7.0);
      least = std::min(least, times.back().back());
      greatest = std::max(greatest, times.back().back());
    }
  }
  const Sample sample({times});
  const ValueWithInterval m = bootstrap({&sample, 1}, [](std::span<const double> values) { return values[0]; });
  RC_ASSERT(least <= m.low && m.low <= m.high && m.high <= greatest);
  RC_ASSERT(m.low <= m.value && m.value <= m.high);
}

// --- references and quantities ----------------------------------------------------------------------------------------

TEST(analysis, a_scene_parameter_is_read_from_the_reference_or_from_the_generator) {
  EXPECT_EQ(split_reference("soup:count=5,seed=2"), std::pair(std::string("soup"), std::string("count=5,seed=2")));
  EXPECT_EQ(split_reference("models/tree.toml"), std::pair(std::string("models/tree.toml"), std::string()));
  EXPECT_EQ(scene_parameter("sphere_field:count=40", "count"), 40);
  EXPECT_EQ(scene_parameter("sphere_field:seed=2", "count"), 100);  // its default
  EXPECT_EQ(scene_parameter("sphere_field", "no_such"), std::nullopt);
  EXPECT_EQ(scene_parameter("elsewhere", "count"), std::nullopt);
}

TEST(analysis, the_time_of_a_still_is_no_parameter) {
  EXPECT_EQ(split_reference("soup:count=5,seed=2@walk=1.5"), std::pair(std::string("soup"), std::string("count=5,seed=2")));
  EXPECT_EQ(split_reference("models/tree.toml@walk=1"), std::pair(std::string("models/tree.toml"), std::string()));
  EXPECT_EQ(scene_parameter("sphere_field:count=40@1.5", "count"), 40);
  EXPECT_EQ(scene_parameter("sphere_field@1.5", "count"), 100);
  EXPECT_EQ(scene_parameter("sphere_field@walk=1.5", "walk"), std::nullopt);
}

TEST(analysis, causes_are_shares_of_the_tested_pixels) {
  Record r = row("a", 1, 1, 0.1);
  EXPECT_EQ(quantity(r, "cause.acne"), std::nullopt);
  r.causes = {{"acne", 25}};
  EXPECT_EQ(quantity(r, "cause.acne"), 0.025);
  EXPECT_EQ(quantity(r, "resolve_ms"), 1);
  EXPECT_EQ(quantity(r, "bytes"), 1048576);
}

TEST(analysis, unknown_quantities_are_errors_with_the_nearest_name) {
  const std::vector<Record> records{row("a", 1, 1, 0.1)};
  try {
    find_fields(records, {.error = "wrong_rat"});
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_TRUE(has(error.what(), "there is no wrong_rat; did you mean wrong_rate?")) << error.what();
  }
}

TEST(analysis, filter_sees_scene_light_setting_and_label) {
  std::vector<Record> records{row("a", 1, 1, 0.1), row("b:k=2", 1, 1, 0.1, "fence")};
  records[0].label = "short name";
  EXPECT_EQ(title(records[0]), fmt::format("soup point {} a", records[0].view));
  for (Record& record : records) record.view = "view";  // which titles leave out
  EXPECT_EQ(matching(records, "^soup point a$").size(), 1u);
  EXPECT_EQ(matching(records, "short").size(), 1u);
  EXPECT_EQ(matching(records, "k=2").front().scene, "fence");
  records[1].parameters["bias"] = "slope";  // its default: not in the settings
  EXPECT_EQ(matching(records, "bias=slope").size(), 1u);
  EXPECT_EQ(matching(records, "").size(), 2u);
  EXPECT_THROW(matching(records, "("), Error);
  // A path is where it is in the title of the job.
  records[0].path = "slide";
  EXPECT_EQ(title(records[0]), "soup point slide a");
  EXPECT_EQ(matching(records, "^soup point slide a$").size(), 1u);
  EXPECT_EQ(matching(records, "^soup point slide short name$").size(), 1u);
  EXPECT_EQ(matching(records, "point a").size(), 0u);
}

// --- front ------------------------------------------------------------------------------------------------------------

TEST(front, those_that_nobody_beats_in_both_are_on_it) {
  Record reference = row("rays", 0, 1, 0);
  reference.role = Role::reference;
  // Cost relight + resolve: fast 2, middle 4, slow 8, bad 5.
  const std::vector<Record> records{row("fast", 1, 1, 0.3), row("middle", 2, 2, 0.2), row("slow", 4, 4, 0.1),
                                    row("bad", 2, 3, 0.25), reference};
  const std::vector<Field> fields = find_fields(records, {});
  ASSERT_EQ(fields.size(), 1u);  // one place: nothing to sum up
  const std::vector<FrontEntry> stands = find_front(fields[0], "lower");
  EXPECT_EQ(stands[0].standing, Standing::front);
  EXPECT_EQ(stands[1].standing, Standing::front);
  EXPECT_EQ(stands[2].standing, Standing::front);
  EXPECT_EQ(stands[3].standing, Standing::beaten);
  EXPECT_EQ(stands[3].beaten_by, "middle");
  EXPECT_EQ(stands[4].standing, Standing::aside);
  EXPECT_EQ(fields[0].candidates[2].relative_cost.value, 4);
  // Place more is better, the order of errors turns round: bad is dearer than fast and worse, middle and slow too.
  const std::vector<FrontEntry> turned = find_front(fields[0], "higher");
  EXPECT_EQ(turned[0].standing, Standing::front);
  for (const std::size_t other : {1u, 2u, 3u}) EXPECT_EQ(turned[other].standing, Standing::beaten);
}

TEST(front, noise_that_hides_who_is_cheaper_is_said) {
  Record a = row("a", 0.5, 1, 0.1), b = row("b", 0.5, 1, 0.2);
  a.times(Stage::resolve) = {{1.0}, {1.4}, {1.2}};
  b.times(Stage::resolve) = {{1.1}, {1.5}, {1.3}};  // dearer and worse, but 0.1 ms is less than the noise
  const std::vector<FrontEntry> stands = find_front(find_fields(std::vector{a, b}, {})[0], "lower");
  EXPECT_EQ(stands[1].standing, Standing::unclear);
  EXPECT_EQ(stands[1].beaten_by, "a");
}

TEST(front, over_all_places_means_are_of_the_same_scenes) {
  // "partial" finished one scene only; a mean over its easy scene would flatter it, so both are compared there.
  const std::vector<Record> records{row("a", 1, 1, 0.1, "easy"), row("a", 8, 8, 0.5, "hard"), row("b", 2, 2, 0.3, "easy"),
                                    row("b", 1, 1, 0.1, "hard")};
  std::vector<Field> fields = find_fields(records, {});
  ASSERT_EQ(fields.size(), 3u);
  EXPECT_FALSE(fields[2].place);
  EXPECT_EQ(fields[2].places, 2u);
  EXPECT_NEAR(fields[2].candidates[0].error, 0.3, 1e-12);
  EXPECT_NEAR(fields[2].candidates[0].cost->value, std::sqrt(2.0 * 16), 1e-9);  // geometric mean of 2 and 16
  std::vector<Record> more = records;
  more.push_back(row("partial", 1, 1, 0.01, "easy"));
  fields = find_fields(more, {});
  EXPECT_EQ(fields[2].places, 1u);
  EXPECT_EQ(fields[2].all_places, 2u);
  EXPECT_NEAR(fields[2].candidates[0].error, 0.1, 1e-12);
  EXPECT_EQ(fields[2].notes, std::vector<std::string>{"not among the 1 place: hard, point (partial: not in the run)"});
  more.push_back(row("partial", 1, 1, 0.01, "hard"));
  more.back().status = Status::failed;
  more.back().reason = "it crashed";
  EXPECT_EQ(find_fields(more, {})[2].notes,
            std::vector<std::string>{"not among the 1 place: hard, point (partial: failed, it crashed)"});
  more.pop_back();
  // Who shares no place with the others is left out, and said.
  more.back().scene = "elsewhere";
  fields = find_fields(more, {});
  EXPECT_EQ(fields.back().places, 2u);
  EXPECT_EQ(fields.back().candidates.size(), 2u);
  ASSERT_EQ(fields.back().notes.size(), 1u);
  EXPECT_EQ(fields.back().notes[0], "left out: partial, which finished only 1 of the places");
}

TEST(front, what_cannot_be_ranked_is_an_error) {
  const auto says = [](const std::vector<Record>& records, const char* metric, const char* words) {
    try {
      find_fields(records, {.error = metric});
      FAIL() << "no error";
    } catch (const Error& error) {
      EXPECT_TRUE(has(error.what(), words)) << error.what();
    }
  };
  std::vector<Record> records{row("a", 1, 1, 0.1), row("b", 1, 1, 0.2)};
  for (Record& r : records) r.metrics[Truth::shape]["penumbra_shift"] = 1.0;
  says(records, "penumbra_shift", "penumbra_shift has no better side: front and best cannot rank by it");
  for (Record& r : records) r.role = Role::reference;
  says(records, "wrong_rate", "no contender finished with the number wrong_rate");
}

RC_GTEST_PROP(front, nobody_on_it_is_beaten_and_everybody_else_is, ()) {
  Field field;
  for (int k = 0; k < *rc::gen::inRange(1, 12); ++k) {
    Candidate c;
    c.setting = fmt::format("s{}", k);
    c.error = *rc::gen::inRange(0, 6);
    c.cost = ValueWithInterval(*rc::gen::inRange(1, 6));
    field.candidates.push_back(c);
  }
  const std::vector<FrontEntry> stands = find_front(field, "lower");
  bool has_front = false;
  for (std::size_t i = 0; i < stands.size(); ++i) {
    bool is_beaten = false;
    for (const Candidate& other : field.candidates) {
      const Candidate& mine = field.candidates[i];
      const bool is_no_worse = other.error <= mine.error && other.cost->value <= mine.cost->value;
      is_beaten = is_beaten || (is_no_worse && (other.error < mine.error || other.cost->value < mine.cost->value));
    }
    RC_ASSERT((stands[i].standing == Standing::front) == !is_beaten);
    has_front = has_front || !is_beaten;
  }
  RC_ASSERT(has_front);
}

// --- best -------------------------------------------------------------------------------------------------------------

TEST(best, budgets_choose_by_what_they_leave_free) {
  std::vector<Record> records{row("fast", 1, 1, 0.3), row("middle", 2, 2, 0.2), row("slow", 4, 4, 0.1)};
  records[0].bytes = 1 << 20, records[1].bytes = 8 << 20, records[2].bytes = 2 << 20;
  const Field field = find_fields(records, {})[0];
  const auto winner = [&](const Budgets& budgets) {
    const std::vector<Best> best = find_best(field, budgets, "lower");
    return best[0].winner ? field.candidates[*best[0].winner].setting : "none";
  };
  EXPECT_EQ(winner({.times = {1.9}, .memories = {}, .errors = {}}), "none");
  EXPECT_EQ(winner({.times = {2}, .memories = {}, .errors = {}}), "fast");
  EXPECT_EQ(winner({.times = {5}, .memories = {}, .errors = {}}), "middle");
  EXPECT_EQ(winner({.times = {100}, .memories = {}, .errors = {}}), "slow");
  EXPECT_EQ(winner({.times = {}, .memories = {1 << 20}, .errors = {}}), "fast");
  EXPECT_EQ(winner({.times = {}, .memories = {100 << 20}, .errors = {}}), "slow");
  EXPECT_EQ(winner({.times = {}, .memories = {}, .errors = {0.05}}), "none");
  EXPECT_EQ(winner({.times = {}, .memories = {}, .errors = {0.1}}), "slow");
  EXPECT_EQ(winner({.times = {}, .memories = {}, .errors = {0.25}}), "middle");
}

TEST(best, round_budgets_run_from_somebody_to_everybody) {
  const std::vector<Record> records{row("fast", 1, 1.3, 0.3), row("slow", 20, 20, 0.01)};
  const Budgets budgets = round_budgets(find_fields(records, {}), 10);
  EXPECT_EQ(budgets.times, (std::vector<double>{5, 10, 20, 50}));  // times 2.3 and 40
  EXPECT_EQ(budgets.errors, (std::vector<double>{0.01, 0.02, 0.05, 0.1, 0.2, 0.5}));
  EXPECT_EQ(budgets.memories, (std::vector<double>{1 << 20}));
  EXPECT_LE(round_budgets(find_fields(records, {}), 3).errors.size(), 3u);
  EXPECT_EQ(round_budgets(find_fields(records, {}), 3).errors.back(), 0.5);
}

// Powers of ten were once counted up from the logarithm of what is not there: two billion of them, some minutes.
TEST(best, there_is_no_budget_where_nobody_errs) {
  const std::vector<Record> records{row("one", 1, 1, 0), row("other", 2, 2, 0)};
  EXPECT_EQ(round_budgets(find_fields(records, {}), 10).errors, std::vector<double>());
}

// --- map --------------------------------------------------------------------------------------------------------------

TEST(map, cells_are_means_over_the_scenes_and_the_best_is_marked) {
  std::vector<Record> records;
  for (const char* scene : {"one", "two"})
    for (const double bias : {0.5, 1.0, 10.0})
      for (const int size : {256, 1024}) {
        const double wrong = (std::string(scene) == "one" ? 0.1 : 0.3) + std::abs(bias - 1) / 10 + 10.0 / size;
        records.push_back(row(fmt::format("map:bias={},size={}", bias, size), 1, 1, wrong, scene));
      }
  const std::vector<Map> maps = make_maps(records, {});
  ASSERT_EQ(maps.size(), 1u);
  EXPECT_EQ(maps[0].x, "bias");  // three values against two
  EXPECT_EQ(maps[0].y, "size");
  EXPECT_EQ(maps[0].xs, (std::vector<std::string>{"0.5", "1", "10"}));  // by size, not as words
  EXPECT_EQ(maps[0].places, 2u);
  EXPECT_NEAR(*maps[0].at(1, 1).value, 0.2 + 10.0 / 1024, 1e-12);
  for (std::size_t y = 0; y < 2; ++y)
    for (std::size_t x = 0; x < 3; ++x) EXPECT_EQ(maps[0].at(x, y).is_best, x == 1 && y == 1);
}

TEST(map, what_else_varies_becomes_a_facet) {
  std::vector<Record> records;
  for (const int mode : {1, 2})
    for (const int bias : {1, 2})
      for (const int size : {256, 512, 1024})
        records.push_back(row(fmt::format("map:bias={},size={},mode={}", bias, size, mode), 1, 1, 0.1 * mode));
  const std::vector<Map> maps = make_maps(records, {.x = "size", .y = "bias"});
  ASSERT_EQ(maps.size(), 2u);
  EXPECT_EQ(maps[1].facet, (std::vector<std::pair<std::string, std::string>>{{"mode", "2"}}));
  EXPECT_TRUE(maps[0].at(0, 0).is_best);
  EXPECT_FALSE(maps[1].at(0, 0).is_best);  // best of all maps, not of each
  EXPECT_EQ(make_maps(records, {.x = "size"}).size(), 4u);
}

TEST(map, places_that_the_means_leave_out_are_named) {
  std::vector<Record> records;
  for (const int mode : {1, 2})
    for (const int size : {256, 512, 1024})
      for (const char* scene : {"one", "two", "three"})
        if (std::string_view(scene) != "two" || size == 512 || mode == 2)
          records.push_back(row(fmt::format("map:size={},mode={},unused=3", size, mode), 1, 1, 0.1, scene));
  const std::vector<Map> maps = make_maps(records, {.x = "size"});
  ASSERT_EQ(maps.size(), 2u);
  EXPECT_EQ(maps[0].places, 2u);
  EXPECT_EQ(maps[0].notes, std::vector<std::string>{
                               "not among the 2 places: two, point (no value of size=256,mode=1, and of 1 more setting)"});
  EXPECT_EQ(maps[1].notes, std::vector<std::string>()) << "said of the technique";
  for (const Format format : {Format::terminal, Format::markdown, Format::latex, Format::json})
    EXPECT_TRUE(has(analyze(records, "map", {.x = "size"}, format), "and of 1 more setting"));
  std::erase_if(records, [](const Record& r) { return r.scene == "two"; });
  EXPECT_EQ(make_maps(records, {.x = "size"})[0].notes, std::vector<std::string>());
}

TEST(map, nothing_to_map_is_an_error) {
  EXPECT_THROW(make_maps(std::vector{row("a", 1, 1, 0.1)}, {}), Error);
  const std::vector<Record> records{row("a:k=1", 1, 1, 0.1), row("a:k=2", 1, 1, 0.1)};
  EXPECT_THROW(make_maps(records, {.x = "kk"}), Error);
  EXPECT_THROW(make_maps(records, {.x = "k", .y = "k"}), Error);
  EXPECT_THROW(make_maps(records, {.x = "k", .facet = "k"}), Error);
}

// --- tables of them ---------------------------------------------------------------------------------------------------

TEST(analyze, every_kind_speaks_every_format) {
  std::vector<Record> records = family({10, 100, 1000}, 1);
  for (const int size : {256, 512}) records.push_back(row(fmt::format("map:size={}", size), 1, 1, 0.1));
  records.push_back(row("a", 1, 1, 0.2));
  records.back().path = "slide";
  records.back().frames = {{"error", {0.2, 0.1}}};
  records.push_back(row("cascades", 1, 1, 0.1));
  for (const std::string& bin : seam_bin_names())
    for (const std::string_view of : {seam_error_prefix, seam_share_prefix})
      records.back().metrics[Truth::shape][fmt::format("{}{}", of, bin)] = 0.125;
  for (const std::string& kind : analysis_kinds()) {
    if (kind == "masks") continue;  // reads the files of a run: tests/cli/analyze_test.py has its formats
    AnalysisOptions options;
    if (kind == "sweep") options.x = "count";
    if (kind == "forecast") options.x = "triangles";
    for (const Format format : {Format::terminal, Format::markdown, Format::latex})
      EXPECT_GT(analyze(records, kind, options, format).size(), 100u) << kind;
    const std::string csv = analyze(records, kind, options, Format::csv);
    const auto fields = std::count(csv.begin(), csv.begin() + static_cast<long>(csv.find('\r')), ',');
    std::size_t lines = 0;
    for (std::size_t at = 0; at < csv.size(); at = csv.find('\n', at) + 1, ++lines) {
      const std::string line = csv.substr(at, csv.find('\r', at) - at);
      if (!has(line, "\"")) {
        EXPECT_EQ(std::count(line.begin(), line.end(), ','), fields) << line;
      }
    }
    const Json json = Json::parse(analyze(records, kind, options, Format::json));
    EXPECT_EQ(json["schema"], "gnomon-table-1");
    EXPECT_EQ(json["rows"].size() + 1, lines) << kind;  // one header
    for (const Json& one : json["rows"]) EXPECT_EQ(one.size(), json["columns"].size());
  }
  EXPECT_THROW(analyze(records, "grwoth", {}, Format::csv), Error);
}

}  // namespace analysis_test
