#pragma once
#include <gnomon/scene.h>

#include <algorithm>
#include <vector>

namespace gnomon {

/// How one mesh moved between two poses of its scene.
struct MeshChange {
  enum class Kind : std::uint8_t {
    still,    ///< all vertices have the bits that they had
    rigid,    ///< one matrix moved all vertices; each is rounded for itself
    deformed  ///< each vertex moved in its own way
  };
  Kind kind = Kind::still;
  std::uint32_t first = 0, count = 0;  ///< the range of vertices that holds all that differ; empty where it is still
  Bounds before, after;                ///< of the whole mesh, meters
  glm::dmat4 matrix{1};                ///< of a rigid one: where its points are from where they were
};

/// What moved in a scene since a technique saw its vertices last.
struct Changes {
  std::vector<MeshChange> meshes;  ///< as many as the scene's, in its order
  bool empty() const {
    return std::ranges::all_of(meshes, [](const MeshChange& m) { return m.kind == MeshChange::Kind::still; });
  }
};

inline constexpr std::string_view name(MeshChange::Kind kind) {
  return kind == MeshChange::Kind::still ? "still" : kind == MeshChange::Kind::rigid ? "rigid" : "deformed";
}

}  // namespace gnomon
