// The textbook's failures, switched on: what they draw, on paper and by their own formula, and that they are named.
#include "cause_world.h"
#include "planar_rig.h"

namespace planar_artefacts_test {
using namespace planar_rig;

const Light lamp{.kind = PointLight{{0, 2, 0}}};
const View above{.eye = {3, 9, 6}, .target = {0, 0, 0}};

/// Casters over a ground |x|, |z| <= 5 that casts nothing but receives.
Scene over_ground(std::vector<Mesh> casters) {
  Scene scene;
  scene.meshes = {small_world::ground(5)};
  scene.meshes.insert(scene.meshes.end(), casters.begin(), casters.end());
  return scene;
}

/// Runs with a setting, compares with an answer on paper, and expects the account of just the pixels where the answer without
/// it is another.
int expect_artefact(const Scene& scene, const Light& light, const std::string& setting,
                    const std::function<double(double x, double z)>& answer) {
  const GBuffer g = small_world::make_gbuffer(scene, above, 160, 120);
  const auto spoiled = small_world::run(gnomon_technique_planar_projected, setting, scene, light, g);
  const auto exact = small_world::run(gnomon_technique_planar_projected, "", scene, light, g);
  for (std::size_t i = 0; i < g.size(); ++i) {
    EXPECT_EQ(spoiled.technique->explain(i)->formula_differs, std::abs(spoiled.mask[i] - exact.mask[i]) > 0.5f) << i;
    EXPECT_FALSE(exact.technique->explain(i)->formula_differs);
  }
  return expect_on_ground(g, spoiled.mask, answer);
}

// At height 3 over a light at height 2, w = 1 - 3/2 = -1/2: 1/2 <= x <= 1, |z| <= 1/2 becomes -2 <= x <= -1, |z| <= 1.
TEST_F(PlanarProjected, unclipped_casters_behind_the_light_cast_mirrored_anti_shadows) {
  EXPECT_GT(expect_artefact(over_ground({plate(0.5f, 1, -0.5f, 0.5f, 3)}), lamp, "unclipped=true",
                            [](double x, double z) { return x > -2 && x < -1 && std::abs(z) < 1 ? 0 : 1; }),
            50);
}

// At height -1, w = 1 + 1/2: the plate shrinks to two thirds. Under a sun it is moved by its depth against the light.
TEST_F(PlanarProjected, unclipped_casters_behind_the_plane_cast_false_shadows) {
  EXPECT_GT(expect_artefact(over_ground({plate(1.5f, 3, -1.5f, 1.5f, -1)}), lamp, "unclipped=true",
                            [](double x, double z) { return x > 1 && x < 2 && std::abs(z) < 1 ? 0 : 1; }),
            50);
  EXPECT_GT(expect_artefact(over_ground({plate(1.5f, 3, -1, 1, -1)}), {.kind = DirectionalLight{{1, -1, 0}}}, "unclipped=true",
                            [](double x, double z) { return x > 0.5 && x < 2 && std::abs(z) < 1 ? 0 : 1; }),
            50);
}

// Corners (1, 1, -+1/2) have their images at (2, -+1); (1, 4, 0) has w = 1 - 4/2 = -1, and its image at (-1, 0). The triangle
// between them, |z| <= (x + 1) / 3 to the left of x = 2, is dark; the shadow is what the same two lines bound to the right of
// it.
TEST_F(PlanarProjected, unclipped_triangles_through_the_light_s_height_wrap_around) {
  const Scene scene = over_ground({make_mesh({{1, 1, -0.5f}, {1, 1, 0.5f}, {1, 4, 0}}, {{0, 1, 2}}, true, false)});
  EXPECT_GT(expect_artefact(scene, lamp, "unclipped=true",
                            [](double x, double z) { return x < 2 && std::abs(z) < (x + 1) / 3 ? 0 : 1; }),
            50);
  EXPECT_GT(expect_artefact(scene, lamp, "", [](double x, double z) { return x > 2 && std::abs(z) < (x + 1) / 3 ? 0 : 1; }),
            50);
}

// (1, 2, 0) is at the light's height: its image is far away in the direction (1, 0), as if it were a hair lower, so that the
// triangle's is x >= 2, |z| <= 1, its true shadow. A triangle wholly at that height has its image far away, too.
TEST_F(PlanarProjected, unclipped_vertices_at_the_light_s_height_have_their_images_far_away) {
  const Scene peak = over_ground({make_mesh({{1, 1, -0.5f}, {1, 1, 0.5f}, {1, 2, 0}}, {{0, 1, 2}}, true, false)});
  for (const char* setting : {"", "unclipped=true"})
    EXPECT_GT(expect_artefact(peak, lamp, setting, [](double x, double z) { return x > 2 && std::abs(z) < 1 ? 0 : 1; }), 50);
  const Scene flat = over_ground({plate(0.5f, 1, -0.5f, 0.5f, 2), plate(-1, -0.5f, 0.5f, 1, 2)});
  EXPECT_EQ(expect_artefact(flat, lamp, "unclipped=true", [](double, double) { return 1; }), 0);
}

/// The textbook's answer in double: whether the point of a plane is in the image of a triangle, every corner divided by its w.
/// Triangles on the plane are left out.
Question by_division(const Scene& scene, const Light& light, const glm::dvec4& plane) {
  std::vector<std::array<glm::dvec3, 3>> images;
  const glm::dvec4 l = homogeneous(light);
  for (const Mesh& mesh : scene.meshes)
    for (const glm::uvec3& t : mesh.triangles) {
      if (!mesh.casts) continue;
      std::array<glm::dvec3, 3> image;
      bool is_off = false;
      for (int k = 0; k < 3; ++k) {
        const glm::dvec4 p(glm::dvec3(mesh.positions[t[k]]), 1);
        const double height = glm::dot(plane, p);
        const glm::dvec4 m = glm::dot(plane, l) * p - height * l;
        image[k] = glm::dvec3(m) / m.w;
        is_off = is_off || std::abs(height) > 1e-5;
      }
      if (is_off) images.push_back(image);
    }
  return [images, n = glm::dvec3(plane)](const glm::dvec3& point) {
    return std::ranges::any_of(images, [&](const auto& image) {
      const auto side = [&](int k) { return glm::dot(n, glm::cross(image[(k + 1) % 3] - image[k], point - image[k])) >= 0; };
      return side(0) == side(1) && side(1) == side(2);
    });
  };
}

// Soup below the ground, above it and around the light, the ground and a table: what the formula says for each plane. Where
// that is wrong, the account says so, but for what the rasterizer rounds; what is right with it is not accused.
TEST_F(PlanarProjected, unclipped_is_the_textbook_s_formula_on_every_plane) {
  int wrong = 0, off = 0, off_away = 0, unnamed_away = 0;
  for (unsigned seed = 1; seed <= 8; ++seed) {
    std::mt19937 random(seed);
    Scene scene;
    // The ground would darken the whole table, which is in front of it.
    scene.meshes = {small_world::ground(3, 0, false), small_world::ground(0.8f, 0.6f),
                    small_world::random_soup(random, 8, 1.5f, -0.8f, 3, 0.5f)};
    scene.meshes[2].receives = false;
    const GBuffer g = small_world::make_gbuffer(scene, view, 96, 72);
    for (const Light& light : {Light{.kind = PointLight{{0.3f, 2, 0.1f}}}, Light{.kind = DirectionalLight{{0.4f, -1, 0.2f}}}}) {
      const auto spoiled = run(scene, light, g, "unclipped=true");
      const auto exact = run(scene, light, g);
      const Question truth = by_rays(scene, light);
      const Question formulas[] = {by_division(scene, light, {0, 1, 0, 0}), by_division(scene, light, {0, 1, 0, -0.6f})};
      for (std::size_t i = 0; i < g.size(); ++i) {
        if (!faces_light(scene, g, light, i)) continue;
        const Question& formula = formulas[g.mesh[i]];
        const bool is_dark = spoiled.mask[i] == 0, says = spoiled.technique->explain(i)->formula_differs;
        EXPECT_EQ(says, spoiled.mask[i] != exact.mask[i]);
        if (formula(g.position(i)) != is_dark) ++off, off_away += !near_edge(formula, g, i, 0.02);
        if (truth(g.position(i)) == is_dark) continue;
        ++wrong;
        unnamed_away += !says && !near_edge(truth, g, i, 0.02);
      }
    }
  }
  EXPECT_GT(wrong, 3000);
  EXPECT_LE(off, 10);
  EXPECT_EQ(off_away, 0);
  EXPECT_EQ(unnamed_away, 0);
}

// The plates of shadows_that_overlap_are_not_darker: 1 <= x <= 2 is covered twice, x = 3/2 alone by all three.
TEST_F(PlanarProjected, double_blend_halves_for_every_triangle) {
  Scene scene = over_ground({});
  for (const float height : {1.0f, 1.5f, 2.25f}) scene.meshes.push_back(plate(-0.5f, 0.5f, -1, 1, height));
  const auto answer = [](double x, double z) {
    double visibility = 1;
    for (const double height : {1.0, 1.5, 2.25})
      if (std::abs(x - height) < 0.5 && std::abs(z) < 1) visibility /= 2;
    return visibility;
  };
  EXPECT_GT(expect_artefact(scene, {.kind = DirectionalLight{{1, -1, 0}}}, "double_blend=true", answer), 100);
}

// The near sides of a closed convex caster cover its shadow once, and so do the far ones, with the same outline: 1/4 wherever
// it casts, to the last pixel. Several multiply.
TEST_F(PlanarProjected, double_blend_is_a_quarter_for_each_closed_convex_caster) {
  Random random(7);
  const auto number = [&](double low, double high) { return static_cast<float>(random.uniform(low, high)); };
  Scene scene = over_ground({});
  for (int k = 0; k < 6; ++k) {
    const glm::vec3 a(number(-2, 1), number(0.1, 2), number(-2, 1));
    scene.meshes.push_back(small_world::box(a, a + glm::vec3(number(0.4, 1.2), number(0.4, 1.2), number(0.4, 1.2))));
    scene.meshes.back().receives = false;
  }
  const GBuffer g = small_world::make_gbuffer(scene, view, 128, 96);
  for (const Light& light : {Light{.kind = PointLight{{0.5f, 5, 1}}}, Light{.kind = DirectionalLight{{0.4f, -1, 0.2f}}}}) {
    std::vector<float> product(g.size(), 1);
    for (std::size_t k = 1; k < scene.meshes.size(); ++k) {
      Scene alone = scene;
      for (std::size_t m = 0; m < scene.meshes.size(); ++m) alone.meshes[m].casts = m == k;
      const std::vector<float> exact = run(alone, light, g).mask, blended = run(alone, light, g, "double_blend=true").mask;
      for (std::size_t i = 0; i < g.size(); ++i) {
        EXPECT_EQ(blended[i], exact[i] == 0 ? 0.25f : 1);
        product[i] *= blended[i];
      }
    }
    const std::vector<float> all = run(scene, light, g, "double_blend=true").mask;
    EXPECT_EQ(all, product);
    EXPECT_GT(std::ranges::count_if(all, [](float v) { return v < 0.1f; }), 100) << "shadows overlap";
  }
}

// Both at once: an anti-shadow of one plate, halved once by each triangle that covers it.
TEST_F(PlanarProjected, unclipped_and_double_blend_go_together) {
  const Scene scene = over_ground({plate(0.5f, 1, -0.5f, 0.5f, 3), plate(0.5f, 1, -0.5f, 0.5f, 3)});
  EXPECT_GT(expect_artefact(scene, lamp, "unclipped=true,double_blend=true",
                            [](double x, double z) { return x > -2 && x < -1 && std::abs(z) < 1 ? 0.25 : 1; }),
            50);
}

// The account of the last resolve, after another one: under the sun a plate 3 m up casts 3 m aside, as it should.
TEST_F(PlanarProjected, account_of_an_artefact_is_that_of_the_last_resolve) {
  const Scene scene = over_ground({plate(0.5f, 1, -0.5f, 0.5f, 3)});
  const GBuffer g = small_world::make_gbuffer(scene, above, 160, 120);
  const auto planar = run(scene, lamp, g, "unclipped=true");
  const auto accused = [&] {
    int count = 0;
    for (std::size_t i = 0; i < g.size(); ++i) count += planar.technique->explain(i)->formula_differs;
    return count;
  };
  EXPECT_GT(accused(), 50);
  VisibilityMask mask(g.width, g.height);
  planar.technique->relight({.kind = DirectionalLight{{1, -1, 0}}});
  planar.technique->resolve(g, mask);
  EXPECT_EQ(accused(), 0);
  EXPECT_GT(std::ranges::count(mask.read(), 0.0f), 20);
}

// A tile above the light, and one below it. The anti-shadow is named; a pixel that something else turned over is not.
TEST_F(PlanarProjected, wrong_pixels_of_an_artefact_have_the_cause_formula) {
  cause_world::World world(cause_world::on_ground({plate(1, 1.8f, -1, 1, 3), plate(1, 1.5f, 1.2f, 1.7f, 0.5f)}), lamp);
  const auto of = [&](const std::string& settings) {
    auto planar = run(world.scene, world.light, world.gbuffer, settings);
    world.mask = planar.mask;
    const auto own = world.wrong();
    const std::uint32_t lit = world.pixel(-1, 3);
    world.mask[lit] = 0;
    return std::pair(own, world.causes([&](std::uint32_t i) { return planar.technique->explain(i); }));
  };
  using cause_world::Causes;
  EXPECT_EQ(of("").second, (Causes{{"crack", 1}}));
  const auto [wrong, causes] = of("unclipped=true");
  EXPECT_GT(wrong, 100u);
  EXPECT_EQ(causes, (Causes{{"formula", wrong}, {"crack", 1}}));
  EXPECT_EQ(of("double_blend=true").second, (Causes{{"crack", 1}})) << "too light, but not wrong by more than one half";
}

}  // namespace planar_artefacts_test
