#include "measure/conformance/world.h"

#include <gnomon/registry.h>

#include "measure/frame/soft_reference.h"
#include "measure/scene/load.h"

namespace gnomon::conformance {

Scene generated_scene(const std::string& reference) {
  const std::string id = reference.substr(0, reference.find(':'));
  if (!registry().find_scene(id))
    throw CannotAsk("the generated scene {} is missing: this program was built without it, and rules are asked there", id);
  return load_scene(reference);
}

World::World(Scene the_scene, Truth the_truth)
    : scene(std::move(the_scene)),
      truth(the_truth),
      everything_(scene, truth, RayScene::Which::all),
      casters_(scene, truth, RayScene::Which::casters) {}

GBuffer World::gbuffer(const View& view, int width, int height) const {
  return make_gbuffer(scene, everything_, view, width, height, truth);
}

World::Truthful World::reference(const GBuffer& gbuffer, const Light& light, LightShareKind estimates) const {
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

std::vector<Light> lights_of_all_kinds(const Scene& scene) {
  const glm::vec3 high(homogeneous(scene.lights[0])), down = -high;
  std::vector<Light> lights = scene.lights;
  lights.push_back({.name = "spot", .kind = SpotLight{high, down, 8, 16}});
  lights.push_back({.name = "rect", .kind = RectLight{high, {0.5f, 0, 0}, {0, 0, 0.4f}}});
  lights.push_back({.name = "disc", .kind = DiscLight{high, down, 0.5f}});
  lights.push_back({.name = "sphere", .kind = SphereLight{high, 0.5f}});
  return lights;
}

std::string title(const Light& light) { return fmt::format("{} ({})", light.name, kind_name(light)); }

}  // namespace gnomon::conformance
