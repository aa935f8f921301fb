#pragma once
// What a coordinate may be; and, private to the loaders, what a reference names.
#include <gnomon/scene.h>

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace gnomon {

/// No coordinate, radius or component of a direction is larger, in meters. Embree takes none from 1.844e18 on, and ends the
/// program; a body as far out as it is wide, and an eye that sees all of it, stay below that.
inline constexpr double largest_coordinate = 1e17;
inline constexpr std::string_view coordinate_range = "-1e17 .. 1e17";  ///< the same, for messages
/// Whether all three are finite and within `largest_coordinate`.
bool is_sound(const glm::dvec3& p);

/// Descriptions that are being read, outermost first: each names the next as its `scene`.
using Descriptions = std::vector<std::filesystem::path>;

/// What a reference names, as its generator or file gives it: neither finished nor framed. `above` led here.
Scene read_scene(const std::string& reference, const Descriptions& above);
/// Of a description. Unknown keys are errors with the nearest known one, file and line.
Scene read_scene_toml(const std::filesystem::path& file, const Descriptions& above = {});

/// Whether every fetched file that this scene needs is there; true for what cannot be read, which loading will say.
bool is_fetched(const std::string& reference);

}  // namespace gnomon
