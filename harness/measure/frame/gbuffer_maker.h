#pragma once
#include <gnomon/gbuffer.h>
#include <gnomon/kit/rays.h>

namespace gnomon {

/// Primary visibility through pixel centers, on all threads. `everything` holds all meshes under `truth`. Positions are
/// recomputed in double: on a triangle, where the pixel's ray cuts its plane; on a curved shape, on the shape itself.
GBuffer make_gbuffer(const Scene& scene, const RayScene& everything, const View& view, int width, int height, Truth truth);

}  // namespace gnomon
