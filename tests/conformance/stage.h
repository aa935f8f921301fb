#pragma once
#include <gnomon/kit/gl.h>
#include <gnomon/kit/rays.h>
#include <gnomon/registry.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "device/context.h"
#include "measure/frame/classify.h"
#include "measure/frame/gbuffer_maker.h"
#include "measure/frame/soft_reference.h"
#include "measure/scene/load.h"

// What every registered technique is asked. A test of `Every` runs once for each of them, under its id.
namespace conformance {
using namespace gnomon;

/// The techniques that say so of themselves. INSTANTIATE_TEST_SUITE_P asks when the tests start, after the roll was called.
inline std::vector<std::string> ids_where(bool (*wanted)(const About&)) {
  std::vector<std::string> ids;
  for (const TechniqueEntry& entry : registry().techniques())
    if (wanted(entry.about)) ids.push_back(entry.id);
  return ids;
}
inline std::vector<std::string> technique_ids() {
  return ids_where([](const About&) { return true; });
}
inline std::string id_of(const testing::TestParamInfo<std::string>& info) { return info.param; }

/// A scene, and what rays say of it under the truth of the geometry that a technique sees.
class World {
 public:
  World(Scene the_scene, Truth the_truth)
      : scene(std::move(the_scene)),
        truth(the_truth),
        everything_(scene, truth, RayScene::Which::all),
        casters_(scene, truth, RayScene::Which::casters) {}
  World(const World&) = delete;

  GBuffer gbuffer(const View& view, int width = 96, int height = 54) const {
    return make_gbuffer(scene, everything_, view, width, height, truth);
  }
  GBuffer gbuffer() const { return gbuffer(scene.views[0]); }

  struct Truthful {
    std::vector<float> mask;
    std::vector<PixelClass> classes;
    std::vector<float> error;  ///< standard errors under a light with area, else empty
  };
  /// Under a light with area the share that the technique estimates.
  Truthful reference(const GBuffer& gbuffer, const Light& light, LightShareKind estimates = LightShareKind::area) const {
    if (has_area(light)) {
      SoftReference soft = trace_soft(scene, casters_, gbuffer, light, {});
      if (estimates == LightShareKind::area) return {soft.area, soft.classes, soft.area_error};
      return {soft.irradiance, soft.classes, soft.irradiance_error};
    }
    Truthful result;
    result.mask.resize(gbuffer.size());
    trace_shadows(casters_, scene, gbuffer, light, result.mask);
    result.classes = classify(scene, casters_, gbuffer, light, result.mask);
    return result;
  }

  const Scene scene;
  const Truth truth;

 private:
  RayScene everything_, casters_;
};

/// The lights of a generated scene, `point` and `sun`, and one of each other kind around the point light.
inline std::vector<Light> lights_of_all_kinds(const Scene& scene) {
  const glm::vec3 high(homogeneous(scene.lights[0])), down = -high;
  std::vector<Light> lights = scene.lights;
  lights.push_back({.name = "spot", .kind = SpotLight{high, down, 8, 16}});
  lights.push_back({.name = "rect", .kind = RectLight{high, {0.5f, 0, 0}, {0, 0, 0.4f}}});
  lights.push_back({.name = "disc", .kind = DiscLight{high, down, 0.5f}});
  lights.push_back({.name = "sphere", .kind = SphereLight{high, 0.5f}});
  return lights;
}

/// A mask that holds nonsense until a technique has written every pixel of it, in memory or in its texture.
inline std::vector<float> resolve(Technique& technique, const GBuffer& gbuffer, bool uses_gl) {
  VisibilityMask mask(gbuffer.width, gbuffer.height);
  const float nonsense = -7;
  if (uses_gl) glClearTexImage(mask.texture(), 0, GL_RED, GL_FLOAT, &nonsense);
  std::ranges::fill(mask.pixels(), nonsense);
  technique.resolve(gbuffer, mask);
  const auto pixels = mask.read();
  return {pixels.begin(), pixels.end()};
}

class Every : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    if (uses_gl()) process_context();
  }

  const TechniqueEntry& entry() const { return registry().technique(GetParam()); }
  bool uses_gl() const { return entry().about.needs_gl; }

  std::unique_ptr<World> world(const std::string& reference) const {
    return std::make_unique<World>(load_scene(reference), entry().about.sees);
  }
  std::unique_ptr<World> world(Scene scene) const { return std::make_unique<World>(std::move(scene), entry().about.sees); }

  /// The answer of a fresh object, as everything else asks: before it runs.
  Support support(const Scene& scene, const Light& light, const std::string& settings = "") const {
    const auto technique = entry().make();
    technique->apply(settings);
    return technique->supports(scene, light, scene.views[0]);
  }
  std::vector<Light> supported_lights(const Scene& scene, const std::string& settings = "") const {
    std::vector<Light> lights = lights_of_all_kinds(scene);
    std::erase_if(lights, [&](const Light& light) { return !support(scene, light, settings); });
    return lights;
  }

  std::unique_ptr<Technique> set_up(const std::string& settings = "") const {
    auto technique = entry().make();
    technique->apply(settings);
    technique->setup();
    return technique;
  }
  std::vector<float> resolve(Technique& technique, const GBuffer& gbuffer) const {
    return conformance::resolve(technique, gbuffer, uses_gl());
  }
  std::vector<float> answer(Technique& technique, const Scene& scene, const Light& light, const GBuffer& gbuffer) const {
    technique.build(scene);
    technique.relight(light);
    return resolve(technique, gbuffer);
  }
  std::vector<float> fresh_answer(const Scene& scene, const Light& light, const GBuffer& gbuffer,
                                  const std::string& settings = "") const {
    return answer(*set_up(settings), scene, light, gbuffer);
  }
};

/// Bit for bit, so that also a NaN equals itself; says where the first difference is.
inline testing::AssertionResult same(const std::vector<float>& a, const std::vector<float>& b) {
  if (a.size() != b.size()) return testing::AssertionFailure() << a.size() << " and " << b.size() << " pixels";
  std::size_t count = 0, first = 0;
  for (std::size_t i = a.size(); i-- > 0;)
    if (std::bit_cast<std::uint32_t>(a[i]) != std::bit_cast<std::uint32_t>(b[i])) ++count, first = i;
  if (count == 0) return testing::AssertionSuccess();
  return testing::AssertionFailure() << count << " pixels differ, the first is " << first << ": " << a[first] << " and "
                                     << b[first];
}

/// Every value is a share of light, and 1 where there is nothing to decide (classes B and F).
inline testing::AssertionResult is_mask(const std::vector<float>& mask, const World& world, const GBuffer& gbuffer,
                                        const Light& light) {
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (!(mask[i] >= 0 && mask[i] <= 1)) return testing::AssertionFailure() << "pixel " << i << " is " << mask[i];
    if (mask[i] != 1 && !faces_light(world.scene, gbuffer, light, i))
      return testing::AssertionFailure() << "pixel " << i << " does not face the light and is " << mask[i] << ", not 1";
  }
  return testing::AssertionSuccess();
}

/// "sun (directional)", for messages.
inline std::string title(const Light& light) { return fmt::format("light {} ({})", light.name, kind_name(light)); }

}  // namespace conformance
