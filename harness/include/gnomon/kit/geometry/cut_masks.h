#pragma once
#include <gnomon/changes.h>
#include <gnomon/kit/bytes.h>
#include <gnomon/scene.h>

#include <memory>
#include <utility>
#include <vector>

namespace gnomon {

// Casters with holes as polygons, for techniques that handle no other casters. The solid texels before a triangle become
// rectangles, row by row and merged downwards; what of them lies in the triangle becomes triangles of the world, its pieces.
//
// Neighboring rectangles share the corners on their common edge, so that no light leaks between two pieces of a triangle. Two
// triangles of a card share the corners on their edge, too, where the same rows and columns of the mask cross both. Corners are
// computed in double and rounded to float32: an edge of a hole so moves by 2^-24 of a coordinate at most, which is far below
// what texel_rounding allows.

/// How many pieces the casting triangles with alpha masks of a scene make.
struct CutCount {
  std::size_t pieces = 0;
  bool is_more = false;  ///< counting was given up: there are more
};
/// Counts without a triangle of the world made. Gives up at a triangle with more than `most` pieces, and where more than 2^28
/// texels would have to be read.
CutCount cut_count(const Scene& scene, std::size_t most);

/// A scene for a technique that sees triangles without holes. Where casters have alpha masks, each of their meshes stays where
/// it is, without the mask and no longer casting, so that the numbers of meshes and triangles stay those of the G-buffer; and
/// behind all meshes there is for each one that casts what it was, with its pieces as triangles. Any other scene is taken as it
/// is, without a copy.
class CutMasks {
 public:
  /// How surfaces with holes are drawn: as the triangles that they had; or as the pieces, for a technique that draws the depth
  /// of the scene itself. The old triangles are then points.
  enum class Drawn { triangles, pieces };

  CutMasks() = default;
  /// The scene as it is, with or without masks; it outlives this object.
  explicit CutMasks(const Scene& scene) : original_(&scene) {}
  /// Throws Error where there are more than `most` pieces.
  CutMasks(const Scene& scene, std::size_t most, Drawn drawn = Drawn::triangles);
  /// Follows a scene that moved. Returns false, and does nothing, where what is cut moved: it is to be cut anew.
  bool follow(const Changes& changes);

  const Scene& scene() const { return cut_ ? *cut_ : *original_; }
  /// The scene that it was made of.
  const Scene& original() const { return *original_; }
  bool is_cut() const { return cut_ != nullptr; }

  // Triangles are counted over the scene, mesh after mesh. Those of the original come first and keep their numbers.

  std::uint32_t first_piece() const { return first_piece_; }
  bool is_piece(std::uint32_t number) const { return number >= first_piece_; }
  /// The triangle that a piece was cut out of; any other triangle itself. What never shades a point of that triangle and what
  /// lies in its plane is decided by it: a piece's own plane is rounded.
  std::uint32_t source(std::uint32_t number) const { return is_piece(number) ? sources_[number - first_piece_] : number; }
  /// The numbers of a triangle's pieces, from first to before second.
  std::pair<std::uint32_t, std::uint32_t> pieces_of(std::uint32_t source) const;
  std::size_t piece_count() const { return sources_.size(); }
  std::size_t bytes() const;

 private:
  const Scene* original_ = nullptr;
  std::unique_ptr<Scene> cut_;  ///< null where nothing is cut
  std::uint32_t first_piece_ = 0xffffffffu;
  std::vector<std::uint32_t> sources_;  ///< of each piece, rising
};

/// Whether a mesh casts with holes.
inline bool casts_with_holes(const Mesh& mesh) { return mesh.casts && mesh.alpha_mask; }

}  // namespace gnomon
