#pragma once
#include <gnomon/changes.h>

#include "measure/json.h"

namespace gnomon {

/// What moved, as a program reads it: for each mesh that moved, in their order, {"mesh", "kind", "first", "count", "before",
/// "after"} and of a rigid one "matrix". `first` counts in the scene's array `position`. Bounds are their two corners, the
/// least first; a matrix is its rows. Throws Error where there are not as many changes as meshes.
Json changes_json(const Scene& scene, const Changes& changes);

}  // namespace gnomon
