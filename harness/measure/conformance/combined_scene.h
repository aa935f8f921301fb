#pragma once
#include <gnomon/scene.h>

#include <cstdint>

namespace gnomon::conformance {

/// A scene drawn from a seed, the same on every machine: a ground, a block and a ball that stand still, a box that walks, and
/// four cards, of which the first three move or bend and the fourth may. Bits of the seed tell what the cards are:
///   1  the first and the third have holes, an alpha mask each
///   2  the second and the third let parts of the light through, the same everywhere
///   4  with 2: these parts have texels
/// It has three lights, one or two of them with area, of kinds that depend on the seed, and one animation of 4 s. All casters
/// are over the ground and below the lights.
Scene combined_scene(std::uint64_t seed);

}  // namespace gnomon::conformance
