#pragma once
#include <gnomon/kit/geometry/box_tree.h>
#include <gnomon/kit/geometry/cut_masks.h>
#include <gnomon/kit/geometry/receiver.h>

#include "volume.h"

namespace gnomon::area_svbsp {

/// A convex polygon that casts: a triangle, or two of a mesh in exactly one plane that make a convex quadrilateral.
struct CasterPolygon {
  std::uint32_t count = 3;
  glm::vec3 corners[4];
  std::uint32_t mesh = 0;
  std::uint32_t triangles[2] = {0, 0};  ///< counted over the scene; of a triangle twice the same

  Bounds bounds() const {
    Bounds box;
    box.add(std::span(corners, count));
    return box;
  }
};

/// All that casts in a scene, without triangles of zero area. The scene must outlive it.
struct Casters {
  CutMasks cut;
  const Scene* scene = nullptr;  ///< after the cut
  Bounds bounds;                 ///< of the scene
  TriangleNumbers numbers;
  std::vector<CasterPolygon> polygons;
  BoxTree boxes;  ///< of the polygons

  Casters() = default;
  explicit Casters(const Scene& scene) : Casters(CutMasks(scene)) {}
  explicit Casters(CutMasks cut);

  /// Whether a polygon never shades a point of a triangle: it is its own, a piece of it, or in its plane. `point` may be in
  /// space, or on a mesh that is left out whole.
  bool leaves_out(const Receiver& point, const CasterPolygon& polygon) const;
  /// The same of all points of a receiving triangle, counted over the scene, for polygons of other triangles and for pieces.
  bool is_coplanar(const glm::vec3* triangle, const CasterPolygon& polygon) const;
  std::size_t bytes() const { return bytes_of(polygons) + numbers.bytes() + boxes.bytes() + cut.bytes(); }

 private:
  /// The triangle of the original scene that a polygon's triangle is a piece of, or itself.
  Triangle source(std::uint32_t number) const;
};

/// The umbra and penumbra volumes of all casters for one light, with boxes over them.
class Volumes {
 public:
  /// On all threads; the outcome does not depend on their number. `epsilon` in meters.
  void make(std::span<const CasterPolygon> polygons, const LightBody& light, double epsilon);

  std::span<const Volume> all() const { return volumes_; }
  /// The numbers of a polygon's volumes: none where it hides nothing, up to four where its plane crosses the light and the
  /// light's plane crosses it.
  std::pair<std::uint32_t, std::uint32_t> of(std::uint32_t polygon) const {
    return {first_of_[polygon], first_of_[polygon + 1]};
  }
  std::span<const ClipPlane> penumbra(const Volume& v) const { return {planes_.data() + v.first, v.penumbra_count}; }
  /// Empty where no point is in the umbra of the polygon alone.
  std::span<const ClipPlane> umbra(const Volume& v) const {
    return {planes_.data() + v.first + v.penumbra_count, v.umbra_count};
  }
  std::size_t bytes() const { return bytes_of(volumes_, planes_, first_of_); }

 private:
  std::vector<Volume> volumes_;
  std::vector<ClipPlane> planes_;
  std::vector<std::uint32_t> first_of_;
};

}  // namespace gnomon::area_svbsp
