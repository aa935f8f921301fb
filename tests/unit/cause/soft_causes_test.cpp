// Each cause of soft errors made alone, and found under its name.
#include <gnomon/error.h>
#include <gnomon/kit/area/area_rays.h>

#include <random>

#include "soft_world.h"

namespace soft_causes_test {

using namespace gnomon;
using namespace gnomon::soft_world;
using cause_world::on_ground;
using cause_world::plate;

constexpr float half = 0.6f;

/// A plate of 2.4 m square at 2 m below a lamp of 1.2 m square at 6 m: its umbra on the ground is 3 m wide, its penumbra 0.6 m.
World plate_and_lamp() { return World(on_ground({plate(-1.2f, 1.2f, -1.2f, 1.2f, 2)}), lamp(half)); }

TEST(soft_causes, a_right_mask_has_no_cause_but_the_reference_s_own_error) {
  World world = plate_and_lamp();
  EXPECT_TRUE(world.shares().empty());
  std::ranges::copy(world.seen_of(world.light, on_ground({plate(-1.2f, 1.2f, -1.2f, 1.2f, 2)})), world.mask.begin());
  EXPECT_TRUE(world.shares().empty());
  // The same shares from another set of rays differ by what both may be off by.
  for (std::size_t i = 0; i < world.mask.size(); ++i) world.mask[i] = std::clamp(world.mask[i] + 0.002f, 0.0f, 1.0f);
  for (const Cause cause : world.causes()) EXPECT_TRUE(cause == Cause::none || cause == Cause::reference_error);
}

TEST(soft_causes, the_light_s_size) {
  World world = plate_and_lamp();
  for (const float factor : {1.3f, 1.8f}) {
    world.mask = world.seen_of(lamp(factor * half));
    EXPECT_GT(world.shares()["too_wide"], 0.95) << factor;
  }
  for (const float factor : {0.75f, 0.4f}) {
    world.mask = world.seen_of(lamp(factor * half));
    EXPECT_GT(world.shares()["too_narrow"], 0.9) << factor;
  }
}

TEST(soft_causes, the_light_s_place) {
  World world = plate_and_lamp();
  world.mask = world.seen_of(lamp(half, {0.3f, 0.1f}));
  EXPECT_GT(world.shares()["shifted"], 0.9);
}

TEST(soft_causes, a_hard_shadow) {
  World world = plate_and_lamp();
  for (const glm::vec3 place : {glm::vec3(0, 6, 0), glm::vec3(0.5f, 6, -0.5f)}) {
    const Light point = hand_made::point_light(place);
    trace_shadows(world.casters, world.scene, world.gbuffer, point, world.mask);
    EXPECT_GT(world.shares()["hard_shadow"], 0.97);
    // The same with the one place that was sampled.
    const auto why = [&](std::uint32_t i) {
      Explanation all;
      all.samples = {{place, 1, world.mask[i]}};
      return all;
    };
    EXPECT_GT(world.shares(why)["hard_shadow"], 0.999);
  }
}

TEST(soft_causes, places_that_every_pixel_draws_anew) {
  World world = plate_and_lamp();
  std::mt19937 random(3);
  for (std::size_t i = 0; i < world.mask.size(); ++i)
    world.mask[i] = static_cast<float>(std::binomial_distribution<int>(16, world.truth.area[i])(random)) / 16;
  EXPECT_GT(world.shares()["noise"], 0.9);
}

TEST(soft_causes, few_levels) {
  // Sixteen places in four rows, the same for every pixel: a straight edge along the rows passes four at once.
  World world(on_ground({plate(-1.2f, 1.2f, -1.2f, 1.2f, 2)}), lamp(1.2f));
  for (float& v : world.mask) v = std::round(v * 4) / 4;
  EXPECT_GT(world.shares()["banding"], 0.9);
}

/// Places of the lamp and what is seen of them from pixel i.
Explanation asked(const World& world, std::uint32_t i, std::span<const glm::vec3> places) {
  Explanation why;
  for (const glm::vec3& place : places) {
    std::vector<float> v(1);
    const glm::dvec3 point = glm::dvec3(world.gbuffer.position(i)) + glm::dvec3(0, 1e-5, 0);
    const bool is_seen = world.casters.closest(point, glm::dvec3(place) - point).t >= 1;
    why.samples.push_back({place, 1.0 / static_cast<double>(places.size()), is_seen ? 1.0 : 0.0});
  }
  return why;
}

float mean_of(const Explanation& why) {
  double sum = 0;
  for (const LightSample& sample : why.samples) sum += sample.weight * sample.visibility;
  return static_cast<float>(sum);
}

std::vector<glm::vec3> drawn(std::mt19937& random, int count, float size = half) {
  std::uniform_real_distribution<float> uniform(-size, size);
  std::vector<glm::vec3> places;
  for (int k = 0; k < count; ++k) {
    const float x = uniform(random), z = uniform(random);
    places.emplace_back(x, 6, z);
  }
  return places;
}

TEST(soft_causes, samples_tell_noise_from_banding) {
  World world = plate_and_lamp();
  std::vector<Explanation> whys(world.mask.size());
  const auto why = [&](std::uint32_t i) { return whys[i]; };
  const auto resolve = [&](const auto& places_of) {
    for (std::uint32_t i = 0; i < world.mask.size(); ++i) {
      if (world.truth.classes[i] != PixelClass::T) continue;
      whys[i] = asked(world, i, places_of(i));
      world.mask[i] = mean_of(whys[i]);
    }
  };
  resolve([](std::uint32_t i) {
    std::mt19937 random(i);
    return drawn(random, 32);
  });
  EXPECT_GT(world.shares(why)["noise"], 0.99);
  resolve([](std::uint32_t) {
    std::mt19937 random(1);
    return drawn(random, 32);
  });
  EXPECT_GT(world.shares(why)["banding"], 0.99);
  // Places of the middle of the lamp alone: that is no noise of so many.
  resolve([](std::uint32_t i) {
    std::mt19937 random(i);
    return drawn(random, 256, half / 3);
  });
  EXPECT_GT(world.shares(why)["too_narrow"], 0.9);
}

TEST(soft_causes, samples_that_say_otherwise) {
  World world = plate_and_lamp();
  std::mt19937 random(1);
  const std::vector<glm::vec3> places = drawn(random, 16);
  std::vector<Explanation> whys(world.mask.size());
  for (std::uint32_t i = 0; i < world.mask.size(); ++i) {
    if (world.truth.classes[i] != PixelClass::T) continue;
    whys[i] = asked(world, i, places);
    for (LightSample& sample : whys[i].samples) sample.visibility = 1 - sample.visibility;
    world.mask[i] = mean_of(whys[i]);
  }
  EXPECT_GT(world.shares([&](std::uint32_t i) { return whys[i]; })["false_sample"], 0.95);
}

TEST(soft_causes, penumbrae_joined_as_if_casters_knew_nothing_of_each_other) {
  // Two plates at two heights, whose shadows from the lamp's center end at the same line, x = -0.75, one from either side:
  // there each hides the half that the other leaves.
  const Mesh low = plate(-4, -2.5f, -2, 2, 2), high = plate(-3.375f, -2.25f, -2, 2, 3);
  World world(on_ground({low, high}), lamp(half, {-6, 0}));
  const std::vector<float> by_low = world.seen_of(world.light, on_ground({low})),
                           by_high = world.seen_of(world.light, on_ground({high}));
  for (std::size_t i = 0; i < world.mask.size(); ++i) world.mask[i] = by_low[i] * by_high[i];
  EXPECT_GT(world.shares()["caster_fusion"], 0.9);
  for (std::size_t i = 0; i < world.mask.size(); ++i) world.mask[i] = std::min(by_low[i], by_high[i]);
  EXPECT_GT(world.shares()["caster_fusion"], 0.9);
}

TEST(soft_causes, light_in_the_umbra_and_dark_in_the_light) {
  World world(on_ground({plate(-3, -0.5f, -3, 3, 2)}), lamp(0.2f));
  for (std::uint32_t i = 0; i < world.mask.size(); ++i) {
    const float x = world.gbuffer.px[i], z = world.gbuffer.pz[i];
    if (world.gbuffer.mesh[i] == 0 && x > 2 && x < 3 && z > -1 && z < 1) world.mask[i] = 0.4f;
  }
  EXPECT_EQ(world.shares(), (std::map<std::string, double>{{"region", 1}}));
  world.mask = world.truth.area;
  std::vector<std::uint32_t> lit;
  for (std::uint32_t i = 0; i < world.mask.size(); ++i)
    if (world.gbuffer.px[i] > 2 && world.truth.classes[i] == PixelClass::T) lit.push_back(i);
  for (std::size_t k = 0; k < lit.size(); k += 97) world.mask[lit[k]] = 0.2f;
  EXPECT_EQ(world.shares(), (std::map<std::string, double>{{"crack", 1}}));
  // A lamp at the side: the umbra is from x = -3 to 1.5, and the eye sees it beside the plate.
  Light aside = lamp(0.2f, {-6, 0});
  World dark(on_ground({plate(-4, -1, -3, 3, 2)}), aside);
  for (std::uint32_t i = 0; i < dark.mask.size(); ++i)
    if (dark.gbuffer.mesh[i] == 0 && std::abs(dark.gbuffer.px[i]) < 0.8f) dark.mask[i] = 0.4f;
  EXPECT_EQ(dark.shares(), (std::map<std::string, double>{{"lost_umbra", 1}}));
}

TEST(soft_causes, a_shadow_that_is_not_there) {
  World world = plate_and_lamp();
  std::ranges::fill(world.mask, 1.0f);
  EXPECT_EQ(world.shares(), (std::map<std::string, double>{{"missing_caster", 1}}));
}

TEST(soft_causes, what_is_below_the_horizon) {
  // A lamp that stands upright, one half of it below the ground.
  const Light light{.name = "lamp", .kind = RectLight{{5, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  World world(on_ground({}), light);
  const auto is_tested = [&](std::size_t i) { return world.truth.classes[i] == PixelClass::T; };
  for (std::size_t i = 0; i < world.mask.size(); ++i) world.mask[i] = is_tested(i) ? 0.5f : 1.0f;
  ASSERT_GT(std::ranges::count(world.mask, 0.5f), 100);
  EXPECT_EQ(world.shares(), (std::map<std::string, double>{{"horizon", 1}}));
  const auto why = [](std::uint32_t) {
    Explanation all;
    all.samples = {{{5, 0.5, 0.3}, 0.5, 1}, {{5, -0.5, 0.3}, 0.5, 0}};
    return all;
  };
  EXPECT_EQ(world.shares(why), (std::map<std::string, double>{{"horizon", 1}}));
}

TEST(soft_causes, what_the_technique_says_of_itself) {
  World world = plate_and_lamp();
  world.mask = world.seen_of(lamp(2 * half));
  const auto why = [](std::uint32_t i) {
    Explanation all;
    all.covered = i % 2 == 0;
    all.formula_differs = true;
    return all;
  };
  const auto shares = world.shares(why);
  EXPECT_NEAR(shares.at("beyond_coverage") + shares.at("formula"), 1, 1e-12);
  world.right_on_mesh.assign(world.mask.size(), 1);
  EXPECT_EQ(world.shares(), (std::map<std::string, double>{{"tessellation", 1}}));
}

/// A map from the lamp's center with a filter as wide as the penumbra.
TEST(soft_causes, maps_from_the_center) {
  World world(on_ground({plate(-3, -0.5f, -3, 3, 2)}), lamp(half));
  const Light center = hand_made::point_light({0, 6, 0});
  const auto shares_of = [&](const TestMap::Settings& settings) {
    const TestMap map(world.scene, world.casters, center, settings);
    world.mask = world.truth.area;
    for (std::uint32_t i = 0; i < world.mask.size(); ++i)
      if (world.truth.classes[i] == PixelClass::T) world.mask[i] = map.visibility(world.gbuffer, i);
    return world.shares([&](std::uint32_t i) { return map.explain(world.gbuffer, i); });
  };
  // Without any bias, half of every filter is dark on lit ground.
  EXPECT_GT(shares_of({.texel = 0.05, .bias = 0, .radius = 2})["acne"], 0.8);
  // A filter of 1.5 m in place of a penumbra of 0.6 m, one of 0.1 m.
  EXPECT_GT(shares_of({.texel = 0.1, .bias = 0.1, .radius = 7, .receiver_plane = true})["too_wide"], 0.8);
  auto narrow = shares_of({.texel = 0.02, .bias = 0.02, .radius = 1, .receiver_plane = true});
  EXPECT_GT(narrow["too_narrow"] + narrow["hard_shadow"], 0.9);
  // The plate is 2 m above the ground, and so is nearer than the bias.
  EXPECT_GT(shares_of({.texel = 0.05, .bias = 2.5, .radius = 2, .receiver_plane = true})["peter_panning"], 0.8);
}

TEST(soft_causes, maps_that_look_aside_or_hold_another_surface) {
  // The lamp is 45 degrees aside: a point lifted by twenty texels of 5 cm is looked up 1 m nearer to it.
  const Light aside = lamp(0.2f, {-6, 0});
  World world(on_ground({plate(-4, -1, -3, 3, 2)}), aside);
  const auto shares_of = [&](const TestMap::Settings& settings) {
    const TestMap map(world.scene, world.casters, hand_made::point_light({-6, 6, 0}), settings);
    world.mask = world.truth.area;
    for (std::uint32_t i = 0; i < world.mask.size(); ++i)
      if (world.truth.classes[i] == PixelClass::T && world.gbuffer.mesh[i] == 0)
        world.mask[i] = map.visibility(world.gbuffer, i);
    return world.shares([&](std::uint32_t i) { return map.explain(world.gbuffer, i); });
  };
  EXPECT_GT(shares_of({.texel = 0.05, .bias = 0.02, .radius = 1, .normal_offset = 20, .receiver_plane = true})["lookup_shift"],
            0.9);
  // The second surface behind the plate's one is the ground: light in all of the shadow, 2 m below its caster.
  EXPECT_GT(
      shares_of({.texel = 0.05, .bias = 0.02, .radius = 1, .receiver_plane = true, .second = true})["leak_representation"],
      0.9);
}

TEST(soft_causes, an_unexplained_pixel_is_left) {
  // The reference is made to say 0.985 at a lit pixel.
  World world(on_ground({}), lamp(half));
  const auto at = static_cast<std::size_t>(world.gbuffer.width) * 20 + 26;
  ASSERT_EQ(world.truth.classes[at], PixelClass::T);
  world.truth.area[at] = 0.985f;
  world.mask[at] = 0.5f;
  EXPECT_EQ(world.causes()[at], Cause::unexplained);
  world.mask[at] = 1;  // the reference traced again says so, too
  EXPECT_EQ(world.causes()[at], Cause::reference_error);
}

// A filter that errs by what 16 taps may err by is noise where nothing else holds; 400 that err as much are not.
TEST(soft_causes, few_taps_of_a_filter_are_noise) {
  World world(on_ground({plate(3, 3.6f, 3, 3.6f, 2)}), lamp(half));
  const auto at = static_cast<std::uint32_t>(world.gbuffer.width) * 20 + 26;
  ASSERT_EQ(world.truth.classes[at], PixelClass::T);
  world.truth.area[at] = 0.985f;
  world.mask[at] = 0.8125f;
  const glm::dvec3 light(0, 6, 0), point = world.gbuffer.position(at), plate_middle(3.3, 2, 3.3);
  const auto with_taps = [&](int count) {
    return world.causes([&](std::uint32_t) {
      Explanation why;
      why.bias = why.texel_width = 0.01;
      for (int k = 0; k < count; ++k) {
        const bool is_dark = k % 16 < 3;
        const glm::dvec3 to = (is_dark ? plate_middle : point) - light;
        why.taps.push_back({light, glm::normalize(to), 1.0 / count, is_dark ? glm::length(to) : INFINITY});
      }
      return why;
    })[at];
  };
  EXPECT_EQ(with_taps(16), Cause::noise);
  EXPECT_EQ(with_taps(400), Cause::unexplained);
}

}  // namespace soft_causes_test
