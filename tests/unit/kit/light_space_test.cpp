// Light space: faces, places and ties on paper, and what holds for every light.
#include <gnomon/kit/geometry/across.h>
#include <gnomon/kit/maps/light_space.h>
#include <gnomon/kit/random.h>
#include <gtest/gtest.h>

namespace gnomon::light_space_test {

constexpr OppositeFaces all_layouts[] = {OppositeFaces::mirrored, OppositeFaces::turned, OppositeFaces::swapped};

glm::dmat3 random_frame(Random& random) {
  const glm::dvec3 axis = glm::normalize(random.uniform(glm::dvec3(-1), glm::dvec3(1)));
  const auto [u, v] = Across(axis);
  return frame_of(u, v, axis);
}

/// +1 for a right-handed frame, -1 for a left-handed one.
double handedness(const LightSpaceFace& face) { return glm::dot(glm::cross(face.axis(0), face.axis(1)), face.axis(2)); }

// A light at (1, 2, 3), the cube along the axes of the world. (2, 6, 1) is 4 before it along +y, whose face has x along z and y
// along x: the place (-2 / 4, 1 / 4). (-4, 2, 3) is straight along -x, at the distance 5.
TEST(LightSpace, a_cube_on_paper) {
  const LightSpace space({1, 2, 3}, glm::dmat3(1), OppositeFaces::mirrored, 0);
  EXPECT_EQ(space.face_count(), 6);
  EXPECT_FALSE(space.is_parallel());
  ASSERT_EQ(space.face_of({2, 6, 1}), 2);
  EXPECT_EQ(space[2].seen({2, 6, 1}), glm::dvec3(-2, 1, 4));
  EXPECT_EQ(space[2].place_of({2, 6, 1}), glm::dvec2(-0.5, 0.25));
  ASSERT_EQ(space.face_of({-4, 2, 3}), 1);
  EXPECT_EQ(space[1].seen({-4, 2, 3}), glm::dvec3(0, 0, 5));
}

// What (-4, 3, 5) is on the face -x of a light at the origin: x runs along y and y along z, but for the layout.
TEST(LightSpace, faces_against_an_axis_on_paper) {
  const auto seen = [](OppositeFaces layout) {
    return LightSpace(glm::dvec3(0), glm::dmat3(1), layout, 0)[1].seen({-4, 3, 5});
  };
  EXPECT_EQ(seen(OppositeFaces::mirrored), glm::dvec3(3, 5, 4));
  EXPECT_EQ(seen(OppositeFaces::turned), glm::dvec3(3, -5, 4));
  EXPECT_EQ(seen(OppositeFaces::swapped), glm::dvec3(5, 3, 4));
}

TEST(LightSpace, handedness_is_as_the_layout_says) {
  Random random(1);
  const glm::dmat3 frame = random_frame(random);
  for (const OppositeFaces layout : all_layouts) {
    const LightSpace space(glm::dvec3(0), frame, layout, 0);
    for (int face = 0; face < 6; ++face)
      EXPECT_NEAR(handedness(space[face]), face % 2 && layout == OppositeFaces::mirrored ? -1 : 1, 1e-14) << face;
  }
}

// Points between faces, the light itself, and a zero component: the axis that comes first, counted from the first one.
TEST(LightSpace, ties_on_paper) {
  const LightSpace xyz(glm::dvec3(0), glm::dmat3(1), OppositeFaces::turned, 0);
  const LightSpace zxy(glm::dvec3(0), glm::dmat3(1), OppositeFaces::turned, 2);
  struct Case {
    glm::dvec3 point;
    int xyz, zxy;
  };
  for (const auto& [point, first, second] : {Case{{1, 1, 1}, 0, 4}, Case{{-1, 1, -1}, 1, 5}, Case{{1, -1, 0}, 0, 0},
                                             Case{{0, -1, 1}, 3, 4}, Case{{-1, 0, 1}, 1, 4}, Case{{0, 0, 0}, 0, 4}}) {
    EXPECT_EQ(xyz.face_of(point), first) << point.x << ' ' << point.y << ' ' << point.z;
    EXPECT_EQ(zxy.face_of(point), second) << point.x << ' ' << point.y << ' ' << point.z;
  }
}

// Every point lies in the pyramid of its face, comes back from there, and what is on one ray has one place, the farther the
// larger z.
TEST(LightSpace, places_are_rays) {
  Random random(2);
  for (int i = 0; i < 2000; ++i) {
    const glm::dvec3 light = random.uniform(glm::dvec3(-3), glm::dvec3(3));
    const glm::dmat3 frame = i % 2 ? random_frame(random) : glm::dmat3(1);
    const LightSpace space = i % 5 == 0 ? LightSpace(LightSpaceFace{light, frame, false})
                                        : LightSpace(light, frame, all_layouts[i % 3], i % 4 == 0 ? 0 : 2);
    EXPECT_EQ(space.is_parallel(), i % 5 == 0);
    const glm::dvec3 p = random.uniform(glm::dvec3(-5), glm::dvec3(5));
    EXPECT_EQ(space.seen(p), std::pair(space.face_of(p), space[space.face_of(p)].seen(p)));
    const LightSpaceFace& face = space[space.face_of(p)];
    const glm::dvec3 q = face.seen(p);
    EXPECT_LT(glm::distance(face.to_world(q), p), 1e-14);
    const glm::dvec3 ray = space.is_parallel() ? face.axis(2) : p - light, farther = p + 0.75 * ray;
    EXPECT_GT(face.seen(farther).z, q.z);
    EXPECT_LT(glm::distance(face.place_of(farther), face.place(q)), 1e-13);
    if (space.is_parallel()) continue;
    EXPECT_GT(q.z, 0);
    EXPECT_LE(glm::max(glm::abs(q.x), glm::abs(q.y)), q.z);
    EXPECT_EQ(space.main().seen(p), space[4].seen(p));
  }
}

// The frame of a face, from the cube's own one, bit for bit as from the world; along the world's axes too.
TEST(LightSpace, faces_of_a_cube_exchange_components) {
  Random random(3);
  for (int i = 0; i < 1000; ++i) {
    const LightSpace space({1, 2, 3}, i % 2 ? random_frame(random) : glm::dmat3(1), all_layouts[i % 3], 2);
    const glm::dvec3 p = random.uniform(glm::dvec3(-5), glm::dvec3(5)), q = space.in_cube(p);
    EXPECT_EQ(q, space.main().seen(p));
    for (int face = 0; face < 6; ++face) {
      EXPECT_EQ(space[face].from_cube.face(), face);
      EXPECT_EQ(space[face].from_cube(q), space[face].seen(p));
      EXPECT_EQ(space[face].from_cube(q), space[face].light_from_world * (p - space[face].origin));
    }
  }
}

// A spot's one face sees in perspective, and everything falls on it.
TEST(LightSpace, a_lone_face_takes_all) {
  const LightSpace space(LightSpaceFace{{0, 4, 0}, frame_of({1, 0, 0}, {0, 0, 1}, {0, -1, 0}), true});
  EXPECT_EQ(space.face_count(), 1);
  EXPECT_FALSE(space.is_parallel());
  EXPECT_EQ(space.face_of({100, 4, 0}), 0);
  EXPECT_EQ(space[0].place_of({1, 2, 3}), glm::dvec2(0.5, 1.5));
}

// u, v and the axis are right-handed and orthonormal, whatever helps to find them.
TEST(Across, two_directions_across_a_third) {
  Random random(3);
  for (int i = 0; i < 1000; ++i) {
    const glm::dvec3 axis = glm::normalize(random.uniform(glm::dvec3(-1), glm::dvec3(1)));
    for (const Across& pair : {Across(axis), Across::by_x(axis, 0.6), Across(axis, {axis.y, axis.z, -axis.x})}) {
      EXPECT_NEAR(glm::dot(pair.u, pair.v), 0, 1e-14);
      EXPECT_NEAR(glm::dot(pair.u, axis), 0, 1e-14);
      EXPECT_NEAR(glm::length(pair.u), 1, 1e-14);
      EXPECT_LT(glm::distance(glm::cross(pair.u, pair.v), axis), 1e-14);
    }
  }
}

TEST(Across, sideways_of_what_runs_along_up) {
  EXPECT_EQ(sideways({0, 0, -1}, {0, 2, 0}), glm::dvec3(2, 0, 0));
  EXPECT_EQ(sideways({0, -1, 0}, {0, 2, 0}), glm::cross(glm::dvec3(0, -1, 0), glm::dvec3(1, 0, 0)));
  EXPECT_EQ(sideways({1, 0, 0}, {-3, 0, 0}), glm::cross(glm::dvec3(1, 0, 0), glm::dvec3(0, 0, 1)));
}

}  // namespace gnomon::light_space_test
