// Camera moves: what follows the mouse, what stays, and what no drag can break.
#include "app/viewer/moves.h"

#include <gtest/gtest.h>

#include "world.h"

namespace moves_test {

using namespace gnomon::viewer;
using namespace viewer_world;

// From (0, 0, 5) at the origin. Over the whole height, to the right: half a turn, the eye goes left. An eighth of that and
// down: the eye goes up by 22.5 degrees.
TEST(viewer_moves, orbit_on_paper) {
  const View front{.eye = {0, 0, 5}};
  EXPECT_LT(gap(orbit(front, {height, 0}, height).eye, {0, 0, -5}), 1e-6);
  EXPECT_LT(gap(orbit(front, {height / 2.0, 0}, height).eye, {-5, 0, 0}), 1e-6);
  EXPECT_LT(gap(orbit(front, {0, height / 8.0}, height).eye, {0, 5 * std::sin(pi / 8), 5 * std::cos(pi / 8)}), 1e-6);
  EXPECT_LT(gap(orbit_by(front, {pi / 2, 0}).eye, {5, 0, 0}), 1e-6);
  EXPECT_LT(gap(orbit_by(front, {0, -pi / 6}).eye, {0, -2.5, 5 * std::cos(pi / 6)}), 1e-6);
}

// A point before the target, on the near side of the scene, goes the way of the mouse: to the right and down.
TEST(viewer_moves, the_near_side_of_the_scene_follows_an_orbit) {
  Random random(1);
  for (int i = 0; i < 300; ++i) {
    const View view = any_view(random, 1);
    const glm::dvec3 near_side = glm::dvec3(view.target) - 0.1 * offset(view);
    for (const glm::dvec2 drag : {glm::dvec2(3, 0), glm::dvec2(0, 3)}) {
      const glm::dvec2 before = *project(Camera(view, width, height), near_side);
      const glm::dvec2 after = *project(Camera(orbit(view, drag, height), width, height), near_side);
      EXPECT_GT(glm::dot(after - before, drag), 0);
    }
  }
}

TEST(viewer_moves, orbit_keeps_distance_target_and_up) {
  Random random(2);
  for (const double size : sizes)
    for (int i = 0; i < 1000; ++i) {
      const View view = any_view(random, size);
      const View moved = orbit(view, {random.uniform(-1e4, 1e4), random.uniform(-1e4, 1e4)}, height);
      EXPECT_EQ(moved.target, view.target);
      EXPECT_EQ(moved.up, view.up);
      // Each of three coordinates was rounded once.
      EXPECT_LE(std::abs(distance(moved) - distance(view)), 1.01 * std::sqrt(3.0) * std::max(rounding(view), rounding(moved)));
    }
}

// Every one of n steps rounds each coordinate of the eye by half a unit in the last place at most, and turns what was rounded
// before with it: n sqrt(3) of them is the most there can be in the end. Rounding up and down by chance leaves far less, about
// sqrt(n): nothing pulls the eye in or out.
TEST(viewer_moves, a_full_turn_in_small_drags_comes_back) {
  Random random(3);
  for (const double size : sizes)
    for (const int count : {36, 720}) {
      View view = any_view(random, size);
      const View start = view;
      double unit = 0;
      for (int i = 0; i < count; ++i) {
        view = orbit(view, {2.0 * height / count, 0}, height);
        unit = std::max(unit, rounding(view));
      }
      EXPECT_LE(gap(view.eye, start.eye), count * std::sqrt(3.0) * unit);
      EXPECT_LE(std::abs(distance(view) - distance(start)), 6 * std::sqrt(count) * unit);
    }
}

TEST(viewer_moves, a_drag_and_back_comes_back) {
  Random random(4);
  for (const double size : sizes)
    for (int i = 0; i < 1000; ++i) {
      const View view = any_view(random, size);
      for (const glm::dvec2 drag : {glm::dvec2(random.uniform(-900, 900), 0), glm::dvec2(0, random.uniform(-20, 20))}) {
        // Two roundings of three coordinates, the first seen from an arm that has turned back; 4 leaves room for the second
        // turn, whose arm is a little off. `way`, in distances to the target, is what the little is multiplied with.
        const auto comes_back = [&](const View& there, const View& back, double way = 0) {
          const double unit = std::max({rounding(view), rounding(there), rounding(back)});
          const double most = std::max(gap(back.eye, view.eye), gap(back.target, view.target));
          EXPECT_LE(most, (4 + swing * way) * std::sqrt(3.0) * unit) << drag.x << ' ' << drag.y;
        };
        const View around = orbit(view, drag, height), aside = pan(view, drag, height);
        comes_back(around, orbit(around, -drag, height));
        comes_back(aside, pan(aside, -drag, height),
                   glm::distance(glm::dvec3(aside.eye), glm::dvec3(view.eye)) / distance(view));
        const View elsewhere = look(view, drag * 0.1, height);
        comes_back(elsewhere, look(elsewhere, drag * -0.1, height));
        const View near_by = zoom(view, drag.y / 5);
        comes_back(near_by, zoom(near_by, -drag.y / 5));
      }
    }
}

TEST(viewer_moves, no_pixels_move_nothing) {
  Random random(5);
  for (const double size : sizes) {
    const View view = any_view(random, size);
    EXPECT_TRUE(same(orbit(view, {0, 0}, height), view));
    EXPECT_TRUE(same(pan(view, {0, 0}, height), view));
    EXPECT_TRUE(same(look(view, {0, 0}, height), view));
    EXPECT_TRUE(same(zoom(view, 0), view));
    EXPECT_TRUE(same(fly(view, {0, 0, 0}, size), view));
  }
}

// Half a degree before the pole, whatever the axis, and from there back again.
TEST(viewer_moves, orbit_and_look_stop_short_of_the_poles) {
  Random random(6);
  const auto above = [](const View& view) {
    return std::acos(glm::dot(glm::normalize(offset(view)), glm::normalize(glm::dvec3(view.up))));
  };
  for (int i = 0; i < 300; ++i) {
    const View view = any_view(random, 1);
    for (const double pixels : {1e3, 1e9, 1e300}) {
      EXPECT_NEAR(above(orbit(view, {0, pixels}, height)), pi * (1 - 1 / 360.0), 1e-5);  // from above: looks down
      EXPECT_NEAR(above(orbit(view, {0, -pixels}, height)), pi / 360, 1e-5);
      EXPECT_NEAR(above(look(view, {0, 1e3 * pixels}, height)), pi / 360, 1e-5);  // the scene goes down: looks up
      EXPECT_NEAR(above(look(view, {0, -1e3 * pixels}, height)), pi * (1 - 1 / 360.0), 1e-5);
    }
    const View top = orbit(view, {0, 1e6}, height);
    EXPECT_LT(above(orbit(top, {0, -54}, height)), pi * 0.9);  // a tenth of the height is a tenth of half a turn
    // Nothing turned around: it is over the same side, seen from the axis.
    const glm::dvec3 axis = glm::normalize(glm::dvec3(view.up));
    const auto side = [&](const View& v) { return glm::normalize(offset(v) - glm::dot(offset(v), axis) * axis); };
    EXPECT_GT(glm::dot(side(view), side(top)), 0.999);
  }
}

// Nearer to the pole than half a degree as it was given: a move does not push it away, and does not take it farther.
TEST(viewer_moves, a_view_at_the_pole_stays_usable) {
  const View steep{.eye = {0, 5, 5e-4f}, .target = {0, 0, 0}};
  EXPECT_LT(gap(orbit(steep, {0, 100}, height).eye, steep.eye), 1e-6);
  EXPECT_LT(gap(orbit(steep, {height / 2.0, 0}, height).eye, {-5e-4, 5, 0}), 1e-6);
  EXPECT_NEAR(orbit(steep, {0, -height / 2.0}, height).eye.z, 5, 1e-3);
}

TEST(viewer_moves, the_point_at_the_targets_distance_follows_a_pan) {
  Random random(7);
  for (const double size : {1e-3, 1.0, 1e3})
    for (int i = 0; i < 1000; ++i) {
      const View view = any_view(random, size);
      const Camera before(view, width, height);
      const glm::dvec2 from(random.uniform(0, width), random.uniform(0, height)),
          drag(random.uniform(-500, 500), random.uniform(-500, 500));
      const glm::dvec3 point = before.eye + distance(view) * before.ray(from.x, from.y);
      const View moved = pan(view, drag, height);
      const glm::dvec2 to = *project(Camera(moved, width, height), point);
      // A pixel at the target is 2 tan(fov / 2) distance / height wide. Rounding moves both ends, and so turns the frame; that
      // moves a point the more, by the square of the slope, the farther it is from the middle.
      const double slope = 2 * before.tan_y / height, pixel = slope * distance(view);
      const glm::dvec2 middle(width / 2.0, height / 2.0);
      const double off = slope * std::max(glm::distance(from, middle), glm::distance(to, middle));
      const double unit = std::sqrt(3.0) * std::max(rounding(view), rounding(moved));
      EXPECT_LE(glm::distance(to, from + drag), 1e-6 + (2 + swing * (1 + off * off)) * unit / pixel);
    }
}

// The offset is a multiple of a quarter, and so is that of any two floats below 2^22 of which one is rounded and the other that
// much off it.
TEST(viewer_moves, pan_and_fly_keep_the_offset_to_the_bit_where_float_holds_it) {
  View view{.eye = {3, 4.5f, -6}, .target = {2.25f, 0, 1}};
  const View start = view;
  Random random(8);
  for (int i = 0; i < 1000; ++i) {
    view = pan(view, {random.uniform(-9, 9), random.uniform(-9, 9)}, height);
    view = fly(view, random.uniform(glm::dvec3(-1), glm::dvec3(1)), 0.1);
    ASSERT_EQ(offset(view), offset(start)) << i;
  }
  EXPECT_NE(view.eye, start.eye);
  // Else by the rounding of both ends at most.
  for (const double size : sizes)
    for (int i = 0; i < 1000; ++i) {
      const View before = any_view(random, size),
                 after = pan(before, {random.uniform(-900, 900), random.uniform(-900, 900)}, height);
      EXPECT_LE(gap(offset(after), offset(before)), 2 * rounding(after));
    }
}

// The middle of the picture goes where the mouse goes: a pixel to the right or down is a pixel, up to the curvature of a circle
// of small radius around the axis.
TEST(viewer_moves, the_middle_follows_a_look) {
  Random random(9);
  for (int i = 0; i < 1000; ++i) {
    const View view = any_view(random, 1);
    for (const glm::dvec2 drag : {glm::dvec2(1, 0), glm::dvec2(0, 1), glm::dvec2(-1, 0), glm::dvec2(0, -1)}) {
      const View moved = look(view, drag, height);
      EXPECT_EQ(moved.eye, view.eye);
      EXPECT_LE(std::abs(distance(moved) - distance(view)), 1.01 * std::sqrt(3.0) * std::max(rounding(view), rounding(moved)));
      const glm::dvec2 to = *project(Camera(moved, width, height), view.target);
      EXPECT_LT(glm::length(to - glm::dvec2(width, height) / 2.0 - drag), 0.05);
    }
  }
}

TEST(viewer_moves, zoom_goes_a_tenth_of_the_way_and_never_through) {
  const View view{.eye = {1, 2, 13}, .target = {1, 2, 3}};
  EXPECT_EQ(zoom(view, 1).eye, glm::vec3(1, 2, 12));
  EXPECT_LT(gap(zoom(view, 2).eye, {1, 2, 11.1}), 1e-6);
  EXPECT_LT(gap(zoom(view, -1).eye, {1, 2, 3 + 10 / 0.9}), 1e-6);
  for (const double steps : {100.0, 1e4, 1e300, HUGE_VAL}) {
    const View near_by = zoom(view, steps);
    EXPECT_GT(near_by.eye.z, near_by.target.z);
    // 3 m of coordinate over 1e-4 rad: where half a unit of its last place, 3 * 2^-24, still turns the line of sight by less.
    EXPECT_NEAR(distance(near_by), 3 * 0x1p-24 / 1e-4, 3 * 0x1p-22);
    EXPECT_GT(distance(zoom(near_by, -1)), 1.05 * distance(near_by));  // and back out
    EXPECT_NEAR(distance(zoom(view, -steps)), std::min(10 * std::pow(0.9, -steps), 1e9), 1e3);
  }
}

// Looking along -z from the side: right is +x, up is the view's, forward is -z.
TEST(viewer_moves, fly_goes_right_up_and_forward) {
  const View view{.eye = {0, 1, 5}, .target = {0, 1, 0}};
  const View moved = fly(view, {1, 2, 3}, 0.5);
  EXPECT_LT(gap(moved.eye, {0.5, 2, 3.5}), 1e-6);
  EXPECT_LT(gap(moved.target, {0.5, 2, -1.5}), 1e-6);
  // Up is up, even for one who looks down.
  const View steep{.eye = {0, 5, 1}, .target = {0, 0, 0}};
  EXPECT_LT(gap(fly(steep, {0, 1, 0}, 1).eye, {0, 6, 1}), 1e-6);
}

TEST(viewer_moves, what_is_no_move_changes_nothing) {
  const View view{.eye = {3, 4, 5}};
  for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    for (const glm::dvec2 drag : {glm::dvec2(bad, 0), glm::dvec2(bad, bad)}) {
      EXPECT_TRUE(same(orbit(view, drag, height), view));
      EXPECT_TRUE(same(pan(view, drag, height), view));
      EXPECT_TRUE(same(look(view, drag, height), view));
    }
    EXPECT_TRUE(same(fly(view, {0, bad, 0}, 1), view));
    EXPECT_TRUE(same(fly(view, {0, 1, 0}, bad), view));
  }
  EXPECT_TRUE(same(zoom(view, std::nan("")), view));
  // So far that float32 could not tell eye from target there: not at all.
  EXPECT_TRUE(same(fly(view, {1e12, 0, 0}, 1), view));
  EXPECT_TRUE(same(fly(view, {1e8, 0, 0}, 1), view));  // floats are 8 m apart there, and eye and target 7
  EXPECT_TRUE(same(pan(view, {1e300, 0}, height), view));
  check(orbit(view, {30, 20}, 0), "a window without height");
  check(pan(view, {30, 20}, 0), "a window without height");
}

