#pragma once
#include <gnomon/technique.h>

#include "map.h"

namespace gnomon::two_pass_object {

/// The polygons of a map, by clipping its cells once more, now without a margin and for the dark parts too. `merge`: a triangle
/// that is lit, or dark, throughout is one polygon.
SurfaceDetail make_detail(const Scene& scene, const Triangles& triangles, const LightMap& map, bool merge);

}  // namespace gnomon::two_pass_object
