// Causes of a technique's own: where they are in the order, and what they must be like.
#include "measure/cause/own_causes.h"

#include <gnomon/error.h>

#include <cstdio>
#include <fstream>
#include <random>

#include "measure/cause/color_vision.h"
#include "places.h"
#include "soft_world.h"

namespace own_causes_test {

using namespace gnomon;
using cause_world::Causes;

constexpr OwnCause off_screen{"off_screen", "What casts the shadow is out of the picture.", {252, 0, 132}};
constexpr OwnCause few_steps{"few_steps", "The march took too few steps.", {20, 255, 148}};
constexpr OwnCause both[] = {off_screen, few_steps};

std::vector<CauseInfo> rows_of_both() {
  About about;
  about.causes = both;
  return own_causes(about);
}

Explanation named(const char* cause) {
  Explanation why;
  why.cause = cause;
  return why;
}

TEST(own_causes, come_behind_the_common_ones_in_the_order_of_the_data_sheet) {
  const std::vector<CauseInfo> own = rows_of_both();
  ASSERT_EQ(own.size(), 2u);
  EXPECT_EQ(static_cast<int>(own[0].cause), static_cast<int>(Cause::unexplained) + 1);
  EXPECT_EQ(own[1].cause, own_cause(1));
  const std::vector<CauseInfo> all = with_common(own);
  for (std::size_t k = 0; k < all.size(); ++k) EXPECT_EQ(static_cast<std::size_t>(all[k].cause), k + 1) << all[k].name;
  EXPECT_EQ(own_cause_named("few_steps", own), own_cause(1));
}

// A screen 3 m high whose shadow on the ground is lit everywhere: all of it is a missing caster, unless the technique knows
// better.
TEST(own_causes, hold_before_what_rays_find_and_after_the_other_words_of_the_technique) {
  cause_world::World world = cause_world::behind_a_screen();
  world.own_causes = rows_of_both();
  world.mask.assign(world.mask.size(), 1);
  const std::uint64_t all = world.wrong();
  EXPECT_EQ(world.causes(), (Causes{{"missing_caster", all}}));
  EXPECT_EQ(world.causes([](std::uint32_t) { return named("off_screen"); }), (Causes{{"off_screen", all}}));
  const auto with = [&](auto change) {
    return world.causes([&](std::uint32_t) {
      Explanation why = named("few_steps");
      change(why);
      return why;
    });
  };
  EXPECT_EQ(with([](Explanation& why) { why.taps = {cause_world::through(1, 0, 0)}; }), (Causes{{"few_steps", all}}));
  EXPECT_EQ(with([](Explanation& why) { why.outline_error = 1; }), (Causes{{"few_steps", all}}));
  EXPECT_EQ(with([](Explanation& why) { why.formula_differs = true; }), (Causes{{"formula", all}}));
  EXPECT_EQ(with([](Explanation& why) { why.covered = false; }), (Causes{{"beyond_coverage", all}}));
  world.right_on_mesh.assign(world.mask.size(), 1);
  EXPECT_EQ(with([](Explanation&) {}), (Causes{{"tessellation", all}}));
}

// Of every wrong pixel `causes` expects one cause, and of no other; those that the technique names are counted by hand.
TEST(own_causes, and_the_common_ones_are_exhaustive_over_random_masks_and_accounts) {
  std::mt19937 random(20);
  for (int round = 0; round < 8; ++round) {
    cause_world::World world = cause_world::shadow_of_two_by_two();
    world.own_causes = rows_of_both();
    world.rasterizes = round % 2;
    for (float& v : world.mask)
      if (random() % 4 == 0) v = static_cast<float>(random() % 5) / 4;
    std::vector<std::optional<Explanation>> whys(world.mask.size());
    std::map<std::string, std::uint64_t> expected;
    for (std::uint32_t i = 0; i < whys.size(); ++i) {
      if (random() % 5 == 0) continue;
      Explanation& why = whys[i].emplace();
      why.covered = random() % 4 != 0;
      why.formula_differs = random() % 4 == 0;
      if (random() % 2) why.cause = both[random() % 2].id;
      if (random() % 3 == 0) why.taps = {cause_world::through(0, 0, 0)};
      why.texel_width = 0.1;
      const bool is_wrong = world.classes[i] == PixelClass::T && gnomon::is_wrong(world.mask[i], world.truth[i]);
      if (is_wrong && why.covered && !why.formula_differs && !why.cause.empty()) ++expected[why.cause];
    }
    const Causes found = world.causes([&](std::uint32_t i) { return whys[i]; });
    std::uint64_t sum = 0;
    for (const auto& [name, count] : found) sum += count;
    EXPECT_EQ(sum, world.wrong());
    for (const OwnCause& cause : both) EXPECT_EQ(found.at(std::string(cause.id)), expected[std::string(cause.id)]) << cause.id;
  }
}

TEST(own_causes, hold_all_of_the_error_that_they_are_named_for_under_a_light_with_area) {
  soft_world::World world(cause_world::on_ground({cause_world::plate(-1, 1, -1, 1, 2)}), soft_world::lamp(0.5f));
  world.own_causes = rows_of_both();
  world.mask.assign(world.mask.size(), 1);
  EXPECT_EQ(world.shares([](std::uint32_t) { return named("off_screen"); }),
            (std::map<std::string, double>{{"off_screen", 1}}));
  // By turns: the sum of the named ones' errors, counted here, is what they hold; `shares` looks for exactly one a pixel.
  double all = 0, of_few = 0;
  for (std::size_t i = 0; i < world.mask.size(); ++i) {
    const double error = 1 - static_cast<double>(world.truth.area[i]);
    if (world.truth.classes[i] != PixelClass::T || error <= 4 * world.truth.area_error[i]) continue;
    all += error;
    if (i % 2) of_few += error;
  }
  const auto shares = world.shares([](std::uint32_t i) { return named(i % 2 ? "few_steps" : "off_screen"); });
  EXPECT_NEAR(shares.at("few_steps"), of_few / all, 1e-12);
  EXPECT_NEAR(shares.at("off_screen"), 1 - of_few / all, 1e-12);
  const auto refused = [&] { world.causes([](std::uint32_t) { return named("steps"); }); };
  EXPECT_THROW(refused(), Error);
}

TEST(own_causes, that_are_not_declared_are_an_error_which_says_what_is) {
  cause_world::World world = cause_world::behind_a_screen();
  world.mask.assign(world.mask.size(), 1);
  const auto message = [&] {
    try {
      world.causes([](std::uint32_t) { return named("off_scren"); });
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_EQ(message(), "an explanation names the cause off_scren, which the technique does not declare; it declares none");
  world.own_causes = rows_of_both();
  EXPECT_EQ(
      message(),
      "an explanation names the cause off_scren, which the technique does not declare; it declares off_screen, few_steps");
}

// What neither draws shadows nor looks them up has nothing that a raster could have snapped.
TEST(own_causes, an_edge_is_one_of_a_raster_only_where_shadows_are_drawn) {
  cause_world::World world = cause_world::shadow_of_two_by_two();
  std::uint32_t edge = world.pixel(0.5, 0);
  while (world.truth[edge] == 0) ++edge;
  ASSERT_EQ(world.classes[edge], PixelClass::T);
  world.mask[edge] = 0;
  EXPECT_EQ(world.causes(), (Causes{{"edge_raster", 1}}));
  world.rasterizes = false;
  EXPECT_EQ(world.causes(), (Causes{{"edge", 1}}));
}

TEST(own_causes, are_numbered_in_pictures_behind_the_common_ones_that_their_record_knows) {
  const std::vector<CauseInfo> own = rows_of_both();
  Causes counts = count_causes(std::vector{own_cause(1), own_cause(1), Cause::acne}, own);
  EXPECT_EQ(counts.at("few_steps"), 2u);
  EXPECT_EQ(counts.at("off_screen"), 0u);
  EXPECT_EQ(counts.at("acne"), 1u);
  EXPECT_EQ(counts.size(), cause_infos().size() + 2);
  const auto first = static_cast<float>(cause_infos().size()) + 1;
  EXPECT_EQ(causes_from_numbers(std::vector{first, first + 1}, counts, own), (std::vector{own_cause(0), own_cause(1)}));
  EXPECT_THROW(causes_from_numbers(std::vector{first + 2}, counts, own), Error);
  // A program that knew no `edge` numbered all behind it, and the own ones, one lower.
  counts.erase("edge");
  const float region = static_cast<float>(Cause::region) - 1;
  EXPECT_EQ(causes_from_numbers(std::vector{region, first - 1, first}, counts, own),
            (std::vector{Cause::region, own_cause(0), own_cause(1)}));
  // One that called its own cause what is a common one today: the number is its own.
  std::vector<CauseInfo> old = own;
  old[0].name = "edge";
  counts["edge"] = 0;
  EXPECT_EQ(causes_from_numbers(std::vector{region, first - 1}, counts, old), (std::vector{Cause::region, own_cause(0)}));
}

class Declared : public testing::Test {
 protected:
  /// What is said of techniques a, b .. with these causes; empty where nothing is.
  static std::string complaint(std::initializer_list<std::vector<OwnCause>> techniques) {
    std::vector<TechniqueEntry> entries;
    for (const std::vector<OwnCause>& causes : techniques) {
      TechniqueEntry& entry = entries.emplace_back();
      entry.id = std::string(1, static_cast<char>('a' + entries.size() - 1));
      entry.about.causes = causes;
    }
    try {
      check_own_causes(entries);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }
  static OwnCause with_id(std::string_view id) { return {id, "It is so.", off_screen.color}; }
  static OwnCause colored(std::array<std::uint8_t, 3> color) { return {"blot", "It is so.", color}; }
};

TEST_F(Declared, names_are_plain_free_and_there_once) {
  EXPECT_EQ(complaint({{off_screen, few_steps}, {}}), "");
  for (const char* id : {"", "Off", "off screen", "off-screen", "2nd", "caf\xc3\xa9"})
    EXPECT_NE(complaint({{with_id(id)}}).find("is not plain"), std::string::npos) << id;
  for (const char* id : {"acne", "edge", "reference_error", "unexplained", "none"})
    EXPECT_EQ(complaint({{with_id(id)}}),
              fmt::format("cause {} of technique a: the name is taken by a common cause (`gnomon list causes`)", id));
  EXPECT_EQ(complaint({{}, {off_screen, few_steps, off_screen}}), "cause off_screen of technique b is declared twice");
  EXPECT_EQ(complaint({{{"blot", " ", off_screen.color}}}),
            "cause blot of technique a has no sentence that says what it means");
  EXPECT_EQ(complaint({std::vector(33, off_screen)}), "technique a declares 33 causes; 32 are allowed");
}

TEST_F(Declared, one_name_means_one_thing_in_all_techniques) {
  EXPECT_EQ(complaint({{off_screen}, {few_steps, off_screen}}), "");
  OwnCause other = off_screen;
  other.sentence = "The light is out of the picture.";
  EXPECT_EQ(complaint({{off_screen}, {other}}),
            "techniques a and b have a cause off_screen each with another sentence or color; one name means one thing");
  other = off_screen;
  other.color = few_steps.color;
  EXPECT_NE(complaint({{off_screen}, {other}}), "");
}

TEST_F(Declared, colors_stay_apart_and_one_that_is_free_is_told) {
  // The color of acne itself, 2 levels beside it, a gray of the pictures, and that of another cause of the same technique.
  EXPECT_NE(complaint({{colored({224, 120, 0})}}).find("its color #e07800 is 0.0 from that of acne"), std::string::npos);
  EXPECT_NE(complaint({{colored({226, 120, 0})}}).find("from that of acne"), std::string::npos);
  EXPECT_NE(complaint({{colored({100, 100, 100})}}).find("from that of the pictures' gray"), std::string::npos);
  EXPECT_NE(complaint({{off_screen, colored({252, 4, 132})}}).find("from that of off_screen"), std::string::npos);
  const std::string words = complaint({{colored({224, 120, 0})}});
  const std::size_t hash = words.rfind('#');
  ASSERT_NE(hash, std::string::npos);
  const unsigned long rgb = std::stoul(words.substr(hash + 1, 6), nullptr, 16);
  const auto level = [&](int shift) { return static_cast<std::uint8_t>(rgb >> shift & 255); };
  EXPECT_EQ(complaint({{colored({level(16), level(8), level(0)})}}), "") << words;
}

// docs/causes.md lists colors for authors: all of them may be had together.
TEST_F(Declared, the_colors_of_the_page_are_free_together) {
  std::ifstream page(tree_file("docs/causes.md"));
  std::vector<OwnCause> causes;
  std::vector<std::string> names(most_own_causes);
  for (std::string line; std::getline(page, line);) {
    if (!line.starts_with("| `{")) continue;
    int r = 0, g = 0, b = 0;
    ASSERT_EQ(std::sscanf(line.c_str(), "| `{%d, %d, %d}`", &r, &g, &b), 3) << line;
    std::string& name = names[causes.size()] = fmt::format("free_{}", causes.size());
    causes.push_back({name, "It is so.", {std::uint8_t(r), std::uint8_t(g), std::uint8_t(b)}});
  }
  EXPECT_GE(causes.size(), 10u);
  EXPECT_EQ(complaint({causes}), "");
}

TEST(own_causes, of_the_techniques_of_this_program_stand_beside_the_common_ones) {
  EXPECT_NO_THROW(check_own_causes(registry().techniques()));
}

}  // namespace own_causes_test
