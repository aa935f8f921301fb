// The scenes for light that surfaces hand on: closed_room, facing_plates, cornell_box.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "generated_scene.h"
#include "small_world.h"

namespace lit_room_scenes_test {

using namespace gnomon;
using generated::make;
using generated::mesh;
using generated::shape;

/// Of all triangles, m^2.
double area(const Mesh& mesh) {
  double total = 0;
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
    total += glm::length(glm::cross(b - a, c - a)) / 2;
  }
  return total;
}

// 4 x 4 m of floor and of ceiling and four times 4 x 3 m around them. By the divergence theorem a third of the sum of area
// times distance, from a point inside along the normal of each sheet, is the volume, 48 m^3, only where every sheet is in its
// place and turned to the inside.
TEST(Scenes, closed_room_is_closed_and_faces_its_inside) {
  const Scene scene = make("closed_room");
  double total = 0, volume = 0;
  for (const Mesh& mesh : scene.meshes) {
    const glm::dvec3 a(mesh.positions[mesh.triangles[0].x]), b(mesh.positions[mesh.triangles[0].y]);
    const glm::dvec3 c(mesh.positions[mesh.triangles[0].z]);
    const double height = glm::dot(glm::dvec3(1, 1, 1) - a, glm::normalize(glm::cross(b - a, c - a)));
    EXPECT_GT(height, 0) << mesh.name << " is turned away from the inside";
    total += area(mesh);
    volume += area(mesh) * height / 3;
  }
  EXPECT_NEAR(total, 2 * 16 + 4 * 12, 1e-9);
  EXPECT_NEAR(volume, 48, 1e-9);
  for (const View& view : scene.views) {
    const GBuffer g = small_world::make_gbuffer(scene, view, 64, 36);
    for (std::size_t i = 0; i < g.size(); ++i) ASSERT_FALSE(g.is_background(i)) << view.name << ", pixel " << i;
  }
}

TEST(Scenes, closed_room_has_one_reflectance) {
  for (const Mesh& mesh : make("closed_room").meshes) EXPECT_EQ(mesh.albedo, glm::vec3(0.5f)) << mesh.name;
  for (const Mesh& mesh : make("closed_room", "reflectance=0.25").meshes) EXPECT_EQ(mesh.albedo, glm::vec3(0.25f)) << mesh.name;
}

// The lamp is between the plates and shines down, for any size and distance; the eye is between their planes and outside of
// them, so that it sees the lower one in the first view and the upper one in the second.
TEST(Scenes, facing_plates_face_each_other_with_the_lamp_between) {
  for (const char* settings : {"", "size=0.5,distance=4", "size=4,distance=0.25"}) {
    SCOPED_TRACE(settings);
    const Scene scene = make("facing_plates", settings);
    const Plane &lower = shape<Plane>(scene, "lower"), &upper = shape<Plane>(scene, "upper");
    EXPECT_GT(glm::cross(lower.half_u, lower.half_v).y, 0);
    EXPECT_LT(glm::cross(upper.half_u, upper.half_v).y, 0);
    const RectLight& lamp = std::get<RectLight>(std::ranges::find(scene.lights, "panel", &Light::name)->kind);
    EXPECT_GT(lamp.center.y, lower.center.y);
    EXPECT_LT(lamp.center.y, upper.center.y);
    EXPECT_LT(glm::cross(lamp.half_u, lamp.half_v).y, 0);
    EXPECT_EQ(lamp.emits, Emits::in_front);
    EXPECT_NEAR(area(mesh(scene, "lower")), area(mesh(scene, "upper")), 1e-9);
    for (std::size_t v = 0; v < 2; ++v) {
      const GBuffer g = small_world::make_gbuffer(scene, scene.views.at(v), 64, 36);
      std::size_t seen = 0;
      for (std::size_t i = 0; i < g.size(); ++i)
        seen += !g.is_background(i) && std::abs(g.position(i).y - (v == 0 ? lower : upper).center.y) < 1e-4f;
      EXPECT_GT(seen, 20u) << scene.views[v].name;
    }
  }
}

// The reflectances that renderers share.
TEST(Scenes, cornell_box_has_its_published_colors) {
  const Scene scene = make("cornell_box");
  EXPECT_EQ(mesh(scene, "left_wall").albedo, glm::vec3(0.63f, 0.065f, 0.05f));
  EXPECT_EQ(mesh(scene, "right_wall").albedo, glm::vec3(0.14f, 0.45f, 0.091f));
  for (const char* name : {"floor", "ceiling", "back_wall", "short_block", "tall_block"})
    EXPECT_EQ(mesh(scene, name).albedo, glm::vec3(0.725f, 0.71f, 0.68f)) << name;
}

TEST(Scenes, colonnade_has_two_rows_of_columns) {
  // A shaft of s segments has 2 s vertices.
  EXPECT_EQ(mesh(make("colonnade"), "shafts").positions.size(), 2 * 8 * 2 * 32u);
  EXPECT_EQ(mesh(make("colonnade", "columns=3,segments=8"), "shafts").positions.size(), 2 * 3 * 2 * 8u);
}

}  // namespace lit_room_scenes_test
