#include <gnomon/kit/bytes.h>
#include <gnomon/kit/geometry/edges.h>
#include <gnomon/kit/geometry/exact.h>
#include <gnomon/kit/parallel.h>
#include <gnomon/kit/vectorized.h>

#include <algorithm>
#include <cmath>

namespace gnomon {

namespace {

constexpr std::size_t silhouette_block = std::size_t{1} << 15;

// The error of a plane's value at a homogeneous point of floats, with e = 2^-24 and S the sum of the normal's components times
// the largest coordinate of the point plus w times that of the scene: rounding the normal and the offset to float32 costs 2 e S
// (find_planes leaves out the planes whose error before that is not small beside it); the products and sums in float32 cost
// 4 e S.
constexpr float plane_error = 0x1p-21f;

/// Infinite where products of so small numbers have fewer digits.
float allowed_error(float scale) { return scale < 0x1p-90f ? INFINITY : plane_error * scale; }

struct FloatPlanes {
  const float *x, *y, *z, *offset;
};

/// +1, -1, or `unsure` where rounding may have made the sign.
constexpr std::int8_t unsure = 2;
GNOMON_VECTORIZED void quick_sides(std::size_t begin, std::size_t end, FloatPlanes planes, const float* point, float scale,
                                   std::int8_t* __restrict sides) {
  const float px = point[0], py = point[1], pz = point[2], pw = point[3], allowed = allowed_error(scale);
  for (std::size_t t = begin; t < end; ++t) {
    const float x = planes.x[t], y = planes.y[t], z = planes.z[t];
    const float value = x * px + y * py + z * pz + planes.offset[t] * pw;
    const float bound = (std::abs(x) + std::abs(y) + std::abs(z)) * allowed;
    sides[t] = static_cast<std::int8_t>(value > bound ? 1 : value < -bound ? -1 : unsure);
  }
}

float largest(const glm::dvec4& point, double extent) {
  return static_cast<float>(gnomon::extent(glm::dvec3(point)) + std::abs(point.w) * extent);
}

}  // namespace

/// In double from the corners, rounded; scaled by a power of two to a length about 1, so that no product leaves the range of
/// float32. The double normal errs by at most 2^-51 of its permanent m (the sum of its products without signs). Where the
/// normal is so short beside m that this is not small beside 2^-24 of it, the plane is left out, and where the numbers leave
/// the range.
void EdgeAdjacency::find_planes(std::size_t first, std::size_t count) {
  for_blocks(count, silhouette_block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = first + begin; t < first + end; ++t) {
      planes_.x[t] = planes_.y[t] = planes_.z[t] = planes_.offset[t] = 0;
      const glm::dvec3 a = positions_[triangles_[t].x], u = glm::dvec3(positions_[triangles_[t].y]) - a,
                       v = glm::dvec3(positions_[triangles_[t].z]) - a;
      const glm::dvec3 normal = glm::cross(u, v), au = glm::abs(u), av = glm::abs(v), an = glm::abs(normal);
      const double permanent = au.y * av.z + au.z * av.y + au.z * av.x + au.x * av.z + au.x * av.y + au.y * av.x;
      const double length = an.x + an.y + an.z;
      if (!(length >= 0x1p-20 * permanent && length >= 0x1p-900 && length <= 0x1p900)) continue;
      const glm::dvec3 unit = normal * std::ldexp(1.0, -std::ilogb(length));  // exact
      const double offset = -glm::dot(unit, a);
      if (!(std::abs(offset) <= 0x1p120)) continue;
      planes_.x[t] = static_cast<float>(unit.x);
      planes_.y[t] = static_cast<float>(unit.y);
      planes_.z[t] = static_cast<float>(unit.z);
      planes_.offset[t] = static_cast<float>(offset);
    }
  });
}

int EdgeAdjacency::side(std::uint32_t t, const glm::dvec4& point) const {
  const glm::vec4 p(point);
  const float x = planes_.x[t], y = planes_.y[t], z = planes_.z[t];
  const float value = x * p.x + y * p.y + z * p.z + planes_.offset[t] * p.w;
  const float bound = (std::abs(x) + std::abs(y) + std::abs(z)) * allowed_error(largest(point, extent_));
  if (value > bound) return 1;
  if (value < -bound) return -1;
  const auto& [a, b, c] = corners(t).points;
  return orient3d_sign(a, b, c, point);
}

std::size_t Silhouette::bytes() const {
  std::size_t bytes = bytes_of(facing, edges, halves);
  for (const std::vector<SilhouetteEdge>& block : blocks) bytes += bytes_of(block);
  return bytes;
}

