#pragma once
#include <gnomon/kit/camera.h>

#include <span>

#include "measure/frame/classify.h"

namespace gnomon {

/// Square meters that pixel i covers on the plane through its point, across its normal: the exact area of the quadrilateral
/// that the pixel's four corner rays cut out. 0 for background, and for a pixel so flat to the eye's ray that the distance to
/// the plane more than triples from the nearest to the farthest corner: what it covers is not what its center shows.
/// `camera` is that of the G-buffer.
double pixel_area(const Camera& camera, const GBuffer& gbuffer, std::size_t i);

/// Square meters of surface in cast shadow: the area of every pixel of T times 1 - its visibility.
double shadow_area(const GBuffer& gbuffer, std::span<const PixelClass> classes, std::span<const float> mask);

}  // namespace gnomon
