// Masks that are wrong for one known reason, over scenes of many edges: at least 95 % of what is wrong has that reason's name.
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <random>

#include "measure/cause/whole_mask.h"
#include "soft_world.h"

namespace constructed_causes_test {

using namespace gnomon;
using cause_world::on_ground;
using cause_world::plate;

constexpr double least_share = 0.95;

/// Boards of half a meter and more at many heights over the ground.
Scene many_boards(float lowest, float highest) {
  std::mt19937 random(5);
  const auto uniform = [&](float low, float high) { return std::uniform_real_distribution<float>(low, high)(random); };
  std::vector<Mesh> boards;
  for (int k = 0; k < 14; ++k) {
    const float x = uniform(-4, 2.5f), z = uniform(-3, 3), along = uniform(0.5f, 1.4f), aside = uniform(0.5f, 1.4f);
    boards.push_back(plate(x, x + along, z, z + aside, uniform(lowest, highest)));
  }
  return on_ground(std::move(boards));
}

/// Slats side by side, one pixel (0.13 m) and less wide, and as far from each other.
Scene slats() {
  std::vector<Mesh> all;
  for (int k = 0; k < 24; ++k) {
    const float x = -5 + 0.25f * static_cast<float>(k);
    all.push_back(plate(x, x + 0.12f, -3, 3, 2));
  }
  return on_ground(std::move(all));
}

/// The share of the named cause of the wrong pixels of the ground, which are 30 or more.
double share(cause_world::World& world, const TestMap& map, const std::string& cause) {
  world.take(map, [&](std::uint32_t i, float) { return world.gbuffer.mesh[i] == 0; });
  EXPECT_GE(world.wrong(), 30u);
  const cause_world::Causes causes = world.causes(map);
  const auto found = causes.find(cause);
  return found == causes.end() ? 0 : static_cast<double>(found->second) / static_cast<double>(world.wrong());
}

struct MapCase {
  const char* cause;
  Scene scene;
  TestMap::Settings settings;
};

TEST(constructed_causes, of_maps) {
  const MapCase cases[] = {
      {"filter_width", slats(), {.texel = 0.01, .bias = 0.01, .radius = 12, .receiver_plane = true}},
      {"edge_resolution", many_boards(1, 3), {.texel = 0.3, .bias = 0.01, .receiver_plane = true}},
      {"peter_panning", many_boards(0.5f, 1), {.texel = 0.02, .bias = 2}},
      {"acne", many_boards(1, 3), {.texel = 0.1, .bias = 0}},
      {"lookup_shift", many_boards(1, 3), {.texel = 0.02, .bias = 0.01, .normal_offset = 20, .receiver_plane = true}},
  };
  for (const MapCase& c : cases) {
    cause_world::World world(c.scene, cause_world::slanted);
    const TestMap map(world.scene, world.casters, world.light, c.settings);
    EXPECT_GE(share(world, map, c.cause), least_share)
        << c.cause << ' ' << fmt::format("{}", fmt::join(world.causes(map), " "));
  }
}

// The texels hold the casters, and every third shadow pixel is lit all the same.
TEST(constructed_causes, of_a_map_that_does_not_believe_its_texels) {
  cause_world::World world(many_boards(1, 3), cause_world::slanted);
  const TestMap map(world.scene, world.casters, world.light, {.texel = 0.02, .bias = 0.01, .receiver_plane = true});
  for (std::size_t i = 0; i < world.mask.size(); i += 3) world.mask[i] = 1;
  const cause_world::Causes causes = world.causes(map);
  EXPECT_GE(static_cast<double>(causes.at("leak_representation")), least_share * static_cast<double>(world.wrong()));
}

// All that casts is lifted by the bias, or left out of the map: the mask is the same, all lit, and the taps tell them apart.
TEST(constructed_causes, a_lifted_caster_is_told_from_one_that_is_not_in_the_map) {
  const Scene scene = many_boards(0.5f, 1), empty = on_ground({});
  cause_world::World world(scene, cause_world::slanted);
  const RayScene nothing(empty, Truth::mesh, RayScene::Which::casters);
  EXPECT_GE(share(world, TestMap(scene, world.casters, world.light, {.texel = 0.02, .bias = 4}), "peter_panning"), least_share);
  EXPECT_GE(share(world, TestMap(scene, nothing, world.light, {.texel = 0.02, .bias = 0.01}), "missing_caster"), least_share);
}

/// The mask of another program, and what is said of it.
template <class World>
std::optional<WholeMask> whole_of(const World& world, const Reference& reference) {
  return find_whole_mask({world.scene, world.casters, world.gbuffer, world.light, reference, world.mask, {}, nullptr});
}

/// The named cause's share of the error of pixels that have a cause but the reference's own noise.
template <class World>
double whole_share(const World& world, Cause cause) {
  const Reference reference = world.reference();
  Attribution asked{world.scene, world.casters, world.gbuffer, world.light, reference, world.mask, {}, nullptr};
  const std::optional<WholeMask> whole = find_whole_mask(asked);
  if (!whole) return 0;
  asked.whole = &*whole;
  const std::vector<Cause> causes = find_causes(asked);
  double named = 0, all = 0;
  for (std::size_t i = 0; i < causes.size(); ++i) {
    if (causes[i] == Cause::none || causes[i] == Cause::reference_error) continue;
    const double error = std::abs(static_cast<double>(world.mask[i]) - reference.mask[i]);
    all += error;
    if (causes[i] == cause) named += error;
  }
  EXPECT_GT(all, 0);
  return named / all;
}

/// Of values a picture of 64 x 64 pixels; beside it the rim repeats.
std::vector<float> moved(const std::vector<float>& v, double right, double down) {
  std::vector<float> to(v.size());
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      const double fx = std::clamp(x - right, 0.0, 63.0), fy = std::clamp(y - down, 0.0, 63.0);
      const int left = std::min(62, static_cast<int>(fx)), top = std::min(62, static_cast<int>(fy));
      const double u = fx - left, w = fy - top;
      const auto at = [&](int a, int b) { return static_cast<double>(v[(top + b) * 64 + left + a]); };
      to[y * 64 + x] =
          static_cast<float>((1 - u) * (1 - w) * at(0, 0) + u * (1 - w) * at(1, 0) + (1 - u) * w * at(0, 1) + u * w * at(1, 1));
    }
  return to;
}
/// The mean over a square of 2 * reach + 1.
std::vector<float> boxed(const std::vector<float>& v, int reach) {
  std::vector<float> to(v.size());
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      float sum = 0;
      for (int dy = -reach; dy <= reach; ++dy)
        for (int dx = -reach; dx <= reach; ++dx) sum += v[std::clamp(y + dy, 0, 63) * 64 + std::clamp(x + dx, 0, 63)];
      to[y * 64 + x] = sum / static_cast<float>((2 * reach + 1) * (2 * reach + 1));
    }
  return to;
}