// Given where floats are 8 m apart, eye and target a few of them: most moves round to the place itself or onto the target.
TEST(viewer_moves, views_that_are_too_coarse_to_begin_with_stay_views) {
  Random random(16);
  for (int i = 0; i < 20000; ++i) {
    View view{.eye = glm::vec3(1e8f) + 8.0f * glm::vec3(random.below(4), random.below(4), random.below(4))};
    view.target = glm::vec3(1e8f) + 8.0f * glm::vec3(random.below(4), 4, random.below(4));
    view.up = {random.below(2), 1, random.below(2)};
    if (glm::length(glm::cross(offset(view), glm::dvec3(view.up))) == 0) continue;
    ASSERT_NO_THROW(check(view, "given"));
    const glm::dvec2 drag(random.uniform(-600, 600), random.uniform(-600, 600));
    const View moved[] = {orbit(view, drag, height), pan(view, drag, height), look(view, drag, height), zoom(view, drag.x / 9),
                          fly(view, {drag.x, drag.y, drag.x}, 1)};
    for (const View& after : moved) {
      ASSERT_NO_THROW(check(after, "test")) << i;
    }
  }
}

TEST(viewer_moves, a_million_steps_break_nothing) {
  Random random(10);
  for (const double size : {1e-3, 1e-3, 1.0, 1e3, 1e5}) {
    View view = any_view(random, size);
    const glm::vec3 up = view.up;
    for (int i = 0; i < 200000; ++i) {
      // From a hundredth of a pixel to a million screens.
      const double reach = std::exp(random.uniform(-5, random.below(50) ? 5 : 20));
      const glm::dvec2 drag(random.uniform(-reach, reach), random.uniform(-reach, reach));
      switch (random.below(5)) {
        case 0:
          view = orbit(view, drag, height);
          break;
        case 1:
          view = pan(view, drag, height);
          break;
        case 2:
          view = look(view, drag, height);
          break;
        case 3:
          view = zoom(view, drag.x / 10);
          break;
        default:
          view = fly(view, {drag.x / 10, drag.y / 10, reach / 20}, size / 50);
      }
      if (i % 4 == 0) {
        ASSERT_NO_THROW(check(view, "test")) << size << ' ' << i;
      }
    }
    EXPECT_EQ(view.up, up);
    check(view, "test");
  }
}

// Camera::ray and back, to a millionth of a pixel, at any distance and beside the picture.
TEST(viewer_moves, project_is_the_ray_backwards) {
  Random random(11);
  for (const double size : sizes)
    for (int i = 0; i < 10000; ++i) {
      const Camera camera(any_view(random, size), 1 + random.below(2000), 1 + random.below(2000));
      const glm::dvec2 pixel(random.uniform(-1, 2) * camera.width, random.uniform(-1, 2) * camera.height);
      const double depth = size * std::exp(random.uniform(-3, 3));
      const auto back = project(camera, camera.eye + depth * camera.ray(pixel.x, pixel.y));
      ASSERT_TRUE(back);
      ASSERT_LT(glm::length(*back - pixel), 1e-6);
      ASSERT_FALSE(project(camera, camera.eye - depth * camera.ray(pixel.x, pixel.y)));
    }
  const Camera camera(View{}, width, height);
  EXPECT_FALSE(project(camera, camera.eye));
  EXPECT_FALSE(project(camera, glm::dvec3(std::nan(""))));
}

}  // namespace moves_test
