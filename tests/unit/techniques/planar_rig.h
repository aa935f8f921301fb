#pragma once
// Planar projected shadows brought up on small scenes, and what rays in double say about them.
#include <gnomon/kit/gl/gl.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>

#include "device/context.h"
#include "measure/conformance/gl_state.h"
#include "small_world.h"

extern "C" void gnomon_technique_planar_projected(gnomon::Registry&);

namespace planar_rig {
using namespace gnomon;
using small_world::make_mesh;

class PlanarProjected : public testing::Test {
 protected:
  PlanarProjected() { process_context(); }
  void TearDown() override { EXPECT_EQ(state_differences(), std::vector<std::string>{}); }

  static small_world::Run run(const Scene& scene, const Light& light, const GBuffer& g, const std::string& settings = "") {
    return small_world::run(gnomon_technique_planar_projected, settings, scene, light, g);
  }
  static Support supports(const Scene& scene, const Light& light) {
    Registry registry;
    gnomon_technique_planar_projected(registry);
    return registry.techniques()[0].make()->supports(scene, light, {});
  }
};

inline const View view{.eye = {3, 5, 6}, .target = {0, 0.3f, 0}};

/// A horizontal rectangle that casts and does not receive.
inline Mesh plate(float x0, float x1, float z0, float z1, float height) {
  return make_mesh({{x0, height, z0}, {x0, height, z1}, {x1, height, z1}, {x1, height, z0}}, {{0, 1, 2}, {0, 2, 3}}, true,
                   false);
}
/// A rectangle of the plane across the x axis, the same way.
inline Mesh screen(float x, float y0, float y1, float z0, float z1) {
  return make_mesh({{x, y0, z0}, {x, y0, z1}, {x, y1, z1}, {x, y1, z0}}, {{0, 1, 2}, {0, 2, 3}}, true, false);
}

/// Whether a point is dark.
using Question = std::function<bool(const glm::dvec3&)>;

/// Whether the answer changes when the pixel's sample point moves by `pixels` on the screen, on the plane of the pixel.
inline bool near_edge(const Question& is_dark, const GBuffer& g, std::size_t i, double pixels) {
  const glm::dvec3 eye = g.view.eye, forward = glm::normalize(glm::dvec3(g.view.target) - eye);
  const glm::dvec3 right = glm::normalize(glm::cross(forward, glm::dvec3(g.view.up))), up = glm::cross(right, forward);
  const double step = 2 * std::tan(glm::radians(double(g.view.fov_y_degrees)) / 2) / g.height * pixels;
  const glm::dvec3 point = g.position(i), normal = g.normal(i);
  const glm::dvec3 ray = (point - eye) / glm::dot(point - eye, forward);
  const bool here = is_dark(point);
  for (int k = 0; k < 16; ++k) {
    const glm::dvec3 turned = ray + (right * std::cos(k * 0.3927) + up * std::sin(k * 0.3927)) * step;
    if (is_dark(eye + turned * (glm::dot(normal, point - eye) / glm::dot(normal, turned))) != here) return true;
  }
  return false;
}

inline Question by_rays(const Scene& scene, const Light& light) {
  return [&](const glm::dvec3& point) { return small_world::caster_distance(scene, light, point) < INFINITY; };
}

/// How a mask compares with rays on the pixels that face the light by more than a degree.
struct Agreement {
  int tested = 0, dark = 0, wrong = 0, far_from_edge = 0;
  /// Adds one picture. The mask must be 0 or 1, and 1 where the light is not faced.
  void add(const Scene& scene, const Light& light, const GBuffer& g, const std::vector<float>& mask) {
    const Question is_dark = by_rays(scene, light);
    for (std::size_t i = 0; i < g.size(); ++i) {
      EXPECT_TRUE(mask[i] == 0 || mask[i] == 1) << mask[i];
      if (!faces_light(scene, g, light, i)) {
        EXPECT_EQ(mask[i], 1);
        continue;
      }
      const glm::dvec3 to = glm::normalize(to_light(homogeneous(light), g.position(i)));
      if (glm::dot(to, glm::dvec3(g.normal(i))) < 0.02) continue;  // rounding of the point may reach its own triangle
      const bool reference = is_dark(g.position(i));
      ++tested;
      dark += reference;
      if (reference == (mask[i] == 0)) continue;
      ++wrong;
      far_from_edge += !near_edge(is_dark, g, i, 0.01);
    }
  }
  /// Nothing is wrong but where the rasterizer rounds.
  void expect(int least_dark) const {
    EXPECT_GE(dark, least_dark);
    EXPECT_LE(wrong, 2 + tested / 2000);
    EXPECT_EQ(far_from_edge, 0);
  }
};

/// Compares the pixels of mesh 0 that are no nearer than a millimeter to an edge with an answer worked out on paper; returns
/// how many are dark.
inline int expect_on_ground(const GBuffer& g, const std::vector<float>& mask,
                            const std::function<double(double x, double z)>& answer) {
  int dark = 0;
  for (std::size_t i = 0; i < g.size(); ++i) {
    if (g.is_background(i) || g.mesh[i] != 0) continue;
    const double x = g.px[i], z = g.pz[i], here = answer(x, z), e = 1e-3;
    if (answer(x + e, z) != here || answer(x - e, z) != here || answer(x, z + e) != here || answer(x, z - e) != here) continue;
    EXPECT_EQ(mask[i], here) << x << ' ' << z;
    dark += here < 1;
  }
  return dark;
}

}  // namespace planar_rig
