// Outlines of lights with area, and what a drag at their handles does.
#include "app/viewer/light_size.h"

#include <gtest/gtest.h>

#include "app/viewer/moves.h"
#include "world.h"

namespace light_size_test {

using namespace gnomon::viewer;
using namespace viewer_world;

const View front{.eye = {1, 2, 13}, .target = {1, 2, 3}};  // 10 m before the lights of all_kinds, level

Light of_kind(std::string_view name) {
  for (const Light& light : all_kinds())
    if (light.name == name) return light;
  throw std::logic_error("no such light");
}

TEST(viewer_light_size, outlines_are_as_large_as_the_lights) {
  const glm::dvec3 eye(front.eye), center(1, 2, 3);
  const auto rect = light_outline(of_kind("rect"), eye);
  ASSERT_EQ(rect.size(), 4u);
  for (const auto& [from, to] : rect) {
    EXPECT_NEAR(glm::distance(from, to), 2, 1e-6);
    EXPECT_NEAR(glm::distance(from, center), std::sqrt(2.0), 1e-6);
  }
  for (const auto& [from, to] : light_outline(of_kind("disc"), eye)) {
    EXPECT_NEAR(glm::distance(from, center), 0.5, 1e-6);
    EXPECT_NEAR(from.y, 2, 1e-6) << "its normal is down";
  }
  // Rays from the eye touch a sphere where they are across its radius: dot(p - center, p - eye) = 0.
  for (const auto& [from, to] : light_outline(of_kind("sphere"), eye)) {
    EXPECT_NEAR(glm::distance(from, center), 0.5, 1e-6);
    EXPECT_NEAR(glm::dot(from - center, from - eye), 0, 1e-6);
  }
  EXPECT_TRUE(light_outline(of_kind("sphere"), center).empty()) << "from inside";
  for (const char* name : {"point", "spot", "sun"}) {
    EXPECT_TRUE(light_outline(of_kind(name), eye).empty());
    EXPECT_TRUE(light_lengths(of_kind(name)).empty());
    EXPECT_TRUE(size_handles(Camera(front, width, height), of_kind(name)).empty());
  }
}

TEST(viewer_light_size, a_length_is_set_and_nothing_else) {
  const Light rect = with_length(of_kind("rect"), 1, 0.25);
  EXPECT_EQ(std::get<RectLight>(rect.kind).half_u, glm::vec3(1, 0, 0));
  EXPECT_EQ(std::get<RectLight>(rect.kind).half_v, glm::vec3(0, 0.25f, 0));
  EXPECT_EQ(std::get<RectLight>(rect.kind).center, glm::vec3(1, 2, 3));
  for (const char* name : {"disc", "sphere"}) EXPECT_EQ(light_lengths(with_length(of_kind(name), 0, 3))[0].meters, 3) << name;
  for (const double none : {0.0, -1.0, std::nan(""), HUGE_VAL, 1e-40, 1e20})
    EXPECT_EQ(light_lengths(with_length(of_kind("disc"), 0, none))[0].meters, 0.5) << none;
  EXPECT_EQ(light_lengths(with_length(of_kind("disc"), 1, 2))[0].meters, 0.5) << "it has one length";
}

TEST(viewer_light_size, a_dragged_handle_shows_under_the_mouse) {
  const Camera camera(front, width, height);
  const glm::dvec3 center(1, 2, 3);
  for (const char* name : {"rect", "disc", "sphere"}) {
    const Light light = of_kind(name);
    const std::vector<SizeHandle> handles = size_handles(camera, light);
    ASSERT_EQ(handles.size(), 2 * light_lengths(light).size()) << name;
    for (std::size_t k = 0; k < handles.size(); ++k) {
      const double before = light_lengths(light)[handles[k].which].meters;
      EXPECT_NEAR(glm::distance(handles[k].place, center), before, 1e-6);
      // Twice as far from the center in the picture is twice as long, for all handles are across the line of sight.
      const glm::dvec2 middle = *project(camera, center), at = *project(camera, handles[k].place);
      const Light larger = drag_size(camera, light, k, middle + 2.0 * (at - middle));
      EXPECT_NEAR(light_lengths(larger)[handles[k].which].meters, 2 * before, 1e-5) << name << k;
      // Over the center it does not turn around: a hundredth stays.
      const Light least = drag_size(camera, light, k, middle - (at - middle));
      EXPECT_NEAR(light_lengths(least)[handles[k].which].meters, before / 100, 1e-6) << name << k;
    }
  }
  EXPECT_EQ(light_lengths(drag_size(camera, of_kind("disc"), 2, {0, 0}))[0].meters, 0.5) << "no such handle";
}

TEST(viewer_light_size, any_drag_leaves_a_light_that_check_accepts) {
  Random random(21);
  for (const Light& light : all_kinds())
    for (int i = 0; i < 20000; ++i) {
      const Camera camera(any_view(random, 10), width, height);
      const Light sized = drag_size(camera, light, random.below(4), {random.uniform(-3000, 3000), random.uniform(-3000, 3000)});
      ASSERT_NO_THROW(check(sized, "test"));
      for (const SizeHandle& handle : size_handles(camera, light)) ASSERT_TRUE(std::isfinite(glm::length(handle.place)));
    }
}

}  // namespace light_size_test