EdgeAdjacency::Half EdgeAdjacency::half(const Part& part, const glm::dvec4& light) const {
  if (!part.closed) return Half::both;
  if (light.w != 0 && part.bounds.holds(glm::dvec3(light) / light.w)) return Half::both;
  return part.volume < 0 ? Half::clockwise : Half::counter_clockwise;
}

std::vector<std::int8_t> EdgeAdjacency::halves_under(const glm::dvec4& light) const {
  std::vector<std::int8_t> halves;
  halves.reserve(parts_.size());
  for (const Part& part : parts_) halves.push_back(static_cast<std::int8_t>(half(part, light)));
  return halves;
}

void EdgeAdjacency::find_facing(std::size_t first, std::size_t count, const glm::dvec4& light,
                                const std::vector<std::int8_t>& halves, std::vector<std::int8_t>& facing) const {
  const glm::vec4 point(light);
  const FloatPlanes planes{planes_.x.data(), planes_.y.data(), planes_.z.data(), planes_.offset.data()};
  for_blocks(count, silhouette_block, [&](std::size_t begin, std::size_t end) {
    std::int8_t* const sides = facing.data();
    quick_sides(first + begin, first + end, planes, &point.x, largest(light, extent_), sides);
    for (std::size_t t = first + begin; t < first + end; ++t) {
      const std::uint32_t part = part_of_[t];
      const std::int8_t wanted = part == no_part ? std::int8_t{0} : halves[part];
      if (sides[t] == unsure) sides[t] = static_cast<std::int8_t>(side(static_cast<std::uint32_t>(t), light));
      if (part == no_part || (wanted != 0 && sides[t] != wanted)) sides[t] = 0;
    }
  });
}

int EdgeAdjacency::count_at(const IrregularEdge& edge, std::span<const std::int8_t> facing) const {
  int count = 0;
  for (const Side side : std::span(sides_).subspan(edge.first_side, edge.side_count))
    count += side & 1 ? facing[side / 2] : -facing[side / 2];
  return count;
}

template <class AnyEdge>
void EdgeAdjacency::add_outline(std::span<const AnyEdge> some, std::span<const std::int8_t> facing,
                                std::vector<SilhouetteEdge>& outline) const {
  for (const AnyEdge& edge : some) {
    const int count = count_at(edge, facing);
    if (count == 0 || (joins_by_rigs_ && positions_[edge.low] == positions_[edge.high])) continue;
    outline.push_back({edge.low, edge.high, count, part_at(edge)});
  }
}

void EdgeAdjacency::find_silhouette(const glm::dvec4& light, Silhouette& out) const {
  out.light = light;
  std::vector<std::int8_t> halves = halves_under(light);
  out.facing.resize(triangles_.size());
  find_facing(0, triangles_.size(), light, halves, out.facing);
  if (!joins_by_rigs_) halves.clear();
  out.halves = std::move(halves);

  out.blocks.resize((edges_.size() + silhouette_block - 1) / silhouette_block);
  for_blocks(edges_.size(), silhouette_block, [&](std::size_t begin, std::size_t end) {
    std::vector<SilhouetteEdge>& block = out.blocks[begin / silhouette_block];
    block.clear();
    add_outline(edges().subspan(begin, end - begin), out.facing, block);
  });
  out.edges.clear();
  for (const std::vector<SilhouetteEdge>& block : out.blocks) out.edges.insert(out.edges.end(), block.begin(), block.end());
  out.regular_count = out.edges.size();
  add_outline(irregular_edges(), out.facing, out.edges);
}

// Edges of all kinds rise by their lower end, and those of an outline do, too. An edge at a vertex of a mesh that moved is of
// triangles that moved with it.
template <class AnyEdge>
void EdgeAdjacency::add_moved(std::span<const AnyEdge> all, std::span<const SilhouetteEdge> before, const Moved& moved,
                              std::span<const std::int8_t> facing, std::vector<SilhouetteEdge>& outline) const {
  const auto from = [](const auto& some, std::uint32_t vertex) {
    const auto is_below = [vertex](const auto& edge) { return edge.low < vertex; };
    return static_cast<std::size_t>(std::partition_point(some.begin(), some.end(), is_below) - some.begin());
  };
  std::size_t kept = 0;
  for (const std::uint32_t m : moved) {
    const std::uint32_t first = meshes_[m].first_vertex, end = first + meshes_[m].vertex_count;
    const std::span<const SilhouetteEdge> still = before.subspan(kept, from(before, first) - kept);
    outline.insert(outline.end(), still.begin(), still.end());
    kept = from(before, end);
    const std::size_t at = from(all, first);
    add_outline(all.subspan(at, from(all, end) - at), facing, outline);
  }
  outline.insert(outline.end(), before.begin() + static_cast<std::ptrdiff_t>(kept), before.end());
}

