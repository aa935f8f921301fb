#pragma once
#include <gnomon/changes.h>
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
  /// Vertices of the scene moved in place since it was built or updated last. Answers are then those of a scene that is built
  /// there. The tree is refitted, and built anew where it has decayed or triangles lost or got their area.
  void update(const Changes& changes);

  /// What a receiver sees of a light. `figure` is that of the light from there and must be seen. The receiver's own triangle,
  /// those exactly in its plane, and those in whose plane the point lies cover nothing.
  LightShares seen(const Receiver& receiver, const LightFigure& figure, LightPieces& pieces, AreaTally& tally) const;

  const Scene& scene() const { return *scene_; }
  /// Of one that is built where the scene is now: how many boxes a refitted tree has depends on where it was built.
  std::size_t bytes() const {
    return is_refitted_ ? AreaScene(*scene_).bytes() : tree_.bytes() + bytes_of(corners_, meshes_, triangles_, left_out_);
  }

 private:
  /// Takes what the triangle at a place covers off the pieces. Answers whether nothing is left.
  bool subtract(std::uint32_t place, const Receiver& receiver, LightPieces& pieces, AreaTally& tally) const;
  /// Answers whether the tree may stay.
  bool refit(const Changes& changes);

  const Scene* scene_;
  /// What is left of a light is rounded after each triangle, hence depends on their order. Where meshes move it is that of the
  /// scene, which stays; elsewhere that of the tree, which is quicker.
  bool is_in_order_ = false;
  BoxTree tree_;
  std::vector<std::array<glm::vec3, 3>> corners_;  // by place of the tree
  std::vector<std::uint32_t> meshes_, triangles_;
  std::vector<std::array<std::uint32_t, 2>> left_out_;  // mesh and triangle of those without area
  bool is_refitted_ = false;                            // since it was built
  double built_cost_ = 0;                               // of the tree, once it is refitted
};

}  // namespace gnomon
