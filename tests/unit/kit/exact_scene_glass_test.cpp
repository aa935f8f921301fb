// The oracle on casters with transmission: vectors on paper, and every triangle in rational numbers.
#include <gnomon/kit/geometry/exact_scene.h>
#include <gtest/gtest.h>

#include "glass.h"
#include "rational_holes.h"
#include "small_world.h"

namespace gnomon::exact_scene_glass_test {

using glass::glass_card;

glm::dvec4 at(const glm::vec3& p) { return {glm::dvec3(p), 1}; }

Scene scene_of(std::vector<Mesh> meshes) {
  Scene scene;
  scene.meshes = std::move(meshes);
  return scene;
}

ExactShare share(const Scene& scene, const Receiver& receiver, const glm::dvec4& light) {
  ExactTally tally;
  return ExactScene(scene).transmitted(receiver, light, tally);
}

/// masked::triangle_on_paper with transmission in place of the mask.
Mesh triangle_on_paper(std::shared_ptr<const Transmission> transmission) {
  return glass::with_transmission(masked::triangle_on_paper(nullptr), std::move(transmission));
}

/// Texel k of count in a row lets k / count through.
std::shared_ptr<const Transmission> steps(int width, int height) {
  std::vector<float> values;
  for (int k = 0; k < width * height; ++k) values.push_back(static_cast<float>(k) / static_cast<float>(width * height));
  return glass::texels(width, height, values);
}

// The way meets (u, v) = (5/12, 1/3): texel (3, 2) of 8 x 8, number 19 of 64, and (1, 1) of 4 x 4, number 5 of 16.
TEST(exact_scene_glass, the_texel_is_that_derived_on_paper) {
  const glm::vec3 point(1, 0, 1), light(3, 6, 2);
  for (const glm::dvec4& l : {at(light), glm::dvec4(glm::dvec3(light - point), 0)}) {
    EXPECT_EQ(share(scene_of({triangle_on_paper(steps(8, 8))}), {point}, l).light.share, glm::dvec3(19.0 / 64));
    EXPECT_EQ(share(scene_of({triangle_on_paper(steps(4, 4))}), {point}, l).light.share, glm::dvec3(5.0 / 16));
  }
}

// Exactly on the edge of columns 3 and 4 of 8: column 4 counts.
TEST(exact_scene_glass, a_way_through_the_edge_of_two_texels_has_an_answer) {
  const ExactShare found = share(scene_of({triangle_on_paper(steps(8, 1))}), {{1.5f, 0, 1}}, at({3, 6, 2}));
  EXPECT_EQ(found.light.share, glm::dvec3(4.0 / 8));
  EXPECT_FALSE(found.degenerate);
}

// The mask says where the triangle is, the transmission what its solid part lets through.
TEST(exact_scene_glass, what_is_solid_of_a_mask_lets_its_part_through) {
  const glm::vec3 point(1, 0, 1), light(3, 6, 2);
  Mesh mesh = glass::with_transmission(masked::triangle_on_paper(masked::checker(8, 8)), glm::vec3(0.25f));
  ExactShare found = share(scene_of({mesh}), {point}, at(light));
  EXPECT_EQ(found.light.share, glm::dvec3(1));  // through the hole
  EXPECT_EQ(found.light.surfaces, 0);
  mesh.alpha_mask = masked::checker(4, 4);
  found = share(scene_of({mesh}), {point}, at(light));
  EXPECT_EQ(found.light.share, glm::dvec3(0.25));
  EXPECT_EQ(found.light.surfaces, 1);
  // Of another number of texels than the mask: number 19 of 64.
  mesh.transmission = steps(8, 8);
  EXPECT_EQ(share(scene_of({mesh}), {point}, at(light)).light.share, glm::dvec3(19.0 / 64));
}

TEST(exact_scene_glass, the_own_triangle_and_coplanar_ones_let_all_through) {
  const Scene scene = scene_of({glass_card(1, 0, 0.5f), glass_card(0.5f, 0, 0.25f), glass_card(1, 1, 0.75f)});
  const Receiver own{{0.3f, 0, 0.1f}, 0, 1};
  EXPECT_EQ(share(scene, own, at({0.3f, 5, 0.1f})).light.share, glm::dvec3(0.75));
  // A point a little below its own triangle: that and what is in its plane lie on the way, and are left out all the same.
  const Receiver below{{0.3f, -0x1p-20f, 0.1f}, 0, 1};
  EXPECT_EQ(share(scene, below, at({0.3f, 5, 0.1f})).light.share, glm::dvec3(0.75));
  const Receiver anywhere{below.point};
  EXPECT_EQ(share(scene, anywhere, at({0.3f, 5, 0.1f})).light.share, glm::dvec3(0.5 * 0.25 * 0.75));
}

TEST(exact_scene_glass, opaque_questions_pass_glass_by) {
  ExactTally tally;
  const Scene scene = scene_of({glass_card(1, 1, 0), hand_made::square(0.5f, 2)});
  const ExactScene exact(scene);
  EXPECT_TRUE(exact.has_transmission());
  EXPECT_FALSE(exact.occluded({{0.7f, 0, 0.1f}}, at({0.7f, 5, 0.1f}), tally).blocked);
  EXPECT_TRUE(exact.occluded({{0.3f, 0, 0.1f}}, at({0.3f, 5, 0.1f}), tally).blocked);
  EXPECT_FALSE(ExactScene(scene_of({hand_made::square(1, 1)})).has_transmission());
}

/// What the texel lets through, in rational numbers.
glm::vec3 transmission_of(const Mesh& mesh, std::uint32_t triangle, const rational_holes::Cut& cut) {
  const Transmission& glass = *mesh.transmission;
  if (glass.is_constant()) return glass.at(0, 0);
  const auto texel = [&](int axis, int size, Transmission::Wrap wrap) {
    mpq_class place = 0;
    for (int k = 0; k < 3; ++k)
      place += cut.shares[k] * mpq_class(static_cast<double>(mesh.uv[mesh.triangles[triangle][k]][axis]));
    return rational_holes::wrapped(rational_holes::whole_below(place * size), size, wrap);
  };
  const int column = texel(0, glass.width(), glass.wrap_u()), row = texel(1, glass.height(), glass.wrap_v());
  return glass.at(column, row);
}

struct RationalShare {
  ExactShare answer;      ///< products in double, mesh after mesh and triangle after triangle
  mpq_class product = 1;  ///< of red, without rounding
};
RationalShare by_rationals(const Scene& scene, const Receiver& receiver, const glm::dvec4& light) {
  RationalShare found;
  bool is_crossed = false, touches_opaque = false, touches_glass = false;
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
    const Mesh& mesh = scene.meshes[m];
    for (std::uint32_t t = 0; mesh.casts && t < mesh.triangles.size(); ++t) {
      const Triangle corners = mesh.corners(t);
      if (receiver.is_own(m, t) || receiver.is_coplanar(scene, corners.points)) continue;
      const auto cut = rational_holes::cut({receiver.point, light}, corners);
      if (!cut || !rational_holes::is_solid(mesh, t, *cut)) continue;
      if (!mesh.transmission) {
        (cut->is_on_edge ? touches_opaque : is_crossed) = true;
        continue;
      }
      touches_glass |= cut->is_on_edge;
      const glm::vec3 factor = transmission_of(mesh, t, *cut);
      found.answer.light.share *= glm::dvec3(factor);
      found.answer.light.surfaces += factor != glm::vec3(1);
      found.product *= mpq_class(static_cast<double>(factor.x));
    }
  }
  if (is_crossed || touches_opaque) {
    found.answer.light = {.share = glm::dvec3(0), .surfaces = 0};
    found.product = 0;
  }
  found.answer.degenerate = !is_crossed && (touches_opaque || touches_glass);
  return found;
}

