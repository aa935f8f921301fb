#pragma once
#include <gnomon/technique.h>

namespace gnomon {

// Pictures of debug layers: width * height * 3 floats, linear RGB in 0 .. 1.

/// The scene in muted colors, shaded by the cosine of the light's incidence and darkened where the mask is dark: what other
/// things are drawn over.
std::vector<float> shaded_layer(const Scene& scene, const GBuffer& gbuffer, const Light& light, std::span<const float> mask);

/// One color of it: a point of a mesh with its unit normal on the eye's side, and what the mask says.
glm::vec3 shaded_color(const Mesh& mesh, const Light& light, const glm::dvec3& point, const glm::dvec3& normal,
                       float visibility);

/// Where a layer shows no surface: dark gray.
glm::vec3 background_color();

/// Values as colors over a dim picture of the scene: 0 is left as it is, negative values are red, and the rest has the color of
/// its class: 1, 2, 3, 4, 5-8, 9-16 and so on to 129-256, 257 and more; each is lighter than the one before, from dark blue to
/// yellow; the first few differ in hue. A value has one color in all pictures. Values are finite; one that is not whole has the
/// class of its rounded value, above 0 that of 1 at least. The background is dark gray unless it has a value.
std::vector<float> heat_layer(const GBuffer& gbuffer, std::span<const float> values);

/// The classes of `heat_layer`, smallest first; without the negative values.
std::vector<Swatch> heat_legend();
/// The color of negative values there.
glm::dvec3 negative_heat();

/// A debug layer of `heat_layer`, whose sentence ends with how to read it.
inline DebugLayer heat_debug_layer(std::string name, const std::string& what) {
  return {std::move(name), what + ": none where the picture is left gray, else colors as in the legend.", heat_legend()};
}

/// Faces of shadow volumes between the eye and the surface of one pixel.
struct VolumeFaces {
  float front_sides = 0;  ///< side quads turned to the eye: they are entered here
  float back_sides = 0;   ///< turned away: they are left here
  float light_caps = 0, dark_caps = 0;
};
/// The debug layers `volumes` (faces painted over the picture) and `counts` (heat of the count at each pixel).
std::vector<DebugLayer> volume_layers();

/// Faces over a picture that is `width` pixels wide, whatever their order along the rays. Sides are translucent: front sides
/// orange, back sides teal; every one hides a quarter of what is left of the picture. Caps are hatching, so that they hide
/// little of the picture: light caps yellow lines that rise to the right, dark caps violet ones that fall; one cap is a line
/// that hides half.
void paint_volumes(std::span<const VolumeFaces> faces, int width, std::span<float> picture);

}  // namespace gnomon
