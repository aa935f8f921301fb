#include "measure/frame/lit_ways.h"

#include <gnomon/kit/random.h>
#include <gtest/gtest.h>

#include <algorithm>

namespace lit_ways_test {

using namespace gnomon;

/// A G-buffer of one row with these points; all lie on a surface.
struct Points {
  GBuffer gbuffer;
  std::vector<float> x, y, z, normal;
  std::vector<std::uint32_t> ids;

  explicit Points(const std::vector<glm::vec3>& points) : normal(points.size()), ids(points.size()) {
    for (const glm::vec3& p : points) {
      x.push_back(p.x);
      y.push_back(p.y);
      z.push_back(p.z);
    }
    gbuffer = {View{}, Truth::mesh, static_cast<int>(points.size()), 1, x, y, z, normal, normal, normal, ids, ids, nullptr};
  }
};

/// The least distance of two segments, by halving steps of both at once from a grid; good to some 1e-9 of their lengths.
double distance(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d) {
  // Of convex functions over a square: the point of one segment that is nearest, for each of the other, by golden sections.
  const auto to_segment = [&](const glm::dvec3& p) {
    const glm::dvec3 along = d - c;
    const double share = std::clamp(glm::dot(p - c, along) / glm::dot(along, along), 0.0, 1.0);
    return glm::distance(p, c + share * along);
  };
  double low = 0, high = 1;
  for (int k = 0; k < 100; ++k) {
    const double one = low + (high - low) / 3, other = high - (high - low) / 3;
    (to_segment(a + one * (b - a)) < to_segment(a + other * (b - a)) ? high : low) =
        to_segment(a + one * (b - a)) < to_segment(a + other * (b - a)) ? other : one;
  }
  return to_segment(a + low * (b - a));
}

TEST(lit_ways, a_segment_that_comes_near_a_way_may_touch_it) {
  Random random(1);
  int touching = 0, spared = 0;
  for (int round = 0; round < 60; ++round) {
    const bool is_point = round % 2 == 0;
    const double reach = round % 3 == 0 ? 1e-6 : 1e-3;
    glm::dvec3 place(random.uniform(glm::dvec3(-2), glm::dvec3(2)));
    place = glm::dvec3(glm::vec3(place));
    const glm::dvec4 light(place, is_point ? 1 : 0);
    std::vector<glm::vec3> points;
    for (int i = 0; i < 40; ++i) points.emplace_back(random.uniform(glm::dvec3(-5), glm::dvec3(5)));
    std::vector<float> reference;
    for (std::size_t i = 0; i < points.size(); ++i) reference.push_back(i % 2 ? 1.0f : 0.0f);
    const Points seen(points);
    const LitWays ways(seen.gbuffer, light, reference, reach);
    for (int k = 0; k < 300; ++k) {
      // Through a place on a way or beside it by about the reach, of all lengths and directions; or anywhere.
      const glm::dvec3 p(points[2 * random.below(20) + 1]), to = is_point ? place : p + 20.0 * place;
      glm::dvec3 at = p + random.uniform(0, 1) * (to - p) + random.uniform(glm::dvec3(-1), glm::dvec3(1)) * reach;
      if (k % 3 == 0) at = random.uniform(glm::dvec3(-6), glm::dvec3(6));
      const double length = std::pow(10.0, random.uniform(-5, 1));
      const glm::dvec3 along = length * random.uniform(glm::dvec3(-1), glm::dvec3(1));
      const glm::dvec3 a = at - random.uniform(0, 1) * along, b = a + along;
      bool is_near = false;
      for (std::size_t i = 1; i < points.size(); i += 2) {
        const glm::dvec3 q(points[i]);
        is_near = is_near || distance(q, is_point ? place : q + 100.0 * place, a, b) <= reach;
      }
      touching += is_near;
      const bool may = ways.may_touch(a, b);
      spared += !may;
      ASSERT_TRUE(may || !is_near) << round << ' ' << k;
    }
  }
  EXPECT_GT(touching, 4000);
  EXPECT_GT(spared, 2000);
}

TEST(lit_ways, what_lies_behind_all_lit_points_touches_none) {
  const std::vector<glm::vec3> points{{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {0.4f, 0.5f, 0.3f}};
  const Points seen(points);
  const std::vector<float> lit(4, 1.0f), dark(4, 0.0f);
  // Half a meter over the last point, on its way.
  for (const auto& [light, over] : {std::pair(glm::dvec4(0.2, 3, 0.2, 1), glm::dvec3(0.36, 1, 0.28)),
                                    std::pair(glm::dvec4(0.1, 1, 0.2, 0), glm::dvec3(0.45, 1, 0.4))}) {
    const glm::dvec3 below = glm::dvec3(points[3]) - 0.1 * to_light(light, glm::dvec3(points[3])), aside(0.01, 0, 0.02);
    EXPECT_TRUE(LitWays(seen.gbuffer, light, lit, 1e-6).may_touch(over - aside, over + aside));
    EXPECT_FALSE(LitWays(seen.gbuffer, light, lit, 1e-6).may_touch(below - aside, below + aside));
    EXPECT_FALSE(LitWays(seen.gbuffer, light, dark, 1e-6).may_touch(over - aside, over + aside));
  }
}

}  // namespace lit_ways_test
