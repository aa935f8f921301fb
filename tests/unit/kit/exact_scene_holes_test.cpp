// The oracle on casters with holes: vectors on paper, and every triangle in rational numbers.
#include <gnomon/kit/geometry/exact_scene.h>
#include <gtest/gtest.h>

#include "masked.h"
#include "rational_holes.h"
#include "small_world.h"

namespace gnomon::exact_scene_holes_test {

using masked::mask_of;

glm::dvec4 at(const glm::vec3& p) { return {glm::dvec3(p), 1}; }

ExactAnswer answer(const Scene& scene, const glm::vec3& point, const glm::dvec4& light) {
  ExactTally tally;
  return ExactScene(scene).occluded({point}, light, tally);
}

Scene scene_of(std::vector<Mesh> meshes) {
  Scene scene;
  scene.meshes = std::move(meshes);
  return scene;
}

constexpr ExactAnswer lit{}, dark{.blocked = true}, by_an_edge{.blocked = true, .degenerate = true};

// The way meets texel (3, 2) of 8 x 8, a hole, and (1, 1) of 4 x 4, which is set.
TEST(exact_scene_holes, the_vector_on_paper_is_lit_through_the_hole_and_dark_behind_the_texel) {
  const glm::vec3 point(1, 0, 1), light(3, 6, 2);
  for (const glm::dvec4& l : {at(light), glm::dvec4(glm::dvec3(light - point), 0)}) {
    EXPECT_EQ(answer(scene_of({masked::triangle_on_paper(masked::checker(8, 8))}), point, l), lit);
    EXPECT_EQ(answer(scene_of({masked::triangle_on_paper(masked::checker(4, 4))}), point, l), dark);
  }
}

// Exactly on the edge of columns 3 and 4: column 4 counts, also where the bits differ.
TEST(exact_scene_holes, a_way_through_the_edge_of_two_texels_has_an_answer) {
  const glm::vec3 point(1.5f, 0, 1), light(3, 6, 2);
  EXPECT_EQ(answer(scene_of({masked::triangle_on_paper(mask_of({"....####"}))}), point, at(light)), dark);
  EXPECT_EQ(answer(scene_of({masked::triangle_on_paper(mask_of({"####...."}))}), point, at(light)), lit);
  EXPECT_EQ(answer(scene_of({masked::triangle_on_paper(mask_of({"...##..."}))}), point, at(light)), dark);
}

TEST(exact_scene_holes, a_mask_without_a_hole_is_solid_and_one_of_holes_is_nothing) {
  const glm::vec3 point(1, 0, 1), light(3, 6, 2);
  EXPECT_EQ(
      answer(scene_of({masked::triangle_on_paper(std::make_shared<const AlphaMask>(4, 4, std::vector<std::uint8_t>(16, 77)))}),
             point, at(light)),
      lit);
  EXPECT_EQ(answer(scene_of({masked::triangle_on_paper(mask_of({"#"}))}), point, at(light)), dark);
}

// Both cards have holes; the second one is solid where the way meets it.
TEST(exact_scene_holes, what_lies_behind_a_hole_shades_all_the_same) {
  const auto holes = mask_of({"."}), solid = mask_of({"#"});
  const glm::vec3 point(0.3f, 0, 0.2f);
  const glm::dvec4 light = at({0.3f, 9, 0.2f});
  EXPECT_EQ(answer(scene_of({masked::card(1, 1, holes), masked::card(1, 2, solid)}), point, light), dark);
  EXPECT_EQ(answer(scene_of({masked::card(1, 1, solid), masked::card(1, 2, holes)}), point, light), dark);
  EXPECT_EQ(answer(scene_of({masked::card(1, 1, holes), masked::card(1, 2, holes)}), point, light), lit);
  EXPECT_EQ(answer(scene_of({masked::card(1, 1, holes), hand_made::square(1, 2)}), point, light), dark);
}

// The diagonal of a card is an edge of both of its triangles: in a hole it is no edge of anything.
TEST(exact_scene_holes, an_edge_in_a_hole_is_none) {
  const glm::dvec4 light = at({0, 9, 0});
  EXPECT_EQ(answer(scene_of({masked::card(1, 1, mask_of({"#"}))}), {0, 0, 0}, light), by_an_edge);
  EXPECT_EQ(answer(scene_of({masked::card(1, 1, mask_of({"."}))}), {0, 0, 0}, light), lit);
}

// Two triangles of one mesh, one above the other: the lower half of u is on the lower one. That is the receiver's own and left
// out whole.
TEST(exact_scene_holes, other_triangles_of_the_own_mesh_shade_by_their_texels) {
  const auto roof = [](const char* row) {
    return scene_of({masked::with_mask(
        hand_made::mesh_of({{0, 0, -1}, {0, 0, 1}, {1, 0, 0}, {0, 1, -1}, {0, 1, 1}, {1, 1, 0}}, {{0, 1, 2}, {3, 4, 5}}),
        mask_of({row}), {{0, 0}, {0, 0}, {0.5f, 0}, {0.5f, 0}, {0.5f, 0}, {1, 0}})});
  };
  ExactTally tally;
  const Receiver own{{0.25f, 0, 0}, 0, 0};
  for (const char* row : {"##", "#.", ".#", ".."}) {
    const Scene scene = roof(row);
    const ExactAnswer expected = row[1] == '#' ? dark : lit;
    EXPECT_EQ(ExactScene(scene).occluded(own, at({0.25f, 5, 0}), tally), expected) << row;
  }
}

/// Every caster in rational numbers.
ExactAnswer by_rationals(const Scene& scene, const Receiver& receiver, const glm::dvec4& light) {
  bool is_crossed = false, is_touched = false;
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
    const Mesh& mesh = scene.meshes[m];
    for (std::uint32_t t = 0; mesh.casts && t < mesh.triangles.size(); ++t) {
      const Triangle corners = mesh.corners(t);
      if (receiver.is_own(m, t) || receiver.is_coplanar(scene, corners.points)) continue;
      const auto cut = rational_holes::cut({receiver.point, light}, corners);
      if (!cut || !rational_holes::is_solid(mesh, t, *cut)) continue;
      (cut->is_on_edge ? is_touched : is_crossed) = true;
    }
  }
  return {is_crossed || is_touched, is_touched && !is_crossed};
}

