#pragma once
// Private to the importer: places the vertices of one mesh of a file, and makes one of those that are at one place.
#include <limits>
#include <string_view>

#include "measure/scene/import.h"

namespace gnomon::importing {

/// How far numbers reach, and whether steps between those that float32 keeps can be seen.
struct Reach {
  double farthest = 0;
  glm::dvec3 low{std::numeric_limits<double>::max()}, high{std::numeric_limits<double>::lowest()};
  bool is_float = true;  ///< whether all are numbers of float32 already
  void add(const glm::dvec3& p);
  double step() const { return farthest * std::numeric_limits<float>::epsilon() / 2; }
  bool is_coarse() const;
};

/// Counts for the scene's notes, over all meshes of a file.
struct NoteCounts {
  std::size_t short_faces = 0, self_crossing_polygons = 0;  ///< left out, split as fans
  std::size_t textured = 0, transparent = 0;                ///< triangles
  std::size_t odd_colors = 0;                               ///< meshes
  std::size_t masked_glass = 0;                             ///< meshes, by what a description says of their file
  Reach raw, placed;
};

/// Which vertices of a file became which of a mesh.
struct Welded {
  std::vector<std::uint32_t> places;   ///< of each vertex of the file, in the mesh; only those that faces use have one
  std::vector<std::uint32_t> sources;  ///< of each vertex of the mesh, the first of the file that is it
};

/// Places the vertices that faces use, and welds them: readers may repeat a vertex for every face; one position becomes one
/// vertex again. Two differ all the same where the mesh needs their places in an image and these differ, or where `rig`, null
/// or of the vertices of the file, lets them part. Fills `positions` and `uv` of the mesh. `hint` ends errors of places in an
/// image. Throws Error, which opens with `where`: "FILE: mesh 'leaf'".
Welded place_vertices(const std::string& where, const ImportedMesh& raw, const glm::dmat4& place, const Placement& placement,
                      const Rig* rig, std::string_view hint, NoteCounts& counts, Mesh& mesh);

}  // namespace gnomon::importing
