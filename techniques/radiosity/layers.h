#pragma once
#include <gnomon/technique.h>

#include <functional>

#include "lighting.h"

namespace gnomon::radiosity {

/// Where a pixel looks: an undivided element, the side of it that the eye sees, and the place on its face. Nothing where there
/// is no surface.
struct Found {
  std::uint32_t element;
  int side;
  glm::dvec2 place;
};
using Look = std::function<std::optional<Found>(std::size_t pixel)>;

std::vector<DebugLayer> layers();

// Pictures: width * height * 3 floats, linear RGB in 0 .. 1.

/// A tone for each patch, darker lines around patches.
std::vector<float> paint_patches(const GBuffer& gbuffer, const Lighting& lighting, const Look& look);
/// How often patches were divided.
std::vector<float> paint_subdivision(const GBuffer& gbuffer, const Lighting& lighting, const Look& look);
/// Light that patches have not handed on, in the color that it has, white where it is the most.
std::vector<float> paint_unshot(const GBuffer& gbuffer, const Lighting& lighting, const Look& look);
/// What of the picked patch's light goes to each patch: heat of form factors; the picked patch is white.
std::vector<float> paint_form_factors(const GBuffer& gbuffer, const Lighting& lighting, const Look& look, const Found& picked,
                                      const Surfaces& surfaces);
/// The hemicube on the picked patch, unfolded, in the middle of the picture; the albedo of what it sees, patch by patch.
std::vector<float> paint_hemicube(const GBuffer& gbuffer, const Lighting& lighting, const Found& picked, const Scene& scene,
                                  Hemicube& hemicube, int resolution);

}  // namespace gnomon::radiosity
