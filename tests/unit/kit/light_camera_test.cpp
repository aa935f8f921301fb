#include <gnomon/kit/maps/light_camera.h>
#include <gtest/gtest.h>

#include "map_scenes.h"
#include "small_world.h"

namespace light_camera_test {
using namespace gnomon;
using map_scenes::soup_over_ground;

const std::vector<Light> lights = {{.name = "point", .kind = PointLight{{1, 4, 0.5f}}},
                                   {.name = "inside", .kind = PointLight{{0.2f, 1.2f, 0.3f}}},
                                   {.name = "sun", .kind = DirectionalLight{{0.4f, -1, 0.2f}}},
                                   {.name = "spot", .kind = SpotLight{{1, 4, 1}, {-0.2f, -1, -0.2f}, 20, 35}},
                                   {.name = "wide_spot", .kind = SpotLight{{1, 3, 1}, {-0.2f, -1, -0.2f}, 60, 75}}};

constexpr int resolution = 512, margin = 3;

/// Whether a point's texel is inside the margin of its image, to a hundredth of a texel.
bool is_inside(const LightCamera& camera, const glm::dvec3& point) {
  const auto [face, q] = camera.space.seen(point);
  const LightImage& image = camera.images[face];
  if (image.layer < 0) return false;
  const glm::dvec2 texel = image.place(q) * image.scale + image.offset;
  return glm::all(glm::greaterThan(texel, glm::dvec2(margin - 0.01))) &&
         glm::all(glm::lessThan(texel, glm::dvec2(resolution - margin + 0.01)));
}

// A point in shadow and its caster share a ray, so both windows hold it: fitted to the scene, and fitted to the very picture.
TEST(light_camera, every_point_in_shadow_is_inside_the_margins_of_its_image) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const Scene scene = soup_over_ground(seed);
    const MeshBoxes boxes = mesh_boxes(scene);
    for (const View& view :
         {View{.eye = {3, 5, 6}, .target = {0, 0.3f, 0}}, View{.eye = {2.5f, 0.4f, 2}, .target = {0, 0.3f, 0}}}) {
      const GBuffer g = small_world::make_gbuffer(scene, view, 64, 48);
      for (const Light& light : lights) {
        const LightCamera to_scene = fit_to_scene(light, boxes, resolution, margin);
        const LightCamera to_view = fit_to_view(light, boxes, g, resolution, margin);
        int dark = 0;
        for (std::size_t i = 0; i < g.size(); ++i) {
          if (!faces_light(scene, g, light, i)) continue;
          if (small_world::caster_distance(scene, light, g.position(i)) == INFINITY) continue;
          ++dark;
          EXPECT_TRUE(is_inside(to_scene, g.position(i))) << light.name << ' ' << i;
          EXPECT_TRUE(is_inside(to_view, g.position(i))) << light.name << ' ' << i;
        }
        EXPECT_GT(dark, 3) << light.name;
      }
    }
  }
}

// A picture shows a part of the receivers: no texel of an image that is fitted to it is larger, and a close look has small
// ones.
TEST(light_camera, fitted_to_a_view_texels_are_no_larger_and_casters_no_more) {
  const Scene scene = soup_over_ground(1);
  const MeshBoxes boxes = mesh_boxes(scene);
  const View close{.eye = {0.6f, 0.4f, 0.6f}, .target = {0, 0, 0}, .fov_y_degrees = 30};
  const GBuffer g = small_world::make_gbuffer(scene, close, 64, 48);
  double most = 0;
  for (const Light& light : lights) {
    const LightCamera to_scene = fit_to_scene(light, boxes, resolution, margin);
    const LightCamera to_view = fit_to_view(light, boxes, g, resolution, margin);
    ASSERT_EQ(to_scene.images.size(), to_view.images.size());
    EXPECT_LE(to_view.layer_count, to_scene.layer_count);
    for (std::size_t k = 0; k < to_view.images.size(); ++k) {
      const LightImage &wide = to_scene.images[k], &narrow = to_view.images[k];
      if (narrow.layer < 0) continue;
      EXPECT_GE(narrow.scale.x, wide.scale.x * (1 - 1e-9)) << light.name;
      EXPECT_GE(narrow.scale.y, wide.scale.y * (1 - 1e-9)) << light.name;
      EXPECT_LE(narrow.casters.size(), wide.casters.size()) << light.name;
      EXPECT_LE(narrow.far, wide.far * (1 + 1e-6)) << light.name;
      most = std::max(most, narrow.scale.x / wide.scale.x);
    }
  }
  EXPECT_GT(most, 3);
}