TEST(constructed_causes, of_whole_masks_of_hard_shadows) {
  cause_world::World world(many_boards(1, 3), cause_world::slanted);
  for (const glm::dvec2 shift : {glm::dvec2(1, 0), glm::dvec2(0, -1), glm::dvec2(2, -3), glm::dvec2(-3, 4)}) {
    world.mask = moved(world.truth, shift.x, shift.y);
    EXPECT_GE(whole_share(world, Cause::mask_shift), least_share) << shift.x << ' ' << shift.y;
    const auto whole = whole_of(world, world.reference());
    ASSERT_TRUE(whole);
    EXPECT_EQ(whole->shift, shift);
    EXPECT_GT(whole->explained, 0.99);
  }
  // Of a blurred mask only what is narrow is wrong by more than one half.
  cause_world::World narrow(slats(), cause_world::slanted);
  narrow.mask = boxed(narrow.truth, 2);
  EXPECT_GT(narrow.wrong(), 30u);
  EXPECT_GE(whole_share(narrow, Cause::mask_blur), least_share);
}

TEST(constructed_causes, of_whole_masks_under_lights_with_area) {
  soft_world::World world(many_boards(1, 3), soft_world::lamp(0.6f));
  const std::vector<float> truth = world.mask;
  for (const glm::dvec2 shift : {glm::dvec2(1, 0), glm::dvec2(0.5, 0.5), glm::dvec2(-1.25, 0.5)}) {
    world.mask = moved(truth, shift.x, shift.y);
    EXPECT_GE(whole_share(world, Cause::mask_shift), least_share) << shift.x << ' ' << shift.y;
    EXPECT_NEAR(glm::distance(whole_of(world, world.reference())->shift, shift), 0, 0.1);
  }
  for (const double gamma : {1 / 2.2, 0.8, 2.2}) {
    world.mask = truth;
    for (float& v : world.mask) v = static_cast<float>(std::pow(v, gamma));
    EXPECT_GE(whole_share(world, Cause::mask_gamma), least_share) << gamma;
    EXPECT_NEAR(whole_of(world, world.reference())->gamma, gamma, 0.02);
  }
  for (const int reach : {1, 3}) {
    world.mask = boxed(truth, reach);
    EXPECT_GE(whole_share(world, Cause::mask_blur), least_share) << reach;
    // A square of n pixels has a variance of (n^2 - 1) / 12.
    EXPECT_NEAR(whole_of(world, world.reference())->sigma, std::sqrt(reach * (reach + 1) / 3.0), 0.3);
  }
}

TEST(constructed_causes, masks_that_are_turned_about_are_said_to_be) {
  using Change = WholeMask::Change;
  cause_world::World world(many_boards(1, 3), cause_world::slanted);
  const auto told = [&](const auto& from) {
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x) world.mask[y * 64 + x] = from(x, y);
    const auto whole = whole_of(world, world.reference());
    return whole ? std::optional(whole->change) : std::nullopt;
  };
  const auto at = [&](int x, int y) { return world.truth[y * 64 + x]; };
  EXPECT_EQ(told([&](int x, int y) { return at(x, 63 - y); }), Change::upside_down);
  EXPECT_EQ(told([&](int x, int y) { return at(63 - x, y); }), Change::mirrored);
  EXPECT_EQ(told([&](int x, int y) { return at(63 - x, 63 - y); }), Change::turned);
  EXPECT_EQ(told([&](int x, int y) { return 1 - at(x, y); }), Change::inverted);
  EXPECT_EQ(told(at), std::nullopt) << "right";
  EXPECT_EQ(told([&](int x, int y) { return x < 32 ? at(x, y) : 1 - at(x, y); }), std::nullopt) << "a half is inverted";
  EXPECT_EQ(told([](int, int) { return 1.0f; }), std::nullopt) << "without shadows";
  EXPECT_EQ(told([](int, int) { return 0.5f; }), std::nullopt);
  EXPECT_EQ(told([](int, int) { return 0.0f; }), std::nullopt) << "black, where four fifths and more are lit";
  std::mt19937 random(1);
  EXPECT_EQ(told([&](int, int) { return static_cast<float>(random() % 2); }), std::nullopt) << "noise";
}

}  // namespace constructed_causes_test