Refaced EdgeAdjacency::find_silhouette(const glm::dvec4& light, const Moved& moved, Silhouette& out) const {
  const auto triangle_count = static_cast<std::uint32_t>(triangles_.size());
  const std::vector<std::int8_t> halves = halves_under(light);
  if (!joins_by_rigs_ || out.light != light || out.facing.size() != triangle_count || out.halves != halves) {
    find_silhouette(light, out);
    return {0, triangle_count};
  }
  Refaced refaced{triangle_count, 0};
  std::vector<std::int8_t> before;
  for (const std::uint32_t m : moved) {
    const MeshTriangles& mesh = meshes_[m];
    const auto first = out.facing.begin() + mesh.first;
    before.assign(first, first + mesh.count);
    find_facing(mesh.first, mesh.count, light, halves, out.facing);
    for (std::uint32_t k = 0; k < mesh.count; ++k) {
      if (before[k] == out.facing[mesh.first + k]) continue;
      refaced.first = std::min(refaced.first, mesh.first + k);
      refaced.end = mesh.first + k + 1;
    }
  }
  std::vector<SilhouetteEdge> outline;
  outline.reserve(out.edges.size());
  const std::span<const SilhouetteEdge> known(out.edges);
  add_moved(edges(), known.first(out.regular_count), moved, out.facing, outline);
  const std::size_t regular_count = outline.size();
  add_moved(irregular_edges(), known.subspan(out.regular_count), moved, out.facing, outline);
  out.edges = std::move(outline);
  out.regular_count = regular_count;
  for (std::vector<SilhouetteEdge>& block : out.blocks) block.clear();
  return refaced;
}

// The way from P to the light crosses triangle ABC iff P and L are on different sides of its plane and the three edges turn
// the same way about it.
EdgeAdjacency::Depth EdgeAdjacency::depth_at(const glm::vec3& point, const Silhouette& silhouette) const {
  const glm::dvec4 p(point, 1), &light = silhouette.light;
  // A box that the way to the light clearly misses holds nothing that it crosses.
  const auto misses = [&](const Bounds& box) {
    const glm::dvec3 way = to_light(light, glm::dvec3(p));
    const double reach = 0x1p-40 * std::max(extent_, extent(point)), length = light.w != 0 ? 1 / light.w : INFINITY;
    double near = 0, far = length;
    for (int k = 0; k < 3; ++k) {
      const double low = box.min[k] - reach - p[k], high = box.max[k] + reach - p[k];
      if (way[k] == 0) {
        if (low > 0 || high < 0) return true;
        continue;
      }
      near = std::max(near, std::min(low / way[k], high / way[k]) * (1 - 0x1p-40));
      far = std::min(far, std::max(low / way[k], high / way[k]) * (1 + 0x1p-40));
    }
    return near > far;
  };
  Depth sum;
  std::vector<Depth> blocks;
  for (const MeshTriangles& mesh : meshes_) {
    if (!mesh.casts || misses(mesh.bounds)) continue;
    blocks.assign((mesh.count + silhouette_block - 1) / silhouette_block, {});
    for_blocks(mesh.count, silhouette_block, [&](std::size_t begin, std::size_t end) {
      Depth& block = blocks[begin / silhouette_block];
      for (std::size_t t = mesh.first + begin; t < mesh.first + end; ++t) {
        const int facing = silhouette.facing[t];
        if (facing == 0) continue;
        const int of_point = side(static_cast<std::uint32_t>(t), p);
        if (of_point == facing) continue;
        const auto& [a, b, c] = corners(t).points;
        const int turns[] = {orient3d_sign(point, a, b, light), orient3d_sign(point, b, c, light),
                             orient3d_sign(point, c, a, light)};
        const bool up = turns[0] >= 0 && turns[1] >= 0 && turns[2] >= 0, down = turns[0] <= 0 && turns[1] <= 0 && turns[2] <= 0;
        if (!up && !down) continue;
        block.degenerate |= of_point == 0 || turns[0] == 0 || turns[1] == 0 || turns[2] == 0;
        block.volumes += of_point != 0;
      }
    });
    for (const Depth& block : blocks) {
      sum.volumes += block.volumes;
      sum.degenerate |= block.degenerate;
    }
  }
  return sum;
}

}  // namespace gnomon
