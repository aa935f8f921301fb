#pragma once
#include <gtest/gtest.h>

#include "device/context.h"
#include "hand_made.h"
#include "small_world.h"

/// Marches over small pictures whose answers are derived on paper.
namespace contact_march_rig {
using namespace gnomon;

/// A technique that answered.
struct Answered {
  std::unique_ptr<Technique> technique;
  std::vector<float> mask;
  std::string cause(std::size_t i) const {
    const auto why = technique->explain(i);
    return why ? why->cause : "not explained";
  }
};

inline Answered answered(const std::string& id, const std::string& settings, const Scene& scene, const Light& light,
                         const GBuffer& gbuffer) {
  Answered a{registry().technique(id).make(), {}};
  a.technique->apply(settings);
  a.technique->setup();
  a.technique->build(scene);
  a.technique->relight(light);
  a.mask = small_world::mask_of(*a.technique, gbuffer);
  return a;
}

/// The march without a partner, `meters` long, and as thick.
inline Answered alone(const Scene& scene, const Light& light, const GBuffer& gbuffer, double meters, double thick_meters,
                      int steps = 4096) {
  const Bounds box = scene.bounds();
  const double diagonal = glm::distance(glm::dvec3(box.min), glm::dvec3(box.max));
  return answered(
      "contact_march",
      fmt::format("partner=unshadowed,length={},thickness={},steps={}", meters / diagonal, thick_meters / meters, steps), scene,
      light, gbuffer);
}

/// The pixel of mesh `mesh` whose point is nearest to `point`.
inline std::size_t pixel_at(const GBuffer& g, std::uint32_t mesh, const glm::vec3& point, double at_most = 0.05) {
  std::size_t best = 0;
  double least = INFINITY;
  for (std::size_t i = 0; i < g.size(); ++i)
    if (const double d = glm::distance(g.position(i), point); g.mesh[i] == mesh && d < least) {
      least = d;
      best = i;
    }
  EXPECT_LT(least, at_most);
  return best;
}

/// A wall at z = -4, mesh 0, seen by an eye at the origin with 90 degrees: the picture is |x|, |y| < -z, so that a point is at
/// x / -z of its half. The sun shines from the right and from the eye's side: a ray from x goes to x + a, -4 + a.
inline Mesh upright(float x0, float x1, float y, float z) {
  return small_world::make_mesh({{x0, -y, z}, {x1, -y, z}, {x1, y, z}, {x0, y, z}}, {{0, 1, 2}, {0, 2, 3}});
}
inline Scene before_a_wall(std::vector<Mesh> more) {
  Scene scene;
  scene.meshes = {upright(-5, 5, 5, -4)};
  scene.meshes.insert(scene.meshes.end(), more.begin(), more.end());
  scene.views = {{.name = "view", .eye = {0, 0, 0}, .target = {0, 0, -1}, .fov_y_degrees = 90}};
  return scene;
}
inline const Light from_the_right = hand_made::sun({-1, 0, -1});
inline GBuffer picture_of(const Scene& scene, int side = 256) {
  return small_world::make_gbuffer(scene, scene.views[0], side, side);
}

/// Of the march alone no pixel needs OpenGL; partners that draw do.
class ContactMarch : public testing::Test {
 protected:
  ContactMarch() { process_context(); }
};

}  // namespace contact_march_rig
