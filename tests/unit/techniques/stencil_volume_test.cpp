// Stencil volumes: all ways of counting against each other and against exact signs, and what parameters and layers do.
#include <gnomon/kit/geometry/shapes.h>

#include "stencil_rig.h"

namespace stencil_volume_test {
using namespace stencil_rig;

class StencilVolume : public TestRig {};

// --- Agreement --------------------------------------------------------------------------------------------------------------

TEST_F(StencilVolume, every_way_of_counting_gives_the_same_mask) {
  Random random(1);
  int dark = 0, lit = 0;
  for (int round = 0; round < 12; ++round) {
    const Scene scene = casters_over_ground(random, 8);
    const GBuffer g = small_world::make_gbuffer(scene, random_view(random, round % 3 == 2), 80, 60);
    for (const Light& light : lights_around(random)) {
      const auto mask = expect_all_agree(scene, light, g, fmt::format("round {}, {}", round, light.name));
      dark += std::ranges::count(mask, 0.0f), lit += std::ranges::count(mask, 1.0f);
    }
  }
  EXPECT_GT(dark, 10000);
  EXPECT_GT(lit, 10000);
}

// A caster's corners in another order, and turned round, are the same caster. The depth of the view is drawn in that order too,
// and may come out different in its last bit: then a pixel within the rasterizer's rounding of a boundary may change, once in a
// hundred thousand.
TEST_F(StencilVolume, order_of_a_triangles_corners_changes_no_pixel_beyond_rounding) {
  Random random(3);
  std::ptrdiff_t changed = 0, pixels = 0;
  for (int round = 0; round < 12; ++round) {
    const Scene scene = casters_over_ground(random, 8);
    Scene turned = scene;
    for (Mesh& mesh : turned.meshes)
      for (glm::uvec3& t : mesh.triangles) {
        for (std::uint32_t k = random.below(3); k > 0; --k) t = {t.y, t.z, t.x};
        if (random.below(2)) flip(t);
      }
    const View view = random_view(random, round % 3 == 2);
    const GBuffer g = small_world::make_gbuffer(scene, view, 80, 60),
                  turned_g = small_world::make_gbuffer(turned, view, 80, 60);
    for (const Light& light : lights_around(random)) {
      const auto expected = mask("", scene, light, g);
      const Exact exact(scene, g, light);
      for (const char* settings : {"", "extrusion=per_triangle"}) {
        const auto now = mask(settings, turned, light, turned_g);
        for (std::size_t i = 0; i < now.size(); ++i) {
          ++pixels;
          if (now[i] == expected[i]) continue;
          ++changed;
          EXPECT_TRUE(exact.snaps_to(i, now[i]) && exact.snaps_to(i, expected[i]))
              << "round " << round << ", " << light.name << ", pixel " << i;
        }
      }
    }
  }
  EXPECT_LE(changed, pixels / 100000);
}

// --- Against exact signs ----------------------------------------------------------------------------------------------------

// The rasterizer rounds every vertex to 1/256 px, so an edge may pass a pixel's center on the other side when it comes within
// 1/512 px of it along x and y: about one in 500 of the pixels at a boundary, and no other pixel, may differ.
TEST_F(StencilVolume, only_pixels_within_the_rasterizers_rounding_differ_from_exact_signs) {
  Random random(4);
  Tally sum;
  for (int round = 0; round < 40; ++round) {
    const Scene scene = casters_over_ground(random, 8, {.t_junctions = false});
    const GBuffer g = small_world::make_gbuffer(scene, random_view(random, round % 3 == 2), 80, 60);
    for (const Light& light : lights_around(random)) sum.add(Exact(scene, g, light), mask("", scene, light, g));
  }
  EXPECT_GT(sum.tested, 400000);
  EXPECT_GT(sum.dark, 80000);
  EXPECT_LE(sum.wrong, sum.tested / 10000);
  EXPECT_EQ(sum.not_snapped, 0);
}

// Light caps tie with the surfaces they are made from, so nothing needs a bias: a convex body never shades its own lit side.
TEST_F(StencilVolume, lit_side_of_a_convex_body_has_no_dark_pixel_at_any_scale) {
  Random random(5);
  int facing = 0;
  for (const auto& [scale, shift] : {std::pair(1.0f, 0.0f), {1e3f, 0.0f}, {0.125f, 0.0f}, {1.0f, 300.0f}})
    for (Mesh mesh : {tessellate(Sphere{{0, 1, 0}, 1}, 24, "sphere"), turned_box(random, {0, 1, 0}, {1, 0.5f, 0.75f}),
                      tetrahedron({-1, 0, -1}, {1, 0, -1}, {0, 0, 1.5f}, {0, 1.5f, 0})}) {
      for (glm::vec3& p : mesh.positions) p = p * scale + shift;
      finish(mesh);
      mesh.shape.reset();
      const Scene scene = scene_of({mesh});
      const View view{.eye = random_point(random, {-3, 1, 3}, {3, 4, 5}) * scale + shift,
                      .target = glm::vec3(0, 0.75f, 0) * scale + shift};
      const GBuffer g = small_world::make_gbuffer(scene, view, 96, 72);
      for (int k = 0; k < 4; ++k) {
        const glm::vec3 to = glm::normalize(random_point(random, {-1, -0.5f, -0.5f}, {1, 1, 1}));
        const Light light = k % 2 ? Light{.kind = DirectionalLight{-to}}
                                  : Light{.kind = PointLight{(to * 3.5f + glm::vec3(0, 1, 0)) * scale + shift}};
        for (std::size_t i = 0; i < g.size(); ++i) facing += faces_light(scene, g, light, i);
        for (const char* settings : {"count=zfail", "count=zpass", "count=zpass_plus", "extrusion=per_triangle"})
          EXPECT_EQ(std::ranges::count(mask(settings, scene, light, g), 0.0f), 0)
              << settings << ", scale " << scale << ", shift " << shift;
      }
    }
  EXPECT_GT(facing, 20000);
}

// The same box twice, its faces cut along the other diagonals or its triangles in another order and turned round: coplanar
// surfaces differ in the last bits of their depth, but the nearest is what is seen, and a cap behind it takes nothing away.
TEST_F(StencilVolume, coplanar_casters_do_not_darken_each_other) {
  Random random(9);
  int facing = 0;
  for (int round = 0; round < 40; ++round) {
    const Mesh one = turned_box(random, {0, 1, 0}, {1, 0.5f, 0.75f});
    Mesh two = one;
    for (std::size_t i = 0; i + 1 < one.triangles.size(); i += 2) {
      const glm::uvec3 t = one.triangles[i], u = one.triangles[i + 1];  // a b c and a c d
      if (round % 2) two.triangles[i] = {t.y, t.z, u.z}, two.triangles[i + 1] = {t.y, u.z, t.x};
      if (round % 3) two.triangles[i] = {two.triangles[i].y, two.triangles[i].z, two.triangles[i].x};
      if (round % 4 > 1) flip(two.triangles[i]);
    }
    finish(two);
    const Scene scene = scene_of({one, two});
    const GBuffer g = small_world::make_gbuffer(scene, random_view(random, false), 96, 72);
    const glm::vec3 to = glm::normalize(random_point(random, {-1, -0.5f, -0.5f}, {1, 1, 1}));
    const Light light{.kind = PointLight{to * 3.5f + glm::vec3(0, 1, 0)}};
    for (std::size_t i = 0; i < g.size(); ++i) facing += faces_light(scene, g, light, i);
    for (const char* settings : {"count=zfail", "count=zpass", "extrusion=per_triangle"})
      EXPECT_EQ(std::ranges::count(mask(settings, scene, light, g), 0.0f), 0) << settings << ", round " << round;
  }
  EXPECT_GT(facing, 10000);
}

// --- Lights, casters, parameters, layers ------------------------------------------------------------------------------------

TEST_F(StencilVolume, light_with_area_is_unsupported_with_a_reason) {
  for (const Light& light : {Light{.kind = SphereLight{}}, Light{.kind = RectLight{}}, Light{.kind = DiscLight{}}}) {
    const Support support = supports("", scene_of({small_world::ground(1)}), light, {});
    EXPECT_EQ(support.kind(), Support::Kind::unsupported);
    EXPECT_FALSE(support.why().empty());
  }
}

// A spot light is a point light whose pixels outside the cone are left alone.
TEST_F(StencilVolume, spot_light_is_a_point_light_inside_its_cone) {
  Random random(6);
  const Scene scene = casters_over_ground(random, 8);
  const GBuffer g = small_world::make_gbuffer(scene, random_view(random, false), 80, 60);
  const glm::vec3 position(1, 5, 0.5f);
  const Light spot{.kind = SpotLight{position, {-0.2f, -1, -0.1f}, 5, 12}};
  const auto inside = mask("", scene, spot, g), everywhere = mask("", scene, {.kind = PointLight{position}}, g);
  int dark = 0, left_alone = 0;
  for (std::size_t i = 0; i < g.size(); ++i) {
    const bool in_cone = faces_light(scene, g, spot, i);
    EXPECT_EQ(inside[i], in_cone ? everywhere[i] : 1);
    dark += inside[i] == 0, left_alone += !in_cone && everywhere[i] == 0;
  }
  EXPECT_GT(dark, 50);
  EXPECT_GT(left_alone, 50);
}

TEST_F(StencilVolume, mesh_that_does_not_cast_casts_nothing) {
  Random random(7);
  Scene scene = casters_over_ground(random, 6), without = scene;
  scene.meshes[0].casts = without.meshes[0].casts = true;
  scene.meshes[2].casts = false;
  without.meshes.erase(without.meshes.begin() + 2);
  const View view = random_view(random, false);
  const GBuffer g = small_world::make_gbuffer(scene, view, 80, 60),
                g_without = small_world::make_gbuffer(without, view, 80, 60);
  for (const Light& light : lights_around(random)) {
    const auto here = mask("", scene, light, g), there = mask("", without, light, g_without);
    for (std::size_t i = 0; i < g.size(); ++i) {
      if (g.mesh[i] != 2) {
        EXPECT_EQ(here[i], there[i]);
      }
    }
    // Nothing casts at all: all lit, on the receivers that may cast or not.
    Scene none = scene;
    for (Mesh& mesh : none.meshes) mesh.casts = false;
    for (const std::string& settings : every_setting())
      EXPECT_EQ(std::ranges::count(mask(settings, none, light, g), 1.0f), std::ptrdiff_t(g.size()));
  }
}

TEST_F(StencilVolume, mesh_that_does_not_receive_is_lit_and_casts) {
  Scene scene = scene_of({small_world::ground(3), small_world::ground(1, 1), small_world::ground(1, 2)});
  scene.meshes[1].receives = false;
  const GBuffer g = small_world::make_gbuffer(scene, {.eye = {4, 3, 4}, .target = {0, 0.5f, 0}}, 80, 60);
  const auto now = mask("", scene, {.kind = DirectionalLight{{0, -1, 0}}}, g);
  int lit = 0, dark = 0;
  for (std::size_t i = 0; i < g.size(); ++i) {
    const bool does_not_receive = g.mesh[i] == 1;
    if (does_not_receive) {
      EXPECT_EQ(now[i], 1);
    }
    lit += does_not_receive, dark += now[i] == 0;
  }
  EXPECT_GT(lit, 50);
  EXPECT_GT(dark, 50);
}

// The eye in the shadow of a roof, so that zpass errs: a parameter set on a live object is seen from the stage it spoils on.
TEST_F(StencilVolume, parameter_set_later_gives_the_mask_of_a_fresh_object) {
  const Scene scene = under_roofs(2);
  const View view{.eye = {0.25f, 1, 0.5f}, .target = {0, 0.25f, -4}, .fov_y_degrees = 70};
  const GBuffer g = small_world::make_gbuffer(scene, view, 64, 48);
  const Light light{.kind = PointLight{{0.5f, 6, 0.25f}}};
  const auto right = mask("", scene, light, g), wrong = mask("count=zpass", scene, light, g);
  EXPECT_GT(differences(right, wrong), 1000);
  Technique& t = technique("");
  t.build(scene);
  t.relight(light);
  const auto then = [&](const std::string& settings) {
    t.apply(settings);
    const Stage from = t.parameter(settings.substr(0, settings.find('='))).spoils();
    if (from <= Stage::setup) t.setup();
    if (from <= Stage::build) t.build(scene);
    if (from <= Stage::relight) t.relight(light);
    VisibilityMask mask(g.width, g.height);
    t.resolve(g, mask);
    const auto pixels = mask.read();
    return std::vector<float>(pixels.begin(), pixels.end());
  };
  EXPECT_EQ(differences(then("count=zpass"), wrong), 0);
  EXPECT_EQ(count("volumes_at_eye"), 0);
  EXPECT_EQ(differences(then("count=zpass_plus"), right), 0);
  EXPECT_EQ(count("volumes_at_eye"), 2);
  EXPECT_EQ(count("counter_bits"), 8);
  EXPECT_EQ(differences(then("counter=wide"), right), 0);
  EXPECT_EQ(count("counter_bits"), 32);
  EXPECT_EQ(differences(then("near_cap=rectangle"), right), 0);
  EXPECT_EQ(count("volumes_at_eye"), 0);
  // The outline of the box's lit half has 6 edges or fewer, its 12 triangles have 36.
  const double few = count("triangles");
  EXPECT_EQ(differences(then("extrusion=per_triangle"), right), 0);
  EXPECT_GT(count("triangles"), few);
  EXPECT_EQ(differences(then("count=zfail"), right), 0);
  EXPECT_EQ(differences(then("count=zpass"), wrong), 0);
  EXPECT_EQ(differences(then("finder=gpu"), wrong), 0);
  EXPECT_EQ(differences(then("count=zfail"), right), 0);
}

// A new light and a new eye on one object, without the earlier stages, give what a fresh start gives.
TEST_F(StencilVolume, later_stages_repeat_without_the_earlier_ones) {
  Random random(8);
  const Scene scene = casters_over_ground(random, 8);
  const auto lights = lights_around(random);
  const View views[] = {random_view(random, false), random_view(random, true)};
  for (const char* settings :
       {"count=zfail", "count=zpass_plus,near_cap=rectangle", "count=zpass_plus,extrusion=per_triangle"}) {
    std::vector<std::vector<float>> fresh;
    std::vector<GBuffer> gbuffers;
    for (const View& view : views) gbuffers.push_back(small_world::make_gbuffer(scene, view, 48, 36));
    for (const Light& light : lights)
      for (const GBuffer& g : gbuffers) fresh.push_back(mask(settings, scene, light, g));
    Technique& t = technique(settings);
    t.build(scene);
    std::size_t place = 0;
    for (const Light& light : lights) {
      t.relight(light);
      for (const GBuffer& g : gbuffers) {
        VisibilityMask mask(g.width, g.height);
        t.resolve(g, mask);
        const auto pixels = mask.read();
        EXPECT_TRUE(std::ranges::equal(pixels, fresh[place++])) << settings << ' ' << light.name;
      }
    }
  }
}

// A box over the ground under a sun straight down: its volume is the column below it, and a pixel shows some of it where its
// way from the eye to the surface, or on into the background, meets the column's sides below the box's top. The picture is
// compared with that of the same scene where nothing casts.
TEST_F(StencilVolume, layers_show_volumes_and_counts_where_they_are) {
  const glm::vec3 low(-0.5f, 1, -0.5f), high(0.5f, 1.5f, 0.5f);
  const Scene scene = scene_of({small_world::ground(2, 0, false), small_world::box(low, high)});
  Scene without = scene;
  without.meshes[1].casts = false;
  const GBuffer g = small_world::make_gbuffer(scene, {.eye = {2, 2.5f, 3.5f}, .target = {0, 0.5f, 0}}, 80, 60);
  const Light light{.kind = DirectionalLight{{0, -1, 0}}};
  for (const char* settings : {"count=zfail", "count=zpass", "count=zpass_plus", "count=zpass,counter=wide"}) {
    mask(settings, without, light, g);
    const auto plain_volumes = technique_->draw_debug("volumes"), plain_counts = technique_->draw_debug("counts");
    const auto now = mask(settings, scene, light, g);
    const std::vector<DebugLayer> layers = technique_->debug_layers();
    ASSERT_EQ(layers.size(), 3u);
    ASSERT_EQ(layers[0].name, "volumes");
    ASSERT_EQ(layers[1].name, "counts");
    ASSERT_EQ(layers[2].name, "silhouette");
    const auto volumes = technique_->draw_debug("volumes"), counts = technique_->draw_debug("counts");
    ASSERT_EQ(volumes.size(), 3 * g.size());
    ASSERT_EQ(counts.size(), 3 * g.size());
    const auto differs = [](const std::vector<float>& a, const std::vector<float>& b, std::size_t i) {
      return a[3 * i] != b[3 * i] || a[3 * i + 1] != b[3 * i + 1] || a[3 * i + 2] != b[3 * i + 2];
    };
    int crossed = 0, missed = 0, wrong = 0, counted = 0, not_counted = 0;
    for (std::size_t i = 0; i < g.size(); ++i) {
      for (int k = 0; k < 3; ++k) {
        EXPECT_GE(volumes[3 * i + k], 0);
        EXPECT_LE(volumes[3 * i + k], 1);
        EXPECT_GE(counts[3 * i + k], 0);
        EXPECT_LE(counts[3 * i + k], 1);
      }
      if (g.is_background(i)) continue;
      // The way from the eye to the pixel's point against the column without end, down from the middle of the box.
      const glm::dvec3 eye = g.view.eye, way = glm::dvec3(g.position(i)) - eye;
      double near = 0, far = 1;
      for (const int k : {0, 2}) {
        const double s = (double(low[k]) - eye[k]) / way[k], t = (double(high[k]) - eye[k]) / way[k];
        near = std::max(near, std::min(s, t)), far = std::min(far, std::max(s, t));
      }
      const double length = far - near, y_near = eye.y + near * way.y;
      if (g.mesh[i] == 0 && length > 0.01 && y_near < 0.9) {
        ++crossed, wrong += !differs(volumes, plain_volumes, i);
      }
      if (g.mesh[i] == 0 && length < -0.01) {
        ++missed, wrong += differs(volumes, plain_volumes, i);
      }
      if (!faces_light(scene, g, light, i)) continue;
      if (now[i] == 0) {
        ++counted, wrong += !differs(counts, plain_counts, i);
      } else {
        ++not_counted, wrong += differs(counts, plain_counts, i);
      }
    }
    EXPECT_GT(crossed, 100) << settings;
    EXPECT_GT(missed, 100) << settings;
    EXPECT_GT(counted, 50) << settings;
    EXPECT_GT(not_counted, 500) << settings;
    EXPECT_EQ(wrong, 0) << settings;
  }
  EXPECT_THROW(technique_->draw_debug("nothing"), Error);
}

}  // namespace stencil_volume_test
