// The alias-free map: footprints and shadows of single triangles against exact signs, a triangle on paper, points on the lines
// of the grid, and the technique against the exact oracle on scenes that are hard on it.
#include <gnomon/kit/exact_scene.h>
#include <gnomon/kit/random.h>
#include <gnomon/kit/shapes.h>
#include <gnomon/registry.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>

#include "hand_made.h"
#include "hard_scenes.h"
#include "small_world.h"
#include "techniques/alias_free_map/walk.h"

extern "C" void gnomon_technique_alias_free_map(gnomon::Registry& registry);

namespace gnomon {
namespace {

using namespace hand_made;
using namespace alias_free_map;
using hard_scenes::boxes;
using hard_scenes::grid_soup;
using hard_scenes::on_grid;
using small_world::value;

small_world::Run run(const Scene& scene, const Light& light, const GBuffer& gbuffer, const std::string& settings = "") {
  return small_world::run(gnomon_technique_alias_free_map, settings, scene, light, gbuffer);
}

/// A point light, a spot or a sun, on a grid: in supporting planes of triangles, along axes, inside bodies, between casters.
Light hard_light(Random& random) {
  for (;;) {
    const glm::vec3 at = on_grid(random, 4, 16);
    if (at == glm::vec3(0)) continue;
    switch (random.below(3)) {
      case 0:
        return {.name = "spot", .kind = SpotLight{at, -at, 20, 10.0f + static_cast<float>(random.below(70))}};
      case 1:
        return sun(at);
      default:
        return point_light(random.below(2) ? at : 0.25f * at);
    }
  }
}

// A triangle with a right angle in the plane y = 2, under a light at (0, 4, 0), has on the floor a shadow of twice its size:
// x, z >= 0 and x + z <= 2. Its edges belong to it.
TEST(AliasFreeMap, one_triangle_on_paper) {
  Scene scene;
  scene.meshes = {square(10, 0), mesh_of({{0, 2, 0}, {0, 2, 1}, {1, 2, 0}}, {{0, 1, 2}})};
  struct Case {
    glm::vec3 point;
    bool dark;
  };
  const Case cases[] = {
      {{0.5f, 0, 0.5f}, true},
      {{0.25f, 1, 0.25f}, true},
      {{0.25f, 3, 0.25f}, false},
      {{1, 0, 1}, true},
      {{0, 0, 1}, true},
      {{2, 0, 0}, true},
      {{0, 0, 0}, true},
      {{1, 0, 1.0001f}, false},
      {{-0.0001f, 0, 1}, false},
      {{1, 0x1p-20f, 1}, false},
      {{1, -0x1p-20f, 1}, true},
      {{-0.5f, 0, -0.5f}, false},
      {{1.5f, 0, 1.5f}, false},
      {{0.5f, 2, 0.25f}, false},
      {{-0.25f, 5, -0.25f}, false},
      {{0.5f, 1.9999f, 0.5f}, true},
  };
  Picture picture(std::size(cases), 1);
  for (std::size_t i = 0; i < std::size(cases); ++i) {
    const bool above = cases[i].point.y > 4;
    picture.set(i, cases[i].point, {0, above ? -1 : 1, 0}, 0, cases[i].point.x < cases[i].point.z ? 0 : 1);
  }
  const Light light = point_light({0, 4, 0});
  for (const char* settings : {"", "resolution=16", "resolution=4096"}) {
    const auto done = run(scene, light, picture.gbuffer, settings);
    for (std::size_t i = 0; i < std::size(cases); ++i) {
      SCOPED_TRACE(i);
      EXPECT_EQ(done.mask[i] == 0, cases[i].dark);
      const auto why = done.technique->explain(i);
      ASSERT_TRUE(why);
      EXPECT_TRUE(why->covered);
      ASSERT_EQ(why->element.has_value(), cases[i].dark);
      if (cases[i].dark) {
        EXPECT_EQ(*why->element, 2u);
      }
    }
    EXPECT_EQ(value(done.technique->counts(), "samples"), std::size(cases));
    EXPECT_GE(value(done.technique->counts(), "exact_tests"), 4);  // the points under edges and corners
  }
}

// Samples on a lattice that the grid's lines go through, for 16 x 16 and 32 x 32 cells of the box 0 .. 4, under squares whose
// edges lie on the same lines, straight below a sun. A point is dark when it lies in a closed square.
TEST(AliasFreeMap, points_on_the_lines_of_the_grid_and_under_edges) {
  Scene scene;
  scene.meshes = {square(10, 0)};
  Random random(1);
  struct Box {
    float x0, x1, z0, z1;
  };
  std::vector<Box> boxes;
  for (int i = 0; i < 12; ++i) {
    const auto line = [&](std::uint32_t count) { return static_cast<float>(random.below(count)) / 8; };
    const float x = line(24), z = line(24), w = 0.125f + line(8), d = 0.125f + line(8);
    boxes.push_back({x, x + w, z, z + d});
    const float y = 1 + static_cast<float>(i);
    scene.meshes.push_back(mesh_of({{x, y, z}, {x, y, z + d}, {x + w, y, z + d}, {x + w, y, z}}, {{0, 1, 2}, {0, 2, 3}}));
  }
  Picture picture(33, 33);
  for (std::size_t i = 0; i < picture.gbuffer.size(); ++i) {
    const float x = static_cast<float>(i % 33) / 8, z = static_cast<float>(i / 33) / 8;
    picture.set(i, {x, 0, z}, {0, 1, 0}, 0, x < z ? 0 : 1);
  }
  for (const char* settings : {"resolution=16", "resolution=32", "resolution=33", "resolution=512"}) {
    const auto done = run(scene, sun({0, -1, 0}), picture.gbuffer, settings);
    int dark = 0;
    for (std::size_t i = 0; i < picture.gbuffer.size(); ++i) {
      const glm::vec3 p = picture.gbuffer.position(i);
      const bool covered =
          std::ranges::any_of(boxes, [&](const Box& b) { return p.x >= b.x0 && p.x <= b.x1 && p.z >= b.z0 && p.z <= b.z1; });
      EXPECT_EQ(done.mask[i] == 0, covered) << p.x << ", " << p.z;
      dark += covered;
    }
    EXPECT_GT(dark, 200);
    EXPECT_LT(dark, 900);
    EXPECT_GT(value(done.technique->counts(), "exact_tests"), 100);
  }
}

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

// A larger one would be right as well, and would ask about points that the triangle cannot shade. Seen on one face, it goes
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
    const auto at = [&](const Side& s) { return s.at(q.x, q.y, q.z); };
    const bool outside = std::ranges::any_of(shadow.sides, [&](const Side& s) { return at(s) < 0; });
    const bool inside = std::ranges::all_of(shadow.sides, [&](const Side& s) { return at(s) > 2 * s.error; });
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

struct Differences {
  int wrong = 0, dark = 0, lit = 0, degenerate = 0;
  double exact = 0;
};

/// Counts pixels that the oracle decides otherwise. Degenerate answers are alike too: edges and vertices block in both.
void compare(const Scene& scene, const Light& light, const GBuffer& gbuffer, const std::string& settings, Differences& d) {
  const auto done = run(scene, light, gbuffer, settings);
  const ExactScene exact(scene);
  for (std::size_t i = 0; i < gbuffer.size(); ++i) {
    if (!faces_light(scene, gbuffer, light, i)) {
      ASSERT_EQ(done.mask[i], 1);
      continue;
    }
    ExactTally tally;
    const ExactAnswer answer = exact.occluded(receiver_at(scene, gbuffer, i), homogeneous(light), tally);
    d.degenerate += answer.degenerate;
    ++(answer.blocked ? d.dark : d.lit);
    if ((done.mask[i] == 0) != answer.blocked && d.wrong++ == 0) {
      const glm::vec3 p = gbuffer.position(i);
      ADD_FAILURE() << "pixel " << i << " of mesh " << gbuffer.mesh[i] << ", triangle " << gbuffer.triangle[i] << " at " << p.x
                    << ", " << p.y << ", " << p.z << " should be " << (answer.blocked ? "dark" : "lit");
    }
    if (!answer.blocked) continue;
    // What is named does shade the point.
    std::uint64_t named = done.technique->explain(i)->element.value();
    std::size_t m = 0;
    while (named >= scene.meshes[m].triangles.size()) named -= scene.meshes[m++].triangles.size();
    const glm::uvec3& corner = scene.meshes[m].triangles[named];
    const auto& positions = scene.meshes[m].positions;
    const Triangle triangle{{positions[corner.x], positions[corner.y], positions[corner.z]}};
    ASSERT_NE(crosses({gbuffer.position(i), homogeneous(light)}, triangle), Crossing::none);
  }
  d.exact += value(done.technique->counts(), "exact_tests");
}

/// Points of all triangles, rounded, turned to the light. Shares in sixteenths put many of them exactly on edges and on planes
/// of other triangles. Every eighth is aimed: behind an end or the middle of some edge, which is exact where the scene is on a
/// grid.
void scatter(const Scene& scene, const Light& light, Random& random, Picture& picture) {
  for (std::size_t i = 0; i < picture.gbuffer.size(); ++i) {
    const std::uint32_t m = random.below(static_cast<std::uint32_t>(scene.meshes.size()));
    const Mesh& mesh = scene.meshes[m];
    if (mesh.triangles.empty()) continue;
    std::uint32_t t = random.below(static_cast<std::uint32_t>(mesh.triangles.size()));
    const glm::uvec3& corners = mesh.triangles[t];
    const glm::dvec3 a(mesh.positions[corners.x]), b(mesh.positions[corners.y]), c(mesh.positions[corners.z]);
    const bool coarse = random.below(2);
    const double u = coarse ? random.below(17) / 16.0 : random.uniform(0, 1),
                 v = (coarse ? random.below(17) / 16.0 : random.uniform(0, 1)) * (1 - u);
    glm::vec3 p(a + u * (b - a) + v * (c - a));
    if (i % 8 == 0) {
      const glm::dvec3 edge = random.below(2) ? a : (a + b) / 2.0;
      p = edge - (1 + random.below(4)) / 2.0 * to_light(homogeneous(light), edge);
      t = random.below(static_cast<std::uint32_t>(mesh.triangles.size()));
    }
    glm::dvec3 n = glm::normalize(glm::cross(b - a, c - a));
    if (glm::dot(n, to_light(homogeneous(light), p)) < 0) n = -n;
    picture.set(i, p, n, m, t);
  }
}

std::string resolution(Random& random) { return fmt::format("resolution={}", 16 << random.below(7)); }

TEST(AliasFreeMap, decides_as_the_oracle_does_on_soups) {
  Random random(5);
  Differences d;
  for (int round = 0; round < 300; ++round) {
    Scene scene;
    scene.meshes = {grid_soup(random, 1 + round % 40), grid_soup(random, 5)};
    scene.meshes[1].casts = random.below(2);
    const Light light = hard_light(random);
    Picture picture(40, 20);
    scatter(scene, light, random, picture);
    SCOPED_TRACE(round);
    compare(scene, light, picture.gbuffer, resolution(random), d);
  }
  EXPECT_EQ(d.wrong, 0);
  EXPECT_GT(d.dark, 20'000);
  EXPECT_GT(d.lit, 20'000);
  EXPECT_GT(d.degenerate, 500);
  EXPECT_GT(d.exact, 5000);
  RecordProperty("pixels", fmt::format("{} dark, {} lit, {} degenerate, {} exact", d.dark, d.lit, d.degenerate, d.exact));
}

TEST(AliasFreeMap, decides_as_the_oracle_does_on_boxes) {
  Random random(6);
  Differences d;
  for (int round = 0; round < 200; ++round) {
    Scene scene;
    scene.meshes = {boxes(random, 1 + round % 12, round % 2), boxes(random, 2, true), square(6, -2)};
    const Light light = hard_light(random);
    Picture picture(40, 20);
    scatter(scene, light, random, picture);
    SCOPED_TRACE(round);
    compare(scene, light, picture.gbuffer, resolution(random), d);
  }
  EXPECT_EQ(d.wrong, 0);
  EXPECT_GT(d.dark, 20'000);
  EXPECT_GT(d.lit, 10'000);
  EXPECT_GT(d.degenerate, 500);
  EXPECT_GT(d.exact, 5000);
  RecordProperty("pixels", fmt::format("{} dark, {} lit, {} degenerate, {} exact", d.dark, d.lit, d.degenerate, d.exact));
}

// Three bars, each over the next one: no order of them is right for all points.
TEST(AliasFreeMap, decides_as_the_oracle_does_on_cyclic_overlap) {
  std::vector<glm::vec3> positions;
  std::vector<glm::uvec3> triangles;
  for (int k = 0; k < 3; ++k) {
    const double turn = 2 * 3.14159265358979 / 3 * k;
    const auto at = [&](double x, double y, double z) {
      return glm::vec3(std::cos(turn) * x - std::sin(turn) * z, y, std::sin(turn) * x + std::cos(turn) * z);
    };
    const auto base = static_cast<std::uint32_t>(positions.size());
    positions.insert(positions.end(), {at(-2, 1, 0.5), at(-2, 1, 0.9), at(2, 2, 0.9), at(2, 2, 0.5)});
    triangles.insert(triangles.end(), {{base, base + 1, base + 2}, {base, base + 2, base + 3}});
  }
  Scene scene;
  scene.meshes = {mesh_of(positions, triangles), square(4, 0)};
  Random random(9);
  Differences d;
  for (const Light& light :
       {point_light({0.2f, 5, 0.1f}), sun({0.1f, -1, 0.05f}), point_light({0.1f, 1.5f, 0}), sun({1, -0.2f, 0})}) {
    Picture picture(80, 60);
    scatter(scene, light, random, picture);
    compare(scene, light, picture.gbuffer, "", d);
  }
  EXPECT_EQ(d.wrong, 0);
  EXPECT_GT(d.dark, 1000);
  EXPECT_GT(d.lit, 1000);
}

/// Pictures as the eye sees them, with a light among the casters in every second one.
template <class Visit>
void for_pictures(int rounds, Visit&& visit) {
  std::mt19937 engine(7);
  Random random(7);
  for (int round = 0; round < rounds; ++round) {
    Scene scene;
    scene.meshes = {small_world::ground(3, 0), small_world::random_soup(engine, 60, 2, 0.1f, 2, 0.4f), boxes(random, 5, false)};
    const View view{.eye = glm::vec3(random.uniform(glm::dvec3(-4, 0.5, -4), glm::dvec3(4, 4, 4))), .target = {0, 0.5f, 0}};
    const GBuffer gbuffer = small_world::make_gbuffer(scene, view, 150, 83);
    const glm::vec3 up(random.uniform(glm::dvec3(-3, 2, -3), glm::dvec3(3, 5, 3)));
    for (const Light& light : {point_light(round % 2 ? 0.3f * up : up), sun(-up)}) {
      SCOPED_TRACE(round);
      visit(scene, light, gbuffer);
    }
  }
}

// The light is 2^-56 m off the plane of the triangle around it, which so shades half of space. In double the light's faces see
// the triangle as a line through themselves, and a clip to a face leaves nothing of it, or little.
TEST(AliasFreeMap, a_triangle_that_all_but_holds_the_light_shades_half_of_space) {
  Scene scene;
  scene.meshes = {mesh_of({{0.25f, -0.5f, 0}, {0.25f, 0.5f, -1}, {1.25f, 0.5f, 0x1p-54f}}, {{0, 1, 2}}),
                  tessellate(Sphere{{0.25f, 0.5f, 0}, 3}, 12, "room"), square(6, -2)};
  scene.meshes[1].shape.reset();
  scene.meshes[1].casts = false;
  const Light light = point_light({0.5f, 0, -0.25f});
  Random random(12);
  Picture picture(100, 20);
  scatter(scene, light, random, picture);
  Differences d;
  compare(scene, light, picture.gbuffer, "", d);
  EXPECT_EQ(d.wrong, 0);
  EXPECT_GT(d.dark, 500);
  EXPECT_GT(d.lit, 500);
}

TEST(AliasFreeMap, decides_as_the_oracle_does_in_pictures) {
  Differences d;
  for_pictures(12,
               [&](const Scene& scene, const Light& light, const GBuffer& gbuffer) { compare(scene, light, gbuffer, "", d); });
  EXPECT_EQ(d.wrong, 0);
  EXPECT_GT(d.dark, 10'000);
  EXPECT_GT(d.lit, 10'000);
  RecordProperty("pixels", fmt::format("{} dark, {} lit, {} degenerate, {} exact", d.dark, d.lit, d.degenerate, d.exact));
}

// More cells leave fewer samples to test, and never another answer.
TEST(AliasFreeMap, all_resolutions_agree) {
  for_pictures(3, [](const Scene& scene, const Light& light, const GBuffer& gbuffer) {
    const auto expected = run(scene, light, gbuffer);
    double before = INFINITY;
    for (const int resolution : {16, 17, 100, 333, 1024, 4096}) {
      const auto done = run(scene, light, gbuffer, fmt::format("resolution={}", resolution));
      EXPECT_EQ(done.mask, expected.mask) << resolution;
      const double tests = value(done.technique->counts(), "sample_tests");
      if (resolution == 16 || resolution == 100 || resolution == 1024) {
        EXPECT_LT(tests, before);
        before = tests;
      }
    }
  });
}

TEST(AliasFreeMap, one_thread_and_many_agree) {
  for_pictures(3, [](const Scene& scene, const Light& light, const GBuffer& gbuffer) {
    const auto answer = [&](std::size_t threads) {
      const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
      return run(scene, light, gbuffer);
    };
    const auto one = answer(1), many = answer(8);
    EXPECT_EQ(one.mask, many.mask);
    const Counts counts = one.technique->counts(), others = many.technique->counts();
    for (std::size_t k = 0; k < counts.size(); ++k)
      if (counts[k].name != "bytes") {
        EXPECT_EQ(counts[k].value, others[k].value) << counts[k].name;
      }
    for (std::size_t i = 0; i < gbuffer.size(); ++i) {
      const auto why = one.technique->explain(i), other = many.technique->explain(i);
      ASSERT_EQ(why.has_value(), other.has_value());
      if (!why) continue;
      ASSERT_EQ(why->element, other->element) << i;
    }
    for (const auto& layer : one.technique->debug_layers())
      EXPECT_EQ(one.technique->draw_debug(layer.name), many.technique->draw_debug(layer.name));
  });
}

// Points on a true sphere, drawn smaller than its triangles so that these are before every one of them: they are shaded by
// other meshes only.
TEST(AliasFreeMap, an_exact_shape_is_not_shaded_by_its_own_triangles) {
  Scene scene;
  scene.meshes = {tessellate(Sphere{{0, 0, 0}, 1}, 12, "sphere"), square(4, -1.5f), square(0.4f, 3)};
  scene.meshes[0].shape = Sphere{{0, 0, 0}, 0.75f};
  Picture picture(100, 102, Truth::shape);
  Random random(4);
  const Light light = point_light({0.3f, 6, -0.2f});
  for (std::size_t i = 0; i < picture.gbuffer.size(); ++i) {
    const glm::vec3 n(glm::normalize(random.uniform(glm::dvec3(-1), glm::dvec3(1))));
    const float x = static_cast<float>(random.uniform(-3, 3)), z = static_cast<float>(random.uniform(-3, 3));
    if (i < 10'000)
      picture.set(i, 0.75f * n, n, 0, 0);
    else
      picture.set(i, {x, -1.5f, z}, {0, 1, 0}, 1, z > x ? 0 : 1);
  }
  Differences d;
  compare(scene, light, picture.gbuffer, "", d);
  EXPECT_EQ(d.wrong, 0);
  EXPECT_GT(d.dark, 100);
  EXPECT_GT(d.lit, 1000);
  scene.meshes[2].casts = false;
  const auto done = run(scene, light, picture.gbuffer);
  EXPECT_EQ(std::count(done.mask.begin(), done.mask.begin() + 10'000, 1.0f), 10'000);
  EXPECT_GT(std::count(done.mask.begin() + 10'000, done.mask.end(), 0.0f), 10);
}

TEST(AliasFreeMap, area_lights_are_refused_with_a_reason) {
  Registry roll;
  gnomon_technique_alias_free_map(roll);
  const auto technique = roll.technique("alias_free_map").make();
  const Support support = technique->supports({}, {.name = "area", .kind = SphereLight{}}, {});
  EXPECT_FALSE(support);
  EXPECT_FALSE(support.why().empty());
  EXPECT_TRUE(technique->supports({}, {.name = "spot", .kind = SpotLight{}}, {}));
}

// Five points of a floor under a sun, four of them in one of 16 x 16 cells. The sun sees two squares: one over the four, one
// over none, which nothing is tested against. The floor's own two triangles walk too. So the four have the longest list and the
// most tests, and both layers show them brighter than the fifth.
TEST(AliasFreeMap, layers_show_the_lists_and_the_tests) {
  Scene scene;
  scene.meshes = {square(10, 0), mesh_of({{-1, 1, -1}, {-1, 1, 1}, {1, 1, 1}, {1, 1, -1}}, {{0, 1, 2}, {0, 2, 3}}),
                  mesh_of({{5, 1, 5}, {5, 1, 6}, {6, 1, 6}, {6, 1, 5}}, {{0, 1, 2}, {0, 2, 3}})};
  Picture picture(6, 1);
  for (int i = 0; i < 4; ++i) picture.set(i, {0.01f * static_cast<float>(i), 0, 0.005f}, {0, 1, 0}, 0, 1);
  picture.set(4, {4, 0, -4}, {0, 1, 0}, 0, 1);
  const auto done = run(scene, sun({0, -1, 0}), picture.gbuffer, "resolution=16");
  EXPECT_EQ(done.mask, (std::vector<float>{0, 0, 0, 0, 1, 1}));
  const Counts counts = done.technique->counts();
  EXPECT_EQ(value(counts, "samples"), 5);
  EXPECT_EQ(value(counts, "cells_used"), 2);
  EXPECT_EQ(value(counts, "longest_list"), 4);
  EXPECT_LE(value(counts, "sample_tests"), 5 * 2 + 4 * 2);
  EXPECT_GE(value(counts, "sample_tests"), 5 * 1 + 4 * 1);
  for (const char* layer : {"list", "tests"}) {
    SCOPED_TRACE(layer);
    const std::vector<float> picture_of = done.technique->draw_debug(layer);
    const auto pixel = [&](int i) { return std::vector<float>(picture_of.begin() + 3 * i, picture_of.begin() + 3 * i + 3); };
    EXPECT_NE(pixel(0), pixel(4));
    EXPECT_NE(pixel(4), pixel(5));
  }
  EXPECT_EQ(done.technique->draw_debug("list")[0], done.technique->draw_debug("list")[3]);
  EXPECT_THROW(done.technique->draw_debug("map"), std::exception);
}

}  // namespace
}  // namespace gnomon
