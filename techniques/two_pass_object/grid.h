#pragma once
#include <array>

#include "triangles.h"

namespace gnomon::two_pass_object {

/// A box of places on a face around what the light sees of a triangle there.
struct Footprint {
  double u0, v0, u1, v1;
  std::uint32_t triangle;
};

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

/// The part of a triangle that a face, or a little more, sees; returns its number of corners. `out` holds 7.
inline std::size_t cut_to_face(const LightSpace& space, int face, const Triangle& triangle, Corner* out) {
  Corner other[8];
  std::size_t count = 3;
  for (int k = 0; k < 3; ++k) out[k] = {glm::dvec3(triangle.points[k])};
  for (int side = 0; side < 4 && count > 0; ++side) {
    ClipPlane plane = space.border(face, side / 2, side % 2 ? 1 + 0x1p-10 : -1 - 0x1p-10);
    if (side % 2) plane.normal = -plane.normal, plane.offset = -plane.offset;
    double values[8];
    Corner lost[8];
    const Lies lies = classify({out, count}, plane, 0, values);
    if (lies == Lies::positive || lies == Lies::within) continue;
    if (lies == Lies::negative) return 0;
    count = cut_polygon({out, count}, values, 0, 0, lost, other).positive;
    std::copy_n(other, count, out);
  }
  return count;
}

/// Calls visit(face, footprint) for each face that sees a part of the triangle.
template <class Visit>
void for_footprints(const Triangles& triangles, std::uint32_t i, Visit&& visit) {
  const LightSpace& space = triangles.space();
  const Triangle& triangle = triangles[i];
  const auto box_of = [&](int face, const auto* corners, std::size_t count) {
    Footprint box{INFINITY, INFINITY, -INFINITY, -INFINITY, i};
    for (std::size_t k = 0; k < count; ++k) {
      const Seen s = space.seen(face, corners[k]);
      box.u0 = std::min(box.u0, s.u), box.u1 = std::max(box.u1, s.u);
      box.v0 = std::min(box.v0, s.v), box.v1 = std::max(box.v1, s.v);
    }
    return box;
  };
  const glm::dvec3 points[3] = {glm::dvec3(triangle.points[0]), glm::dvec3(triangle.points[1]), glm::dvec3(triangle.points[2])};
  if (space.is_parallel()) return visit(0, box_of(0, points, 3));
  const int only = space.face_of(points[0]);
  const auto is_clearly_in = [&](const glm::dvec3& p) {
    const double depth = space.depth(only, p);
    if (!(depth > 0x1p-30 * space.extent())) return false;
    const Seen s = space.seen(only, p);
    return std::max(std::abs(s.u), std::abs(s.v)) < 1 - 0x1p-10;
  };
  if (is_clearly_in(points[0]) && is_clearly_in(points[1]) && is_clearly_in(points[2]))
    return visit(only, box_of(only, points, 3));
  const bool is_doubtful = triangles.is(i, Triangles::doubtful);
  for (int face = 0; face < 6; ++face) {
    if (is_doubtful) {
      visit(face, Footprint{-1, -1, 1, 1, i});
      continue;
    }
    Corner polygon[8];
    const std::size_t count = cut_to_face(space, face, triangle, polygon);
    if (count == 0) continue;
    glm::dvec3 at[8];
    bool is_near = false;
    for (std::size_t k = 0; k < count; ++k) {
      at[k] = polygon[k].at;
      is_near |= !(space.depth(face, at[k]) > 0x1p-30 * space.extent());
    }
    // So near to the light places are lost in rounding.
    Footprint box = is_near ? Footprint{-1, -1, 1, 1, i} : box_of(face, at, count);
    if (box.u0 > 1 || box.u1 < -1 || box.v0 > 1 || box.v1 < -1) continue;
    box.u0 = std::max(box.u0, -1.0), box.u1 = std::min(box.u1, 1.0);
    box.v0 = std::max(box.v0, -1.0), box.v1 = std::min(box.v1, 1.0);
    visit(face, box);
  }
}

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
      slack[k] = 0x1p-24 * (std::abs(lines[k].x) + std::abs(lines[k].y) + std::abs(lines[k].z));
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

/// The footprints of all triangles that take part, by face.
using Footprints = std::array<std::vector<Footprint>, 6>;

inline Footprints find_footprints(const Triangles& triangles) {
  constexpr std::size_t block = 16384;
  std::vector<Footprints> found((triangles.size() + block - 1) / block);
  for_blocks(triangles.size(), block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (triangles.takes_part(static_cast<std::uint32_t>(i)))
        for_footprints(triangles, static_cast<std::uint32_t>(i),
                       [&](int face, const Footprint& f) { found[begin / block][face].push_back(f); });
  });
  Footprints all;
  for (int face = 0; face < 6; ++face) {
    std::size_t count = 0;
    for (const Footprints& some : found) count += some[face].size();
    all[face].reserve(count);
    for (Footprints& some : found) {
      all[face].insert(all[face].end(), some[face].begin(), some[face].end());
      some[face] = {};
    }
  }
  return all;
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

/// for_bins(item, visit) calls visit(bin) for each bin of an item, and does so twice: to count and to deal. On all threads if
/// `block` is less than the number of items; the outcome is the same.
template <class ForBins>
void deal(std::size_t item_count, std::size_t block, std::size_t bin_count, Dealt& out, ForBins&& for_bins) {
  const std::size_t blocks = (item_count + block - 1) / block;
  std::vector<std::uint32_t> counts(blocks * bin_count, 0);
  for_blocks(item_count, block, [&](std::size_t begin, std::size_t end) {
    std::uint32_t* const own = counts.data() + begin / block * bin_count;
    for (std::size_t i = begin; i < end; ++i) for_bins(i, [&](std::size_t bin) { ++own[bin]; });
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
  for_blocks(item_count, block, [&](std::size_t begin, std::size_t end) {
    std::uint32_t* const next = counts.data() + begin / block * bin_count;
    for (std::size_t i = begin; i < end; ++i)
      for_bins(i, [&](std::size_t bin) { out.items[next[bin]++] = static_cast<std::uint32_t>(i); });
  });
}

}  // namespace gnomon::two_pass_object
