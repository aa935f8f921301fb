#pragma once
#include <gnomon/kit/geometry/box_tree.h>

namespace gnomon {

/// How far a tree over the triangles of a mesh has decayed that is refitted and into which nobody can look. Small trees of our
/// own over runs of neighbors, spread over the whole mesh, are refitted with it and stand for its lower levels, where nearly
/// all boxes are. Of a large mesh they hold a part of the triangles.
class TreeSample {
 public:
  static constexpr std::size_t run_length = 64;  ///< triangles of a small tree
  static constexpr std::size_t most_triangles =
      64 * 64;  ///< of a mesh with as many or fewer all, of others less than twice so many

  TreeSample() = default;
  /// Neighbors are those of the present positions.
  explicit TreeSample(const Mesh& mesh);

  /// What a ray takes in the small trees on the mean that meets the box of them all, where the mesh is now: as BoxTree::cost. 0
  /// where the mesh is a point or a line.
  double refit(const Mesh& mesh);
  double cost() const;
  std::size_t bytes() const;

 private:
  struct Run {
    std::vector<std::uint32_t> triangles;
    BoxTree tree;
  };
  std::vector<Run> runs_;
};

}  // namespace gnomon
