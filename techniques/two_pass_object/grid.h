#pragma once
#include <gnomon/kit/bins.h>

#include "footprint.h"

namespace gnomon::two_pass_object {

/// A rectangle of places, and the cells that it is divided into: none in a cell that holds triangles itself.
struct Node {
  Places box;
  std::uint32_t first = 0, count = 0;   ///< entries; or nodes, row after row
  std::uint32_t columns = 0, rows = 0;  ///< both 0 without nodes below
  bool is_leaf() const { return columns == 0; }
  /// Where column `c` begins; the last one's end is the rectangle's, so that neighbors have the same border, bit for bit.
  double u(std::uint32_t c) const { return c == 0 ? box.u0 : c == columns ? box.u1 : box.u0 + box.width() * c / columns; }
  double v(std::uint32_t r) const { return r == 0 ? box.v0 : r == rows ? box.v1 : box.v0 + box.height() * r / rows; }
  std::uint32_t column(double at) const { return index((at - box.u0) / box.width() * columns, columns); }
  std::uint32_t row(double at) const { return index((at - box.v0) / box.height() * rows, rows); }
  /// Cells are counted row after row.
  std::uint32_t cell_count() const { return columns * rows; }
  std::uint32_t cell_at(const PlaceAndDepth& p) const { return row(p.v) * columns + column(p.u); }
  Node child(std::uint32_t k) const {
    const std::uint32_t c = k % columns, r = k / columns;
    return {.box = {u(c), v(r), u(c + 1), v(r + 1)}};
  }

 private:
  static std::uint32_t index(double at, std::uint32_t count) {
    return at > 0 ? std::min(static_cast<std::uint32_t>(at), count - 1) : 0;
  }
};

/// How far beyond its rectangle a cell looks: a share of the places of the face, so far above all rounding of a place.
inline double margin_of(const Places& face) { return std::max(0x1p-20 * std::max(face.width(), face.height()), 1e-9); }

/// Calls visit(cell) for the cells of a node, each grown by the margin, that a triangle may touch.
void for_cells(const Triangles& triangles, int face, const Node& node, double margin, const Footprint& f, const auto& visit) {
  const double reach = 2 * margin;
  if (node.box.misses(f.box, reach)) return;
  const std::uint32_t c0 = node.column(f.box.u0 - reach), c1 = node.column(f.box.u1 + reach);
  const std::uint32_t r0 = node.row(f.box.v0 - reach), r1 = node.row(f.box.v1 + reach);
  const bool cuts = (c1 - c0 + 1) * (r1 - r0 + 1) > 2 && !triangles.is(f.triangle, Triangles::doubtful);
  glm::dvec3 lines[3];
  double slack[3];
  if (cuts)
    for (int k = 0; k < 3; ++k) {
      const RawPlane side = triangles.side(f.triangle, k);
      lines[k] = triangles.space().line(face, side.normal, side.on_plane);
      slack[k] = slack_of(lines[k]);
    }
  for (std::uint32_t r = r0; r <= r1; ++r) {
    const double v0 = node.v(r) - reach, v1 = node.v(r + 1) + reach;
    for (std::uint32_t c = c0; c <= c1; ++c) {
      bool misses = false;
      if (cuts) {
        const double u0 = node.u(c) - reach, u1 = node.u(c + 1) + reach;
        for (int k = 0; k < 3; ++k) {
          const glm::dvec3& line = lines[k];
          misses |= line.x * (line.x > 0 ? u1 : u0) + line.y * (line.y > 0 ? v1 : v0) + line.z < -slack[k];
        }
      }
      if (!misses) visit(std::size_t{r} * node.columns + c);
    }
  }
}

}  // namespace gnomon::two_pass_object
