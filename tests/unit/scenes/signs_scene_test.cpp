// The scene `signs`: what grows with distance, and what a move far from the origin does to it.
#include <gtest/gtest.h>

#include <cmath>

#include "generated_scene.h"

namespace signs_scene_test {

using namespace gnomon;
using generated::make;

glm::dvec3 eye_of(const Scene& scene) { return scene.views.front().eye; }

Bounds bounds_of(const Mesh& mesh) {
  Bounds bounds;
  bounds.add(mesh.positions);
  return bounds;
}

// The view looks along z. A front stands at the sign's depth, slats reach 0.06 of it nearer and the plate 0.02 of it farther.
// Divided by the depth all signs have the size of the first, and all of each is in a picture of 16 to 9: half the height of the
// picture is tan 25 degrees = 0.4663 of the depth, half the width 0.8290.
TEST(SignsScene, signs_are_of_one_size_in_the_picture_from_two_meters_to_far) {
  for (const double far : {10.0, 1000.0, 100000.0}) {
    const Scene scene = make("signs", fmt::format("far={}", far));
    ASSERT_EQ(scene.meshes.size(), 24u);
    double before = 0;
    for (std::size_t k = 0; k < scene.meshes.size(); ++k) {
      const Bounds bounds = bounds_of(scene.meshes[k]);
      const double depth = (bounds.max.z - eye_of(scene).z) / 1.02;
      EXPECT_NEAR(depth, 2 * std::pow(far / 2, static_cast<double>(k) / 23), 1e-6 * depth);
      EXPECT_GT(depth, before);
      before = depth;
      EXPECT_NEAR((bounds.max.x - bounds.min.x) / depth, 0.23, 1e-5);
      EXPECT_NEAR((bounds.max.y - bounds.min.y) / depth, 0.19, 1e-5);
      EXPECT_NEAR((bounds.max.z - bounds.min.z) / depth, 0.08, 1e-5);
      // Slats are nearer, by 0.06 of the depth, and so larger in the picture.
      for (const glm::vec3& p : scene.meshes[k].positions) {
        const glm::dvec3 seen = (glm::dvec3(p) - eye_of(scene)) / (p.z - eye_of(scene).z);
        EXPECT_LT(std::abs(seen.x), 0.829) << k;
        EXPECT_LT(std::abs(seen.y), 0.4663) << k;
      }
    }
  }
}

// Of coordinates up to 2^17 m float32 has steps of 2^-7 m, up to 2^14 m of 2^-10 m: a vertex is off by half a step at most, and
// the thinnest part, 0.024 m of the nearest slats, is three steps wide at 10^5 m.
TEST(SignsScene, moved_vertices_are_rounded_once_and_none_coincide) {
  for (const auto& [offset, step] : {std::pair(10000, 0x1p-10), {100000, 0x1p-7}}) {
    const Scene here = make("signs", "far=10"), there = make("signs", fmt::format("far=10,offset={}", offset));
    for (std::size_t m = 0; m < here.meshes.size(); ++m)
      for (std::size_t i = 0; i < here.meshes[m].positions.size(); ++i) {
        const glm::dvec3 off =
            glm::dvec3(there.meshes[m].positions[i]) - glm::dvec3(offset, 0, offset) - glm::dvec3(here.meshes[m].positions[i]);
        EXPECT_LE(extent(off), step / 2 + 1e-6);
      }
    ASSERT_EQ(there.notes.size(), 1u);
    EXPECT_TRUE(there.notes[0].starts_with("0 of ")) << there.notes[0];
    EXPECT_TRUE(here.notes.empty());
  }
}

}  // namespace signs_scene_test
