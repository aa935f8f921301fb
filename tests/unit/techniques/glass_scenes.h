#pragma once
// Casters with transmission for tests of techniques: soups, cards and boxes, with holes and without, beside opaque casters.
#include <fmt/format.h>
#include <gnomon/kit/geometry/exact_scene.h>
#include <gnomon/kit/rays/gbuffer_maker.h>

#include "glass.h"
#include "masked_scenes.h"

namespace gnomon::glass_scenes {

/// Constant or textured; one mesh of three loses its holes, and one of two is not seen by the eye.
inline void make_glass(Mesh& mesh, Random& random) {
  if (random.below(3) == 0) mesh.alpha_mask = nullptr;
  mesh.transmission = random.below(2) ? glass::constant(glm::vec3(glass::any_share(random))) : glass::any_texels(random, 6);
  if (mesh.uv.empty())
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) mesh.uv.push_back(masked_scenes::place_in_eighths(random));
  mesh.seen = random.below(2) != 0;
}

/// masked_scenes::random_scene, of which all but the floor, mesh 1, becomes glass by chance, and soups of glass.
inline Scene random_scene(Random& random, bool on_lattice) {
  Scene scene = masked_scenes::random_scene(random, on_lattice);
  for (std::size_t m = 0; m < scene.meshes.size(); ++m)
    if (m != 1 && random.below(2)) make_glass(scene.meshes[m], random);
  for (std::uint32_t soups = 1 + random.below(3); soups > 0; --soups) {
    Mesh soup = hard_scenes::grid_soup(random, 8);
    if (on_lattice) questions::snap(soup);
    make_glass(soup, random);
    scene.meshes.push_back(std::move(soup));
  }
  return scene;
}

/// What the exact oracle says of a pixel that faces the light.
struct Owed {
  ExactShare found;
  bool is_blocked_by_edge = false;  ///< of an opaque caster, alone
  float visibility() const { return static_cast<float>(found.light.share.x); }
  bool is_blocked() const { return found.light.share.x == 0 && found.light.surfaces == 0; }
};

/// Every other scene is on a lattice; every third pair of scenes is seen by an eye, through holes and glass that it does not
/// see.
struct Question {
  Scene scene;
  Light light;
  hand_made::Picture picture{64, 48};
  GBuffer seen;
  std::vector<std::optional<Owed>> owed;

  Question(int round, Random& random) {
    const bool on_lattice = round % 2 == 0;
    scene = random_scene(random, on_lattice);
    light = questions::hard_light(scene.meshes[0], random);
    View& view = picture.gbuffer.view;
    view.eye = glm::vec3(random.uniform(glm::dvec3(-4, 0.5, -4), glm::dvec3(4, 4, 4)));
    (on_lattice ? questions::scatter_on_lattice : hard_scenes::scatter)(scene, light, random, picture);
    seen = picture.gbuffer;
    if (round / 2 % 3 == 0)
      seen = make_gbuffer(scene, RayScene(scene, Truth::mesh, RayScene::Which::seen), view, 64, 48, Truth::mesh);
    ask();
  }
  Receiver receiver(std::size_t i) const { return receiver_at(scene, seen, i); }
  float visibility(std::size_t i) const { return owed[i] ? owed[i]->visibility() : 1; }
  std::string place(std::size_t i) const {
    const Receiver at = receiver(i);
    return fmt::format("pixel {} of mesh {}, triangle {} at {}, {}, {} should be {}", i, at.mesh, seen.triangle[i], at.point.x,
                       at.point.y, at.point.z, visibility(i));
  }

 private:
  void ask() {
    const ExactScene exact(scene);
    const glm::dvec4 l = homogeneous(light);
    ExactTally tally;
    owed.resize(seen.size());
    for (std::size_t i = 0; i < owed.size(); ++i) {
      if (!faces_light(scene, seen, light, i)) continue;
      owed[i] = {exact.transmitted(receiver(i), l, tally), false};
      if (owed[i]->found.degenerate) owed[i]->is_blocked_by_edge = exact.occluded(receiver(i), l, tally).degenerate;
    }
  }
};

}  // namespace gnomon::glass_scenes
