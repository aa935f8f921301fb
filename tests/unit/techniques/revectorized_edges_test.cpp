#include <gtest/gtest.h>

#include "device/context.h"
#include "hand_made.h"
#include "small_world.h"

extern "C" void gnomon_technique_shadow_map(gnomon::Registry&);

namespace revectorized_edges_test {
using namespace gnomon;

small_world::Run run(const std::string& settings, const Scene& scene, const Light& light, const GBuffer& g) {
  process_context();
  return small_world::run(gnomon_technique_shadow_map, "bias=receiver_plane," + settings, scene, light, g);
}

/// A square of 3 m, turned a little, 1 m above the ground under a vertical sun: its shadow is the same square.
struct Turned {
  static constexpr double half = 1.5, turn = 0.2;
  Scene scene;
  Light sun = hand_made::sun({0, -1, 0});
  GBuffer g;
  Turned() {
    Mesh caster = hand_made::square(half, 1);
    for (glm::vec3& p : caster.positions) {
      const glm::dvec2 q = outside_of({p.x, p.z}, -turn);
      p.x = static_cast<float>(q.x), p.z = static_cast<float>(q.y);
    }
    scene.meshes = {small_world::ground(2.5f, 0, false), caster};
    g = small_world::make_gbuffer(scene, {.eye = {0, 0.9f, 0.01f}, .target = {0, 0, 0}, .fov_y_degrees = 140}, 400, 400);
  }
  static glm::dvec2 outside_of(const glm::dvec2& p, double by) {
    return {std::cos(by) * p.x - std::sin(by) * p.y, std::sin(by) * p.x + std::cos(by) * p.y};
  }
  /// Distance of a pixel's point from the nearest edge, positive in the light; nothing near corners and far from edges.
  std::optional<double> outside(std::size_t i) const {
    if (!faces_light(scene, g, sun, i) || g.position(i).y > 0.5f) return std::nullopt;
    const glm::dvec2 q = glm::abs(outside_of({g.position(i).x, g.position(i).z}, turn));
    if (std::min(q.x, q.y) > half - 0.3 || std::abs(std::max(q.x, q.y) - half) > 0.3) return std::nullopt;
    return std::max(q.x, q.y) - half;
  }
};

// The edges are straight, so what is dark ends at a line: how far dark points reach beyond lit ones, across the edge, is a
// texel in stairs, and a fraction of it where steps of four and of five texels follow each other as lines.
TEST(revectorized_edges, a_straight_edge_has_a_straight_shadow) {
  const Turned world;
  const auto overlap = [&](const std::string& filter) {
    const auto map = run("resolution=128,filter=" + filter, world.scene, world.sun, world.g);
    double darkest = -1, lightest = 1, width = 0;
    int seen = 0;
    for (std::size_t i = 0; i < world.g.size(); ++i)
      if (const auto outside = world.outside(i)) {
        ++seen;
        if (map.mask[i] == 0) darkest = std::max(darkest, *outside);
        if (map.mask[i] == 1) lightest = std::min(lightest, *outside);
        width = std::max(width, map.technique->explain(i)->texel_width);
      }
    EXPECT_GT(seen, 1000);
    return (darkest - lightest) / width;
  };
  const double stairs = overlap("nearest"), lines = overlap("revectorized");
  EXPECT_GT(stairs, 0.9);
  EXPECT_LT(lines, 0.35);
  EXPECT_GT(overlap("revectorized,edge_search=1"), 0.6) << "an edge that is not followed to its end stays";
}

// Lines are drawn in lit texels alone, next to dark ones: nothing dark gets light, and what gets dark has the answer of the
// texel beside.
TEST(revectorized_edges, shadows_grow_by_less_than_a_texel) {
  std::mt19937 random(11);
  Scene scene;
  scene.meshes = {small_world::ground(3), small_world::random_soup(random, 12, 2, 0.5f, 2, 1)};
  const GBuffer g = small_world::make_gbuffer(scene, {.eye = {3, 5, 6}, .target = {0, 0.3f, 0}}, 160, 120);
  for (const Light& light : {Light{.name = "sun", .kind = DirectionalLight{{0.4f, -1, 0.3f}}},
                             Light{.name = "point", .kind = PointLight{{0.5f, 4, 0.2f}}}}) {
    // The same images: both are fitted with the margin of the wider filter.
    const auto stairs = run("resolution=256,filter=revectorized,edge_search=16", scene, light, g);
    const std::vector<float>& mask = stairs.mask;
    int grown = 0, beside = 0;
    for (std::size_t i = 0; i < g.size(); ++i) {
      if (!faces_light(scene, g, light, i)) continue;
      EXPECT_TRUE(mask[i] == 0 || mask[i] == 1);
      const auto why = stairs.technique->explain(i);
      ASSERT_TRUE(why);
      if (why->taps.empty()) continue;
      ASSERT_EQ(why->taps.size(), 1u);
      const Tap& tap = why->taps[0];
      const glm::dvec3 v = glm::dvec3(g.position(i)) - tap.origin;
      const double aside = glm::length(v - tap.direction * glm::dot(v, tap.direction)) / why->texel_width;
      EXPECT_LT(aside, 1.7) << "half a diagonal, and one texel beside";
      grown += mask[i] == 0 && aside > 0.75;
      beside += mask[i] == 1 && aside > 0.75;
    }
    EXPECT_GT(grown, 20) << light.name;
    EXPECT_EQ(beside, 0) << light.name << ": a lit point has the answer of its own texel";
  }
}

TEST(revectorized_edges, a_bias_for_one_texel_is_refused) {
  Registry registry;
  gnomon_technique_shadow_map(registry);
  const auto technique = registry.techniques()[0].make();
  for (const auto& [bias, is_supported] : {std::pair("constant", false),
                                           {"slope", false},
                                           {"normal_offset", false},
                                           {"godot", false},
                                           {"receiver_plane", true},
                                           {"adaptive", true}}) {
    technique->apply(std::string("filter=revectorized,bias=") + bias);
    const Support support = technique->supports({}, hand_made::sun({0, -1, 0}), {});
    EXPECT_EQ(bool(support), is_supported) << bias;
    if (!is_supported) {
      EXPECT_EQ(support.why().find("filter=revectorized follows edges"), 0u) << support.why();
    }
  }
}

}  // namespace revectorized_edges_test
