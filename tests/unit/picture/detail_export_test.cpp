#include "measure/picture/detail_export.h"

#include <gnomon/error.h>
#include <gtest/gtest.h>

#include "hand_made.h"

namespace detail_export_test {

using namespace gnomon;

struct Sample {
  Scene scene;
  SurfaceDetail detail;

  void add(std::uint32_t mesh, std::uint32_t triangle, bool is_lit, const std::vector<glm::dvec3>& corners) {
    detail.polygons.push_back({mesh, triangle, is_lit, static_cast<std::uint32_t>(detail.corners.size()),
                               static_cast<std::uint32_t>(corners.size())});
    detail.corners.insert(detail.corners.end(), corners.begin(), corners.end());
  }
};

Sample square_and_triangle() {
  Sample sample;
  sample.scene.meshes = {hand_made::square(1, 0), hand_made::square(1, 1), hand_made::square(1, 2)};
  sample.scene.meshes[0].name = "oak floor";
  sample.add(0, 0, false, {{-1, 0, -1}, {-1, 0, 1}, {0, 0, 1}});
  sample.add(0, 0, true, {{-1, 0, -1}, {0, 0, 1}, {1, 0, 1}});
  sample.add(2, 1, true, {{-1, 2, -1}, {1, 2, 1}, {1, 2, 1.0 / 3}, {0.25, 2, -1}});
  return sample;
}

TEST(detail_export, an_object_for_each_mesh_with_shared_vertices) {
  const Sample sample = square_and_triangle();
  const std::vector<std::string> notes{"scene: two\nlines"};
  EXPECT_EQ(
      detail_obj(sample.scene, sample.detail, notes, "x.mtl"),
      "# Surface detail: the parts of triangles that are lit, in a penumbra and in cast shadow. Units: meters, +y is up.\n"
      "# scene: two lines\n"
      "# polygons: 2 lit, 1 shadowed\n"
      "mtllib x.mtl\n"
      "o oak_floor\n"
      "v -1 0 -1\nv -1 0 1\nv 0 0 1\nv 1 0 1\n"
      "usemtl lit\nf 1 3 4\n"
      "usemtl shadowed\nf 1 2 3\n"
      "o mesh_2\n"
      "v -1 2 -1\nv 1 2 1\nv 1 2 0.3333333333\nv 0.25 2 -1\n"
      "usemtl lit\nf 5 6 7 8\n");
}

TEST(detail_export, what_rounding_tells_apart_is_one_vertex_and_what_is_smaller_is_left_out) {
  Sample sample;
  sample.scene.meshes = {hand_made::square(1, 0)};
  // 0.1 + 0.2 is not 0.3 in double, and 1e-17 is not 0: on paper both are.
  sample.add(0, 0, true, {{0, 0, 0}, {0.3, 0, 1}, {1, 0, 1}});
  sample.add(0, 0, false, {{1e-17, -1e-17, 0}, {0.1 + 0.2, 0, 1}, {-1, 0, 1}, {1e-17, 0, 1e-16}});
  sample.add(0, 0, false, {{0.5, 0, 0.5}, {0.5 + 1e-13, 0, 0.5}, {0.5, 0, 0.5 + 1e-13}});
  const std::string text = detail_obj(sample.scene, sample.detail, {}, "x.mtl");
  EXPECT_NE(text.find("usemtl lit\nf 1 2 3\nusemtl shadowed\nf 1 2 4\n"), std::string::npos) << text;
  EXPECT_NE(text.find("# polygons: 1 lit, 1 shadowed\n# left out: 1 "), std::string::npos) << text;
}

TEST(detail_export, every_object_has_a_name_of_its_own) {
  Sample sample;
  sample.scene.meshes = {hand_made::square(1, 0), hand_made::square(1, 0), hand_made::square(1, 0), hand_made::square(1, 0)};
  sample.scene.meshes[0].name = sample.scene.meshes[1].name = "wall";
  sample.scene.meshes[2].name = "a\tb #c";
  for (std::uint32_t m = 0; m < 4; ++m) sample.add(m, 0, true, {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}});
  const std::string text = detail_obj(sample.scene, sample.detail, {}, "x.mtl");
  for (const char* name : {"\no wall\n", "\no wall_1\n", "\no a_b__c\n", "\no mesh_3\n"})
    EXPECT_NE(text.find(name), std::string::npos) << name << " is missing in\n" << text;
}

TEST(detail_export, materials_are_those_that_are_used) {
  const std::string text = detail_mtl();
  EXPECT_NE(text.find("newmtl lit\nKd "), std::string::npos);
  EXPECT_NE(text.find("newmtl shadowed\nKd "), std::string::npos);
}

TEST(detail_export, bytes_give_the_same_detail_and_others_are_refused) {
  const SurfaceDetail detail = square_and_triangle().detail;
  const std::vector<std::byte> bytes = detail_bytes(detail);
  const SurfaceDetail back = detail_from_bytes(bytes);
  EXPECT_EQ(back.corners, detail.corners);
  ASSERT_EQ(back.polygons.size(), detail.polygons.size());
  for (std::size_t k = 0; k < back.polygons.size(); ++k) {
    const DetailPolygon &a = back.polygons[k], &b = detail.polygons[k];
    EXPECT_EQ(std::tie(a.mesh, a.triangle, a.is_lit, a.first, a.count),
              std::tie(b.mesh, b.triangle, b.is_lit, b.first, b.count));
  }
  EXPECT_TRUE(detail_from_bytes(detail_bytes({})).polygons.empty());
  for (std::size_t length = 0; length < bytes.size(); ++length)
    EXPECT_THROW(detail_from_bytes(std::span(bytes).first(length)), Error) << length;
  // Magic number and counts, of which the second one lies behind the corners.
  for (std::size_t k = 0; k < 24; ++k) {
    const std::size_t place = k < 16 ? k : k + detail.corners.size() * sizeof(glm::dvec3);
    std::vector<std::byte> other = bytes;
    other[place] ^= std::byte{0x40};
    EXPECT_THROW(detail_from_bytes(other), Error) << place;
  }
}

}  // namespace detail_export_test
