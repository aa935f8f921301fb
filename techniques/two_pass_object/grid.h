#pragma once
#include "footprint.h"

namespace gnomon::two_pass_object {

/// A rectangle of places, and the cells that it is divided into: none in a cell that holds triangles itself.
struct Node {
  double u0, v0, u1, v1;
  std::uint32_t first = 0, count = 0;   ///< entries; or nodes, row after row
  std::uint32_t columns = 0, rows = 0;  ///< both 0 without nodes below
  bool is_leaf() const { return columns == 0; }
  /// Where column `c` begins; the last one's end is the rectangle's, so that neighbors have the same border, bit for bit.
  double u(std::uint32_t c) const { return c == 0 ? u0 : c == columns ? u1 : u0 + (u1 - u0) * c / columns; }
  double v(std::uint32_t r) const { return r == 0 ? v0 : r == rows ? v1 : v0 + (v1 - v0) * r / rows; }
  std::uint32_t column(double at) const { return cell((at - u0) / (u1 - u0) * columns, columns); }
  std::uint32_t row(double at) const { return cell((at - v0) / (v1 - v0) * rows, rows); }
  bool holds(double u, double v) const { return u >= u0 && u <= u1 && v >= v0 && v <= v1; }
  Node child(std::uint32_t c, std::uint32_t r) const { return {u(c), v(r), u(c + 1), v(r + 1)}; }

 private:
  static std::uint32_t cell(double at, std::uint32_t count) {
    return at > 0 ? std::min(static_cast<std::uint32_t>(at), count - 1) : 0;
  }
};

/// How far beyond its rectangle a cell looks: a share of the places of the face, so far above all rounding of a place.
inline double margin_of(const Node& face) { return std::max(0x1p-20 * std::max(face.u1 - face.u0, face.v1 - face.v0), 1e-9); }

/// Calls visit(column, row) for the cells of a node, each grown by the margin, that a triangle may touch.
template <class Visit>
void for_cells(const Triangles& triangles, int face, const Node& node, double margin, const Footprint& f, Visit&& visit) {
  const double reach = 2 * margin;
  if (f.u1 < node.u0 - reach || f.u0 > node.u1 + reach || f.v1 < node.v0 - reach || f.v0 > node.v1 + reach) return;
  const std::uint32_t c0 = node.column(f.u0 - reach), c1 = node.column(f.u1 + reach);
  const std::uint32_t r0 = node.row(f.v0 - reach), r1 = node.row(f.v1 + reach);
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
      if (!misses) visit(c, r);
    }
  }
}

/// The first division of a face: its rectangle fits the footprints, and about one cell comes on `share` of them; fewer, where
/// large triangles would lie in too many.
inline Node divide_face(std::span<const Footprint> footprints, double share, bool is_cube) {
  Node node{INFINITY, INFINITY, -INFINITY, -INFINITY};
  double area = 0, width = 0, height = 0;
  for (const Footprint& f : footprints) {
    node.u0 = std::min(node.u0, f.u0), node.u1 = std::max(node.u1, f.u1);
    node.v0 = std::min(node.v0, f.v0), node.v1 = std::max(node.v1, f.v1);
    area += (f.u1 - f.u0) * (f.v1 - f.v0), width += f.u1 - f.u0, height += f.v1 - f.v0;
  }
  // Never without width: points beside all triangles are lit, and those on the border are asked.
  const double size = std::max({node.u1 - node.u0, node.v1 - node.v0, 1e-6});
  const double grow = 0x1p-10 * size;
  node.u0 -= grow, node.u1 += grow, node.v0 -= grow, node.v1 += grow;
  // Faces of a cube meet and do not overlap.
  if (is_cube)
    node.u0 = std::max(node.u0, -1.0), node.u1 = std::min(node.u1, 1.0), node.v0 = std::max(node.v0, -1.0),
    node.v1 = std::min(node.v1, 1.0);
  const double du = node.u1 - node.u0, dv = node.v1 - node.v0, n = static_cast<double>(footprints.size());
  for (double cells = std::clamp(n / share, 1.0, 0x1p20);; cells /= 2) {
    const double stretch = std::sqrt(du / dv);
    const double columns = std::clamp(std::round(std::sqrt(cells) * stretch), 1.0, 2048.0);
    const double rows = std::clamp(std::round(std::sqrt(cells) / stretch), 1.0, 2048.0);
    const double touched = n + width / du * columns + height / dv * rows + area / (du * dv) * columns * rows;
    if (cells > 1 && touched > 4 * n + 64) continue;
    node.columns = static_cast<std::uint32_t>(columns), node.rows = static_cast<std::uint32_t>(rows);
    return node;
  }
}

/// Items dealt to bins: bin b holds items[begin[b]] .. items[begin[b + 1]], in rising order.
struct Dealt {
  std::vector<std::uint32_t> begin, items;
};

/// for_bins(item, visit) calls visit(bin) for each bin of an item. On all threads if `block` is less than the number of items;
/// the outcome is the same.
template <class ForBins>
void deal(std::size_t item_count, std::size_t block, std::size_t bin_count, Dealt& out, ForBins&& for_bins) {
  const std::size_t blocks = (item_count + block - 1) / block;
  struct Visit {
    std::uint32_t bin, item;
  };
  std::vector<std::vector<Visit>> visits(blocks);
  std::vector<std::uint32_t> counts(blocks * bin_count, 0);
  for_blocks(item_count, block, [&](std::size_t begin, std::size_t end) {
    std::uint32_t* const own = counts.data() + begin / block * bin_count;
    std::vector<Visit>& mine = visits[begin / block];
    mine.reserve(2 * (end - begin));
    for (std::size_t i = begin; i < end; ++i)
      for_bins(i, [&](std::size_t bin) {
        ++own[bin];
        mine.push_back({static_cast<std::uint32_t>(bin), static_cast<std::uint32_t>(i)});
      });
  });
  out.begin.resize(bin_count + 1);
  std::uint32_t sum = 0;
  for (std::size_t bin = 0; bin < bin_count; ++bin) {
    out.begin[bin] = sum;
    for (std::size_t k = 0; k < blocks; ++k) {
      const std::uint32_t count = counts[k * bin_count + bin];
      counts[k * bin_count + bin] = sum;
      sum += count;
    }
  }
  out.begin[bin_count] = sum;
  out.items.resize(sum);
  for_blocks(blocks, 1, [&](std::size_t b, std::size_t) {
    std::uint32_t* const next = counts.data() + b * bin_count;
    for (const Visit& visit : visits[b]) out.items[next[visit.bin]++] = visit.item;
  });
}

}  // namespace gnomon::two_pass_object
