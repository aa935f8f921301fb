// Stencil volumes where counting is hard: the eye inside volumes, on their boundary and beside it, and more volumes than a byte
// counts.
#include "stencil_rig.h"

namespace stencil_volume_eye_test {
using namespace stencil_rig;

class StencilVolumeEye : public TestRig {};

TEST_F(StencilVolumeEye, eye_inside_volumes_is_right_for_zfail_and_zpass_plus_and_said_to_be_wrong_for_zpass) {
  const Light lights[] = {{.name = "point", .kind = PointLight{{0.5f, 9, 0.25f}}},
                          {.name = "sun", .kind = DirectionalLight{{-0.125f, -1, 0.0625f}}},
                          {.name = "spot", .kind = SpotLight{{0.5f, 9, 0.25f}, {0, -1, 0}, 40, 60}}};
  const View view{.eye = {0.375f, 1, 0.5f}, .target = {0, 0.25f, -4}, .fov_y_degrees = 70};
  for (const int layers : {1, 2, 5}) {
    const Scene scene = under_roofs(layers);
    const GBuffer g = small_world::make_gbuffer(scene, view, 96, 72);
    for (const Light& light : lights) {
      const Support support = supports("count=zpass", scene, light, view);
      EXPECT_EQ(support.kind(), Support::Kind::approximate);
      EXPECT_EQ(support.why(), "the eye is inside a shadow volume, which zpass does not count");
      EXPECT_EQ(supports("count=zfail", scene, light, view).kind(), Support::Kind::full);
      EXPECT_EQ(supports("count=zpass_plus", scene, light, view).kind(), Support::Kind::full);

      const Exact exact(scene, g, light);
      for (const char* settings : {"count=zfail", "count=zpass_plus", "count=zpass_plus,near_cap=rectangle"}) {
        Tally right;
        right.add(exact, mask(settings, scene, light, g));
        EXPECT_GT(right.dark, 300);
        EXPECT_GT(right.tested - right.dark, 300);
        EXPECT_EQ(right.not_snapped, 0) << settings << ", " << light.name;
        EXPECT_LE(right.wrong, 3) << settings << ", " << light.name;
      }
      mask("count=zpass_plus", scene, light, g);
      EXPECT_EQ(count("volumes_at_eye"), layers);
      // Every pixel of zpass is off by the roofs: what lies under them counts 0, and what lies beside them counts -layers.
      const auto wrong = mask("count=zpass", scene, light, g);
      EXPECT_GT(differences(wrong, exact.visibility), 3000) << light.name;
    }
  }
}

/// A square of half-side 1/2 at height 2, under a sun straight down or a lamp at height 4, over a ground with a post.
Scene side_planes() {
  return scene_of(
      {small_world::ground(4), small_world::ground(0.5f, 2), small_world::box({-0.25f, 0, -1.5f}, {0.625f, 0.5f, -1})});
}

/// A point on the plane of one side quad of the square, and its normal, away from the volume: at x = 1/2 under the sun, through
/// (3/4, 1) under the lamp.
struct Side {
  Light light;
  glm::dvec3 on, normal;
};
std::vector<Side> sides() {
  return {{{.name = "sun", .kind = DirectionalLight{{0, -1, 0}}}, {0.5, 1, 0.125}, {1, 0, 0}},
          {{.name = "lamp", .kind = PointLight{{0, 4, 0}}}, {0.75, 1, 0.125}, glm::normalize(glm::dvec3(4, 1, 0))}};
}

// The eye is 0.1, 0.5 and 2 mm beside a side plane, on both sides, where the near plane (0.5 mm and more) cuts the quad.
// Outside the volume zpass is right, too: it has no near plane either.
TEST_F(StencilVolumeEye, near_plane_that_cuts_a_side_quad_leaves_all_counts_right) {
  const Scene scene = side_planes();
  int outside = 0, rectangle_differs = 0;
  std::ptrdiff_t rectangle_most = 0;
  for (const Side& side : sides())
    for (const double distance : {1e-4, 5e-4, 2e-3, -1e-4, -5e-4, -2e-3})
      for (const glm::vec3& way : {glm::vec3(0, -0.5f, -1), glm::vec3(0.01f, -0.5f, -1), glm::vec3(-1, -0.5f, 0.1f),
                                   glm::vec3(1, -0.75f, 0.1f), glm::vec3(0.7f, -1, -0.7f), glm::vec3(-0.3f, -0.6f, -1)}) {
        const glm::vec3 eye(side.on + side.normal * distance);
        const View view{.eye = eye, .target = eye + way, .fov_y_degrees = 60};
        const GBuffer g = small_world::make_gbuffer(scene, view, 96, 72);
        const auto zfail = mask("count=zfail", scene, side.light, g),
                   zpass_plus = mask("count=zpass_plus", scene, side.light, g);
        // The volumes of one end below the ground, those of the other at infinity: corners are snapped apart from each other.
        EXPECT_LE(differences(zfail, zpass_plus), 1) << side.light.name << ' ' << distance << " m, way " << way.x;
        const Exact exact(scene, g, side.light);
        for (const auto& counted : {zfail, zpass_plus}) {
          Tally right;
          right.add(exact, counted);
          EXPECT_EQ(right.unexplained, 0) << side.light.name << ' ' << distance << " m, way " << way.x;
          EXPECT_LE(right.wrong, 2) << side.light.name << ' ' << distance << " m, way " << way.x;
        }
        EXPECT_EQ(supports("count=zpass_plus", scene, side.light, view).kind(), Support::Kind::full);
        const auto published = differences(zfail, mask("count=zpass_plus,near_cap=rectangle", scene, side.light, g));
        const Support support = supports("count=zpass_plus,near_cap=rectangle", scene, side.light, view);
        if (distance > 0) {
          EXPECT_EQ(support.kind(), Support::Kind::approximate);
        }
        rectangle_differs += published > 0, rectangle_most = std::max(rectangle_most, published);
        const bool is_outside = supports("count=zpass", scene, side.light, view).kind() == Support::Kind::full;
        EXPECT_EQ(is_outside, distance > 0);
        if (!is_outside) continue;
        ++outside;
        EXPECT_EQ(differences(mask("count=zpass", scene, side.light, g), zpass_plus), 0) << distance << " m, way " << way.x;
      }
  EXPECT_EQ(outside, 36);
  RecordProperty("cases where the near rectangle differs", rectangle_differs);
  EXPECT_LE(rectangle_most, 96);
}

// The eye anywhere from a micrometer to a centimeter beside a side plane, on either side: what says full is what zfail says. In
// float32 the side quads lie up to some roundings of the largest coordinate off their plane, and an eye within these has to say
// so.
TEST_F(StencilVolumeEye, eye_close_to_a_side_plane_is_right_or_said_to_be_approximate) {
  const Scene scene = side_planes();
  Random random(10);
  int full[3] = {}, approximate[3] = {}, asked = 0;
  for (const Side& side : sides())
    for (int k = 0; k < 240; ++k) {
      const double distance = std::pow(10, random.uniform(-6, k % 4 < 2 ? -2 : -4.5)) * (k % 2 ? 1 : -1);
      const glm::vec3 eye(side.on + side.normal * distance);
      const View view{.eye = eye, .target = eye + random_point(random, {-1, -1, -1}, {1, 0.25f, 1}), .fov_y_degrees = 60};
      const GBuffer g = small_world::make_gbuffer(scene, view, 96, 72);
      const auto zfail = mask("count=zfail", scene, side.light, g);
      ++asked;
      const char* settings[] = {"count=zpass_plus", "count=zpass_plus,near_cap=rectangle", "count=zpass"};
      for (int i = 0; i < 3; ++i) {
        if (supports(settings[i], scene, side.light, view).kind() != Support::Kind::full) {
          ++approximate[i];
          continue;
        }
        ++full[i];
        EXPECT_EQ(differences(mask(settings[i], scene, side.light, g), zfail), 0)
            << settings[i] << ", " << side.light.name << ", " << distance << " m";
      }
    }
  EXPECT_GT(full[0], asked / 4);  // not all of them are said to be approximate
  EXPECT_GT(approximate[0], 10);
  EXPECT_GT(full[2], asked / 8);  // half of the eyes are in the volume, which zpass does not count
}

// A level view under a vertical sun: seen from the light its near rectangle is a line, and nothing can be thrown onto it.
TEST_F(StencilVolumeEye, light_in_the_near_plane_counts_the_volumes_around_the_eye) {
  const Scene scene = under_roofs(2);
  const View view{.eye = {0.375f, 1, 0.5f}, .target = {0.375f, 1, -4}, .fov_y_degrees = 70};
  const GBuffer g = small_world::make_gbuffer(scene, view, 96, 72);
  for (const float tilt : {0.0f, 1e-7f, 1e-5f, 1e-3f}) {
    const Light sun{.name = "sun", .kind = DirectionalLight{{0, -1, tilt}}};
    const char* settings = "count=zpass_plus,near_cap=rectangle";
    const auto zfail = mask("count=zfail", scene, sun, g);
    EXPECT_GT(std::ranges::count(zfail, 0.0f), 100);
    EXPECT_EQ(differences(mask(settings, scene, sun, g), zfail), 0) << tilt;
    EXPECT_EQ(supports(settings, scene, sun, view).kind() == Support::Kind::approximate, tilt < 1e-4f) << tilt;
  }
}

TEST_F(StencilVolumeEye, eye_on_the_boundary_of_a_volume_is_said_to_be_approximate) {
  const Scene scene = scene_of({small_world::ground(4), small_world::ground(0.5f, 2)});
  for (const Light& light : {Light{.kind = DirectionalLight{{0, -1, 0}}}, Light{.kind = PointLight{{0, 4, 0}}}}) {
    const float x = has_area(light) ? 0 : homogeneous(light).w == 0 ? 0.5f : 0.75f;
    for (const float away : {0.0f, 1e-7f, -1e-7f}) {
      const View view{.eye = {x + away, 1, 0.125f}, .target = {0, 0, -1}};
      for (const char* settings : {"count=zpass_plus", "count=zpass", "count=zpass_plus,near_cap=rectangle"}) {
        const Support support = supports(settings, scene, light, view);
        EXPECT_EQ(support.kind(), Support::Kind::approximate) << settings;
        EXPECT_EQ(support.why(), "the eye lies on the boundary of a shadow volume, within rounding");
      }
      EXPECT_EQ(supports("count=zfail", scene, light, view).kind(), Support::Kind::full);
    }
    // Beside the plane but above the caster there is no volume.
    EXPECT_EQ(supports("count=zpass", scene, light, {.eye = {x, 2.5f, 0.125f}, .target = {0, 0, -1}}).kind(),
              Support::Kind::full);
  }
}

// --- Many volumes -----------------------------------------------------------------------------------------------------------

// n triangles over each other: their common shadow on the ground is n volumes deep. The stencil would read 256 as 0.
TEST_F(StencilVolumeEye, two_hundred_fifty_six_nested_volumes_are_dark) {
  const View view{.eye = {6, 1.5f, 4}, .target = {0, 0, 0}};
  for (const int n : {3, 256, 257, 300}) {
    Scene scene = scene_of({small_world::ground(6, 0, false)});
    for (int i = 0; i < n; ++i) {
      const float y = 2 + static_cast<float>(i) / 128;
      scene.meshes.push_back(mesh_of({{-2.5f, y, -2.5f}, {0, y, 2.5f}, {2.5f, y, -2.5f}}, {{0, 1, 2}}));
    }
    const GBuffer g = small_world::make_gbuffer(scene, view, 64, 48);
    for (const Light& light : {Light{.kind = PointLight{{0.125f, 20, 0.25f}}}, Light{.kind = DirectionalLight{{0, -1, 0}}}}) {
      Exact exact(scene, g, light);
      for (const std::string settings :
           {"count=zfail", "count=zpass", "count=zpass_plus", "count=zfail,extrusion=per_triangle"}) {
        Tally tally;
        const auto now = mask(settings, scene, light, g);
        tally.add(exact, now);
        EXPECT_GT(tally.dark, 100);
        EXPECT_EQ(tally.not_snapped, 0) << n << ' ' << settings;
        EXPECT_EQ(count("deepest"), n) << settings;
        EXPECT_EQ(count("counter_bits"), n > 255 ? 32 : 8) << settings;
        EXPECT_GE(count("depth_bound"), n) << settings;
      }
    }
  }
}

// The eye under all of them: what counts is what the eye is inside of, more than a byte holds.
TEST_F(StencilVolumeEye, eye_inside_three_hundred_volumes) {
  const Scene scene = under_roofs(300);
  const View view{.eye = {0.25f, 1, 0.5f}, .target = {0, 0.25f, -4}, .fov_y_degrees = 70};
  const GBuffer g = small_world::make_gbuffer(scene, view, 64, 48);
  const Light light{.kind = DirectionalLight{{-0.0078125f, -1, 0.00390625f}}};
  const auto zfail = mask("count=zfail", scene, light, g), zpass_plus = mask("count=zpass_plus", scene, light, g);
  EXPECT_EQ(count("volumes_at_eye"), 300);
  EXPECT_EQ(differences(zfail, zpass_plus), 0);
  Tally tally;
  tally.add(Exact(scene, g, light), zfail);
  EXPECT_EQ(tally.not_snapped, 0);
  EXPECT_GT(tally.dark, 500);
  EXPECT_GT(tally.tested - tally.dark, 500);
}

}  // namespace stencil_volume_eye_test
