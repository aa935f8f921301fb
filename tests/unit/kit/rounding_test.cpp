#include <gnomon/kit/random.h>
#include <gnomon/light.h>
#include <gtest/gtest.h>

namespace rounding_test {
using namespace gnomon;

/// Hides what is known of the values, so that nothing is folded away.
__attribute__((noinline)) bool is_rounded(const glm::dvec4& l, const glm::vec3&) {
  return glm::dvec3(glm::vec3(l)) == glm::dvec3(l);
}

// Points are rounded to float32 once and widened again. With vectors made of straight-line code, GCC 12 keeps the second
// coordinate of such a point unrounded: the flag that forbids them is what this test checks.
TEST(Rounding, a_point_widened_from_float32_is_rounded_in_every_coordinate) {
  Random random(3);
  const auto point = [&] { return glm::vec3(random.uniform(glm::dvec3(-2), glm::dvec3(2))); };
  double sum = 0;
  for (int i = 0; i < 1000; ++i) {
    const glm::vec3 a = point();
    const glm::dvec4 l(point(), random.below(2));
    const glm::dvec3 widened(l), way = to_light(l, glm::dvec3(a));
    ASSERT_TRUE(is_rounded(l, a)) << i;
    sum += widened.x + way.x;
  }
  EXPECT_TRUE(std::isfinite(sum));
}

}  // namespace rounding_test
