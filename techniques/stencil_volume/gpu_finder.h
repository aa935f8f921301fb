#pragma once
#include <gnomon/kit/volume_faces.h>

namespace stencil_volume {
using namespace gnomon;

/// The relight of `finder=gpu`: facing, outline and caps by compute shaders. Facing is decided in double without the exact
/// fallback: a triangle so nearly edge-on that this matters casts a shadow thinner than rounding, whichever way it is turned.
/// The order of faces in the buffers is open, the set of faces is not, so neither are the counts.
class GpuFinder {
 public:
  void setup();
  void build(const EdgeAdjacency& adjacency);

  /// Finds the silhouette of the scene whose buffers these are. Fills the buffers of faces, and `out` with what they hold, for
  /// the questions that the processor asks.
  FaceCommands find(const SceneBuffers& buffers, const EdgeAdjacency& adjacency, const glm::dvec4& light,
                    const WantedFaces& wanted, FaceBuffers& faces, Silhouette& out);

  std::size_t bytes() const {
    return triangles_.bytes + first_.bytes + edges_.bytes + irregular_.bytes + at_irregular_.bytes + halves_.bytes() +
           work_.bytes();
  }

 private:
  void make_room(const EdgeAdjacency& adjacency, const WantedFaces& wanted, FaceBuffers& faces);
  /// Counts all faces, and writes them as far as there is room.
  FaceCommands run(const SceneBuffers& buffers, const EdgeAdjacency& adjacency, const glm::dvec4& light,
                   const WantedFaces& wanted, const FaceBuffers& faces);
  /// Reads back the outline, of `side_count` sides, and how the triangles face.
  void read_silhouette(const FaceBuffers& faces, std::size_t side_count, std::size_t triangle_count, Silhouette& out) const;

  Program facing_program_, edges_program_, irregular_program_;
  Buffer triangles_, first_, edges_, irregular_, at_irregular_;
  RewrittenBuffer halves_, work_;
};

}  // namespace stencil_volume
