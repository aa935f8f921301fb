#include <fmt/format.h>
#include <gnomon/kit/maps/bias_presets.h>

#include <numbers>

namespace gnomon {

namespace {

using Slope = BiasForm::Slope;
using Normal = BiasForm::Normal;
constexpr double diagonal_of_texel = std::numbers::sqrt2;

constexpr BiasPreset presets[] = {
    // Depth along the axis is taken for depth along the ray. The sign depends on the face: those that face away from the light
    // are moved away from it, and no mask has an answer for them.
    {.name = "oriented",
     .source = "Fatnassi 2023: 2 mm toward the light; the slope factor of 1 that drawing keeps is told by others",
     .form = {.slope = Slope::raster},
     .directional = BiasNumbers{.meters = 0.002, .slope = 1},
     .spot = BiasNumbers{.meters = 0.002, .slope = 1},
     .point = BiasNumbers{.meters = 0.002, .slope = 1}},
    // shadow_bias / 100 meters; shadow_normal_bias texels, less what of them lies along the ray. Its factor for the slope is 1
    // on all faces that look to the light.
    {.name = "godot",
     .source = "Godot 4, forward renderer, first split: shadow_bias 0.1, shadow_normal_bias 1",
     .form = {.normal = Normal::across},
     .directional = BiasNumbers{.meters = 0.001, .normal = 1},
     .missing = "its spot lights have biases in shares of their range, its point lights in shares of an atlas"},
    // Casters are moved away from the light and inward: on their own faces that is the receiver's shift the other way.
    {.name = "unity",
     .source = "Unity 6, Universal Render Pipeline, hard shadows: depth bias 1, normal bias 1",
     .form = {.normal = Normal::one_less_cosine},
     .directional = BiasNumbers{.texels = 1, .normal = 1},
     .missing = "its other lights have biases in texels at their range"},
    // 10 half texels, times the light's shadow bias of 0.5; 3 times 0.5 of that for the slope, which is cut off at 1.
    {.name = "unreal",
     .source = "Unreal Engine 5, cascades: r.Shadow.CSMDepthBias 10, r.Shadow.CSMSlopeScaleDepthBias 3, both of the light 0.5",
     .form = {.slope = Slope::tangent},
     .directional = BiasNumbers{.texels = 2.5, .slope = 3.75},
     .missing = "its other lights have biases in shares of their depth range"},
    {.name = "bevy",
     .source =
         "Bevy 0.16: shadow_depth_bias 0.02 m, of point lights 0.08 m; shadow_normal_bias 1.8, of point lights 0.6, times "
         "a texel's diagonal",
     .form = {.normal = Normal::whole},
     .directional = BiasNumbers{.meters = 0.02, .normal = 1.8 * diagonal_of_texel},
     .spot = BiasNumbers{.meters = 0.02, .normal = 1.8 * diagonal_of_texel},
     .point = BiasNumbers{.meters = 0.08, .normal = 0.6 * diagonal_of_texel}},
    // The constant of the polygon offset is half a step of float32 depth: nothing.
    {.name = "filament",
     .source = "Filament 1.5x: constantBias 1 mm, normalBias 1, polygonOffsetSlope 2",
     .form = {.slope = Slope::raster, .normal = Normal::sine},
     .directional = BiasNumbers{.meters = 0.001, .slope = 2, .normal = 1},
     .spot = BiasNumbers{.meters = 0.001, .slope = 2, .normal = 1},
     .point = BiasNumbers{.meters = 0.001, .slope = 2, .normal = 1}},
    {.name = "three_js",
     .source = "three.js r187: bias 0, normalBias 0; it draws faces turned away from the light, faces=back draws those, too",
     .directional = BiasNumbers{},
     .spot = BiasNumbers{},
     .point = BiasNumbers{}}};

}  // namespace

std::optional<BiasNumbers> BiasPreset::numbers(const Light& light) const {
  if (std::holds_alternative<DirectionalLight>(light.kind)) return directional;
  if (std::holds_alternative<SpotLight>(light.kind)) return spot;
  if (std::holds_alternative<PointLight>(light.kind)) return point;
  return std::nullopt;
}

std::optional<std::string> BiasPreset::refusal(const Light& light, double diagonal) const {
  const std::optional<BiasNumbers> found = numbers(light);
  if (!found)
    return fmt::format("bias={} has no number for a {} light: {}", name, kind_name(light),
                       missing.empty() ? "a shadow map has one center" : missing);
  if (found->meters > diagonal && diagonal > 0)
    return fmt::format("bias={} is {} m toward the light, longer than the scene, whose diagonal is {:.3g} m", name,
                       found->meters, diagonal);
  return std::nullopt;
}

std::span<const BiasPreset> bias_presets() { return presets; }

}  // namespace gnomon
