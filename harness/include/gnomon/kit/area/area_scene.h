#pragma once
#include <gnomon/kit/add_up.h>
#include <gnomon/kit/area/light_pieces.h>
#include <gnomon/kit/geometry/box_tree.h>
#include <gnomon/kit/geometry/receiver.h>

namespace gnomon {

/// Work of exact answers about lights with area.
struct AreaTally {
  std::uint64_t points = 0;                 ///< queried
  std::uint64_t triangles = 0, pieces = 0;  ///< in reach of the light, and left of it, summed over the points
  AreaTally& operator+=(const AreaTally& other) {
    return add_up(*this, other, &AreaTally::points, &AreaTally::triangles, &AreaTally::pieces);
  }
};

/// All casting triangles of a scene, and how much of a light with area they leave: by clipping, in closed form. Shares no code
/// with the ray tracer that it certifies. The scene must outlive it. Every query may run on many threads, each with pieces of
/// its own. Triangles are solid all over: of a scene whose casters have alpha masks the shares are too small.
class AreaScene {
 public:
  explicit AreaScene(const Scene& scene);

  /// What a receiver sees of a light. `figure` is that of the light from there and must be seen. The receiver's own triangle,
  /// those exactly in its plane, and those in whose plane the point lies cover nothing.
  LightShares seen(const Receiver& receiver, const LightFigure& figure, LightPieces& pieces, AreaTally& tally) const;

  const Scene& scene() const { return scene_; }
  std::size_t bytes() const { return tree_.bytes() + bytes_of(corners_, meshes_, triangles_); }

 private:
  const Scene& scene_;
  BoxTree tree_;
  std::vector<std::array<glm::vec3, 3>> corners_;  // by place of the tree
  std::vector<std::uint32_t> meshes_, triangles_;
};

}  // namespace gnomon