// A tap's stored point, looked up, is in the middle of its texel, at the axis distance of its depth.
TEST(light_camera, taps_lie_on_the_rays_through_their_texels) {
  const Scene scene = soup_over_ground(2);
  for (const Light& light : lights) {
    const LightCamera camera = fit_to_scene(light, mesh_boxes(scene), resolution, margin);
    const std::vector<float> depths(static_cast<std::size_t>(resolution) * resolution * camera.layer_count, 0.4f);
    for (const LightImage& image : camera.images) {
      if (image.layer < 0) continue;
      for (const glm::ivec2 texel : {glm::ivec2(0, 0), glm::ivec2(200, 17), glm::ivec2(511, 300)}) {
        const Tap tap = camera.tap(image, depths, texel, 0.25);
        const glm::dvec3 point = tap.origin + tap.direction * tap.stored, q = image.seen(point);
        const glm::dvec2 place = image.place(q) * image.scale + image.offset;
        EXPECT_NEAR(place.x, texel.x + 0.5, 1e-6) << light.name;
        EXPECT_NEAR(place.y, texel.y + 0.5, 1e-6) << light.name;
        EXPECT_NEAR(q.z, image.axis_distance(0.4f), 1e-9) << light.name;
        EXPECT_NEAR(glm::length(tap.direction), 1, 1e-12);
        EXPECT_EQ(tap.weight, 0.25);
      }
      EXPECT_EQ(camera.tap(image, depths, {-1, 0}, 1).stored, INFINITY);
      EXPECT_EQ(camera.tap(image, depths, {0, resolution}, 1).stored, INFINITY);
    }
  }
}

// A receiver may be as near to a light as it likes, if the picture shows it: what is before it is nearer than the near end.
TEST(light_camera, images_fitted_to_a_view_begin_before_the_nearest_receiver) {
  Scene scene;
  // 2 mm below the light and far below it; the caster is in between of both.
  scene.meshes = {small_world::ground(0.01f, -0.002f), small_world::ground(50, -10), small_world::ground(0.0005f, -0.001f)};
  const Light light{.kind = SpotLight{{0, 0, 0}, {0, -1, 0}, 40, 50}};
  const GBuffer g = small_world::make_gbuffer(scene, {.eye = {0.004f, 0.004f, 0.004f}, .target = {0, -0.002f, 0}}, 64, 48);
  const LightCamera camera = fit_to_view(light, mesh_boxes(scene), g, 256, 2);
  ASSERT_GE(camera.images[0].layer, 0);
  EXPECT_LE(camera.images[0].near, 0.002);
}

// The window and the range of depth hold the whole reach, wherever in it the caster is.
TEST(light_camera, windows_stay_while_a_mesh_moves_within_its_reach) {
  Scene scene;
  scene.meshes = {small_world::ground(4), small_world::box({-0.5f, 0.5f, -0.5f}, {0.5f, 1, 0.5f})};
  const auto cameras = [&] {
    std::vector<LightCamera> all;
    for (const Light& light : lights) all.push_back(fit_to_scene(light, mesh_boxes(scene), resolution, margin));
    return all;
  };
  const auto differ = [](const std::vector<LightCamera>& a, const std::vector<LightCamera>& b) {
    int count = 0;
    for (std::size_t c = 0; c < a.size(); ++c)
      for (std::size_t i = 0; i < a[c].images.size(); ++i) {
        const LightImage &one = a[c].images[i], &other = b[c].images[i];
        count += one.scale != other.scale || one.offset != other.offset || one.near != other.near || one.far != other.far;
      }
    return count;
  };
  const auto move = [&](const glm::vec3& by) {
    for (glm::vec3& p : scene.meshes[1].positions) p += by;
  };
  const auto unmoving = cameras();
  move({1, 0.5f, 0});
  EXPECT_GT(differ(unmoving, cameras()), 0);
  scene.meshes[1].reach = {{-0.5f, 0.5f, -0.5f}, {1.5f, 1.5f, 0.5f}};
  const auto moved = cameras();
  move({-0.75f, -0.25f, 0});
  EXPECT_EQ(differ(moved, cameras()), 0);
  move({-0.25f, -0.25f, 0});
  EXPECT_EQ(differ(moved, cameras()), 0);
}

}  // namespace light_camera_test
