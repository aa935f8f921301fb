// Path rays as a technique: its mask is that of soft shadows, its picture that of the kit, and it says what it cannot do.
#include <gnomon/kit/pictures/exposure.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "small_world.h"
#include "soft_world.h"

extern "C" void gnomon_technique_path_rays(gnomon::Registry&);

namespace path_rays_test {
using namespace gnomon;

Registry& own_registry() {
  static Registry registry;
  static const bool is_entered = (gnomon_technique_path_rays(registry), true);
  (void)is_entered;
  return registry;
}

std::unique_ptr<Technique> path_rays(const std::string& settings) {
  auto technique = own_registry().technique("path_rays").make();
  technique->apply(settings);
  return technique;
}

/// A ground and a box on it.
Scene box_on_ground() {
  Scene scene;
  scene.meshes = {small_world::ground(4), small_world::box({-0.8f, 0, -0.5f}, {0.6f, 1.5f, 0.4f})};
  scene.meshes[0].albedo = {0.8f, 0.5f, 0.2f};
  return scene;
}

struct Answer {
  std::unique_ptr<Technique> technique;
  std::vector<float> mask;
};
Answer answer(const std::string& settings, const soft_world::World& world) {
  Answer result{path_rays(settings), {}};
  VisibilityMask mask(world.gbuffer.width, world.gbuffer.height);
  result.technique->setup();
  result.technique->build(world.scene);
  result.technique->relight(world.light);
  result.technique->resolve(world.gbuffer, mask);
  result.mask.assign(mask.read().begin(), mask.read().end());
  return result;
}

// The mask has no error of its own to go by, but with direct light alone the picture has: both are of the same rays. Of seven
// degrees of freedom half a percent is beyond four standard errors, where these are not below what one ray makes.
TEST(PathRays, the_mask_is_the_share_of_irradiance_within_standard_errors) {
  const soft_world::World world(box_on_ground(), soft_world::lamp(2));
  const Answer found = answer("samples=256,ending=bounces,bounces=0", world);
  const auto picture = found.technique->global_picture();
  ASSERT_TRUE(picture);
  const std::vector<float> error = found.technique->draw_debug("standard_error");
  const double brightness = 10 * exposure(*picture);
  int asked = 0, far_off = 0;
  double sum = 0;
  for (std::size_t i = 0; i < found.mask.size(); ++i) {
    if (world.truth.classes[i] != PixelClass::T) continue;
    const double off = found.mask[i] - world.truth.irradiance[i];
    EXPECT_NEAR(off, 0, 0.05) << i;
    if (world.truth.irradiance[i] <= 0.02 || world.truth.irradiance[i] >= 0.98) continue;
    const double relative = error[3 * i] / brightness / (*picture)[3 * i];
    const double own = std::max(relative * found.mask[i], 1 / 256.0);
    ++asked;
    sum += off;
    far_off += std::abs(off) > 4 * std::hypot(own, world.truth.irradiance_error[i]);
  }
  EXPECT_GT(asked, 200);
  EXPECT_LE(far_off, asked / 50);
  EXPECT_LT(std::abs(sum / asked), 0.001);
}

TEST(PathRays, light_from_other_surfaces_only_adds) {
  const soft_world::World world(box_on_ground(), soft_world::lamp(0.8f));
  const auto direct = *answer("ending=bounces,bounces=0", world).technique->global_picture();
  const auto all = *answer("", world).technique->global_picture();
  ASSERT_EQ(direct.size(), 3 * world.gbuffer.size());
  double sum_direct = 0, sum_all = 0;
  for (std::size_t i = 0; i < direct.size(); ++i) {
    EXPECT_GE(all[i], direct[i]);
    sum_direct += direct[i];
    sum_all += all[i];
  }
  EXPECT_GT(sum_all, 1.001 * sum_direct);
  EXPECT_LT(sum_all, 1.1 * sum_direct);  // the sky is open, and the box is small
}

TEST(PathRays, refuses_lights_without_area_and_sums_without_end) {
  Scene scene = box_on_ground();
  const Light lamp = soft_world::lamp(0.5f), point{.name = "point", .kind = PointLight{{0, 5, 0}}};
  EXPECT_EQ(path_rays("")->supports(scene, lamp, {}).kind(), Support::Kind::full);
  const Support no_area = path_rays("")->supports(scene, point, {});
  EXPECT_EQ(no_area.kind(), Support::Kind::unsupported);
  EXPECT_NE(no_area.why().find("no area"), std::string::npos);
  scene.meshes[1].name = "mirror";
  scene.meshes[1].albedo = {0.2f, 1.25f, 0.3f};
  const Support endless = path_rays("")->supports(scene, lamp, {});
  EXPECT_EQ(endless.kind(), Support::Kind::unsupported);
  EXPECT_NE(endless.why().find("mirror"), std::string::npos) << endless.why();
  EXPECT_NE(endless.why().find("1.25"), std::string::npos) << endless.why();
  EXPECT_EQ(path_rays("ending=bounces,bounces=3")->supports(scene, lamp, {}).kind(), Support::Kind::full);
}

TEST(PathRays, samples_of_an_explanation_make_the_mask) {
  const soft_world::World world(box_on_ground(), soft_world::lamp(0.8f));
  const Answer found = answer("samples=40", world);
  int in_penumbra = 0;
  for (std::size_t i = 0; i < found.mask.size(); ++i) {
    const auto why = found.technique->explain(i);
    ASSERT_TRUE(why);
    double weight = 0, seen = 0;
    for (const LightSample& sample : why->samples) {
      weight += sample.weight;
      seen += sample.weight * sample.visibility;
      EXPECT_NEAR(sample.place.y, 6, 1e-5);
    }
    if (why->samples.empty()) continue;
    EXPECT_NEAR(weight, 1, 1e-6);
    EXPECT_NEAR(seen, found.mask[i], 1e-5);
    in_penumbra += found.mask[i] > 0 && found.mask[i] < 1;
  }
  EXPECT_GT(in_penumbra, 100);
}

}  // namespace path_rays_test
