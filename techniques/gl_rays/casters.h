#pragma once
#include <gnomon/kit/geometry/receiver.h>
#include <gnomon/kit/geometry/refit.h>
#include <gnomon/technique.h>

#include "box_nodes.h"

namespace gnomon::gl_rays {

/// A corner of a triangle, as a buffer of layout std430 holds it.
struct Corner {
  glm::vec3 at{0};
  std::int32_t tag = 0;
};
static_assert(sizeof(Corner) == 16);

/// The casters of a scene and a tree of boxes over them, in the frame in which rays are traced: that of the world, or, where
/// the largest coordinate of the scene is below 2^-10 m or above 2^30 m, scaled by a power of two to 1 to 2. That rounds
/// nothing, and products of lengths stay within float32. What meshes reach counts, so that the frame stays the same while they
/// move.
///
/// Boxes are grown by 2^-23 of the largest coordinate. A ray that runs in the very plane of a box's side, where a shader
/// divides by nearly nothing, so meets it.
class Casters {
 public:
  explicit Casters(const Scene& scene);
  /// Vertices of the scene moved in place. Refits the tree, or builds it anew where the frame is another one or where the tree
  /// has decayed (gnomon/kit/geometry/refit.h). Says whether anything of it changed.
  bool update(const Scene& scene, const Changes& changes);

  const std::vector<Node>& nodes() const { return tree_.nodes; }
  /// Three for each place. Tags: the number of the triangle in the scene, counted mesh after mesh; the numbers of its mesh's
  /// alpha mask and of its transmission, each counted in the order of the first meshes that have them; -1: it has none.
  const std::vector<Corner>& corners() const { return corners_; }
  float scale() const { return frame_.scale; }  ///< of the world to the frame
  std::size_t triangle_count() const { return corners_.size() / 3; }
  /// Nodes that a tree over as many triangles has at most: how many it has depends on the pose in which it was built.
  std::size_t most_nodes() const { return corners_.empty() ? 0 : 2 * triangle_count() - 1; }
  std::size_t bytes() const { return most_nodes() * sizeof(Node) + bytes_of(corners_); }
  /// The box of the triangle at a place, grown.
  Bounds box_at(std::size_t place) const;

 private:
  struct Frame {
    float scale = 1;
    float growth = 0;  // of boxes, on all sides
    Frame() = default;
    explicit Frame(const Scene& scene);
    bool operator==(const Frame&) const = default;
  };
  void build(const Scene& scene);

  TriangleNumbers numbers_;
  BoxNodes tree_;  // its order is dropped: places have the numbers of their triangles
  std::vector<Corner> corners_;
  Frame frame_;
  double built_cost_ = 0;
};

/// Triangles of a scene that cast.
std::size_t caster_count(const Scene& scene);

/// Numbers of 32 bits that shaders read together: half a node, or a corner.
inline constexpr std::size_t texel_bytes = 16;
/// Whether a tree over so many triangles can be read, which has two nodes a triangle at most. `device_texels`: of a buffer, at
/// most; nothing where no device is known yet.
Support tree_support(std::size_t triangles, std::optional<std::size_t> device_texels);

}  // namespace gnomon::gl_rays
