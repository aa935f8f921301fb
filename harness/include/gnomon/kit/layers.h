#pragma once
#include <gnomon/gbuffer.h>
#include <gnomon/technique.h>

#include <span>
#include <vector>

namespace gnomon {

// Pictures of debug layers: width * height * 3 floats, linear RGB in 0 .. 1.

/// The scene in muted colors, shaded by the light and darkened where the mask is dark: what other things are drawn over.
std::vector<float> shaded_layer(const Scene& scene, const GBuffer& gbuffer, const Light& light, std::span<const float> mask);

/// Values as colors over a dim picture of the scene: 0 is left as it is, then from dark blue over green to yellow at the
/// largest value; negative values are red. A value has one color all over the picture, and values 1, 2, 3 ... look like steps:
/// even ones where the largest is small, smaller and smaller ones where it is large. The background is dark gray unless it has
/// a value. Values are finite.
std::vector<float> heat_layer(const GBuffer& gbuffer, std::span<const float> values);

/// Faces of shadow volumes between the eye and the surface of one pixel.
struct VolumeFaces {
  float front_sides = 0;  ///< side quads turned to the eye: they are entered here
  float back_sides = 0;   ///< turned away: they are left here
  float light_caps = 0, dark_caps = 0;
};
/// Translucent faces over a picture: front sides orange, back sides blue, light caps yellow, dark caps violet. Every face hides
/// a fifth of what is left of the picture; the order of faces along a ray is not asked.
void paint_volumes(std::span<const VolumeFaces> faces, std::span<float> picture);

}  // namespace gnomon
