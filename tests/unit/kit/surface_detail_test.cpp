#include <gnomon/error.h>
#include <gnomon/kit/pictures/layers.h>
#include <gnomon/kit/pictures/surface_detail.h>
#include <gtest/gtest.h>

#include <set>

#include "hand_made.h"
#include "small_world.h"
#include "surface_world.h"

namespace surface_detail_test {

using namespace gnomon;
using namespace surface_world;

/// All polygons that a shadow makes of the receiving triangles of a world.
SurfaceDetail detail_of(const World& world) {
  SurfaceDetail detail;
  const Shadow shadow(world.scene.meshes[0], world.light);
  for (std::uint32_t m = 0; m < world.scene.meshes.size(); ++m)
    for (std::uint32_t t = 0; t < world.scene.meshes[m].triangles.size() && world.scene.meshes[m].receives; ++t) {
      Polygon corners;
      for (int k = 0; k < 3; ++k) corners.push_back({world.scene.meshes[m].positions[world.scene.meshes[m].triangles[t][k]]});
      const auto add = [&](const Polygon& part, bool is_lit) {
        detail.polygons.push_back(
            {m, t, is_lit, static_cast<std::uint32_t>(detail.corners.size()), static_cast<std::uint32_t>(part.size())});
        for (const Corner& corner : part) detail.corners.push_back(corner.at);
      };
      m == 0 ? add(corners, true) : shadow.divide(corners, add);
    }
  return detail;
}

TEST(surface_detail, fragments_are_warm_where_lit_and_cool_where_shadowed) {
  int lit = 0, shadowed = 0, off = 0;
  for (unsigned seed = 100; seed < 120; ++seed) {
    const World world(seed, seed % 3 == 0);
    const std::vector<float> picture = paint_detail(world.scene, world.gbuffer, world.light, detail_of(world));
    const std::vector<float> plain =
        shaded_layer(world.scene, world.gbuffer, world.light, std::vector<float>(world.gbuffer.size(), 1.0f));
    for (std::size_t i = 0; i < world.gbuffer.size(); ++i) {
      const glm::vec3 c = color(picture, i);
      if (!faces_light(world.scene, world.gbuffer, world.light, i)) {
        ASSERT_EQ(c, color(plain, i)) << "seed " << seed << " pixel " << i;
        continue;
      }
      // Every one has a polygon, those by the border of a triangle too.
      ASSERT_TRUE(is_warm(c) || is_cool(c)) << "seed " << seed << " pixel " << i;
      off += is_warm(c) != (world.mask[i] == 1);
      if (!world.is_plain(i)) continue;
      ASSERT_EQ(is_warm(c), world.mask[i] == 1) << "seed " << seed << " pixel " << i;
      ++(is_warm(c) ? lit : shadowed);
    }
  }
  EXPECT_GT(lit, 10'000);
  EXPECT_GT(shadowed, 500);
  EXPECT_LT(off, 10);
}

/// The floor seen from above: 64 by 64 pixels over the square |x|, |z| <= 1, cut into equal columns and rows, lit where x < 0.
struct Floor {
  Scene scene;
  GBuffer gbuffer;
  SurfaceDetail detail;
  Light light = sun({0, -1, 0});

  explicit Floor(int steps) {
    scene.meshes.push_back(hand_made::mesh_of({{-9, 0, -9}, {-9, 0, 9}, {9, 0, 0}}, {{0, 1, 2}}));
    gbuffer = small_world::make_gbuffer(scene, {.eye = {0, 1, 0}, .target = {0, 0, 0}, .up = {0, 0, -1}, .fov_y_degrees = 90},
                                        64, 64);
    for (int row = 0; row < steps; ++row)
      for (int column = 0; column < steps; ++column) {
        const double step = 2.0 / steps, x = column * step - 1, z = row * step - 1;
        detail.polygons.push_back({0, 0, 2 * column < steps, static_cast<std::uint32_t>(detail.corners.size()), 4});
        for (const glm::dvec3& p :
             {glm::dvec3(x, 0, z), glm::dvec3(x, 0, z + step), glm::dvec3(x + step, 0, z + step), glm::dvec3(x + step, 0, z)})
          detail.corners.push_back(p);
      }
  }
  std::vector<float> picture() const { return paint_detail(scene, gbuffer, light, detail); }
};

TEST(surface_detail, large_fragments_have_borders_and_shades_of_their_own) {
  // Four by four fragments of 16 by 16 pixels each: their last column and row are darker by more than half.
  const std::vector<float> picture = Floor(4).picture();
  std::vector<float> shades;
  for (std::size_t y = 0; y < 64; ++y)
    for (std::size_t x = 0; x < 64; ++x) {
      const glm::vec3 c = color(picture, 64 * y + x), inner = color(picture, 64 * (y / 16 * 16 + 8) + x / 16 * 16 + 8);
      const bool is_border = (x % 16 == 15 && x < 63) || (y % 16 == 15 && y < 63);
      const float share = c.g / inner.g;
      if (is_border)
        ASSERT_LT(share, 0.5f) << x << ' ' << y;
      else
        ASSERT_NEAR(share, 1, 0.2) << x << ' ' << y;
      ASSERT_TRUE(x < 32 ? is_warm(c) : is_cool(c)) << x << ' ' << y;
      if (x % 16 == 8 && y % 16 == 8) shades.push_back(inner.g);
    }
  for (std::size_t k = 0; k < shades.size(); ++k) {
    if (k % 4 != 1 && k % 4 != 3) {
      EXPECT_GT(std::abs(shades[k] / shades[k + 1] - 1), 0.05) << k;
    }
    if (k + 4 < shades.size()) {
      EXPECT_GT(std::abs(shades[k] / shades[k + 4] - 1), 0.05) << k;
    }
  }
}

TEST(surface_detail, fragments_below_a_pixel_leave_the_tones) {
  // 3 by 3 fragments on a pixel: borders everywhere would leave a dark picture.
  const std::vector<float> large = Floor(2).picture(), small = Floor(192).picture();
  double sum_large = 0, sum_small = 0;
  for (std::size_t i = 0; i < 64 * 64; ++i) {
    const glm::vec3 c = color(small, i);
    ASSERT_TRUE(i % 64 < 32 ? is_warm(c) : is_cool(c)) << i;
    sum_large += color(large, i).g, sum_small += c.g;
  }
  EXPECT_NEAR(sum_small / sum_large, 1, 0.15);
}

TEST(surface_detail, polygons_show_on_their_own_mesh_alone) {
  // A shadowed triangle of another mesh, with the same number, under all of the floor.
  Floor floor(2);
  const std::vector<float> before = floor.picture();
  floor.scene.meshes.push_back(hand_made::mesh_of({{-9, -1, -9}, {-9, -1, 9}, {9, -1, 0}}, {{0, 1, 2}}));
  floor.detail.polygons.push_back({1, 0, false, static_cast<std::uint32_t>(floor.detail.corners.size()), 3});
  for (const glm::vec3& p : floor.scene.meshes[1].positions) floor.detail.corners.push_back(p);
  EXPECT_EQ(floor.picture(), before);
}

TEST(surface_detail, what_polygons_leave_out_has_the_color_of_the_nearest) {
  // Lit where x < -0.05, shadowed where 0.05 < x < 0.3: the two columns on either side of x = 0, 1/32 m wide, are left out, and
  // so is what is beyond. It makes no difference that the mesh stands for a curve where the picture is of the mesh.
  Floor floor(2);
  for (const DetailPolygon& polygon : floor.detail.polygons)
    for (glm::dvec3& p : std::span(floor.detail.corners).subspan(polygon.first, polygon.count))
      p.x = polygon.is_lit ? std::min(p.x, -0.05) : p.x == 0 ? 0.05 : 0.3;
  for (const bool is_curve : {false, true}) {
    if (is_curve) floor.scene.meshes[0].shape = Sphere{};
    const std::vector<float> picture = floor.picture();
    for (std::size_t i = 0; i < 64 * 64; ++i)
      ASSERT_TRUE(i % 64 < 32 ? is_warm(color(picture, i)) : is_cool(color(picture, i))) << i % 64 << ' ' << i / 64;
  }
}

TEST(surface_detail, on_a_curve_the_nearest_polygon_of_its_mesh_counts) {
  // A ball of 64 by 32 quads, the upper half of them lit, seen from the side; the G-buffer lies on the exact sphere.
  Scene scene;
  std::vector<glm::vec3> positions;
  std::vector<glm::uvec3> triangles;
  constexpr unsigned around = 64, down = 32;
  for (unsigned v = 0; v <= down; ++v)
    for (unsigned u = 0; u < around; ++u) {
      const double a = 6.283185307179586 * u / around, b = 3.141592653589793 * v / down;
      positions.push_back(glm::vec3(glm::dvec3(std::sin(b) * std::cos(a), std::cos(b), std::sin(b) * std::sin(a))));
    }
  for (unsigned v = 0; v < down; ++v)
    for (unsigned u = 0; u < around; ++u) {
      const unsigned p = v * around + u, q = v * around + (u + 1) % around;
      triangles.push_back({p, q, p + around});
      triangles.push_back({q, q + around, p + around});
    }
  scene.meshes.push_back(hand_made::mesh_of(positions, triangles));
  Mesh& mesh = scene.meshes[0];
  mesh.shape = Sphere{};
  SurfaceDetail detail;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto first = static_cast<std::uint32_t>(detail.corners.size());
    glm::vec3 sum(0);
    for (int k = 0; k < 3; ++k)
      sum += mesh.positions[mesh.triangles[t][k]], detail.corners.push_back(mesh.positions[mesh.triangles[t][k]]);
    detail.polygons.push_back({0, t, sum.y > 0, first, 3});
  }
  hand_made::Picture picture(40, 40, Truth::shape);
  picture.gbuffer.view = {.eye = {0, 0, 4}, .target = {0, 0, 0}, .fov_y_degrees = 30};
  for (std::size_t i = 0; i < picture.gbuffer.size(); ++i) {
    const double tangent = std::tan(glm::radians(15.0)), x = tangent * (2 * (static_cast<double>(i % 40) + 0.5) / 40 - 1),
                 y = tangent * (1 - 2 * (static_cast<double>(i / 40) + 0.5) / 40);
    // (4 - t)^2 + t^2 (x^2 + y^2) = 1
    const double a = 1 + x * x + y * y, root = 16 - 15 * a;
    if (root < 0) continue;
    const double t = (4 - std::sqrt(root)) / a;
    const glm::vec3 point(glm::dvec3(t * x, t * y, 4 - t));
    picture.set(i, point, point, 0, 0);
  }
  const Light light = point_light({0, 0, 9});
  const std::vector<float> painted = paint_detail(scene, picture.gbuffer, light, detail);
  int upper = 0, lower = 0, none = 0;
  for (std::size_t i = 0; i < picture.gbuffer.size(); ++i) {
    if (!faces_light(scene, picture.gbuffer, light, i)) continue;
    const glm::vec3 c = color(painted, i);
    const float height = picture.gbuffer.position(i).y;
    if (!is_warm(c) && !is_cool(c)) {
      // The polygons reach to cos(pi / 32) = 0.995 of the ball's outline and farther.
      EXPECT_GT(glm::length(glm::dvec2(picture.gbuffer.position(i))), 0.9) << i;
      ++none;
      continue;
    }
    EXPECT_EQ(is_warm(c), height > 0) << i;
    ++(height > 0 ? upper : lower);
  }
  EXPECT_GT(upper, 400);
  EXPECT_GT(lower, 400);
  EXPECT_LT(none, 40);
  // Behind each of them there is another one of the mesh: with the front half lit, z > 0, all that the eye sees is, from z =
  // 1/4 on.
  for (DetailPolygon& polygon : detail.polygons) {
    const glm::uvec3& t = mesh.triangles[polygon.triangle];
    polygon.is_lit = mesh.positions[t.x].z + mesh.positions[t.y].z + mesh.positions[t.z].z > 0;
  }
  const std::vector<float> front = paint_detail(scene, picture.gbuffer, light, detail);
  for (std::size_t i = 0; i < picture.gbuffer.size(); ++i)
    EXPECT_FALSE(faces_light(scene, picture.gbuffer, light, i) && is_cool(color(front, i))) << i;
}

TEST(surface_detail, what_does_not_fit_the_scene_is_refused) {
  const Floor floor(2);
  EXPECT_NO_THROW(check_detail(floor.scene, floor.detail));
  const auto refuses = [&](const auto& spoil, const std::string& says) {
    SurfaceDetail detail = floor.detail;
    spoil(detail);
    try {
      check_detail(floor.scene, detail);
      ADD_FAILURE() << says;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(says), std::string::npos) << error.what();
    }
  };
  refuses([](auto& d) { d.polygons[1].mesh = 1; }, "polygon 1 is of mesh 1; the scene has 1");
  refuses([](auto& d) { d.polygons[2].triangle = 4; }, "polygon 2 is of triangle 4; mesh 0 has 1");
  refuses([](auto& d) { d.polygons[0].count = 2; }, "polygon 0 has 2 corners");
  refuses([](auto& d) { d.polygons[3].first = 13; }, "polygon 3 has corners from 13 to 16; there are 16");
  refuses([](auto& d) { d.polygons[3].first = 0xffffffffu; }, "there are 16");
  refuses([](auto& d) { d.corners[5].y = NAN; }, "polygon 1 has a corner at");
  refuses([](auto& d) { d.corners[5].x = INFINITY; }, "polygon 1 has a corner at");
  refuses([](auto& d) { d.corners[5].z = -INFINITY; }, "polygon 1 has a corner at");
  Scene two = floor.scene;
  two.meshes.push_back(two.meshes[0]);
  SurfaceDetail detail = floor.detail;
  detail.polygons[0].mesh = 1;
  EXPECT_THROW(check_detail(two, detail), Error);
  detail = floor.detail;
  two.meshes[0].triangles.push_back({0, 2, 1});
  detail.polygons[2].triangle = detail.polygons[3].triangle = 1;
  EXPECT_NO_THROW(check_detail(two, detail));
  detail.polygons[3].triangle = 0;
  EXPECT_THROW(check_detail(two, detail), Error);
}

}  // namespace surface_detail_test
