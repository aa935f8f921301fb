// Light moves: where the handle is, where a drag takes it, and what the keys do.
#include <gtest/gtest.h>

#include "app/viewer/keys.h"
#include "app/viewer/moves.h"
#include "world.h"

namespace light_moves_test {

using namespace gnomon::viewer;
using namespace viewer_world;

TEST(viewer_light_moves, lights_with_a_place_go_where_their_handle_goes) {
  const Scene scene = roof();
  for (const Light& light : all_kinds()) {
    if (light.name == "sun") continue;
    EXPECT_EQ(light_place(scene, light), glm::dvec3(1, 2, 3)) << light.name;
    const Light moved = light_moved_to(scene, light, {-1, 0.1, 7});
    EXPECT_EQ(glm::dvec3(homogeneous_of_center(moved)), glm::dvec3(glm::vec3(-1, 0.1f, 7))) << light.name;
    EXPECT_EQ(moved.kind.index(), light.kind.index());
    EXPECT_EQ(moved.name, light.name);
    for (const glm::dvec3& nowhere : {glm::dvec3(std::nan("")), glm::dvec3(HUGE_VAL, 0, 0), glm::dvec3(0, 1e31, 0)})
      EXPECT_EQ(light_place(scene, light_moved_to(scene, light, nowhere)), glm::dvec3(1, 2, 3));
  }
  EXPECT_EQ(std::get<SpotLight>(light_moved_to(scene, all_kinds()[1], {5, 5, 5}).kind).direction, glm::vec3(0, -1, 1));
}

// The handle is over the middle (0, 1, 0), against the direction, and outside the bounds.
TEST(viewer_light_moves, the_handle_of_a_directional_light_gives_its_direction_back) {
  Random random(12);
  for (const double size : sizes) {
    const Scene scene = roof(size, {7 * size, -2 * size, size});
    const glm::dvec3 low(scene.bounds().min), high(scene.bounds().max), middle = (low + high) / 2.0;
    for (int i = 0; i < 1000; ++i) {
      const glm::vec3 direction = std::exp(random.uniform(-5, 5)) * random.uniform(glm::dvec3(-1), glm::dvec3(1));
      const Light sun{.name = "sun", .kind = DirectionalLight{direction}};
      const glm::dvec3 place = light_place(scene, sun);
      EXPECT_TRUE(glm::any(glm::lessThan(place, low)) || glm::any(glm::greaterThan(place, high)));
      EXPECT_LT(glm::distance(place, middle), 2 * glm::distance(high, middle));  // and not far off
      const glm::dvec3 back(std::get<DirectionalLight>(light_moved_to(scene, sun, place).kind).direction);
      EXPECT_LT(gap(back, direction), 4e-7 * glm::length(direction));
    }
    const Light sun = all_kinds()[2];
    for (const glm::dvec3& nowhere : {middle, glm::dvec3(std::nan(""))})
      EXPECT_EQ(std::get<DirectionalLight>(light_moved_to(scene, sun, nowhere).kind).direction,
                std::get<DirectionalLight>(sun.kind).direction);
  }
}

TEST(viewer_light_moves, a_scene_without_height_or_bounds_has_a_place_for_the_sun) {
  Scene flat = roof();
  flat.meshes[0].positions[4].y = 0;
  EXPECT_GT(light_place(flat, all_kinds()[2]).y, 0.1);
  const glm::dvec3 place = light_place(Scene{}, all_kinds()[2]);
  EXPECT_GT(glm::length(place), 0.9);
  EXPECT_EQ(key_step(Scene{}), 0.02);
}

// In the plane across the axis, before the very pixel.
TEST(viewer_light_moves, a_dragged_place_lies_under_the_mouse_at_its_depth) {
  Random random(13);
  for (const double size : sizes)
    for (int i = 0; i < 1000; ++i) {
      const Camera camera(any_view(random, size), width, height);
      const glm::dvec3 place =
          camera.eye + size * random.uniform(0.1, 3) * camera.ray(random.uniform(0, width), random.uniform(0, height));
      const glm::dvec2 pixel(random.uniform(0, width), random.uniform(0, height));
      const auto to = drag_place(camera, place, pixel, false);
      ASSERT_TRUE(to);
      EXPECT_LT(glm::length(*project(camera, *to) - pixel), 1e-6);
      EXPECT_NEAR(glm::dot(*to - place, camera.forward), 0, 1e-9 * size);
      EXPECT_FALSE(drag_place(camera, camera.eye - (place - camera.eye), pixel, false));  // behind the eye
      // Vertically: over and under where it was, where no point near by on that line is nearer to the ray.
      if (const auto up = drag_place(camera, place, pixel, true)) {
        EXPECT_EQ(up->x, place.x);
        EXPECT_EQ(up->z, place.z);
        const glm::dvec3 ray = glm::normalize(camera.ray(pixel.x, pixel.y));
        const auto off = [&](double y) { return glm::length(glm::cross(glm::dvec3(place.x, y, place.z) - camera.eye, ray)); };
        const double step = 0.01 * size;
        EXPECT_LE(off(up->y), off(up->y + step));
        EXPECT_LE(off(up->y), off(up->y - step));
      }
    }
}

// From (0, 0, 10), level: a pixel of the row 54 above the middle is 10 m * tan(22.5) / 5 higher at the handle.
TEST(viewer_light_moves, a_vertical_drag_on_paper) {
  const Camera camera(View{.eye = {0, 0, 10}, .fov_y_degrees = 45}, width, height);
  const auto to = drag_place(camera, {0, 3, 0}, {480, 270 - 54}, true);
  ASSERT_TRUE(to);
  EXPECT_NEAR(to->y, 10 * std::tan(pi / 8) / 5, 1e-12);
  // Straight down there is no such thing, nor behind the back.
  const Camera down(View{.eye = {0, 9, 0}, .up = {0, 0, -1}}, width, height);
  EXPECT_FALSE(drag_place(down, {0, 3, 0}, {480, 270}, true));
  EXPECT_FALSE(drag_place(camera, {0, 3, 20}, {480, 100}, true));
}

TEST(viewer_light_moves, a_dragged_light_shows_under_the_mouse) {
  const Scene scene = roof();
  const View view{.eye = {3, 6, 14}, .target = {0, 1, 0}};
  const Camera camera(view, width, height);
  Random random(14);
  for (const Light& light : all_kinds())
    for (int i = 0; i < 300; ++i) {
      // Near the middle, where the ellipsoid is: semiaxes are 7.3, 1.8 and 5.5 m, 16 m away.
      const glm::dvec2 pixel(random.uniform(400, 560), random.uniform(250, 290));
      const Light moved = drag_light(scene, light, camera, pixel, false);
      EXPECT_LT(glm::length(*project(camera, light_place(scene, moved)) - pixel), 1e-3) << light.name;
    }
}

// The handle stays on its side of the ellipsoid, however it is dragged over it; and goes no farther than its rim.
TEST(viewer_light_moves, a_dragged_sun_moves_without_leaps) {
  const Scene scene = roof();
  const Camera camera(View{.eye = {3, 6, 14}, .target = {0, 1, 0}}, width, height);
  Light sun{.name = "sun", .kind = DirectionalLight{{-3, -5, -14}}};  // from the eye
  glm::dvec3 before = light_place(scene, sun);
  for (int i = 0; i < 2000; ++i) {
    // Along a spiral that ends far beside the picture.
    const double angle = i * 0.01, reach = 0.3 * i;
    const glm::dvec2 pixel(480 + reach * std::cos(angle), 270 + reach * std::sin(angle));
    const Light moved = drag_light(scene, sun, camera, pixel, false);
    const glm::dvec3 after = light_place(scene, moved);
    // Steps grow to 6 px, some 0.15 m at the middle; a ray along the rim slides by more.
    EXPECT_LT(glm::distance(after, before), 2.5) << i;
    sun = moved, before = after;
  }
}

// From the light as it was found, the row of pixels is one line over the ellipsoid: on the near side for a handle that was
// there, on the far side for another, even of handles that are found near the rim.
TEST(viewer_light_moves, a_dragged_sun_stays_on_its_side) {
  const Scene scene = roof();
  const Camera camera(View{.eye = {3, 6, 14}, .target = {0, 1, 0}}, width, height);
  const glm::dvec3 middle(0, 1, 0), out = glm::normalize(camera.eye - middle);
  for (const double side : {1.0, 0.3, -0.3, -1.0}) {
    const Light found{.name = "sun", .kind = DirectionalLight{glm::vec3(-(side * out + 0.5 * camera.right))}};
    glm::dvec3 before(0);
    double most = 0;
    for (int x = 380; x < 580; ++x) {
      const glm::dvec3 after = light_place(scene, drag_light(scene, found, camera, {x + 0.5, 270.5}, false));
      if (x > 380) most = std::max(most, glm::distance(after, before));
      before = after;
      EXPECT_EQ(glm::dot(after - middle, out) > 0, side > 0) << side << ' ' << x;
    }
    EXPECT_LT(most, 0.2) << side;
  }
}

TEST(viewer_light_moves, a_light_beside_the_picture_is_fetched_from_the_border) {
  const Camera camera(View{.eye = {0, 0, 10}}, width, height);
  const auto seen = light_handle(camera, camera.eye + 5.0 * camera.ray(100, 200), 12);
  ASSERT_TRUE(seen);
  EXPECT_LT(glm::length(seen->at - glm::dvec2(100, 200)), 1e-9);
  EXPECT_EQ(seen->at, seen->shown);
  // 1440 px right of the middle and 270 above it, on the way at 468 px to the right: 468 / 1440 of 270 above.
  const auto aside = light_handle(camera, camera.eye + 5.0 * camera.ray(1920, 0), 12);
  ASSERT_TRUE(aside);
  EXPECT_LT(glm::length(aside->shown - glm::dvec2(948, 270 - 270 * 468 / 1440.0)), 1e-9);
  EXPECT_FALSE(light_handle(camera, {0, 0, 11}, 12));
  // A hundred pixels to the left of the border is a hundred pixels to the left of where it was.
  const Scene scene = roof();
  const Light light{.name = "point", .kind = PointLight{glm::vec3(camera.eye + 5.0 * camera.ray(1920, 0))}};
  const Light moved =
      drag_light(scene, light, camera, light_handle(camera, light_place(scene, light), 12)->at - glm::dvec2(100, 0), false);
  EXPECT_LT(glm::length(*project(camera, light_place(scene, moved)) - glm::dvec2(1820, 0)), 1e-3);
}

TEST(viewer_light_moves, a_million_drags_of_lights_break_nothing) {
  Random random(15);
  for (const double size : sizes) {
    const Scene scene = roof(size, {size, size, -size});
    for (Light light : all_kinds())
      for (int i = 0; i < 55556; ++i) {
        if (i % 100 == 0) light = light_moved_to(scene, light, size * random.uniform(glm::dvec3(-9), glm::dvec3(9)));
        const Camera camera(View{.eye = glm::vec3(glm::dvec3(3, 6, 9) * size), .fov_y_degrees = 60}, width, height);
        light =
            drag_light(scene, light, camera, {random.uniform(-3000, 3000), random.uniform(-3000, 3000)}, random.below(3) == 0);
        if (i % 4 == 0) {
          ASSERT_NO_THROW(check(light, "test")) << light.name << ' ' << i;
        }
      }
  }
}

// The keys: 5 degrees, a tenth of the way, a fiftieth of the diagonal.
TEST(viewer_key_moves, keys_move_camera_and_light_by_what_their_sentences_say) {
  const Scene scene = roof();
  const double step = std::sqrt(8.0 * 8 + 2 * 2 + 6 * 6) / 50, turn = pi / 36;
  EXPECT_NEAR(key_step(scene), step, 1e-12);
  const View view{.eye = {0, 0, 5}};
  const auto eye = [&](const KeyEffect& effect) { return glm::dvec3(moved_by_key(view, scene, effect, 1)->eye); };
  EXPECT_LT(gap(eye(OrbitSteps{.right = -1}), {-5 * std::sin(turn), 0, 5 * std::cos(turn)}), 1e-6);
  EXPECT_LT(gap(eye(OrbitSteps{.right = 1}), {5 * std::sin(turn), 0, 5 * std::cos(turn)}), 1e-6);
  EXPECT_LT(gap(eye(OrbitSteps{.up = 1}), {0, 5 * std::sin(turn), 5 * std::cos(turn)}), 1e-6);
  EXPECT_LT(gap(eye(OrbitSteps{.up = -1}), {0, -5 * std::sin(turn), 5 * std::cos(turn)}), 1e-6);
  EXPECT_LT(gap(eye(ZoomSteps{1}), {0, 0, 4.5}), 1e-6);
  EXPECT_LT(gap(eye(ZoomSteps{-1}), {0, 0, 5 / 0.9}), 1e-6);
  EXPECT_LT(gap(eye(FlySteps{.forward = 1}), {0, 0, 5 - step}), 1e-6);
  EXPECT_LT(gap(eye(FlySteps{.forward = -1}), {0, 0, 5 + step}), 1e-6);
  EXPECT_LT(gap(eye(FlySteps{.right = -1}), {-step, 0, 5}), 1e-6);
  EXPECT_LT(gap(eye(FlySteps{.right = 1}), {step, 0, 5}), 1e-6);
  EXPECT_LT(gap(eye(FlySteps{.up = 1}), {0, step, 5}), 1e-6);
  EXPECT_LT(gap(eye(FlySteps{.up = -1}), {0, -step, 5}), 1e-6);
  EXPECT_FALSE(moved_by_key(view, scene, LightSteps{.y = 1}, 1));
  for (const Light& light : all_kinds()) {
    const glm::dvec3 from = light_place(scene, light);
    const auto to = [&](const KeyEffect& effect) { return light_place(scene, *moved_by_key(light, scene, effect, 2)); };
    EXPECT_FALSE(moved_by_key(light, scene, OrbitSteps{.up = 1}, 1));
    if (light.name == "sun") {  // the ellipsoid has it, but it goes that way
      EXPECT_LT(to(LightSteps{.x = -1}).x, from.x);
      EXPECT_GT(to(LightSteps{.x = 1}).x, from.x);
      // Down from over the middle is toward it: the same way of the light; aside it tilts.
      EXPECT_GT(std::get<DirectionalLight>(moved_by_key(light, scene, LightSteps{.y = -1}, 2)->kind).direction.y, -2);
      continue;
    }
    EXPECT_LT(gap(to(LightSteps{.x = -1}), from - glm::dvec3(2 * step, 0, 0)), 1e-6);
    EXPECT_LT(gap(to(LightSteps{.x = 1}), from + glm::dvec3(2 * step, 0, 0)), 1e-6);
    EXPECT_LT(gap(to(LightSteps{.y = -1}), from - glm::dvec3(0, 2 * step, 0)), 1e-6);
    EXPECT_LT(gap(to(LightSteps{.y = 1}), from + glm::dvec3(0, 2 * step, 0)), 1e-6);
  }
}

}  // namespace light_moves_test
