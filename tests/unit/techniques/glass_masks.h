#pragma once
// Masks behind glass against the exact product.
#include <gnomon/kit/geometry/exact_scene.h>
#include <gnomon/kit/rays/gbuffer_maker.h>
#include <gtest/gtest.h>

#include <bit>
#include <cstdlib>

#include "glass.h"

namespace glass_masks {
using namespace gnomon;

/// How many steps of float32 lie between two numbers from 0 up.
inline int steps(float a, float b) { return std::abs(std::bit_cast<std::int32_t>(a) - std::bit_cast<std::int32_t>(b)); }

inline Mesh unseen(Mesh mesh) {
  mesh.seen = false;
  mesh.receives = false;
  return mesh;
}
inline Scene scene_of(std::vector<Mesh> meshes) {
  Scene scene;
  scene.meshes = std::move(meshes);
  return scene;
}
inline GBuffer seen_of(const Scene& scene, const View& view, int width, int height) {
  return make_gbuffer(scene, RayScene(scene, Truth::mesh, RayScene::Which::seen), view, width, height, Truth::mesh);
}
/// From above, so that little of a picture is near an edge.
inline const View from_above{.eye = {0.3f, 7, 1.5f}, .target = {0.1f, 0, 0}};

inline std::vector<float> truth_of(const Scene& scene, const Light& light, const GBuffer& g) {
  std::vector<float> truth(g.size());
  ExactScene(scene).decide(g, light, truth);
  return truth;
}

/// How masks compare with the exact product over the pixels that face the light.
struct Agreement {
  int tested = 0;
  int shaded = 0;         ///< of them, exactly neither lit nor dark
  int dark = 0;           ///< exactly
  int inside = 0;         ///< no other exact answer and no other surface within 2 pixels
  int wrong = 0;          ///< by more than so many steps
  int wrong_inside = 0;   ///< of those inside
  int shaded_inside = 0;  ///< of those inside

  void add(const Scene& scene, const Light& light, const GBuffer& g, const std::vector<float>& mask, int most_steps = 4) {
    const std::vector<float> truth = truth_of(scene, light, g);
    for (std::size_t i = 0; i < g.size(); ++i) {
      if (!faces_light(scene, g, light, i)) {
        EXPECT_EQ(mask[i], 1) << "pixel " << i << " does not face the light";
        continue;
      }
      const bool is_inside = !near_edge(g, truth, i), is_wrong = steps(mask[i], truth[i]) > most_steps;
      const bool is_shaded = truth[i] > 0 && truth[i] < 1;
      ++tested;
      shaded += is_shaded;
      dark += truth[i] == 0;
      inside += is_inside;
      shaded_inside += is_inside && is_shaded;
      wrong += is_wrong;
      wrong_inside += is_wrong && is_inside;
      if (is_wrong && is_inside) {
        EXPECT_EQ(mask[i], truth[i]) << "pixel " << i;
      }
    }
  }

 private:
  static bool near_edge(const GBuffer& g, const std::vector<float>& truth, std::size_t i) {
    const int x = static_cast<int>(i) % g.width, y = static_cast<int>(i) / g.width;
    for (int v = std::max(y - 2, 0); v <= std::min(y + 2, g.height - 1); ++v)
      for (int u = std::max(x - 2, 0); u <= std::min(x + 2, g.width - 1); ++u) {
        const std::size_t k = std::size_t(v) * g.width + u;
        if (truth[k] != truth[i] || g.mesh[k] != g.mesh[i] || g.normal(k) != g.normal(i)) return true;
      }
    return false;
  }
};

/// Cards and boxes of glass in and over each other, a card with an alpha mask and an opaque plate among them, over a ground.
inline Scene stacks_and_nests(Random& random, bool with_mask) {
  Scene scene = scene_of({hand_made::square(4, 0)});
  const auto place = [&](Mesh mesh, double reach) {
    const auto by = glm::vec3(random.uniform(glm::dvec3(-reach, 0, -reach), glm::dvec3(reach, 0.3, reach)));
    for (glm::vec3& p : mesh.positions) p += by;
    finish(mesh);
    scene.meshes.push_back(unseen(std::move(mesh)));
  };
  for (int k = 0; k < 3; ++k)
    place(glass::glass_card(0.8f, 0.5f + 0.4f * static_cast<float>(k), glass::any_share(random)), 0.7);
  Mesh leaning = glass::glass_card(0.9f, 1.2f, 0.75f);
  for (glm::vec3& p : leaning.positions) p.y += 0.5f * p.x;
  place(leaning, 1);
  place(hand_made::square(0.4f, 0.9f), 1);
  if (with_mask) place(glass::with_transmission(masked::card(0.8f, 0.7f, masked::any_mask(random, 4)), glm::vec3(0.25f)), 1);
  return scene;
}

inline const Light lights[] = {hand_made::sun({0.2f, -1, 0.1f}),
                               hand_made::point_light({0.4f, 5, -0.3f}),
                               {.name = "spot", .kind = SpotLight{.position = {0.5f, 5, 0}, .direction = {-0.1f, -1, 0}}}};

}  // namespace glass_masks
