#pragma once
#include <gnomon/kit/geometry/receiver.h>
#include <gnomon/kit/parallel.h>
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
  void divide(std::span<const Corner> polygon, std::uint32_t triangle, bool merges, SurfaceDetail& detail) {
    const std::size_t first_corner = detail.corners.size(), first_polygon = detail.polygons.size();
    out_ = &detail;
    mesh_ = facing_.triangles[triangle].mesh;
    triangle_ = triangle - numbers_.first_of(mesh_);
    is_clockwise_ = space_.is_clockwise(facing_.signs[triangle]);
    projector_.run(space_, polygon, facing_.signs[triangle], [&](int face, std::span<const Corner> seen) {
      face_ = face;
      divide_face({seen.begin(), seen.end()});
    });
    const auto made = std::span(detail.polygons).subspan(first_polygon);
    const bool is_lit = made.empty() ? is_lit_in_the_middle(polygon) : made[0].is_lit;
    const auto is_alike = [&](const DetailPolygon& p) { return p.is_lit == is_lit; };
    if (!made.empty() && (!merges || !std::ranges::all_of(made, is_alike))) return;
    detail.corners.resize(first_corner);
    detail.polygons.resize(first_polygon);
    begin_part(polygon.size(), is_lit);
    for (const Corner& corner : polygon) detail.corners.push_back(corner.at);
  }

 private:
  using Polygon = std::vector<Corner>;
  /// For a polygon so narrow, as the light sees it, that no fragment is left of it.
  bool is_lit_in_the_middle(std::span<const Corner> polygon) const {
    glm::dvec3 middle(0);
    for (const Corner& corner : polygon) middle += corner.at / static_cast<double>(polygon.size());
    const auto [face, seen] = space_.of_world(middle);
    Query query = forest_.query(face, seen);
    std::uint64_t visits = 0;
    locate<1>({&query, 1}, visits);
    return !is_in_cell(query.link) ||
           facing_.plane(space_, face, triangle_in(query.link)).at(seen) >= -forest_.epsilon().meters * space_.meter(seen);
  }

  /// What lies below and above a line in x or y; empty where nothing does.
  std::pair<Polygon, Polygon> cut(const Polygon& polygon, int axis, double at) {
    glm::dvec3 normal(0);
    normal[axis] = 1;
    clipper_.start(polygon);
    const Lies lies = clipper_.keep_positive({normal, -at}, forest_.epsilon().across, shadow_cut);
    if (lies == Lies::negative) return {polygon, {}};
    if (lies != Lies::across) return {{}, polygon};
    const std::span<const Corner> below = clipper_.cut_off(), above = clipper_.corners();
    return {{below.begin(), below.end()}, {above.begin(), above.end()}};
  }

  /// Tile by tile. Around the tiles all is lit.
  void divide_face(Polygon rest) {
    const Grid& grid = forest_.grid(face_);
    if (grid.is_empty()) return append(rest, true);
    for (int axis = 0; axis < 2 && !rest.empty(); ++axis) {
      Polygon around;
      std::tie(around, rest) = cut(rest, axis, grid.low[axis]);
      append(around, true);
      if (rest.empty()) break;
      std::tie(rest, around) = cut(rest, axis, grid.high[axis]);
      append(around, true);
    }
    for (int row = 0; row < grid.rows && !rest.empty(); ++row) {
      Polygon strip = std::move(rest);
      rest.clear();
      if (row + 1 < grid.rows) std::tie(strip, rest) = cut(strip, 1, grid.row_side(row + 1));
      for (int column = 0; column < grid.columns && !strip.empty(); ++column) {
        Polygon part = std::move(strip);
        strip.clear();
        if (column + 1 < grid.columns) std::tie(part, strip) = cut(part, 0, grid.column_side(column + 1));
        if (!part.empty()) filter(part, grid.tile(column, row));
      }
    }
  }

  void filter(const Polygon& polygon, std::uint32_t tile) {
    std::uint64_t thin = 0;
    filter_.run(forest_.nodes(tile), forest_.root(tile), polygon, forest_.epsilon().across, thin,
                [&](const Place&, Link cell, std::span<const Corner> fragment) {
                  if (!is_in_cell(cell)) return append(fragment, true);
                  values_.resize(fragment.size());
                  const Lies lies = lies_at(facing_.plane(space_, face_, triangle_in(cell)), space_, fragment,
                                            forest_.epsilon().meters, values_.data());
                  if (lies != Lies::across) return append(fragment, lies != Lies::negative);
                  Polygon beyond(fragment.size() + 1), before(fragment.size() + 1);
                  const CutCounts counts = cut_polygon(fragment, values_.data(), 0, own_edge, beyond.data(), before.data());
                  append({beyond.data(), counts.negative}, false);
                  append({before.data(), counts.positive}, true);
                });
  }

  void append(std::span<const Corner> polygon, bool is_lit) {
    if (polygon.size() < 3) return;
    begin_part(polygon.size(), is_lit);
    for (std::size_t i = 0; i < polygon.size(); ++i)
      out_->corners.push_back(space_.to_world(face_, polygon[is_clockwise_ ? polygon.size() - 1 - i : i].at));
  }

  /// Appends a polygon whose corners are appended next.
  void begin_part(std::size_t corner_count, bool is_lit) {
    const auto first = static_cast<std::uint32_t>(out_->corners.size()), count = static_cast<std::uint32_t>(corner_count);
    out_->polygons.push_back({.mesh = mesh_, .triangle = triangle_, .is_lit = is_lit, .first = first, .count = count});
  }

  const ProjectedSpace& space_;
  const Forest& forest_;
  const Facing& facing_;
  const TriangleNumbers& numbers_;
  Projector projector_;
  Filter filter_;
  Clipper clipper_;
  std::vector<double> values_;
  SurfaceDetail* out_ = nullptr;
  std::uint32_t mesh_ = 0, triangle_ = 0;  // that is divided now, counted over its mesh
  bool is_clockwise_ = false;
  int face_ = 0;
};

/// Those triangles of a scene for which `is_wanted` is set, which receive and are not edge-on, divided; on all threads.
inline SurfaceDetail divide_triangles(const Scene& scene, const TriangleNumbers& numbers, const ProjectedSpace& space,
                                      const Forest& forest, const Facing& facing, std::span<const std::uint8_t> is_wanted,
                                      bool merges) {
  constexpr std::size_t block = 4096;
  const std::span<const SceneTriangle> triangles = facing.triangles;
  std::vector<SurfaceDetail> parts((triangles.size() + block - 1) / block);
  for_blocks(triangles.size(), block, [&](std::size_t begin, std::size_t end) {
    Divider divider(space, forest, facing, numbers);
    for (std::size_t i = begin; i < end; ++i) {
      if (!is_wanted[i] || facing.signs[i] == 0 || !scene.meshes[triangles[i].mesh].receives) continue;
      Corner corners[3];
      for (int k = 0; k < 3; ++k) corners[k] = {glm::dvec3(triangles[i].points[k]), own_edge};
      divider.divide(corners, static_cast<std::uint32_t>(i), merges, parts[begin / block]);
    }
  });
  SurfaceDetail all;
  for (const SurfaceDetail& part : parts) {
    const auto first = static_cast<std::uint32_t>(all.corners.size());
    for (DetailPolygon polygon : part.polygons) {
      polygon.first += first;
      all.polygons.push_back(polygon);
    }
    all.corners.insert(all.corners.end(), part.corners.begin(), part.corners.end());
  }
  return all;
}

}  // namespace gnomon::svbsp
