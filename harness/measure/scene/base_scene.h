#pragma once
// What a coordinate may be; and, private to the loaders, what a reference names.
#include <gnomon/scene.h>

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace gnomon {

/// No coordinate or radius is larger, in meters. Embree takes none from 1.844e18 on, and ends the program; a body as far out as
/// it is wide, and an eye that sees all of it, stay below that limit.
inline constexpr double largest_coordinate = 1e17;
inline constexpr std::string_view coordinate_range = "-1e17 .. 1e17";  ///< the same, for messages
/// Whether all three are finite and within `largest_coordinate`.
bool is_sound(const glm::dvec3& p);

/// No place in an alpha mask is farther from its corner, in images: a mask of 16384 texels then has 2^34 columns.
inline constexpr double largest_uv = 1 << 20;
inline constexpr std::string_view uv_range = "-1048576 .. 1048576";  ///< the same, for messages
/// Whether both are finite and within `largest_uv`.
bool is_sound_uv(const glm::vec2& uv);

/// The direction at a length whose squares and cubes stay far within float32. One whose largest component lies in 1e-6 .. 1e6
/// is as it was; another is divided by the power of ten that brings it to 1 .. 10, so that 1e-38 times [-1, -3, -1] is [-1, -3,
/// -1]. Zero and what is not finite stay so.
glm::dvec3 usable_direction(const glm::dvec3& v);

/// Descriptions that are being read, outermost first: each names the next as its `scene`.
using Descriptions = std::vector<std::filesystem::path>;

/// Reads what a reference names, posed where it has a time: neither finished nor framed. `above` are the descriptions that led
/// here.
Scene read_scene(const std::string& reference, const Descriptions& above);
/// Reads a description. An unknown key is an Error with the nearest valid key, file and line.
Scene read_scene_toml(const std::filesystem::path& file, const Descriptions& above = {});

/// The description of this scene, which has no time: the file that it names, else the one of an id, there or not.
std::filesystem::path described_in(const std::string& scene);
/// No scene starts from more, each of which names the next.
inline constexpr std::size_t most_descriptions = 64;
/// Opens names of files of fetched scenes in descriptions.
inline constexpr std::string_view cache_prefix = "cache:";
/// The file that a description calls `name`: relative to the description; `cache:` opens a path of a fetched scene, whose
/// first folder is the scene's id. Throws SceneNotFetched where that is missing.
std::filesystem::path described_file(const std::string& name, const std::filesystem::path& description);
/// The reference as the program takes it, independent of the folder that contains its description.
std::string seen_from_here(const std::string& reference, const std::filesystem::path& description);

/// Whether every fetched file that this scene needs is there; true for what cannot be read, which loading reports.
bool is_fetched(const std::string& reference);

}  // namespace gnomon
