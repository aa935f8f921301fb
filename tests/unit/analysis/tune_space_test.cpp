#include "analysis/tune_space.h"

#include <gnomon/kit/random.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "error_words.h"

namespace tune_space_test {

using namespace gnomon;
using namespace gnomon::error_words;

const TuneSpace::Parameter& parameter(const TuneSpace& space, const std::string& name) {
  return *std::ranges::find(space.parameters, name, &TuneSpace::Parameter::name);
}

std::size_t index(const TuneSpace& space, const std::string& name) {
  return static_cast<std::size_t>(&parameter(space, name) - space.parameters.data());
}

TEST(tune_space, levels_of_numbers) {
  EXPECT_EQ(tune_levels(64, 8192, 1024, true, true), (std::vector<double>{64, 128, 256, 512, 1024, 2048, 4096, 8192}));
  EXPECT_EQ(tune_levels(1, 8, 1, true, false), (std::vector<double>{1, 2, 3, 4, 5, 6, 7, 8}));
  // 0.25 lies in the lowest eighth of 0 .. 64: the end, then doubled from a fourth of the default until there are nine.
  EXPECT_EQ(tune_levels(0, 64, 0.25, false, false), (std::vector<double>{0, 0.0625, 0.125, 0.25, 0.5, 1, 2, 4, 8}));
  EXPECT_EQ(tune_levels(0, 1, 0.5, false, false), (std::vector<double>{0, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 1}));
  // 0.3 takes the place of the nearest level, 0.25.
  EXPECT_EQ(tune_levels(0, 1, 0.3, false, false), (std::vector<double>{0, 0.125, 0.3, 0.375, 0.5, 0.625, 0.75, 0.875, 1}));
  // Twelve octaves are more than nine levels: eight equal ratios of 2^1.5, whole, the default in the place of one.
  const std::vector<double> samples = tune_levels(1, 4096, 64, true, true);
  EXPECT_EQ(samples, (std::vector<double>{1, 3, 8, 23, 64, 181, 512, 1448, 4096}));
}

TEST(tune_space, a_star_is_all_levels_and_braces_are_some) {
  const TuneSpace space = tune_space("shadow_map:resolution=*,depth_bias={2,0.5,1},filter=pcf");
  ASSERT_EQ(space.parameters.size(), 2u);
  EXPECT_EQ(space.parameters[0].values.size(), 8u);
  EXPECT_EQ(space.parameters[0].values[space.grid.parameters[0].base], "1024");
  EXPECT_EQ(space.parameters[1].values, (std::vector<std::string>{"0.5", "1", "2"}));  // numbers rise
  EXPECT_EQ(space.fixed, "filter=pcf");
  EXPECT_EQ(space.settings({0, 1}), "resolution=64,depth_bias=1,filter=pcf");
  EXPECT_EQ(space.name({4, 0}), "shadow_map:depth_bias=0.5,filter=pcf");
  EXPECT_EQ(space.grid.count(), 24);
}

TEST(tune_space, the_id_alone_is_all_parameters_but_seeds) {
  const TuneSpace rays = tune_space("area_rays");
  EXPECT_EQ(rays.left_out, std::vector<std::string>{"seed"});
  EXPECT_TRUE(std::ranges::none_of(rays.parameters, [](const auto& p) { return p.name == "seed"; }));
  const TuneSpace map = tune_space("shadow_map:*,resolution=256");
  EXPECT_TRUE(std::ranges::none_of(map.parameters, [](const auto& p) { return p.name == "resolution"; }));
  EXPECT_EQ(map.fixed, "resolution=256");
  for (const TuneSpace::Parameter& one : map.parameters)
    EXPECT_NE(std::ranges::find(one.values, one.base), one.values.end()) << one.name;
}

TEST(tune_space, a_parameter_counts_where_its_sentence_says_so) {
  const TuneSpace space = tune_space("shadow_map");
  EXPECT_EQ(parameter(space, "slope_bias").condition, "bias=slope");
  EXPECT_EQ(parameter(space, "normal_offset").condition, "bias=normal_offset");
  EXPECT_EQ(parameter(space, "filter_radius").condition, "filter=pcf,disc,optimized,rotated");
  EXPECT_EQ(parameter(space, "depth_bias").condition, "bias=constant,slope,normal_offset,receiver_plane");
  EXPECT_EQ(parameter(space, "early_bail").condition, "filter=pcf,disc,optimized,bicubic,rotated");
  EXPECT_EQ(parameter(space, "dual_offset").condition, "stored=dual");
  EXPECT_EQ(parameter(space, "resolution").condition, "");
  const TuneGrid::Parameter& slope = space.grid.parameters[index(space, "slope_bias")];
  EXPECT_EQ(slope.controller, index(space, "bias"));
  EXPECT_EQ(slope.controller_levels, std::vector<std::size_t>{1});  // constant, slope, ...
  EXPECT_LT(space.grid.count(), space.grid.raw_count());
  // Of twelve ways one takes slope_bias and one normal_offset.
  const TuneSpace bias = tune_space("shadow_map:bias=*,slope_bias={1,2},normal_offset={1,2,3}");
  EXPECT_EQ(bias.grid.count(), 1 + 2 + 3 + 9);
  // Where what it is for is fixed elsewhere, it does not vary.
  EXPECT_EQ(tune_space("shadow_map:bias=constant,slope_bias=*,filter={nearest,bilinear}").grid.count(), 2);
}

TEST(tune_space, parameters_that_act_on_nothing_that_is_there_are_skipped) {
  const TuneSpace whole = tune_space("shadow_map");
  EXPECT_TRUE(whole.skipped.empty());
  EXPECT_EQ(whole.left_out, std::vector<std::string>{"noise_frame"});
  const TuneSpace plain = tune_space("shadow_map", {.has_holes = false, .has_glass = false, .has_motion = false});
  EXPECT_EQ(plain.skipped, (std::vector<std::string>{"alpha (no mesh has holes)", "glass (no caster lets light through)",
                                                     "update (nothing moves)"}));
  EXPECT_EQ(plain.grid.count() * 4 * 2 * 2, whole.grid.count());  // the choices of these three
  EXPECT_EQ(plain.settings(plain.grid.base()), "");
  // Who asks for one by name gets it skipped, too, and a value that all settings have is theirs.
  const TuneSpace named = tune_space("shadow_map:alpha=*,glass=none,resolution=*", {.has_holes = false, .has_glass = false});
  EXPECT_EQ(named.skipped, std::vector<std::string>{"alpha (no mesh has holes)"});
  EXPECT_EQ(named.grid.count(), 8);
  EXPECT_EQ(named.fixed, "glass=none");
}

TEST(tune_space, what_changes_costs_alone_is_skipped_where_none_counts) {
  const TuneSpace space = tune_space("shadow_map:pass=*,resolution=*", {.has_costs = false});
  EXPECT_EQ(space.skipped, std::vector<std::string>{"pass (no cost counts)"});
  EXPECT_EQ(tune_space("two_pass_object:cell_triangles=*", {.has_costs = false}).grid.count(), 1);
}

TEST(tune_space, without_what_a_parameter_is_for_it_is_skipped_with_its_controller) {
  const TuneSpace space = tune_space("denoised_rays", {.has_motion = false});
  EXPECT_EQ(space.skipped.front(), "memory (no frame follows another)");
  for (const std::string_view name : {"alpha", "longest", "on_change"})
    EXPECT_NE(std::ranges::find(space.skipped, fmt::format("{} (for memory=accumulate,clamp)", name)), space.skipped.end())
        << name;
}

TEST(tune_space, questions_at_a_place_change_early_stages_the_least_often) {
  // bias spoils setup, resolution relight, depth_bias resolve: of eight settings the first changes once, the second three
  // times.
  const TuneSpace space = tune_space("shadow_map:depth_bias={0,1},resolution={64,128},bias={constant,receiver_plane}");
  ASSERT_EQ(space.grid.all().size(), 8u);
  std::vector<TuneQuestion> questions;
  for (const std::size_t place : {1u, 0u})
    for (const TuneSetting& setting : space.grid.all()) questions.push_back({setting, place});
  Random(1).shuffle(questions);
  std::ranges::stable_sort(questions, std::greater(), &TuneQuestion::place);
  put_by_stages(space, questions);
  for (const std::size_t first : {0u, 8u}) {
    std::map<std::string, int> changes;
    std::set<TuneSetting> settings;
    for (std::size_t k = first; k < first + 8; ++k) {
      EXPECT_EQ(questions[k].place, first == 0 ? 1u : 0u);
      settings.insert(questions[k].setting);
      if (k == first) continue;
      for (const std::string name : {"bias", "resolution", "depth_bias"})
        changes[name] += questions[k].setting[index(space, name)] != questions[k - 1].setting[index(space, name)];
    }
    EXPECT_EQ(settings.size(), 8u);
    EXPECT_EQ(changes["bias"], 1);
    EXPECT_EQ(changes["resolution"], 3);
    EXPECT_EQ(changes["depth_bias"], 7);
  }
}

TEST(tune_space, bad_texts_are_refused_with_what_is_allowed) {
  expect_words(error_of([] { tune_space("shadow_mpa"); }), {"shadow_map"});
  expect_words(error_of([] { tune_space("shadow_map:resolutoin=*"); }), {"resolutoin", "resolution"});
  expect_words(error_of([] { tune_space("shadow_map:resolution={16,64}"); }), {"resolution = 16", "64 .. 8192"});
  expect_words(error_of([] { tune_space("shadow_map:resolution={64"); }), {"does not close"});
  expect_words(error_of([] { tune_space("shadow_map:resolution"); }), {"'resolution' is neither"});
  expect_words(error_of([] { tune_space("shadow_map:bias=*,bias=slope"); }), {"bias is given twice"});
  expect_words(error_of([] { tune_space("shadow_map:*,filter=pfc"); }), {"filter = pfc", "pcf"});
}

}  // namespace tune_space_test
