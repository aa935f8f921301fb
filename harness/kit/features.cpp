#include <gnomon/error.h>
#include <gnomon/technique.h>

#include <algorithm>

namespace gnomon {

namespace {

struct FeatureRow {
  Feature feature;
  std::string_view name, what;  ///< what a scene has that has it
};
constexpr FeatureRow rows[] = {
    {Feature::alpha_masks, "alpha_masks", "casters with holes (alpha masks)"},
    {Feature::transmission, "transmission", "casters that let a part of the light through (transmission)"}};
constexpr Feature features[] = {Feature::alpha_masks, Feature::transmission};

}  // namespace

std::string_view name(Feature feature) { return rows[static_cast<int>(feature)].name; }

std::optional<Feature> feature_named(std::string_view name) {
  for (const FeatureRow& row : rows)
    if (row.name == name) return row.feature;
  return std::nullopt;
}

std::span<const Feature> all_features() { return features; }

std::vector<Feature> features_of(const Scene& scene) {
  const auto has_holes = [](const Mesh& mesh) { return mesh.casts && mesh.alpha_mask; };
  std::vector<Feature> features;
  if (std::ranges::any_of(scene.meshes, has_holes)) features.push_back(Feature::alpha_masks);
  if (scene.has_transmission()) features.push_back(Feature::transmission);
  return features;
}

Support support_of(const About& about, const Technique& technique, const Scene& scene, const Light& light, const View& view) {
  for (const Feature feature : features_of(scene))
    if (std::ranges::find(about.handles, feature) == about.handles.end())
      return Support::unsupported(fmt::format("the scene has {}, and {} does not state that it handles {}",
                                              rows[static_cast<int>(feature)].what, technique.id(), name(feature)));
  if (scene.has_colored_transmission())
    return Support::unsupported("the scene's glass colors the light; a technique is asked about one channel at a time");
  return technique.supports(scene, light, view);
}

}  // namespace gnomon
