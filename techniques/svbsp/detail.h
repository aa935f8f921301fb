#pragma once
#include <gnomon/kit/geometry/receiver.h>
#include <gnomon/technique.h>

#include "forest.h"

namespace gnomon::svbsp {

/// Divides polygons into what the light sees of them and what it does not, by the trees of a forest.
class Divider {
 public:
  Divider(const ProjectedSpace& space, const Forest& forest, const Facing& facing, const TriangleNumbers& numbers)
      : space_(space), forest_(forest), facing_(facing), numbers_(numbers) {}

  /// Appends the lit and the shadowed parts of `polygon`, a convex part of a triangle. `merges`: the polygon itself where all
  /// of it is lit, or all shadowed.
  void divide(std::span<const Corner> polygon, std::uint32_t triangle, bool merges, SurfaceDetail& detail);

 private:
  using Polygon = std::vector<Corner>;
  /// For a polygon so narrow, as the light sees it, that no fragment is left of it.
  bool is_lit_in_the_middle(std::span<const Corner> polygon) const;
  /// What lies below and above a line in x or y; empty where nothing does.
  std::pair<Polygon, Polygon> cut(const Polygon& polygon, int axis, double at);
  /// Tile by tile. Around the tiles all is lit.
  void divide_face(Polygon rest);
  void filter(const Polygon& polygon, std::uint32_t tile);
  void append(std::span<const Corner> polygon, bool is_lit);

  const ProjectedSpace& space_;
  const Forest& forest_;
  const Facing& facing_;
  const TriangleNumbers& numbers_;
  Projector projector_;
  Filter filter_;
  Clipper clipper_;
  std::vector<double> values_;
  SurfaceDetail* out_ = nullptr;
  DetailPolygon part_{};
  bool is_clockwise_ = false;
  int face_ = 0;
};

/// Those triangles of a scene for which `is_wanted` is set, which receive and are not edge-on, divided; on all threads.
SurfaceDetail divide_triangles(const Scene& scene, const TriangleNumbers& numbers, const ProjectedSpace& space,
                               const Forest& forest, const Facing& facing, std::span<const std::uint8_t> is_wanted,
                               bool merges);

}  // namespace gnomon::svbsp
