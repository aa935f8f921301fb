#pragma once
#include "grid.h"

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define GNOMON_ALIAS_FREE_MAP_CLONES __attribute__((target_clones("arch=x86-64-v3", "default")))
#else
#define GNOMON_ALIAS_FREE_MAP_CLONES
#endif

namespace gnomon::alias_free_map {

/// Error of a plane's value, of the product of the lengths that made it. With e = 2^-53, points are off by 9 e of their
/// distance (kit/maps/light_space.h), so the cross product of two by 18 e, and by 6 e for its own rounding; its product with a
/// third point adds 9 e for that one and 4 e for rounding: 37 e. A plane off the origin takes another 9 e + 4 e on the side of
/// its offset. 2^-46 is three times as much.
constexpr double plane_error = 0x1p-46;

/// A linear function of a sample in the frame of its face, raised by its error: where it is negative, its true value is. Where
/// it is above 2 `error`, the true value is positive.
struct Side {
  double x, y, z, offset, error;
  double at(double px, double py, double pz) const { return x * px + y * py + z * pz + offset; }
};

/// The shadow of a triangle that is not edge-on: all samples on the inner sides of three planes through the light and an edge,
/// and beyond the triangle's own plane (the last). `facing` is orient3d_sign of the corners and the light; `reach` is more than
/// the distance of any sample that is tested.
struct Shadow {
  Side sides[4];
};

inline Shadow make_shadow(const LightSpaceFace& face, const glm::dvec4& light, const glm::vec3* points, int facing,
                          double reach) {
  Shadow shadow;
  // Of the plane through a point whose inner side is that of `inward` times -facing.
  const auto side = [&](const glm::dvec3& inward, const glm::dvec3& through, double error) {
    const glm::dvec3 n = -static_cast<double>(facing) * inward;
    return Side{n.x, n.y, n.z, error - glm::dot(n, through), error};
  };
  glm::dvec3 corner[3];
  double length[3];
  for (int k = 0; k < 3; ++k) {
    corner[k] = face.seen(points[k]);
    length[k] = norm1(corner[k]);
  }
  const glm::dvec3 a(points[0]), b(points[1]), c(points[2]);
  const glm::dvec3 edges[3] = {face.turned(b - a), face.turned(c - b), face.turned(a - c)};
  if (!face.is_perspective) {
    // P = a + i (b - a) + j (c - a) - t l is in shadow when i, j, 1 - i - j >= 0 and t > 0, and
    // ((b - a) x l) . (P - a) = -j ((b - a) x (c - a)) . l.
    const glm::dvec3 l = face.turned(glm::dvec3(light));
    for (int k = 0; k < 3; ++k)
      shadow.sides[k] =
          side(glm::cross(edges[k], l), corner[k], plane_error * norm1(edges[k]) * norm1(l) * (reach + length[k]));
  } else {
    // P = i a + j b + k c, seen from the light, is in shadow when i, j, k >= 0 and i + j + k > 1, and [a b P] = k [a b c].
    // orient3d of a, b, c and the origin is -[a b c].
    for (int k = 0; k < 3; ++k) {
      const int next = (k + 1) % 3;
      shadow.sides[k] =
          side(glm::cross(corner[k], corner[next]), glm::dvec3(0), plane_error * length[k] * length[next] * reach);
    }
  }
  // The shadow is on the other side of the triangle than the light.
  shadow.sides[3] =
      side(glm::cross(edges[2], edges[0]), corner[0], plane_error * norm1(edges[0]) * norm1(edges[2]) * (reach + length[0]));
  return shadow;
}

/// Samples [begin, end), neighbors in a row of cells.
struct Run {
  std::uint32_t begin, end;
};

/// The samples of a tile that a shadow may contain, as runs: of each row of cells, those between the ends of the footprint and
/// of the shadow's sides, both grown by rounding. Returns how many runs.
inline int find_runs(const Grid::Face& face, const Tile& tile, int cells, const std::uint32_t* begins,
                     const Footprint& footprint, const Shadow& shadow, bool is_parallel, Run* runs) {
  const int c0 = std::max(face.column(footprint.x0) - tile.column, 0);
  const int c1 = std::min(face.column(footprint.x1) - tile.column, cells - 1);
  const int r0 = std::max(face.row(footprint.y0) - tile.row, 0), r1 = std::min(face.row(footprint.y1) - tile.row, cells - 1);
  int count = 0;
  // Few columns are not worth cutting.
  const bool cuts = c1 - c0 > 2;
  double inverse[3], offset[3];
  if (cuts)
    for (int k = 0; k < 3; ++k) {
      // On the face, z is 1 or, for a directional light, of no weight. A sample's distance is below 3 z, so the error of its
      // side, divided by z, is below 3 of the error for the distance 1.
      const Side& side = shadow.sides[k];
      inverse[k] = side.x != 0 ? 1 / side.x : 0;
      offset[k] = is_parallel ? side.offset + side.error : side.z + 4 * side.error / tile.reach;
    }
  for (int r = r0; r <= r1; ++r) {
    int from = c0, to = c1;
    if (cuts) {
      const double margin = 0x1p-20 * face.cell_size.y + face.rounding;
      const double low = face.low.y + (tile.row + r) * face.cell_size.y - margin, high = low + face.cell_size.y + 2 * margin;
      double x0 = footprint.x0, x1 = footprint.x1;
      bool misses = false;
      for (int k = 0; k < 3; ++k) {
        const Side& side = shadow.sides[k];
        const double rest = side.y * (side.y > 0 ? high : low) + offset[k];
        if (side.x == 0) misses |= rest < 0;
        const double x = -rest * inverse[k];
        if (side.x > 0) x0 = std::max(x0, x);
        if (side.x < 0) x1 = std::min(x1, x);
      }
      if (misses) continue;
      const double beside = 0x1p-20 * face.cell_size.x + face.rounding;
      if (x0 - beside > x1 + beside) continue;
      from = std::max(from, face.column(x0 - beside) - tile.column);
      to = std::min(to, face.column(x1 + beside) - tile.column);
    }
    if (from > to) continue;
    const Run run{begins[r * cells + from], begins[r * cells + to + 1]};
    if (run.begin == run.end) continue;
    if (count > 0 && runs[count - 1].end == run.begin)
      runs[count - 1].end = run.end;
    else
      runs[count++] = run;
  }
  return count;
}

/// Writes the samples of the runs that no side clearly leaves out; returns how many.
GNOMON_ALIAS_FREE_MAP_CLONES inline std::uint32_t find_candidates(const double* xs, const double* ys, const double* zs,
                                                                  const Run* runs, int run_count, const Shadow& shadow,
                                                                  std::uint32_t* out) {
  using Lanes = double __attribute__((vector_size(32)));
  typedef double Loaded __attribute__((vector_size(32), aligned(8), may_alias));  // clang takes no alignment from a `using`
  static_assert(sizeof(Lanes) == Grid::lanes * sizeof(double));
  std::uint32_t count = 0;
  const Side* const s = shadow.sides;
  for (int r = 0; r < run_count; ++r)
    for (std::uint32_t i = runs[r].begin; i < runs[r].end; i += Grid::lanes) {
      const Lanes x = *reinterpret_cast<const Loaded*>(xs + i), y = *reinterpret_cast<const Loaded*>(ys + i),
                  z = *reinterpret_cast<const Loaded*>(zs + i);
      const Lanes v0 = s[0].x * x + s[0].y * y + s[0].z * z + s[0].offset;
      const Lanes v1 = s[1].x * x + s[1].y * y + s[1].z * z + s[1].offset;
      const Lanes v2 = s[2].x * x + s[2].y * y + s[2].z * z + s[2].offset;
      const Lanes v3 = s[3].x * x + s[3].y * y + s[3].z * z + s[3].offset;
      const auto outside = (v0 < 0) | (v1 < 0) | (v2 < 0) | (v3 < 0);
      if ((outside[0] & outside[1] & outside[2] & outside[3]) != 0) continue;
      const std::uint32_t end = std::min(Grid::lanes, runs[r].end - i);
      for (std::uint32_t k = 0; k < end; ++k) {
        out[count] = i + k;
        count += outside[k] == 0;
      }
    }
  return count;
}

}  // namespace gnomon::alias_free_map
