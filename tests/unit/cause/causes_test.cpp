#include "measure/cause/causes.h"

#include <gnomon/error.h>
#include <gtest/gtest.h>

#include "cause_world.h"

namespace causes_test {

using namespace gnomon;
using namespace gnomon::cause_world;

TEST(causes, tessellation_is_right_on_the_mesh_and_comes_first) {
  World world(on_ground({}));
  world.right_on_mesh.assign(world.mask.size(), 0);
  world.mask[100] = world.mask[200] = 0;
  world.right_on_mesh[100] = 1;
  world.right_on_mesh[300] = 1;  // right on both: no error at all
  const auto not_covered = [](std::uint32_t) {
    Explanation why;
    why.covered = false;
    return why;
  };
  EXPECT_EQ(world.causes(not_covered), (Causes{{"tessellation", 1}, {"beyond_coverage", 1}}));
}

// A lit pixel four pixels (0.52 m) from the shadow's edge is called dark. An outline that may be off by 0.55 m explains it, one
// that may be off by 0.3 m does not: across the light's ray an edge is nearer than along the ground, but a ray that leans by
// less than 45 degrees brings 0.52 m down to no less than 0.36 m.
TEST(causes, polygons_that_stand_for_a_curve_are_tessellation_as_far_as_their_outline_may_be_off) {
  World world(on_ground({plate(-3, -1, -1, 1, 2)}), slanted);
  const int width = world.gbuffer.width;
  std::uint32_t lit = 0;
  for (std::uint32_t i = 8; lit == 0 && i + 8 < world.mask.size(); ++i) {
    // Dark, then lit for a while, in one row.
    bool edge = world.truth[i] == 0 && i % width > 4 && i % width + 12 < std::uint32_t(width);
    for (std::uint32_t k = 1; k <= 8; ++k) edge = edge && world.truth[i + k] == 1 && world.classes[i + k] == PixelClass::T;
    if (edge) lit = i + 4;
  }
  ASSERT_NE(lit, 0u);
  world.mask[lit] = 0;
  const auto off_by = [](double meters) {
    return [meters](std::uint32_t) {
      Explanation why;
      why.outline_error = meters;
      return why;
    };
  };
  EXPECT_EQ(world.causes(off_by(0.55)), (Causes{{"tessellation", 1}}));
  EXPECT_EQ(world.causes(off_by(0.3)), (Causes{{"crack", 1}}));
  EXPECT_EQ(world.causes(off_by(0)), (Causes{{"crack", 1}}));
}

TEST(causes, beyond_coverage_is_what_the_technique_says_and_comes_before_missing_casters) {
  World world(on_ground({plate(-3, -1, -1, 1, 2)}), slanted);
  world.mask.assign(world.mask.size(), 1);  // the whole shadow is missing
  const auto not_covered = [](std::uint32_t) {
    Explanation why;
    why.covered = false;
    return why;
  };
  EXPECT_GT(world.wrong(), 100u);
  EXPECT_EQ(world.causes(not_covered), (Causes{{"beyond_coverage", world.wrong()}}));
}

// Said of false lit and of false dark pixels alike, and of pixels that are right: those have no cause.
TEST(causes, formula_is_what_the_technique_says_after_its_coverage_and_before_missing_casters) {
  World world(on_ground({plate(-3, -1, -1, 1, 2)}), slanted);
  world.mask.assign(world.mask.size(), 1);  // the whole shadow is missing
  const std::uint64_t lit = world.wrong();
  const std::uint32_t other = world.pixel(3, 2);
  world.mask[other] = 0;
  const auto differs = [&](bool covered) {
    return [covered](std::uint32_t) {
      Explanation why;
      why.formula_differs = true;
      why.covered = covered;
      why.outline_error = 1;
      return why;
    };
  };
  EXPECT_GT(lit, 100u);
  EXPECT_EQ(world.causes(differs(true)), (Causes{{"formula", lit + 1}}));
  EXPECT_EQ(world.causes(differs(false)), (Causes{{"beyond_coverage", lit + 1}}));
  // Pixel by pixel: what is wrong elsewhere keeps its own cause.
  EXPECT_EQ(world.causes([&](std::uint32_t i) {
    Explanation why;
    why.formula_differs = i == other;
    return why;
  }),
            (Causes{{"formula", 1}, {"missing_caster", lit}}));
  world.right_on_mesh.assign(world.mask.size(), 1);
  EXPECT_EQ(world.causes(differs(true)), (Causes{{"tessellation", lit + 1}}));
}

TEST(causes, a_shadow_that_is_lit_is_a_missing_caster) {
  World world(on_ground({plate(-3, -1, -1, 1, 2)}), slanted);
  const std::vector<float> truth = world.truth;
  world.mask.assign(world.mask.size(), 1);
  const std::uint64_t all = world.wrong();
  EXPECT_GT(all, 100u);
  EXPECT_EQ(world.causes(), (Causes{{"missing_caster", all}}));
  // False dark elsewhere is none of it.
  World dark(on_ground({plate(-3, -1, -1, 1, 2)}), slanted);
  dark.mask.assign(dark.mask.size(), 1);
  dark.mask[dark.pixel(3, 2)] = 0;
  EXPECT_EQ(dark.causes(), (Causes{{"missing_caster", all}, {"crack", 1}}));
  // With a tenth of it dark, the caster is there.
  std::uint64_t left = (static_cast<std::uint64_t>(std::ranges::count(truth, 0.0f)) + 9) / 10;
  for (std::size_t i = 0; i < truth.size() && left > 0; ++i)
    if (truth[i] == 0) world.mask[i] = 0, --left;
  EXPECT_FALSE(world.causes().contains("missing_caster"));
}

TEST(causes, a_shadow_of_seven_pixels_or_beside_another_object_s_is_judged_alone) {
  // Plates of one pixel's width, 0.129 m on the ground, seven and nine pixels long; the sun shifts their shadows aside.
  const auto strip = [](float z, int pixels) {
    const float pixel = 8.284f / 64;
    return plate(-3, -3 + pixel * static_cast<float>(pixels), z, z + pixel, 2);
  };
  for (const int length : {6, 7, 8, 9}) {
    World world(on_ground({strip(0.02f, length)}), slanted);
    const auto size =
        static_cast<std::uint64_t>(std::ranges::count_if(world.nearest_caster, [](std::uint32_t m) { return m == 1; }));
    ASSERT_NEAR(double(size), length, 1);
    world.mask.assign(world.mask.size(), 1);
    EXPECT_EQ(world.causes().contains("missing_caster"), size >= 8) << size;
  }
  // Two plates whose shadows touch: one is drawn, the other is not.
  World pair(on_ground({plate(-3, -2, -1, 0, 2), plate(-3, -2, 0, 1, 2)}), slanted);
  std::uint64_t second = 0;
  for (std::size_t i = 0; i < pair.mask.size(); ++i)
    if (pair.nearest_caster[i] == 2) pair.mask[i] = 1, second += pair.classes[i] == PixelClass::T;
  EXPECT_GT(second, 30u);
  EXPECT_EQ(pair.causes(), (Causes{{"missing_caster", second}}));
}

TEST(causes, without_taps_size_and_distance_to_the_edge_decide) {
  World world = behind_a_screen();
  const auto flip = [&](std::uint32_t i, int columns, int rows) {
    for (int y = 0; y < rows; ++y)
      for (int x = 0; x < columns; ++x) {
        ASSERT_EQ(world.classes[i + y * 64 + x], PixelClass::T);
        world.mask[i + y * 64 + x] = 1 - world.truth[i + y * 64 + x];
      }
  };
  // The shadow's far edge: its first lit column at x = 3. Both columns beside it are the boundary itself; the next one is 1
  // pixel away, the one after that 2.
  std::uint32_t edge = world.pixel(2.8, 0);
  while (world.truth[edge] == 0) ++edge;
  const std::vector<float> right = world.mask;
  flip(edge + 1, 1, 9);
  EXPECT_EQ(world.causes(), (Causes{{"edge_raster", 9}}));
  world.mask = right;
  flip(edge + 2, 2, 2);
  EXPECT_EQ(world.causes(), (Causes{{"crack", 4}}));
  world.mask = right;
  flip(edge + 2, 5, 1);
  EXPECT_EQ(world.causes(), (Causes{{"region", 5}}));
  // What touches an edge counts its far pixels only; diagonal neighbors are connected.
  world.mask = right;
  flip(edge, 4, 1);
  EXPECT_EQ(world.causes(), (Causes{{"edge_raster", 2}, {"crack", 2}}));
  world.mask = right;
  for (int k = 0; k < 5; ++k) flip(edge + 3 + k * 65, 1, 1);
  EXPECT_EQ(world.causes(), (Causes{{"region", 5}}));
  // An account without taps, of the element that decided, changes nothing.
  EXPECT_EQ(world.causes([](std::uint32_t) {
    Explanation why;
    why.element = 7;
    return why;
  }),
            (Causes{{"region", 5}}));
}

TEST(causes, an_edge_of_a_shadow_thinner_than_a_pixel_is_an_edge_where_the_raster_may_reach_it) {
  // A strip whose shadow, 1 cm wide, begins 0.3 mm or 3 mm beside a pixel's point, where a pixel is 129 mm: 1/430 and 1/43
  // pixel. No pixel is in it, so the picture of the reference has no edge; snapping to 1/256 pixel explains the first.
  const World ground(on_ground({}), slanted);
  const glm::dvec3 p = ground.point(ground.pixel(1, 0.2));
  for (const double gap : {0.0003, 0.003}) {
    const auto begin = static_cast<float>(p.x + gap - 2);
    World world(on_ground({plate(begin, begin + 0.01f, -1, 1, 2)}), slanted);
    const std::uint32_t i = world.pixel(1, 0.2);
    ASSERT_EQ(world.classes[i], PixelClass::T);
    ASSERT_EQ(std::ranges::count(world.truth, 0.0f), 0);
    world.mask[i] = 0;
    EXPECT_EQ(world.causes(), (Causes{{gap < 0.001 ? "edge_raster" : "crack", 1}}));
  }
}

TEST(causes, dark_where_nothing_is_stored_is_unexplained) {
  World world(on_ground({}), slanted);
  const std::uint32_t i = world.pixel(2, 1);
  world.mask[i] = 0;
  EXPECT_EQ(world.causes([&](std::uint32_t) { return tapped(through(2, 1, -INFINITY), 0.1); }), (Causes{{"unexplained", 1}}));
}

TEST(causes, a_technique_that_explains_another_number_of_pixels_is_an_error) {
  World world(on_ground({}));
  world.mask[100] = 0;
  const Reference r = world.reference();
  const auto none = [](std::span<const std::uint32_t>) { return std::vector<std::optional<Explanation>>(); };
  EXPECT_THROW(find_causes({world.scene, world.casters, world.gbuffer, world.light, r, world.mask, {}, none}), Error);
  // No explanation is no error: then it is a technique without an account.
  EXPECT_EQ(count_causes(find_causes({world.scene, world.casters, world.gbuffer, world.light, r, world.mask, {}, {}}))["crack"],
            1u);
}

}  // namespace causes_test
