#pragma once
#include <gnomon/technique.h>

namespace gnomon {

/// A surface detail as bytes, for the way from a worker to its owner.
std::vector<std::byte> detail_bytes(const SurfaceDetail& detail);
/// The inverse. Throws Error on bytes of another layout.
SurfaceDetail detail_from_bytes(std::span<const std::byte> bytes);

/// How the first line of all these files begins.
inline constexpr std::string_view detail_mark = "# Surface detail";

/// A surface detail as a Wavefront OBJ: one object for each mesh that has polygons, in it first the lit polygons, then
/// those in the penumbra and the shadowed ones, as faces of the materials `lit`, `penumbra` and `shadowed` of the library
/// `mtl_name`. Coordinates have ten significant digits, and corners of a mesh that are written alike are one vertex. Polygons
/// of which fewer than three corners are left so are left out. The file begins with `notes`, one comment each, and the counts
/// of polygons. The detail fits the scene: see check_detail.
std::string detail_obj(const Scene& scene, const SurfaceDetail& detail, std::span<const std::string> notes,
                       const std::string& mtl_name);

/// The materials of all these files, in the colors of the debug layer `fragments`.
std::string detail_mtl();

}  // namespace gnomon
