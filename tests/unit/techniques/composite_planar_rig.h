#pragma once
#include <gnomon/kit/geometry/planar_shadow.h>
#include <gnomon/kit/geometry/shapes.h>
#include <gnomon/kit/gl/gl.h>
#include <gnomon/kit/random.h>
#include <gtest/gtest.h>

#include "device/context.h"
#include "measure/conformance/gl_state.h"
#include "shape_world.h"
#include "small_world.h"

extern "C" void gnomon_technique_composite_planar(gnomon::Registry&);

// Analytic composite shadows brought up to masks, and scenes of shapes as rays see them.
namespace composite_rig {
using namespace gnomon;

inline Mesh mesh_of(const Shape& shape, int segments = 24, const std::string& name = "shape") {
  return tessellate(shape, segments, name);
}

/// A level square around a point.
inline Shape level(const glm::vec3& center, float half) { return Plane{center, {half, 0, 0}, {0, 0, half}}; }

struct World : shape_world::ShapeWorld {
  World(Scene the_scene, const View& view, int width = 160, int height = 90)
      : ShapeWorld(std::move(the_scene), view, width, height) {}
  bool faces(const Light& light, std::size_t i) const { return faces_light(scene, gbuffer, light, i); }
};

inline const View view{.eye = {3, 5, 7}, .target = {0, 0.4f, 0}, .fov_y_degrees = 50};

inline const std::vector<Light> lights = {{.name = "point", .kind = PointLight{{1.5f, 5, 0.5f}}},
                                          {.name = "level", .kind = PointLight{{2.5f, 0.9f, 1.3f}}},
                                          {.name = "low", .kind = PointLight{{-2.8f, 0.15f, 2.1f}}},
                                          {.name = "between", .kind = PointLight{{0.3f, 1.1f, -0.2f}}},
                                          {.name = "below", .kind = PointLight{{0.4f, -1.7f, 0.6f}}},
                                          {.name = "spot", .kind = SpotLight{{1, 4, 1}, {-0.2f, -1, -0.2f}, 20, 35}},
                                          {.name = "sun", .kind = DirectionalLight{{0.4f, -1, 0.2f}}},
                                          {.name = "noon", .kind = DirectionalLight{{0, -2, 0}}},
                                          {.name = "evening", .kind = DirectionalLight{{1, -0.08f, 0.3f}}}};

/// One object for all tests, since its shaders cost more than its pictures; every use begins at the defaults and at `build`.
class TestRig : public testing::Test {
 protected:
  static void SetUpTestSuite() { process_context(); }
  static void TearDownTestSuite() { kept().reset(); }
  void TearDown() override { EXPECT_EQ(state_differences(), std::vector<std::string>{}); }

  static std::unique_ptr<Technique> make(const std::string& settings = "") {
    Registry registry;
    gnomon_technique_composite_planar(registry);
    auto technique = registry.techniques()[0].make();
    technique->apply(settings);
    return technique;
  }
  static Technique& technique(const std::string& settings) {
    if (!kept()) kept() = make(), kept()->setup();
    for (Parameter* parameter : kept()->parameters()) parameter->set(parameter->default_text());
    kept()->apply(settings);
    return *kept();
  }
  static Support supports(const Scene& scene, const Light& light, const std::string& settings = "") {
    return make(settings)->supports(scene, light, {});
  }
  static std::string why_not(const Scene& scene, const Light& light, const std::string& settings = "") {
    const Support answer = supports(scene, light, settings);
    EXPECT_EQ(answer.kind(), Support::Kind::unsupported);
    return answer.why();
  }
  static std::vector<float> mask(const Scene& scene, const Light& light, const GBuffer& g, const std::string& settings = "") {
    Technique& t = technique(settings);
    t.build(scene);
    t.relight(light);
    return resolve(g);
  }
  static std::vector<float> mask(const World& world, const Light& light, const std::string& settings = "") {
    return mask(world.scene, light, world.gbuffer, settings);
  }
  /// Of what was built and lit last; so are `explain` and `count`.
  static std::vector<float> resolve(const GBuffer& g) {
    VisibilityMask mask(g.width, g.height);
    kept()->resolve(g, mask);
    const auto pixels = mask.read();
    return {pixels.begin(), pixels.end()};
  }
  static Explanation explain(std::size_t i) { return *kept()->explain(i); }
  static double count(std::string_view name) { return small_world::value(kept()->counts(), name); }

  struct Tally {
    int tested = 0, dark = 0, false_dark = 0, false_lit = 0, not_covered = 0;
  };
  /// Pixels of class T against rays; those that are wrong must be covered to count. What does not face the light is 1, and so
  /// is what is not covered. Asking whether a pixel is covered takes long: every eighth must do where the answer is right.
  static void compare(const World& world, const Light& light, Tally& tally, const std::string& settings = "") {
    const std::vector<float> answer = mask(world, light, settings), reference = world.reference(light);
    const std::vector<PixelClass> classes = world.classes(light, reference);
    for (std::size_t i = 0; i < answer.size(); ++i) {
      if (!world.faces(light, i)) {
        EXPECT_EQ(answer[i], 1) << i;
      }
      if (classes[i] != PixelClass::T) continue;
      const bool is_wrong = answer[i] != reference[i];
      if ((is_wrong || i % 8 == 0) && !explain(i).covered) {
        EXPECT_EQ(answer[i], 1) << i;
        ++tally.not_covered;
        continue;
      }
      ++tally.tested, tally.dark += reference[i] == 0;
      if (is_wrong) ++(answer[i] == 0 ? tally.false_dark : tally.false_lit);
    }
  }

 private:
  static std::unique_ptr<Technique>& kept() {
    static std::unique_ptr<Technique> technique;
    return technique;
  }
};

}  // namespace composite_rig
