#include <gnomon/kit/inner_technique.h>
#include <gnomon/kit/shapes.h>

namespace gnomon {

std::vector<std::string> InnerTechnique::ids() const {
  std::vector<std::string> all;
  for (const TechniqueEntry& entry : registry().techniques())
    if (!entry.about.named_only && why_not_(entry).empty()) all.push_back(entry.id);
  return all;
}

std::string InnerTechnique::objection(std::string_view id) const {
  const TechniqueEntry* const entry = registry().find_technique(id);
  return entry ? why_not_(*entry) : fmt::format("did you mean {}?", nearest_word(id, ids()));
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

std::string has_no_hard_shadow(const TechniqueEntry& entry) {
  static const Scene scene = triangle_over_ground();
  const glm::vec3 above(0, 4, 0);
  const auto technique = entry.make();
  const auto supports = [&](const LightKind& kind) {
    return bool(technique->supports(scene, {.name = "light", .kind = kind}, scene.views[0]));
  };
  const bool is_soft_only =
      supports(RectLight{.center = above}) && !supports(PointLight{above}) && !supports(DirectionalLight{});
  return is_soft_only ? fmt::format("{} is for lights with area only", entry.id) : "";
}

}  // namespace gnomon
