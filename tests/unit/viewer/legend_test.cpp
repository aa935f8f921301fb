// What the window says in words: what colors mean, and what is known of a pixel.
#include "hand_made_frame.h"
#include "measure/cause/color_vision.h"

namespace legend_test {

using namespace hand_made_frame;

std::vector<std::string> words_of(const std::vector<LegendEntry>& entries) {
  std::vector<std::string> all;
  for (const LegendEntry& entry : entries) all.push_back(words(entry));
  return all;
}

TEST(viewer_legend, shares_are_of_tested_pixels_and_only_what_occurs_is_named) {
  HandMadeFrame seen(10, 1);
  seen.verdict.errors = {.tested = 8, .wrong = 3, .false_dark = 3, .false_lit = 0};
  seen.verdict.cause_counts = {{"crack", 1}, {"acne", 2}, {"region", 0}};
  EXPECT_EQ(words_of(legend(left_of(seen, Paint::kinds), 0)), std::vector<std::string>{"false dark 37.5 % of tested pixels"});
  const std::vector<LegendEntry> causes = legend(left_of(seen, Paint::causes), 0);
  EXPECT_EQ(words_of(causes), (std::vector<std::string>{"acne 25.0 % of tested pixels", "crack 12.5 % of tested pixels"}))
      << "the larger share first";
  seen.verdict.cause_counts = {{"crack", 3}, {"acne", 1}, {"region", 1}};
  EXPECT_EQ(words_of(legend(left_of(seen, Paint::causes), 0)),
            (std::vector<std::string>{"crack 37.5 % of tested pixels", "acne 12.5 % of tested pixels",
                                      "region 12.5 % of tested pixels"}))
      << "equal ones in the order of matching, not of the names";
  EXPECT_EQ(rgb(causes[0].color), false_dark);
  EXPECT_TRUE(legend(left_of(seen, Paint::shaded), 0).empty());
  EXPECT_TRUE(legend(left_of(seen, Paint::causes), 1).empty()) << "nothing is known of the other side";
}

TEST(viewer_legend, differences_count_where_tested_pixels_are_a_half_apart) {
  HandMadeFrame here(8, 1), there(here.frame);
  here.answer->mask = {0, 0, 0.4f, 1, 1, 1, 1, 0};
  there.answer->mask = {1, 1, 1, 0, 0.5f, 1, 1, 1};
  here.reference->classes[6] = here.reference->classes[7] = PixelClass::G;
  there.verdict.reference = here.reference;
  Composition c = left_of(here, Paint::difference);
  c.difference.against = Against::other_side;
  c.sides[1] = there.side();
  EXPECT_EQ(words_of(legend(c, 0)),
            (std::vector<std::string>{"darker 50.0 % of tested pixels", "lighter 16.7 % of tested pixels"}));
  EXPECT_EQ(legend(c, 1)[0].share, 1.0 / 6) << "darker on the other side";
  c.sides[0].verdict = c.sides[1].verdict = nullptr;
  EXPECT_EQ(words_of(legend(c, 0)), (std::vector<std::string>{"darker", "lighter"}));
  // To the reference, of full scale 0.1: what is off by more than 0.05. The reference is lit.
  c.sides[0] = here.side();
  c.difference = {.against = Against::reference, .full = 0.1};
  here.answer->mask = {0.96f, 0.94f, 1, 1, 1, 1, 1, 1};
  EXPECT_EQ(words_of(legend(c, 0)),
            (std::vector<std::string>{"darker 16.7 % of tested pixels", "lighter 0.0000 % of tested pixels"}));
}

TEST(viewer_legend, bars_have_numbers_at_the_colors_that_the_picture_shows) {
  HandMadeFrame seen(3, 1);
  seen.answer->mask = {0.9f, 1, 0.95f};
  Composition c = left_of(seen, Paint::difference);
  c.difference = {.full = 0.1, .is_plain = true};
  const LegendBar bar = legend_bar(c, 0).value();
  std::vector<std::string> words;
  for (const LegendBar::Mark& mark : bar.marks) words.push_back(mark.words);
  EXPECT_EQ(words, (std::vector<std::string>{"-0.1", "-0.05", "0", "+0.05", "+0.1"}));
  std::vector<std::uint32_t> picture(3);
  compose(c, picture);
  const auto color_at = [&](double at) { return bar.colors[static_cast<std::size_t>(at * (bar.colors.size() - 1))]; };
  for (const auto& [x, at] : {std::pair{0, 0.0}, {1, 0.5}, {2, 0.25}})
    for (int k = 0; k < 3; ++k) EXPECT_NEAR((picture[x] >> (8 * k)) & 255, color_at(at)[k], 1) << x;
  // Masks are gray: a bar where there is a penumbra.
  c.paint = Paint::mask;
  EXPECT_FALSE(legend_bar(c, 0));
  seen.frame->light.kind = SphereLight{};
  const LegendBar ramp = legend_bar(c, 0).value();
  EXPECT_EQ(ramp.colors.front(), (Color{0, 0, 0}));
  EXPECT_EQ(ramp.colors[ramp.colors.size() / 2], (Color{128, 128, 128}));
  EXPECT_EQ(ramp.colors.back(), (Color{255, 255, 255}));
  EXPECT_EQ(ramp.marks[1].words, "penumbra");
  c.paint = Paint::causes;
  EXPECT_FALSE(legend_bar(c, 0));
}

TEST(viewer_legend, classes_are_counted_over_all_pixels_and_layers_have_their_swatches) {
  HandMadeFrame seen(4, 1);
  seen.reference->classes = {PixelClass::B, PixelClass::T, PixelClass::T, PixelClass::T};
  Composition c = left_of(seen, Paint::classes);
  const std::vector<LegendEntry> entries = legend(c, 0);
  ASSERT_EQ(entries.size(), 6u);
  EXPECT_EQ(words(entries[0]), "B background 25.0 % of all pixels");
  EXPECT_EQ(words(entries[5]), "T tested 75.0 % of all pixels");
  const std::vector<LegendEntry> swatches = layer_legend(layer_of(seen, {0.5f, 0.25f, 0.125f}));
  ASSERT_EQ(swatches.size(), 1u);
  EXPECT_EQ(words(swatches[0]), "a color");
  EXPECT_EQ(rgb(swatches[0].color), (Rgb{188, 137, 99}));
  c.paint = Paint::mask;
  EXPECT_EQ(words_of(legend(c, 0)), (std::vector<std::string>{"lit", "umbra"}));
  seen.frame->light.kind = SphereLight{};
  EXPECT_EQ(words_of(legend(c, 0)), std::vector<std::string>()) << "a bar of grays stands for them";
}

TEST(viewer_legend, under_a_light_with_area_shares_are_of_the_error) {
  HandMadeFrame seen(10, 1);
  seen.frame->light.kind = DiscLight{.center = {0, 4, 0}, .normal = {0, -1, 0}, .radius = 1};
  seen.answer->mask = {0.6f, 0.9f, 1, 1, 1, 1, 1, 1, 1, 1};
  seen.reference->mask[2] = 0.5f;
  EXPECT_EQ(words_of(legend(left_of(seen, Paint::kinds), 0)),
            (std::vector<std::string>{"too dark 50.0 % of the error", "too light 50.0 % of the error"}));
  seen.verdict.has_causes = true;
  seen.verdict.causes[0] = Cause::crack;
  EXPECT_EQ(words_of(legend(left_of(seen, Paint::causes), 0)), std::vector<std::string>{"crack 40.0 % of the error"});
  seen.verdict.causes[2] = Cause::region;
  EXPECT_EQ(words_of(legend(left_of(seen, Paint::causes), 0)),
            (std::vector<std::string>{"region 50.0 % of the error", "crack 40.0 % of the error"}));
  seen.verdict.causes.clear();
  EXPECT_EQ(legend(left_of(seen, Paint::causes), 0).size(), 2u) << "none were sought";
}

TEST(viewer_numbers, the_error_leads_under_every_light) {
  HandMadeFrame seen(4, 1);
  seen.verdict.errors = {.tested = 4, .wrong = 1, .false_dark = 1, .error_sum = 0.9};
  seen.verdict.error_floor = 0.00125;
  seen.verdict.constant_error = 0.25;
  const auto words = [&](bool has_area) {
    std::vector<std::string> all;
    if (has_area) seen.frame->light.kind = SphereLight{};
    for (const Tally& tally : tallies(seen.frame.get()))
      all.push_back(fmt::format("{}: {}", tally.name, tally.words(seen.verdict)));
    return all;
  };
  EXPECT_EQ(words(false), (std::vector<std::string>{"error: 22.5000 %", "constant: 25.0000 %", "wrong: 25.0000 %",
                                                    "false dark: 1", "false lit: 0", "tested: 4"}));
  EXPECT_EQ(words(true), (std::vector<std::string>{"error: 22.5000 %", "constant: 25.0000 %", "floor: 0.1250 %",
                                                   "wrong: 25.0000 %", "tested: 4"}));
  seen.verdict.errors = {};
  seen.verdict.error_floor.reset();
  seen.verdict.constant_error.reset();
  EXPECT_EQ(words(true), (std::vector<std::string>{"error: ", "constant: ", "floor: ", "wrong: ", "tested: 0"}));
  seen.frame->lights = {seen.frame->light, hand_made::sun({0, -1, 0})};
  seen.verdict.received_error = 0.0625;
  EXPECT_EQ(words(true), (std::vector<std::string>{"error: ", "constant: ", "floor: ", "light error: 6.2500 %", "tested: 0"}))
      << "several lights";
}

/// The value of a fact; "-" when it is not there.
std::string fact(const std::vector<PixelFact>& facts, std::string_view name) {
  const auto found = std::ranges::find(facts, name, &PixelFact::name);
  return found == facts.end() ? "-" : found->value;
}

TEST(pixel_facts, tell_where_the_pixel_is_and_what_the_masks_say) {
  // The point (3, 0, -4) of the ground and a light 5 m above the origin: 5 * sqrt(2) m away, under 45 degrees.
  HandMadeFrame seen(2, 1), other(seen.frame);
  seen.scene().meshes[1].name = "table";
  seen.picture->set(1, {3, 0, -4}, {0, 1, -0.0f}, 1, 17);
  seen.frame->light = hand_made::point_light({0, 5, 0});
  seen.finish();
  seen.answer->mask = {1, 0};
  seen.verdict.causes[1] = Cause::crack;
  Composition c = left_of(seen, Paint::shaded);
  c.width = 4;
  c.height = 2;
  c.sides[1] = other.side();
  const std::vector<PixelFact> facts = pixel_facts(c, 0, 3, 1, nullptr, nullptr);
  EXPECT_EQ(fact(facts, "frame pixel"), "1 0 of 2 x 1");
  EXPECT_TRUE(fact(facts, "class").starts_with("T, tested. "));
  EXPECT_EQ(fact(facts, "error"), "false dark");
  EXPECT_TRUE(fact(facts, "cause").starts_with("crack. At most four connected pixels"));
  EXPECT_EQ(fact(facts, "mask left"), "0 umbra");
  EXPECT_EQ(fact(facts, "mask right"), "1 lit");
  EXPECT_EQ(fact(facts, "reference"), "1 lit");
  EXPECT_EQ(fact(facts, "mesh"), "table");
  EXPECT_EQ(fact(facts, "triangle"), "17");
  EXPECT_EQ(fact(facts, "position"), "3.00000, 0.00000, -4.00000 m");
  EXPECT_EQ(fact(facts, "normal"), "0.0000, 1.0000, 0.0000");
  EXPECT_EQ(fact(facts, "cosine"), "0.7071, 45.0 degrees off the normal");
  EXPECT_EQ(fact(facts, "to the light"), "7.07107 m");
  EXPECT_EQ(fact(facts, "covered"), "-") << "nobody explained it";
  EXPECT_EQ(fact(pixel_facts(c, 0, 0, 0, nullptr, nullptr), "error"), "none");
  EXPECT_EQ(fact(pixel_facts(c, 0, 0, 0, nullptr, nullptr), "cause"), "-");
  EXPECT_TRUE(pixel_facts(c, 0, 4, 0, nullptr, nullptr).empty()) << "beside the picture";
}

TEST(pixel_facts, under_a_light_with_area_say_how_far_the_pixel_is_off) {
  HandMadeFrame seen(3, 1);
  seen.frame->light.kind = DiscLight{.center = {0, 4, 0}, .normal = {0, -1, 0}, .radius = 1};
  seen.answer->mask = {0.25f, 0.496f, 1};
  seen.reference->mask = {0.5f, 0.5f, 1};
  seen.reference->error = {0.0021f, 0, 0};
  const auto error_at = [&](int x) {
    return fact(pixel_facts(left_of(seen, Paint::mask), 0, x, 0, nullptr, nullptr), "error");
  };
  EXPECT_EQ(error_at(0), "-0.2500, too dark; the reference's own 0.0021");
  EXPECT_EQ(error_at(1), "-0.0040, too little to be drawn; the reference's own 0.0000");
  EXPECT_EQ(error_at(2), "+0.0000, too little to be drawn; the reference's own 0.0000");
  // Against the share that the technique estimates.
  seen.reference->irradiance = {0.25f, 0.5f, 1};
  seen.reference->irradiance_error = {0.001f, 0, 0};
  seen.verdict.estimates = LightShareKind::irradiance;
  EXPECT_EQ(error_at(0), "+0.0000, too little to be drawn; the reference's own 0.0010");
}

TEST(pixel_facts, exact_shapes_suns_and_backgrounds_have_their_own_words) {
  HandMadeFrame seen(2, 1);
  seen.picture->gbuffer.truth = Truth::shape;
  seen.scene().meshes[0].shape = Sphere{};
  seen.picture->mesh[1] = no_mesh;
  seen.reference->classes[1] = PixelClass::B;
  seen.finish();
  Composition c = left_of(seen, Paint::shaded);
  const std::vector<PixelFact> facts = pixel_facts(c, 0, 0, 0, nullptr, nullptr);
  EXPECT_EQ(fact(facts, "triangle"), "none: exact sphere");
  EXPECT_EQ(fact(facts, "mesh"), "number 0");
  EXPECT_EQ(fact(facts, "to the light"), "infinite");
  EXPECT_EQ(fact(facts, "frame pixel"), "-") << "that of the picture";
  const std::vector<PixelFact> none = pixel_facts(c, 0, 1, 0, nullptr, nullptr);
  ASSERT_EQ(none.size(), 1u);
  EXPECT_TRUE(none[0].value.starts_with("B, background. "));
  // While the reference is refined it has no classes, and fewer pixels.
  ReferenceState coarse;
  coarse.frame = seen.frame;
  coarse.width = coarse.height = 1;
  coarse.mask = {0.25f};
  c.sides[0].verdict = nullptr;
  EXPECT_EQ(fact(pixel_facts(c, 0, 0, 0, &coarse, nullptr), "reference"), "0.25");
  EXPECT_EQ(fact(pixel_facts(c, 0, 0, 0, &coarse, nullptr), "class"), "-");
}

TEST(pixel_facts, samples_of_the_light_are_counted) {
  HandMadeFrame seen(1, 1);
  seen.answer->mask = {0.5f};
  const Composition c = left_of(seen, Paint::shaded);
  Explanation why;
  why.samples = {{{0, 4, 0}, 0.5, 1}, {{1, 4, 0}, 0.25, 0}, {{0, 4, 1}, 0.25, 0}};
  EXPECT_EQ(fact(pixel_facts(c, 0, 0, 0, nullptr, &why), "samples"), "3 places of the light: 1 seen, 2 hidden");
  why.samples.resize(1);
  EXPECT_EQ(fact(pixel_facts(c, 0, 0, 0, nullptr, &why), "sample"), "seen place of the light");
}

TEST(pixel_facts, explanations_say_which_taps_were_dark) {
  // The point is the origin; the light's rays come down from 4 m above it. Of two taps of half the weight one is dark where the
  // mask is 1/2: the one whose stored surface is farther before the point, though both are before it.
  HandMadeFrame seen(1, 1);
  seen.answer->mask = {0.5f};
  const Composition c = left_of(seen, Paint::shaded);
  const auto tap = [](double stored, double weight) {
    return Tap{.origin = {0, 4, 0}, .direction = {0, -1, 0}, .weight = weight, .stored = stored};
  };
  Explanation why;
  why.taps = {tap(3.99, 0.5), tap(2.5, 0.5)};
  why.bias = 0.02;
  why.texel_width = 0.01;
  std::vector<PixelFact> facts = pixel_facts(c, 0, 0, 0, nullptr, &why);
  EXPECT_EQ(fact(facts, "covered"), "yes");
  EXPECT_EQ(fact(facts, "tap 1"), "lit: stored 3.990 m, measured 4.000 m, weight 0.5");
  EXPECT_EQ(fact(facts, "tap 2"), "dark: stored 2.500 m, measured 4.000 m, weight 0.5");
  EXPECT_EQ(fact(facts, "bias"), "0.02 m, 2 texels");
  EXPECT_EQ(fact(facts, "texel width"), "0.01 m");
  EXPECT_EQ(fact(facts, "element"), "-");
  why.taps = {tap(INFINITY, 1)};
  why.covered = false;
  why.shifted = glm::dvec3(0, 0.03, 0.04);
  seen.answer->mask = {1};
  facts = pixel_facts(c, 0, 0, 0, nullptr, &why);
  EXPECT_TRUE(fact(facts, "covered").starts_with("no"));
  EXPECT_EQ(fact(facts, "tap"), "lit: stored nothing, measured 4.000 m, weight 1");
  EXPECT_EQ(fact(facts, "look-up point"), "moved by 0.05 m");
  // Many are summed up; seven ninths of them are dark.
  seen.answer->mask = {2 / 9.0f};
  why.taps.clear();
  for (int k = 0; k < 9; ++k) why.taps.push_back(tap(1 + 0.25 * k, 1 / 9.0));
  facts = pixel_facts(c, 0, 0, 0, nullptr, &why);
  EXPECT_EQ(fact(facts, "taps"), "9: 7 dark, 2 lit");
  EXPECT_EQ(fact(facts, "stored"), "1.000 m to 3.000 m");
  EXPECT_EQ(fact(facts, "measured"), "4.000 m to 4.000 m");
  EXPECT_EQ(fact(facts, "tap 1"), "-");
  // Geometry has an element instead, and may own up to what it errs by.
  Explanation geometric;
  geometric.element = 42;
  geometric.outline_error = 0.001;
  geometric.formula_differs = true;
  facts = pixel_facts(c, 0, 0, 0, nullptr, &geometric);
  EXPECT_EQ(fact(facts, "element"), "42");
  EXPECT_EQ(fact(facts, "outline error"), "0.001 m");
  EXPECT_NE(fact(facts, "formula"), "-");
  EXPECT_EQ(fact(facts, "bias"), "-");
}

}  // namespace legend_test
