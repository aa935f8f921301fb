#include <gnomon/kit/bases/inner_technique.h>
#include <gnomon/kit/geometry/shapes.h>

#include <algorithm>

namespace gnomon {

std::vector<std::string> InnerTechnique::ids() const {
  std::vector<std::string> all;
  for (const TechniqueEntry& entry : registry().techniques())
    if (!entry.about.named_only && why_not(entry).empty()) all.push_back(entry.id);
  return all;
}

std::string InnerTechnique::objection(std::string_view id) const {
  const TechniqueEntry* const entry = registry().find_technique(id);
  return entry ? why_not(*entry) : fmt::format("did you mean {}?", nearest_word(id, ids()));
}

std::string InnerTechnique::why_not(const TechniqueEntry& entry) const {
  if (entry.about.remembers)
    return fmt::format("{} remembers frames, and within another technique it has no sequence", entry.id);
  if (entry.about.device == Device::vulkan)
    return fmt::format("{} needs Vulkan, and a technique within another one has the processor and OpenGL", entry.id);
  return why_not_(entry);
}

namespace {

/// A triangle over a ground, both with their exact shapes: every technique can do it.
Scene triangle_over_ground() {
  Scene scene;
  scene.name = "triangle_over_ground";
  scene.meshes.push_back(tessellate(Plane{.center = {0, 0, 0}, .half_u = {2, 0, 0}, .half_v = {0, 0, -2}}, 3, "ground"));
  scene.meshes.push_back(tessellate(Triangle{{{-1, 1, -1}, {1, 1, -1}, {0, 1, 1}}}, 3, "triangle"));
  scene.views = {{.name = "view", .eye = {0, 2, 6}}};
  return scene;
}

}  // namespace

std::vector<std::string_view> known_lights(const TechniqueEntry& entry) {
  if (!entry.about.lights.empty()) return {entry.about.lights.begin(), entry.about.lights.end()};
  static const Scene scene = triangle_over_ground();
  const glm::vec3 above(0, 4, 0);
  const LightKind kinds[] = {PointLight{above},          SpotLight{.position = above}, DirectionalLight{},
                             RectLight{.center = above}, DiscLight{.center = above},   SphereLight{.center = above}};
  const auto technique = entry.make();
  std::vector<std::string_view> known;
  for (const LightKind& kind : kinds) {
    const Light light{.name = "light", .kind = kind};
    if (technique->supports(scene, light, scene.views[0])) known.push_back(kind_name(light));
  }
  return known;
}

std::string has_no_hard_shadow(const TechniqueEntry& entry) {
  const std::vector<std::string_view> lights = known_lights(entry);
  const auto has = [&](std::string_view kind) { return std::ranges::find(lights, kind) != lights.end(); };
  const bool is_soft_only = has("rect") && !has("point") && !has("directional");
  return is_soft_only ? fmt::format("{} is for lights with area only", entry.id) : "";
}

}  // namespace gnomon
