// Masks and references of several lights, put together.
#include "app/viewer/several_lights.h"

#include <gnomon/error.h>

#include <algorithm>

#include "app/viewer/engine.h"
#include "measure/scene/load.h"
#include "measure/scene/names.h"

namespace gnomon::viewer {

std::size_t Frame::chosen() const {
  const auto all = all_lights();
  return static_cast<std::size_t>(std::ranges::find(all, light.name, &Light::name) - all.begin());
}

std::vector<Light> listed_lights(const Scene& scene) {
  std::vector<Light> listed;
  for (const Light& whole : whole_lights(scene.lights)) {
    listed.push_back(whole);
    for (const Light& light : scene.lights)
      if (light.name != whole.name && whole_name(light.name) == whole.name) listed.push_back(light);
  }
  return listed;
}

std::vector<Light> lights_named(const Scene& scene, const std::string& name) {
  const std::vector<Light> listed = listed_lights(scene);
  const Light* found = find_named(listed, name);
  if (!found) found = &named_or_first(listed, std::string(whole_name(name)));
  std::vector<Light> lights;
  for (const Light& light : scene.lights)
    if (light.name == found->name || whole_name(light.name) == found->name) lights.push_back(light);
  return lights;
}

std::vector<Light> lights_of(const Selection& selection) {
  if (selection.together.empty()) return {selection.light};
  std::vector<Light> lights = selection.together;
  for (Light& light : lights) {
    if (whole_name(light.name) != whole_name(selection.light.name)) continue;
    const std::string name = light.name;
    light = selection.light;
    light.name = name;
  }
  return lights;
}

bool is_lit_by(const Frame& frame, const Selection& selection) {
  const auto all = frame.all_lights();
  return frame.light.name == selection.light.name && frame.is_together() == !selection.together.empty() &&
         are_same(all, lights_of(selection));
}

std::string together_word(const Selection& selection, std::size_t all_count) {
  if (selection.together.empty()) return "";
  std::vector<std::string> names;
  for (const Light& whole : whole_lights(selection.together)) {
    std::vector<std::string> own;
    for (const Light& light : selection.together)
      if (whole_name(light.name) == whole.name) own.push_back(light.name);
    if (own.size() == std::size(all_channels)) own = {whole.name};
    names.insert(names.end(), own.begin(), own.end());
  }
  return names.size() > 1 && selection.together.size() == all_count ? "all+" : joined(names, "+");
}

bool are_same(std::span<const Light> a, std::span<const Light> b) {
  return std::ranges::equal(a, b, [](const Light& one, const Light& other) { return are_same(one, other); });
}

std::vector<std::vector<float>> split_masks(std::span<const float> all, std::size_t lights) {
  std::vector<std::vector<float>> masks;
  const std::size_t pixels = all.size() / lights;
  for (std::size_t k = 0; k < lights; ++k) {
    const auto own = all.subspan(k * pixels, pixels);
    masks.emplace_back(own.begin(), own.end());
  }
  return masks;
}

namespace {

/// The masks of a picture.
ShownMasks shown_masks(Together& whole) {
  ShownMasks shown{std::move(whole.shown), {}};
  for (Together& one : whole.channels) shown.channels[static_cast<std::size_t>(*one.channel)] = std::move(one.shown);
  return shown;
}

}  // namespace

ShownMasks shown_together(const Frame& frame, const GBuffer& gbuffer, std::span<const std::vector<float>> masks) {
  const std::vector<PixelClass> any_class(gbuffer.size(), PixelClass::B);
  std::vector<Evidence> lights;
  for (std::size_t k = 0; k < masks.size(); ++k)
    lights.push_back({.width = gbuffer.width,
                      .height = gbuffer.height,
                      .classes = any_class,
                      .reference = masks[k],
                      .mask = masks[k],
                      .causes = {},
                      .gbuffer = &gbuffer,
                      .light = &frame.lights[k]});
  Together whole = together(lights);
  return shown_masks(whole);
}

namespace {

/// One light of a reference as if its mask were that share.
Evidence evidence_of(const Frame& frame, const ReferenceState& reference, LightShareKind estimates, std::size_t k) {
  const ReferenceState& own = *reference.lights[k];
  const bool is_irradiance = estimates == LightShareKind::irradiance && !own.irradiance.empty();
  return {.width = frame.gbuffer.width,
          .height = frame.gbuffer.height,
          .classes = own.classes,
          .reference = share_of(own, estimates),
          .mask = share_of(own, estimates),
          .causes = {},
          .scene = &frame.scene(),
          .gbuffer = &frame.gbuffer,
          .light = &frame.lights[k],
          .reference_error = is_irradiance ? own.irradiance_error : own.error,
          .reference_half = is_irradiance ? own.irradiance_half : own.half,
          .kind = answer_kind(frame.scene(), frame.lights[k])};
}

}  // namespace

void put_together(ReferenceState& reference) {
  const Frame& frame = *reference.frame;
  const auto whole = [&](LightShareKind estimates) {
    std::vector<Evidence> lights;
    for (std::size_t k = 0; k < frame.lights.size(); ++k) lights.push_back(evidence_of(frame, reference, estimates, k));
    return together(lights);
  };
  Together area = whole(LightShareKind::area);
  reference.width = frame.gbuffer.width;
  reference.height = frame.gbuffer.height;
  ShownMasks shown = shown_masks(area);
  reference.mask = std::move(shown.mask);
  reference.channels = std::move(shown.channels);
  reference.error = std::move(area.reference_error);
  reference.half = std::move(area.reference_half);
  reference.classes = std::move(area.classes);
  if (reference.error.empty()) return;  // no light's answer is a fraction
  Together irradiance = whole(LightShareKind::irradiance);
  reference.irradiance = std::move(irradiance.shown);
  reference.irradiance_error = std::move(irradiance.reference_error);
  reference.irradiance_half = std::move(irradiance.reference_half);
}

Evidence evidence_of(const SideAnswer& answer, const ReferenceState& reference, LightShareKind estimates, std::size_t k) {
  Evidence evidence = evidence_of(*answer.frame, reference, estimates, k);
  evidence.mask = answer.masks[k];
  return evidence;
}

std::shared_ptr<const Together> put_together(const SideAnswer& answer, const ReferenceState& reference,
                                             LightShareKind estimates, std::span<const std::vector<Cause>> causes,
                                             std::span<const CauseInfo> own_causes) {
  std::vector<Evidence> lights;
  for (std::size_t k = 0; k < answer.masks.size(); ++k) {
    lights.push_back(evidence_of(answer, reference, estimates, k));
    if (!causes.empty()) lights.back().causes = causes[k];
    lights.back().own_causes = own_causes;
  }
  return std::make_shared<const Together>(together(lights));
}

}  // namespace gnomon::viewer