TEST(exact_scene_holes, answers_in_random_scenes_are_those_of_rationals) {
#ifdef __SANITIZE_ADDRESS__
  constexpr int scene_count = 2;
#else
  constexpr int scene_count = 20;
#endif
  Random random(17);
  int dark_count = 0, count = 0;
  for (int s = 0; s < scene_count; ++s) {
    const double scale = std::ldexp(1, s % 4 == 3 ? 12 : 0);
    const auto mask = masked::any_mask(random, 40);
    Scene scene = scene_of({hand_made::square(static_cast<float>(4 * scale), 0),
                            masked::random_cards(random, 12, 2 * scale, 2 * scale, mask),
                            masked::random_cards(random, 12, 2 * scale, scale, masked::random_mask(random, 8, 8))});
    const ExactScene exact(scene);
    ExactTally tally;
    for (int i = 0; i < 200; ++i) {
      const Receiver receiver{glm::vec3(random.uniform(glm::dvec3(-2, 0, -2), glm::dvec3(2, 0, 2)) * scale), 0, 0};
      const glm::dvec3 place = random.uniform(glm::dvec3(-2, 1, -2), glm::dvec3(2, 5, 2)) * scale;
      const glm::dvec4 light(glm::dvec3(glm::vec3(place)), random.below(2));
      const ExactAnswer expected = by_rationals(scene, receiver, light);
      EXPECT_EQ(exact.occluded(receiver, light, tally), expected) << s << ' ' << i;
      dark_count += expected.blocked;
      ++count;
    }
  }
  EXPECT_GT(dark_count, count / 10);
  EXPECT_LT(dark_count, count * 19 / 20);
}

}  // namespace gnomon::exact_scene_holes_test
