// Lights with area through glass: techniques beside the reference, and what they say that they handle.
#include <cmath>

#include "averaged_hard_rig.h"
#include "glass.h"
#include "measure/frame/soft_reference.h"

namespace gnomon::area_glass_test {

using averaged_hard_rig::lamp;

constexpr int count = 32;
constexpr float off_diagonal = 0.01f;  ///< z of all points

/// A lamp of 1 m at (0, 2, 0) over a floor; between them, at y = 1, a card of 4 m whose texels let 0.25 of the light through
/// where x < 0, else 0.75. The way from a floor point at x to a place of the lamp at s meets the card at (x + s) / 2: of the
/// area of the lamp the share 0.5 - x, cut off at 0 and 1, is behind the darker half. Pixel k is the point x = (k - 15.5) / 20.
struct HalfCard {
  Scene scene;
  Light light = lamp({0, 2, 0}, 0.5f);
  hand_made::Picture picture{count, 1};

  explicit HalfCard(std::shared_ptr<const Transmission> transmission = glass::texels(2, 1, {0.25f, 0.75f})) {
    scene.name = "half_card";
    scene.meshes = {small_world::ground(3), glass::glass_card(2, 1, std::move(transmission))};
    scene.lights = {light};
    scene.views = {{.eye = {0, 0.5f, 3}}};
    picture.gbuffer.view = scene.views[0];
    for (int k = 0; k < count; ++k)
      picture.set(static_cast<std::size_t>(k), {x(k), 0, off_diagonal}, {0, 1, 0}, 0, off_diagonal > x(k) ? 0 : 1);
  }
  static float x(int k) { return (static_cast<float>(k) - 15.5f) / 20; }
  static double area_share(int k) { return 0.75 - 0.5 * std::clamp(0.5 - x(k), 0.0, 1.0); }
};

class AreaGlass : public averaged_hard_rig::AveragedHard {
 protected:
  static Support support(const std::string& id, const std::string& settings, const HalfCard& world) {
    const TechniqueEntry& entry = registry().technique(id);
    return support_of(entry.about, *made(id, settings), world.scene, world.light, world.scene.views[0]);
  }
  static std::vector<float> answer(const std::string& id, const std::string& settings, const HalfCard& world) {
    EXPECT_TRUE(support(id, settings, world)) << id << ": " << support(id, settings, world).why();
    return mask_of(id, settings, world.scene, world.light, world.picture.gbuffer);
  }
  static void expect_shares(const std::string& id, const std::string& settings, double (*share)(int), double most_off) {
    const HalfCard world;
    const std::vector<float> mask = answer(id, settings, world);
    for (int k = 0; k < count; ++k) EXPECT_NEAR(mask[static_cast<std::size_t>(k)], share(k), most_off) << id << ", pixel " << k;
  }
};

TEST_F(AreaGlass, the_share_of_the_area_is_that_derived_on_paper) {
  expect_shares("embree_rays", "", HalfCard::area_share, 0.005);
  expect_shares("area_rays", "samples=1024", HalfCard::area_share, 0.005);
  // Of n points of the light, spread evenly, about the square root of n are in doubt; each by 0.5.
  expect_shares("averaged_hard", "of=exact_rays,samples=256", HalfCard::area_share, 0.02);
  // The way to the center of the lamp meets the card on the point's side.
  expect_shares(
      "center_ray", "", [](int k) { return HalfCard::x(k) > 0 ? 0.75 : 0.25; }, 0);
}

TEST_F(AreaGlass, area_rays_are_the_reference_within_its_error) {
  const HalfCard world;
  const RayScene casters(world.scene, Truth::mesh, RayScene::Which::casters);
  const SoftReference reference = trace_soft(world.scene, casters, world.picture.gbuffer, world.light, {}, {});
  const std::vector<float> mask = answer("area_rays", "samples=4096", world);
  for (std::size_t k = 0; k < count; ++k) EXPECT_NEAR(mask[k], reference.area[k], 4 * reference.area_error[k]) << "pixel " << k;
}

// Each sample sees what the card lets through, and their mean is the mask.
TEST_F(AreaGlass, area_rays_explain_what_each_sample_sees) {
  const HalfCard world;
  const auto technique = made("area_rays", "samples=48");
  technique->setup();
  technique->build(world.scene);
  technique->relight(world.light);
  VisibilityMask mask(count, 1);
  technique->resolve(world.picture.gbuffer, mask);
  int both = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const std::optional<Explanation> why = technique->explain(k);
    ASSERT_TRUE(why);
    ASSERT_EQ(why->samples.size(), 48u);
    double sum = 0;
    int darker = 0;
    for (const LightSample& sample : why->samples) {
      EXPECT_EQ(sample.visibility, sample.place.x < -HalfCard::x(static_cast<int>(k)) ? 0.25 : 0.75);
      sum += sample.weight * sample.visibility;
      darker += sample.visibility == 0.25;
    }
    EXPECT_NEAR(mask.read()[k], sum, 1e-6) << "pixel " << k;
    both += darker > 0 && darker < 48;
  }
  EXPECT_GT(both, 15);
}

TEST_F(AreaGlass, a_sheet_over_the_whole_lamp_lets_the_same_through_everywhere) {
  for (const float share : {0.1f, 0.4f, 0.9f, 1.0f, 0.0f}) {
    const HalfCard world(glass::constant(glm::vec3(share)));
    for (const auto& [id, settings] :
         {std::pair("area_rays", "samples=37"), {"center_ray", ""}, {"averaged_hard", "of=exact_rays,samples=16"}})
      for (const float seen : answer(id, settings, world)) EXPECT_NEAR(seen, share, 3e-7) << id;
  }
}

// Not off by float32's rounding of sums: the lamp is dimmed by the very number of the sheet, as in the reference.
TEST_F(AreaGlass, area_rays_behind_one_sheet_are_its_number_exactly) {
  for (const float share : {0.1f, 0.075f, 0.3f, 0.9f})
    for (const char* settings : {"samples=37", "samples=64"})
      for (const float seen : answer("area_rays", settings, HalfCard(glass::constant(glm::vec3(share)))))
        EXPECT_EQ(seen, share) << settings;
}

TEST_F(AreaGlass, what_does_not_multiply_says_so) {
  const HalfCard world;
  const auto expect_refused = [](const HalfCard& of, const std::string& id, const std::string& settings,
                                 const std::string& why) {
    const Support answer = support(id, settings, of);
    EXPECT_FALSE(answer) << id << ":" << settings;
    EXPECT_NE(answer.why().find(why), std::string::npos) << answer.why();
  };
  for (const char* id : {"exact_area", "area_svbsp", "penumbra_wedge", "soft_volume", "radiosity", "path_rays"})
    expect_refused(world, id, "", std::string(id) + " does not state that it handles transmission");
  expect_refused(world, "path_rays", "ending=bounces", "path_rays does not state that it handles transmission");
  expect_refused(world, "averaged_hard", "of=sphere_volume", "sphere_volume does not state that it handles transmission");
  const HalfCard colored(glass::constant({0.9f, 0.2f, 0.1f}));
  for (const char* id : {"area_rays", "center_ray", "averaged_hard"})
    expect_refused(colored, id, "", "glass colors the light; a technique is asked about one channel at a time");
}

}  // namespace gnomon::area_glass_test
