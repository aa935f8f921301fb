#pragma once
#include "measure/frame/classify.h"

namespace gnomon {

/// How far a rasterizer may move a vertex along x and along y: it rounds to the grid of 1/256 px (8 subpixel bits).
inline constexpr double most_snapping = 1.0 / 512;

/// Of every pixel: 1 where it is of class T and its exact answer is another one when its sample point lies at a corner of the
/// square of +- `most_snapping` around the center, else 0. An edge between two rounded vertices moves by up to that along x and
/// along y, and a straight boundary that such a move takes across the center leaves one of the four corners on its other side.
///
/// The point at a corner is the one that a G-buffer would hold there, and its shadow ray goes by the recipe of the reference. A
/// point that does not face the light has no answer, and none differs from it. `everything` holds all meshes under the truth of
/// the G-buffer; `reference` and `classes` are those of `casters`.
std::vector<std::uint8_t> find_snapping(const Scene& scene, const RayScene& everything, const RayScene& casters,
                                        const GBuffer& gbuffer, const Light& light, std::span<const float> reference,
                                        std::span<const PixelClass> classes);

}  // namespace gnomon
