// The reference under lights with area, its classes, and its certificate.
#include "measure/frame/soft_reference.h"

#include <gnomon/kit/geometry/shapes.h>
#include <gtest/gtest.h>

#include <cmath>

#include "measure/frame/certify_soft.h"
#include "measure/scene/load.h"
#include "measure/scratch_folder.h"
#include "measure/statistics/distributions.h"
#include "measure/statistics/statistics.h"

namespace gnomon::soft_reference_test {

Scene card_over_floor(const LightKind& kind) {
  Scene scene;
  scene.name = "card";
  scene.meshes = {tessellate(Plane{{0, 0, 0}, {4, 0, 0}, {0, 0, -4}}, 4, "floor"),
                  tessellate(Plane{{0, 1, 0}, {1, 0, 0}, {0, 0, -1}}, 4, "card")};
  scene.lights = {{.name = "lamp", .kind = kind}};
  scene.views = {View{.eye = {0, 6, 6}}};
  return scene;
}

const std::vector<LightKind>& kinds() {
  static const std::vector<LightKind> all = {RectLight{{0, 3, 0}, {0.5f, 0, 0}, {0, 0, 0.3f}},
                                             DiscLight{{0.5f, 3, 0}, {0, -1, 0}, 0.5f}, SphereLight{{0, 3, 0.5f}, 0.4f}};
  return all;
}

struct Traced {
  Scene scene;
  GBuffer gbuffer;
  SoftReference soft;
};

Traced traced(Scene scene, int width = 96, int height = 54, const AreaTarget& target = {}) {
  const RayScene all(scene, Truth::mesh, RayScene::Which::seen), casters(scene, Truth::mesh, RayScene::Which::casters);
  GBuffer gbuffer = make_gbuffer(scene, all, scene.views[0], width, height, Truth::mesh);
  SoftReference soft = trace_soft(scene, casters, gbuffer, scene.lights[0], find_silhouettes(all, gbuffer), target);
  return {std::move(scene), std::move(gbuffer), std::move(soft)};
}

Reference reference_of(const SoftReference& soft) {
  Reference reference;
  reference.mask = soft.area;
  reference.classes = soft.classes;
  reference.irradiance = soft.irradiance;
  reference.error = soft.area_error;
  reference.irradiance_error = soft.irradiance_error;
  reference.rays = soft.rays;
  return reference;
}

TEST(SoftReference, is_certified_under_every_kind_of_light) {
  for (const LightKind& kind : kinds()) {
    const Traced t = traced(card_over_floor(kind), 192, 108);
    const SoftCertificate certificate = certify_soft(t.scene, t.scene.lights[0], t.gbuffer, reference_of(t.soft));
    EXPECT_TRUE(certificate.holds()) << text(certificate);
    EXPECT_GT(certificate.penumbra_count, 500u);
    ASSERT_EQ(certificate.comparisons.size(), 4u);
    EXPECT_LT(std::abs(certificate.comparisons[0].mean), 2e-4);
  }
}

TEST(SoftReference, a_certificate_refuses_errors_that_are_stated_too_small_and_a_mean_that_is_off) {
  Traced t = traced(card_over_floor(kinds()[0]), 192, 108);
  for (float& error : t.soft.area_error) error /= 3;
  EXPECT_FALSE(certify_soft(t.scene, t.scene.lights[0], t.gbuffer, reference_of(t.soft)).holds());
  for (float& error : t.soft.area_error) error *= 3;
  for (float& share : t.soft.area) share = std::min(1.0f, share + 0.0008f);
  EXPECT_FALSE(certify_soft(t.scene, t.scene.lights[0], t.gbuffer, reference_of(t.soft)).holds());
}

TEST(SoftReference, is_the_same_twice_and_says_what_it_is_made_of) {
  const Traced a = traced(card_over_floor(kinds()[1])), b = traced(card_over_floor(kinds()[1]));
  EXPECT_EQ(a.soft.area, b.soft.area);
  EXPECT_EQ(a.soft.irradiance_error, b.soft.irradiance_error);
  EXPECT_EQ(a.soft.classes, b.soft.classes);
  for (std::size_t i = 0; i < a.soft.area.size(); ++i) {
    if (a.soft.classes[i] != PixelClass::T) continue;
    EXPECT_GE(a.soft.rays[i], 500u);  // an error of 0.002 at least, one ray being 1 / rays
    EXPECT_LE(a.soft.area_error[i], 0.002f);
    EXPECT_GE(a.soft.area_error[i], 0.999f / static_cast<float>(a.soft.rays[i]));
  }
}

// The light is below the floor's plane: nothing of it is seen from there. From a wall's side only the upper part counts.
TEST(SoftReference, classes_are_those_of_the_lights_place) {
  const auto count = [](const Traced& t, PixelClass of) { return count_classes(t.soft.classes)[static_cast<std::size_t>(of)]; };
  const Traced below = traced(card_over_floor(DiscLight{{0, -1, 0}, {0, -1, 0}, 0.5f}));
  EXPECT_EQ(count(below, PixelClass::T), 0u);
  EXPECT_GT(count(below, PixelClass::F), 1000u);
  // In the floor's plane: half of it is above, and what is far away sees that at less than 2 degrees.
  const Traced low = traced(card_over_floor(DiscLight{{12, 0, 0}, {-1, 0, 0}, 0.3f}));
  EXPECT_GT(count(low, PixelClass::G), 1000u);
  // Emits to the other side.
  const Traced turned = traced(card_over_floor(DiscLight{{0, 3, 0}, {0, 1, 0}, 0.5f, Emits::in_front}));
  EXPECT_EQ(count(turned, PixelClass::T), 0u);
  // A point inside a sphere sees no disc of it.
  const Traced inside = traced(card_over_floor(SphereLight{{0, 0, 0}, 20}));
  EXPECT_EQ(count(inside, PixelClass::T), 0u);
}

// A light in the plane of the card: whether rays that end on the card meet it is rounding. One that is a little below it is
// seen from below, and one above it hidden.
TEST(SoftReference, a_light_on_a_caster_is_uncertain) {
  const auto floor_count = [](float y, PixelClass of, float share) {
    const Traced t = traced(card_over_floor(RectLight{{0, y, 0}, {0.5f, 0, 0}, {0, 0, 0.5f}}));
    std::size_t count = 0;
    for (std::size_t i = 0; i < t.gbuffer.size(); ++i)
      count += t.gbuffer.mesh[i] == 0 && t.soft.classes[i] == of && (share < 0 || t.soft.area[i] == share);
    return count;
  };
  EXPECT_GT(floor_count(1, PixelClass::U, -1), 1000u);
  EXPECT_EQ(floor_count(1, PixelClass::T, -1), 0u);
  EXPECT_GT(floor_count(0.999f, PixelClass::T, 1), 1000u);
  EXPECT_GT(floor_count(1.001f, PixelClass::T, 0), 1000u);
  EXPECT_EQ(floor_count(1.001f, PixelClass::U, -1), 0u);
}

// Its corners, not its center, say how far rounding reaches: a light of a million times the scene leaves nothing to test.
TEST(SoftReference, a_light_is_as_far_as_its_corners) {
  for (const LightKind& kind :
       {LightKind(RectLight{{0, 3, 0}, {4e6f, 0, 0}, {0, 0, 4e6f}}), LightKind(DiscLight{{0, 3, 0}, {0, -1, 0}, 4e6f}),
        LightKind(SphereLight{{0, 5e6f, 0}, 4e6f})}) {
    const Traced t = traced(card_over_floor(kind));
    EXPECT_EQ(count_classes(t.soft.classes)[static_cast<std::size_t>(PixelClass::T)], 0u);
    EXPECT_GT(count_classes(t.soft.classes)[static_cast<std::size_t>(PixelClass::U)], 1000u);
  }
}

TEST(SoftReference, a_target_that_the_cap_cannot_reach_makes_penumbrae_uncertain) {
  const Traced t = traced(card_over_floor(kinds()[0]), 96, 54, {.error = 0.0005, .cap = 512});
  EXPECT_EQ(count_classes(t.soft.classes)[static_cast<std::size_t>(PixelClass::T)], 0u);
  EXPECT_GT(count_classes(t.soft.classes)[static_cast<std::size_t>(PixelClass::U)], 1000u);
}

// Of 1,000 trials of chance 0.01 more than 21 are as likely as 0.0007 (Poisson's law of mean 10 has 0.0007 beyond 21).
TEST(SoftReference, what_chance_allows) {
  EXPECT_EQ(most_by_chance(0, 0.5, 1e-4), 0u);
  EXPECT_EQ(most_by_chance(1000, 0.01, 1e-3), 21u);
  EXPECT_EQ(most_by_chance(10, 0.5, 1e-9), 10u);
}

TEST(SoftReference, the_cache_keeps_it_by_its_target_and_makes_it_anew_when_it_is_damaged) {
  const ScratchFolder folder = ScratchFolder::temporary("gnomon_soft");
  const Scene scene = card_over_floor(kinds()[2]);
  const FrameKey key{scene.views[0], 64, 36, Truth::mesh};
  const Light& light = scene.lights[0];
  const auto references = [&] {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
      if (entry.path().extension() == ".reference") files.push_back(entry.path());
    return files;
  };
  std::vector<float> first;
  {
    FrameStore frames(scene, folder.path());
    const Reference reference = frames.reference(key, light);
    first.assign(reference.irradiance.begin(), reference.irradiance.end());
    EXPECT_EQ(reference.rays.size(), first.size());
    EXPECT_TRUE(reference.snapping.empty());
    ASSERT_EQ(references().size(), 1u);
    frames.reference(key, light, {.error = 0.01, .cap = 4096});
    EXPECT_EQ(references().size(), 2u);
  }
  for (const auto& file : references()) {
    std::filesystem::resize_file(file, std::filesystem::file_size(file) - 40);
    std::filesystem::resize_file(file, std::filesystem::file_size(file) + 40);
  }
  FrameStore frames(scene, folder.path());
  const Reference again = frames.reference(key, light);
  EXPECT_TRUE(std::ranges::equal(again.irradiance, first));
}

}  // namespace gnomon::soft_reference_test
