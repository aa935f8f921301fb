// Crow's count: the crossing predicates on paper and against other formulations.
#include <gnomon/kit/geometry/exact_scene.h>
#include <gnomon/kit/random.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "hand_made.h"
#include "hard_scenes.h"
#include "techniques/crow_counting/polygon.h"

namespace gnomon::crow_crossing_test {

using namespace hand_made;
using namespace crow_counting;
using namespace hard_scenes;

// The edge from (0, 1, -1) to (0, 1, 1) under a sun straight down has the side quad x = 0, y <= 1, |z| <= 1; under a light at
// (0, 3, 0) it widens to |z| <= (3 - y) / 2. As high, low, low at infinity the quad's normal is (0, 0, -2) x (0, -1, 0) = (-2,
// 0, 0), so that a volume of positive count lies at x > 0.
TEST(CrowCrossing, a_side_quad_on_paper) {
  const glm::vec3 low(0, 1, -1), high(0, 1, 1);
  const glm::dvec4 sun_up(0, 1, 0, 0), lamp(0, 3, 0, 1);
  const auto meet = [&](const glm::vec3& from, const glm::vec3& to, const glm::dvec4& light) {
    const Meeting meeting = meet_side(from, to, low, high, light);
    EXPECT_EQ(meet_side(from, to, high, low, light), meeting);
    return meeting;
  };
  for (const glm::dvec4& light : {sun_up, lamp}) {
    EXPECT_EQ(meet({-1, 0, 0}, {1, 0, 0.1f}, light), Meeting::crosses);
    EXPECT_EQ(meet({1, 0, 0}, {-1, 0, 0.1f}, light), Meeting::crosses);
    EXPECT_EQ(meet({-1, -99, 0}, {1, -99, 0.1f}, light), Meeting::crosses);
    EXPECT_EQ(meet({-1, 2, 0}, {1, 2, 0.1f}, light), Meeting::none);   // before the edge
    EXPECT_EQ(meet({-1, 5, 0}, {1, 5, 0.1f}, light), Meeting::none);   // behind the lamp
    EXPECT_EQ(meet({-1, 0, 0}, {-2, 0, 0.1f}, light), Meeting::none);  // away from the plane
    EXPECT_EQ(meet({-1, 0, 9}, {1, 0, 9}, light), Meeting::none);      // beside it
    EXPECT_EQ(meet({-1, 0, -9}, {1, 0, -9}, light), Meeting::none);
    EXPECT_EQ(meet({-1, 1, 0}, {1, 1, 0.1f}, light), Meeting::none);  // through the edge: as if before it
    EXPECT_EQ(meet({-1, 0, 0}, {0, 0, 0.1f}, light), Meeting::touches);
    EXPECT_EQ(meet({-1, 0, 0}, {0, 1, 0.1f}, light), Meeting::none);  // on the edge: it does not shade itself
    EXPECT_EQ(meet({-1, 0, 0}, {0, 2, 0.1f}, light), Meeting::none);
    EXPECT_EQ(meet({-1, 0, 0}, {0, 0, 9}, light), Meeting::none);
    EXPECT_EQ(meet({0, 0, 9}, {1, 0, 0}, light), Meeting::none);     // from its plane, beside it
    EXPECT_EQ(meet({0, 0, 9}, {0, 0, 0}, light), Meeting::unclear);  // along its plane
  }
  EXPECT_EQ(meet({-1, 0, 1.25f}, {1, 0, 1.25f}, sun_up), Meeting::none);
  EXPECT_EQ(meet({-1, 0, 1.25f}, {1, 0, 1.25f}, lamp), Meeting::crosses);
  EXPECT_EQ(meet({-1, 0, 1}, {1, 0, 1}, sun_up), Meeting::unclear);  // through the end's ray
  EXPECT_EQ(meet({-1, 0, 1.5f}, {1, 0, 1.5f}, lamp), Meeting::unclear);
  EXPECT_EQ(meet({-1, 0, 0}, {0, 0, 1}, sun_up), Meeting::touches);
  EXPECT_EQ(meet({-1, 0, 0}, {0, 0, 1.5f}, lamp), Meeting::touches);

  const Frame left({}, {-1, 0, 0}), right({}, {1, 0, 0}), on_plane({}, {0, 0, 9});
  EXPECT_EQ(side_polygon(left, low, high, sun_up, 2).step, 2);
  EXPECT_EQ(side_polygon(right, low, high, sun_up, 2).step, -2);
  EXPECT_EQ(side_polygon(left, low, high, lamp, -1).step, -1);
  EXPECT_EQ(side_polygon(on_plane, low, high, lamp, -1).step, 0);
  // Rounding is allowed for by the length of the seen point alone: no normal may be longer than 1.
  for (const float scale : {1e-3f, 1.0f, 1e3f})
    for (const glm::dvec4& light : {sun_up, glm::dvec4(0, 3 * scale, 0, 1)})
      for (const glm::dvec3& n : side_polygon(Frame({}, {-scale, 0, 0}), scale * low, scale * high, light, 1).inside) {
        EXPECT_LE(glm::length(n), 1 + 1e-9);
        EXPECT_GT(glm::length(n), 0.1);
      }
}

// A triangle in the plane y = 1, counter-clockwise seen from above. Entered from the light's side, whichever way it is wound.
TEST(CrowCrossing, a_light_cap_on_paper) {
  const Triangle cap{{{0, 1, 0}, {0, 1, 4}, {4, 1, 0}}};
  const Triangle turned{{cap.points[0], cap.points[2], cap.points[1]}};
  for (const glm::dvec4& light : {glm::dvec4(0, 1, 0, 0), glm::dvec4(1, 9, 1, 1)}) {
    const auto meet = [&](const glm::vec3& from, const glm::vec3& to) {
      const Meeting meeting = meet_cap(from, to, cap, light, 1);
      EXPECT_EQ(meet_cap(from, to, turned, light, -1), meeting);
      return meeting;
    };
    EXPECT_EQ(meet({1, 2, 1.5f}, {1, 0, 1.25f}), Meeting::crosses);
    EXPECT_EQ(meet({1, 0, 1.5f}, {1, 2, 1.25f}), Meeting::crosses);
    EXPECT_EQ(meet({5, 2, 1.5f}, {5, 0, 1.25f}), Meeting::none);
    EXPECT_EQ(meet({1, 2, 1.5f}, {1, 1, 1.25f}), Meeting::none);     // the point on it is on the light's side of it
    EXPECT_EQ(meet({1, 0, 1.5f}, {1, 1, 1.25f}), Meeting::crosses);  // and is reached through it from below
    EXPECT_EQ(meet({9, 1, 1.5f}, {1, 0, 1.25f}), Meeting::none);     // from its plane, beside it
  }
  const Frame above({}, {1, 2, 1}), below({}, {1, 0, 1});
  EXPECT_EQ(cap_polygon(above, cap, 1).step, 1);
  EXPECT_EQ(cap_polygon(above, turned, -1).step, 1);
  EXPECT_EQ(cap_polygon(below, cap, 1).step, -1);
  EXPECT_EQ(cap_polygon(Frame({}, {9, 1, 9}), cap, 1).step, 0);
}

// Against other formulations. Where the way meets the plane of light, a and b, a point lies on the quad when its own way to
// the light comes to the line a b between the two (solved in double by distances from the line; ways within 1e-6 of a border
// are left out). A cap is crossed as the oracle's segment from the point to the eye crosses its triangle. And the
// planes in double never contradict.
TEST(CrowCrossing, random_ways_against_other_formulations) {
  Random random(3);
  const auto point = [&] {
    glm::vec3 p;
    for (int k = 0; k < 3; ++k) p[k] = (static_cast<float>(random.below(1 << 22)) - 0x1p21f) * 0x1p-20f;
    return p;
  };
  int crossed[2] = {0, 0}, missed[2] = {0, 0};
  for (int i = 0; i < 200'000; ++i) {
    const glm::vec3 a = point(), b = point(), c = point(), from = point(), to = point();
    const glm::dvec4 light(point(), random.below(2));
    const glm::dvec3 l(light), da(a), e(from), way = glm::dvec3(to) - e;
    const glm::dvec3 u = to_light(light, da), v = glm::dvec3(b) - da, normal = glm::cross(v, u);
    const double t = glm::dot(normal, da - e) / glm::dot(normal, way);
    const glm::dvec3 x = e + t * way;
    // x = a + j v - k u: k is how far behind the line of the edge; the way from x comes to that line beside a by the share i.
    const double vv = glm::dot(v, v), uv = glm::dot(u, v), uu = glm::dot(u, u), det = vv * uu - uv * uv;
    const glm::dvec3 r = x - da;
    const double j = (glm::dot(r, v) * uu - glm::dot(r, u) * uv) / det, k = -(glm::dot(r, u) * vv - glm::dot(r, v) * uv) / det;
    // Point light: x = a + j v - k (l - a); toward l, the share of u grows from -k to 1 and that of v falls from j to 0.
    const double share = light.w != 0 ? j / (1 + k) : j;
    const double clear = std::min({std::abs(t), std::abs(1 - t), std::abs(k), std::abs(share), std::abs(1 - share),
                                   light.w != 0 ? std::abs(1 + k) : 1.0});
    if (clear > 1e-6) {
      const bool expected = t > 0 && t < 1 && k > 0 && share > 0 && share < 1;
      const Meeting meeting = meet_side(from, to, a, b, light);
      ASSERT_EQ(meeting, expected ? Meeting::crosses : Meeting::none) << "way " << i;
      ++(expected ? crossed : missed)[0];
    }
    const Triangle triangle{{a, b, c}};
    const int facing = orient3d_sign(a, b, c, light);
    const Meeting meeting = meet_cap(from, to, triangle, light, facing);
    ASSERT_EQ(meeting == Meeting::crosses, crosses({to, glm::dvec4(from, 1)}, triangle) == Crossing::crosses) << "way " << i;
    ++(meeting == Meeting::crosses ? crossed : missed)[1];

    View view;
    view.eye = from, view.target = point();
    const Frame frame(view, from);
    const auto judged = [&](const Polygon& polygon) {
      const glm::dvec3 p = frame.seen(to);
      const double error = relative_error * glm::length(p), beyond = glm::dot(polygon.plane, p) - polygon.distance;
      double inside = INFINITY;
      for (const glm::dvec3& n : polygon.inside) inside = std::min(inside, glm::dot(n, p));
      EXPECT_GT(std::min(std::abs(beyond), std::abs(inside)), polygon.slack + error);  // no sign was in doubt
      return beyond > 0 && inside > 0;
    };
    ASSERT_EQ(judged(side_polygon(frame, a, b, light, 1)), meet_side(from, to, a, b, light) == Meeting::crosses);
    ASSERT_EQ(judged(cap_polygon(frame, triangle, facing)), meeting == Meeting::crosses);
  }
  for (int kind = 0; kind < 2; ++kind) {
    EXPECT_GT(crossed[kind], 5000);
    EXPECT_GT(missed[kind], 5000);
  }
}

}  // namespace gnomon::crow_crossing_test