/// A constant share, texels, or both holes and one of these.
Mesh random_glass(Random& random, int count, double half, double size) {
  Mesh mesh = masked::random_cards(random, count, static_cast<float>(half), static_cast<float>(size), nullptr);
  if (random.below(3) == 0) mesh.alpha_mask = masked::any_mask(random, 20);
  mesh.transmission =
      random.below(3) == 0 ? glass::constant(glm::vec3(glass::any_share(random))) : glass::any_texels(random, 12);
  return mesh;
}

TEST(exact_scene_glass, answers_in_random_scenes_are_those_of_rationals) {
#ifdef __SANITIZE_ADDRESS__
  constexpr int scene_count = 2;
#else
  constexpr int scene_count = 12;
#endif
  Random random(19);
  int gray = 0, several = 0, blocked = 0, count = 0;
  for (int s = 0; s < scene_count; ++s) {
    const double scale = std::ldexp(1, s % 4 == 3 ? 12 : 0);
    Scene scene = scene_of({hand_made::square(static_cast<float>(4 * scale), 0), random_glass(random, 8, 2 * scale, 2 * scale),
                            masked::random_cards(random, 2, static_cast<float>(2 * scale), static_cast<float>(scale), nullptr),
                            random_glass(random, 8, 2 * scale, scale), random_glass(random, 4, 2 * scale, 3 * scale)});
    const ExactScene exact(scene);
    ExactTally tally;
    for (int i = 0; i < 200; ++i) {
      const Receiver receiver{glm::vec3(random.uniform(glm::dvec3(-2, 0, -2), glm::dvec3(2, 0, 2)) * scale), 0, 0};
      const glm::dvec3 place = random.uniform(glm::dvec3(-2, 1, -2), glm::dvec3(2, 5, 2)) * scale;
      const glm::dvec4 light(glm::dvec3(glm::vec3(place)), random.below(2));
      const RationalShare expected = by_rationals(scene, receiver, light);
      const ExactShare found = exact.transmitted(receiver, light, tally);
      EXPECT_EQ(found.light.share, expected.answer.light.share) << s << ' ' << i;
      EXPECT_EQ(found.light.surfaces, expected.answer.light.surfaces) << s << ' ' << i;
      EXPECT_EQ(found.degenerate, expected.answer.degenerate) << s << ' ' << i;
      // Each product rounds by 2^-53 of itself.
      const double product = expected.product.get_d();
      EXPECT_NEAR(found.light.share.x, product, product * (found.light.surfaces + 1) * 0x1p-53) << s << ' ' << i;
      ++count;
      blocked += found.light.share.x == 0 && found.light.surfaces == 0;
      gray += found.light.share.x > 0 && found.light.share.x < 1;
      several += found.light.share.x > 0 && found.light.surfaces > 1;
    }
  }
  EXPECT_GT(blocked, count / 50);
  EXPECT_GT(gray, count / 10);
  EXPECT_GT(several, count / 50);
  RecordProperty("seen", std::to_string(count) + " ways, " + std::to_string(gray) + " gray, " + std::to_string(several) +
                             " behind several, " + std::to_string(blocked) + " blocked");
}

}  // namespace gnomon::exact_scene_glass_test
