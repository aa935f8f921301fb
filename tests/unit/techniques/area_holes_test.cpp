// Lights with area through a card with holes: shares derived on paper, and what the techniques say that they handle.
#include <cmath>

#include "averaged_hard_rig.h"
#include "masked.h"

namespace gnomon::area_holes_test {

using averaged_hard_rig::lamp;

constexpr int count = 32;
constexpr float off_diagonal = 0.01f;  ///< z of all points

/// A lamp of 1 m at (0, 2, 0) over a floor; between them, at y = 1, a card of 4 m that is solid where x < 0. The way from a
/// floor point at x to a place of the lamp at s meets the card at (x + s) / 2, so what is seen of the lamp is s > -x: of its
/// area the share 0.5 + x, cut off at 0 and 1. Pixel k is the point x = (k - 15.5) / 20.
struct HalfCard {
  Scene scene;
  Light light = lamp({0, 2, 0}, 0.5f);
  hand_made::Picture picture{count, 1};

  HalfCard() {
    scene.name = "half_card";
    scene.meshes = {small_world::ground(3), masked::card(2, 1, masked::mask_of({"#."}))};
    scene.lights = {light};
    scene.views = {{.eye = {0, 0.5f, 3}}};
    picture.gbuffer.view = scene.views[0];
    for (int k = 0; k < count; ++k)
      picture.set(static_cast<std::size_t>(k), {x(k), 0, off_diagonal}, {0, 1, 0}, 0, off_diagonal > x(k) ? 0 : 1);
  }
  static float x(int k) { return (static_cast<float>(k) - 15.5f) / 20; }
  static double area_share(int k) { return std::clamp(0.5 + x(k), 0.0, 1.0); }
  /// By the midpoints of 200 x 200 parts of the lamp.
  static double irradiance_share(int k) {
    constexpr int parts = 200;
    double seen = 0, all = 0;
    for (int i = 0; i < parts; ++i)
      for (int j = 0; j < parts; ++j) {
        const double s = (i + 0.5) / parts - 0.5, t = (j + 0.5) / parts - 0.5, dx = s - x(k), dz = t - off_diagonal,
                     weight = std::pow(dx * dx + dz * dz + 4, -2);
        all += weight;
        if (s > -x(k)) seen += weight;
      }
    return seen / all;
  }
};

class AreaHoles : public averaged_hard_rig::AveragedHard {
 protected:
  static Support support(const std::string& id, const std::string& settings, const HalfCard& world) {
    const TechniqueEntry& entry = registry().technique(id);
    return support_of(entry.about, *made(id, settings), world.scene, world.light, world.scene.views[0]);
  }
  static void expect_shares(const std::string& id, const std::string& settings, double (*share)(int), double most_off) {
    const HalfCard world;
    ASSERT_TRUE(support(id, settings, world)) << id << ": " << support(id, settings, world).why();
    const std::vector<float> mask = mask_of(id, settings, world.scene, world.light, world.picture.gbuffer);
    for (int k = 0; k < count; ++k) EXPECT_NEAR(mask[static_cast<std::size_t>(k)], share(k), most_off) << id << ", pixel " << k;
  }
};

TEST_F(AreaHoles, the_share_of_the_area_is_that_derived_on_paper) {
  expect_shares("embree_rays", "", HalfCard::area_share, 0.01);
  expect_shares("area_rays", "samples=1024", HalfCard::area_share, 0.01);
  // Of n points of the light, spread evenly, about the square root of n are in doubt.
  expect_shares("averaged_hard", "of=exact_rays,samples=256", HalfCard::area_share, 0.04);
  expect_shares("averaged_hard", "of=shadow_volume_tree,samples=256", HalfCard::area_share, 0.04);
  // The center of the lamp is seen where x > 0.
  expect_shares(
      "center_ray", "", [](int k) { return HalfCard::x(k) > 0 ? 1.0 : 0.0; }, 0);
  expect_shares(
      "unshadowed", "", [](int) { return 1.0; }, 0);
}

TEST_F(AreaHoles, the_share_of_the_irradiance_is_that_of_an_integral) {
  expect_shares("path_rays", "samples=4096,ending=bounces,bounces=0", HalfCard::irradiance_share, 0.02);
  expect_shares("radiosity", "patch_size=0.05,samples=32", HalfCard::irradiance_share, 0.05);
  expect_shares("radiosity", "patch_size=0.05,samples=32,form_factor=rays", HalfCard::irradiance_share, 0.05);
}

TEST_F(AreaHoles, what_does_not_look_up_masks_is_unsupported) {
  const HalfCard world;
  const auto expect_refused = [&](const std::string& id, const std::string& settings, const char* why) {
    const Support answer = support(id, settings, world);
    EXPECT_FALSE(answer) << id << ":" << settings;
    EXPECT_NE(answer.why().find(why), std::string::npos) << answer.why();
  };
  expect_refused("exact_area", "", "exact_area does not state that it handles alpha_masks");
  expect_refused("averaged_hard", "of=sphere_volume", "sphere_volume does not state that it handles alpha_masks");
  expect_refused("radiosity", "form_factor=hemicube", "a hemicube shows whole patches");
}

}  // namespace gnomon::area_holes_test
