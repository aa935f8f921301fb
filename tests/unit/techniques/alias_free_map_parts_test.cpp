// Parts of the alias-free map: footprints and shadows of single triangles against exact signs.
#include <gnomon/kit/geometry/exact_scene.h>
#include <gnomon/kit/random.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "hand_made.h"
#include "techniques/alias_free_map/walk.h"

namespace gnomon::alias_free_map_parts_test {

using namespace hand_made;
using namespace alias_free_map;

glm::vec3 lattice_point(Random& random) {
  glm::vec3 p;
  for (int k = 0; k < 3; ++k) p[k] = (static_cast<float>(random.below(1 << 22)) - 0x1p21f) * 0x1p-20f;
  return p;
}

// Of every pair of a triangle and a point that it shades, the footprint on the point's face holds the point. Lights lie
// anywhere, many of them so close to the triangle that it is seen on several faces, or lost in rounding.
TEST(AliasFreeMapParts, a_footprint_holds_all_that_its_triangle_shades) {
  Random random(2);
  int shaded = 0, several = 0, left_out = 0;
  for (int i = 0; i < 200'000; ++i) {
    Triangle t{{lattice_point(random), lattice_point(random), lattice_point(random)}};
    const glm::vec3 at = lattice_point(random);
    if (i % 4 == 0) t.points[2] = t.points[0] + 0x1p-9f * (t.points[2] - t.points[0]);
    const std::uint32_t kind = random.below(5);
    if (kind == 4) t.points[2] = -(t.points[0] + t.points[1]);  // the origin is its center
    const Light light = kind == 0   ? sun(at)
                        : kind == 1 ? Light{.name = "spot", .kind = SpotLight{at, lattice_point(random)}}
                        : kind == 2 ? point_light(at)
                        : kind == 4 ? point_light(0x1p-40f * at)
                                    : point_light(t.points[0] + 0x1p-12f * (at - t.points[0]));
    const glm::dvec4 l = homogeneous(light);
    if (orient3d_sign(t.points[0], t.points[1], t.points[2], l) == 0) continue;
    Bounds bounds;
    for (const glm::vec3& p : t.points) bounds.add(p);
    const LightSpace space = space_of(light, bounds);
    double extent = 0;
    for (const glm::vec3& p : t.points) extent = std::max(extent, norm1(space.main().seen(p)));
    Footprint footprints[6];
    bool has[6] = {};
    FaceFootprint found[6];
    const int count = find_footprints(space, t.points, extent, 7, found);
    for (int k = 0; k < count; ++k) {
      footprints[found[k].face] = found[k].footprint;
      has[found[k].face] = true;
    }
    several += std::count(has, has + 6, true) > 1;
    left_out += std::count(has, has + 6, true) < 3;
    for (int k = 0; k < 8; ++k) {
      // Behind a place of the triangle, up to its border.
      const double u = k < 2 ? 0 : random.uniform(0, 1), v = (k % 2 ? 1 : random.uniform(0, 1)) * (1 - u);
      const glm::dvec3 a(t.points[0]), hit = a + u * (glm::dvec3(t.points[1]) - a) + v * (glm::dvec3(t.points[2]) - a);
      const glm::vec3 p = kind == 4 ? lattice_point(random) : glm::vec3(hit - random.uniform(0, 1) * to_light(l, hit));
      if (crosses({p, l}, t) == Crossing::none) continue;
      ++shaded;
      const int face = space.face_of(p);
      ASSERT_TRUE(has[face]) << "triangle " << i;
      const glm::dvec3 q = space[face].seen(p);
      const glm::dvec2 place = space[face].place(q);
      const Footprint& f = footprints[face];
      EXPECT_EQ(f.caster, 7u);
      ASSERT_TRUE(f.x0 <= place.x && place.x <= f.x1 && f.y0 <= place.y && place.y <= f.y1 && f.z0 <= q.z) << "triangle " << i;
    }
  }
  EXPECT_GT(shaded, 500'000);
  EXPECT_GT(several, 20'000);
  EXPECT_GT(left_out, 100'000);
}

// A larger one would be right as well, and would test points that the triangle cannot shade. Seen on one face, it goes
// beyond the triangle's corners by some 2^-20, which float32 makes a little more.
TEST(AliasFreeMapParts, a_footprint_ends_where_its_triangle_does) {
  Random random(4);
  for (int i = 0; i < 1'000; ++i) {
    Triangle t;
    for (glm::vec3& p : t.points) p = lattice_point(random);
    const Light light = i % 2 ? point_light({0, 9, 0}) : sun({0, -1, 0});
    Bounds bounds;
    for (const glm::vec3& p : t.points) bounds.add(p);
    const LightSpace space = space_of(light, bounds);
    FaceFootprint found[6];
    ASSERT_EQ(find_footprints(space, t.points, 16, 7, found), 1);
    glm::dvec3 low(INFINITY), high(-INFINITY);
    for (const glm::vec3& p : t.points) {
      const glm::dvec3 seen = space[found[0].face].seen(glm::dvec3(p));
      const double z = i % 2 ? seen.z : 1;
      low = glm::min(low, {seen.x / z, seen.y / z, seen.z});
      high = glm::max(high, {seen.x / z, seen.y / z, seen.z});
    }
    const Footprint& f = found[0].footprint;
    for (const auto& [beyond, end] :
         {std::pair(low.x, -f.x0), {-high.x, f.x1}, {low.y, -f.y0}, {-high.y, f.y1}, {low.z, -f.z0}}) {
      EXPECT_GT(beyond + end, 0);
      EXPECT_LT(beyond + end, 1e-4);
    }
  }
}

// The sides in double never contradict the exact crossing, and leave little to it: for points anywhere, and for points aimed at
// edges and at the triangle itself.
TEST(AliasFreeMapParts, the_sides_of_a_shadow_never_contradict_exact_signs) {
  Random random(3);
  int clear[2] = {0, 0}, unclear = 0;
  for (int i = 0; i < 300'000; ++i) {
    const Triangle t{{lattice_point(random), lattice_point(random), lattice_point(random)}};
    const Light light = random.below(2) ? sun(lattice_point(random)) : point_light(lattice_point(random));
    const glm::dvec4 l = homogeneous(light);
    const int facing = orient3d_sign(t.points[0], t.points[1], t.points[2], l);
    if (facing == 0) continue;
    glm::vec3 p = lattice_point(random);
    const bool aimed = i % 3 == 0;
    if (i % 3 != 2) {
      const double u = random.uniform(0, 1), v = aimed ? 0 : random.uniform(0, 1 - u);
      const glm::dvec3 a(t.points[0]), hit = a + u * (glm::dvec3(t.points[1]) - a) + v * (glm::dvec3(t.points[2]) - a);
      p = hit - (aimed ? random.uniform(0, 1) : 0) * to_light(l, hit);
    }
    const LightSpace space = space_of(light, {});
    const LightSpaceFace& face = space[space.face_of(p)];
    const glm::dvec3 q = face.seen(p);
    const Shadow shadow = make_shadow(face, l, t.points, facing, 2 * norm1(q));
    const auto at = [&](const alias_free_map::Side& s) { return s.at(q.x, q.y, q.z); };
    const bool outside = std::ranges::any_of(shadow.sides, [&](const alias_free_map::Side& s) { return at(s) < 0; });
    const bool inside = std::ranges::all_of(shadow.sides, [&](const alias_free_map::Side& s) { return at(s) > 2 * s.error; });
    const Crossing crossing = crosses({p, l}, t);
    if (inside) {
      ASSERT_EQ(crossing, Crossing::crosses) << i;
    } else if (outside) {
      ASSERT_EQ(crossing, Crossing::none) << i;
    }
    ++(inside || outside ? clear[inside] : unclear);
  }
  EXPECT_GT(clear[0], 100'000);
  EXPECT_GT(clear[1], 50'000);
  EXPECT_LT(unclear, 300);
}

}  // namespace gnomon::alias_free_map_parts_test
