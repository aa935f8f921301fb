#pragma once
#include <gnomon/kit/rays.h>

#include <array>
#include <string_view>
#include <vector>

namespace gnomon {

/// First match decides; every class is reported, only T is scored in the headline. Classes depend on scene, light, view and
/// truth alone, never on a technique.
enum class PixelClass : std::uint8_t {
  B,  ///< background
  F,  ///< faces away from the light, outside the spot cone, or on a mesh that does not receive
  G,  ///< grazing: 0 < N.l < 0.035 (2 degrees)
  S,  ///< primary silhouette: an 8-neighbor is background or another mesh more than 2 % of the distance nearer or farther
  U,  ///< uncertain: the reference changes when the point or the light moves by 16 * 2^-24 * max(|P|, |L|, extent), or when
      ///< the ray starts at the point itself instead of a ray offset above it
  T,  ///< tested
};
inline constexpr std::array<std::string_view, 6> class_names = {"B", "F", "G", "S", "U", "T"};

/// Class of every pixel. `reference` is the mask of trace_shadows for the same casters.
std::vector<PixelClass> classify(const Scene& scene, const RayScene& casters, const GBuffer& gbuffer, const Light& light,
                                 std::span<const float> reference);

std::array<std::size_t, 6> count_classes(std::span<const PixelClass> classes);

}  // namespace gnomon
