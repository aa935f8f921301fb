#include <gmpxx.h>
#include <gnomon/kit/geometry/holes.h>

#include <cassert>
#include <cmath>

namespace gnomon {

namespace {

/// Weights of a triangle's corners at the place where a line meets its plane, up to a common factor: signed volumes of the
/// line with the edge across from each. Each errs by at most `bound`.
struct Weights {
  double w[3], bound[3];
  double sum() const { return w[0] + w[1] + w[2]; }
};

/// Of the line through the origin along `way`; corners relative to a point of the line. Six products of three factors, each a
/// rounded difference, and five sums: nine roundings at most, as of the filter in exact.cpp.
Weights weights(const glm::dvec3 (&corners)[3], const glm::dvec3& way) {
  Weights result;
  for (int k = 0; k < 3; ++k) {
    const glm::dvec3 &u = corners[(k + 1) % 3], &v = corners[(k + 2) % 3];
    const double yz = u.y * v.z, zy = u.z * v.y, zx = u.z * v.x, xz = u.x * v.z, xy = u.x * v.y, yx = u.y * v.x;
    result.w[k] = way.x * (yz - zy) + way.y * (zx - xz) + way.z * (xy - yx);
    result.bound[k] = 9 * 0x1p-53 *
                      (std::abs(way.x) * (std::abs(yz) + std::abs(zy)) + std::abs(way.y) * (std::abs(zx) + std::abs(xz)) +
                       std::abs(way.z) * (std::abs(xy) + std::abs(yx)));
  }
  return result;
}

Weights weights(const Mesh& mesh, std::uint32_t triangle, const glm::dvec3& point, const glm::dvec3& way, double scale = 1) {
  const glm::uvec3& t = mesh.triangles[triangle];
  glm::dvec3 corners[3];
  for (int k = 0; k < 3; ++k) corners[k] = scale * glm::dvec3(mesh.positions[t[k]]) - point;
  return weights(corners, way);
}

/// The coordinate of one axis at the corners, in texels: at most 24 + 14 bits, so exact.
struct Axis {
  double at[3];
  Axis(const Mesh& mesh, std::uint32_t triangle, int axis, int texels) {
    for (int k = 0; k < 3; ++k)
      at[k] = static_cast<double>(texels) * static_cast<double>(mesh.uv[mesh.triangles[triangle][k]][axis]);
  }
  double place(const Weights& weights) const {
    return (weights.w[0] * at[0] + weights.w[1] * at[1] + weights.w[2] * at[2]) / weights.sum();
  }
};

/// Whether a coordinate in texels is a whole number's neighbor that fits 64 bits.
bool is_texel(double place) { return std::abs(place) < 0x1p52; }

/// The texels along one axis that may hold a place: one where double is sure, else two neighbors, and perhaps others where it
/// is not sure of these either.
struct Candidates {
  std::int64_t first, last;
  bool is_sure;
};
Candidates candidates(const Axis& axis, const Weights& weights) {
  const double side = weights.sum() < 0 ? -1 : 1, place = axis.place(weights);
  if (!is_texel(place)) return {0, 0, false};
  const auto middle = static_cast<std::int64_t>(std::floor(place));
  // Sign of the place minus a texel's edge: +1 and -1 where sure, else 0.
  const auto beyond = [&](std::int64_t edge) {
    double value = 0, bound = 0;
    for (int k = 0; k < 3; ++k) {
      const double off = axis.at[k] - static_cast<double>(edge);
      value += side * weights.w[k] * off;
      // The weight's own error, and roundings of the difference, the product and the sums.
      bound += (weights.bound[k] + 4 * 0x1p-53 * std::abs(weights.w[k])) * std::abs(off);
    }
    bound *= 1 + 0x1p-40;
    return value > bound ? 1 : value < -bound ? -1 : 0;
  };
  const std::int64_t first = beyond(middle) > 0 ? middle : middle - 1, last = beyond(middle + 1) < 0 ? middle : middle + 1;
  const bool is_sure = (first == middle || beyond(first) > 0) && (last == middle || beyond(last + 1) < 0);
  return {first, last, is_sure};
}

/// The texel along one axis, in rational numbers.
std::int64_t exact_texel(const Mesh& mesh, std::uint32_t triangle, const Segment& segment, const Axis& axis) {
  const glm::uvec3& t = mesh.triangles[triangle];
  mpq_class corners[3][3], way[3];
  for (int i = 0; i < 3; ++i) {
    way[i] = mpq_class(segment.light[i]) - (segment.light.w != 0 ? mpq_class(segment.point[i]) : mpq_class(0));
    for (int k = 0; k < 3; ++k) corners[k][i] = mpq_class(mesh.positions[t[k]][i]) - mpq_class(segment.point[i]);
  }
  mpq_class place = 0, sum = 0;
  for (int k = 0; k < 3; ++k) {
    const auto &u = corners[(k + 1) % 3], &v = corners[(k + 2) % 3];
    const mpq_class w =
        way[0] * (u[1] * v[2] - u[2] * v[1]) + way[1] * (u[2] * v[0] - u[0] * v[2]) + way[2] * (u[0] * v[1] - u[1] * v[0]);
    place += w * mpq_class(axis.at[k]);
    sum += w;
  }
  if (sum == 0) return 0;
  place /= sum;
  mpz_class floor;
  mpz_fdiv_q(floor.get_mpz_t(), place.get_num_mpz_t(), place.get_den_mpz_t());
  return floor.get_si();
}

/// What `look_up(column, row)` finds where a segment meets a triangle whose texture has width x height texels.
template <class LookUp>
auto found_at(const Mesh& mesh, std::uint32_t triangle, const Segment& segment, int width, int height, const LookUp& look_up) {
  const glm::dvec3 point = segment.point;
  const Weights w = weights(mesh, triangle, point, glm::dvec3(segment.light) - segment.light.w * point);
  const Axis u(mesh, triangle, 0, width), v(mesh, triangle, 1, height);
  const Candidates columns = candidates(u, w), rows = candidates(v, w);
  const auto found = look_up(columns.first, rows.first);
  bool is_same = true;
  for (std::int64_t row = rows.first; row <= rows.last; ++row)
    for (std::int64_t column = columns.first; column <= columns.last; ++column) is_same &= look_up(column, row) == found;
  if (is_same && columns.is_sure && rows.is_sure) return found;
  return look_up(exact_texel(mesh, triangle, segment, u), exact_texel(mesh, triangle, segment, v));
}

/// The same along a line, in double; `edge_on` where the line runs in the triangle's plane and meets no texel.
template <class LookUp>
auto found_along(const Mesh& mesh, std::uint32_t triangle, const glm::dvec3& origin, const glm::dvec3& direction, double scale,
                 int width, int height, const LookUp& look_up, decltype(look_up(0, 0)) edge_on) {
  const Weights w = weights(mesh, triangle, origin, direction, scale);
  const double x = Axis(mesh, triangle, 0, width).place(w), y = Axis(mesh, triangle, 1, height).place(w);
  if (!is_texel(x) || !is_texel(y)) return edge_on;
  return look_up(static_cast<std::int64_t>(std::floor(x)), static_cast<std::int64_t>(std::floor(y)));
}

/// A reach of so many texels meets all that a texture has near.
constexpr double most_reach = 64;

auto look_up_in(const AlphaMask& mask) {
  return [&](std::int64_t column, std::int64_t row) { return mask.is_solid_wrapped(column, row); };
}
auto look_up_in(const Transmission& transmission) {
  return [&](std::int64_t column, std::int64_t row) { return transmission.at_wrapped(column, row); };
}

}  // namespace

TexelPlace texel_place(const Mesh& mesh, std::uint32_t triangle, const glm::dvec3& point, const glm::dvec4& light,
                       const glm::ivec2& size) {
  const Weights w = weights(mesh, triangle, point, glm::dvec3(light) - light.w * point);
  return {Axis(mesh, triangle, 0, size.x).place(w), Axis(mesh, triangle, 1, size.y).place(w)};
}

bool is_solid_at(const Mesh& mesh, std::uint32_t triangle, const Segment& segment) {
  if (!mesh.alpha_mask) return true;
  const AlphaMask& mask = *mesh.alpha_mask;
  return found_at(mesh, triangle, segment, mask.width(), mask.height(), look_up_in(mask));
}

bool is_solid_along(const Mesh& mesh, std::uint32_t triangle, const glm::dvec3& origin, const glm::dvec3& direction,
                    double scale) {
  if (!mesh.alpha_mask) return true;
  const AlphaMask& mask = *mesh.alpha_mask;
  // Edge-on it is solid, as the triangle is that was met.
  return found_along(mesh, triangle, origin, direction, scale, mask.width(), mask.height(), look_up_in(mask), true);
}

glm::vec3 transmission_at(const Mesh& mesh, std::uint32_t triangle, const Segment& segment) {
  if (!mesh.transmission) return glm::vec3(0);
  const Transmission& glass = *mesh.transmission;
  if (glass.is_constant()) return glass.at(0, 0);
  return found_at(mesh, triangle, segment, glass.width(), glass.height(), look_up_in(glass));
}

glm::vec3 transmission_along(const Mesh& mesh, std::uint32_t triangle, const glm::dvec3& origin, const glm::dvec3& direction,
                             double scale) {
  if (!mesh.transmission) return glm::vec3(0);
  const Transmission& glass = *mesh.transmission;
  if (glass.is_constant()) return glass.at(0, 0);
  return found_along(mesh, triangle, origin, direction, scale, glass.width(), glass.height(), look_up_in(glass),
                     glass.at(0, 0));
}

std::optional<glm::vec3> transmission_around(const Transmission& glass, const TexelPlace& place, double reach, float most) {
  if (glass.is_constant()) return glass.at(0, 0);
  if (!(reach < most_reach) || !is_texel(place.x) || !is_texel(place.y)) return std::nullopt;
  const auto texel = [](double at) { return static_cast<std::int64_t>(std::floor(at)); };
  const glm::vec3 found = glass.at_wrapped(texel(place.x), texel(place.y));
  for (std::int64_t row = texel(place.y - reach); row <= texel(place.y + reach); ++row)
    for (std::int64_t column = texel(place.x - reach); column <= texel(place.x + reach); ++column) {
      const glm::vec3 off = glm::abs(glass.at_wrapped(column, row) - found);
      if (std::max({off.x, off.y, off.z}) > most) return std::nullopt;
    }
  return found;
}

Around around(const AlphaMask& mask, const TexelPlace& place, double reach) {
  const auto texel = [](double at) { return static_cast<std::int64_t>(std::floor(at)); };
  if (!(reach < most_reach) || !is_texel(place.x) || !is_texel(place.y)) {
    const double coverage = mask.coverage();
    return coverage == 1 ? Around::solid : coverage == 0 ? Around::hole : Around::both;
  }
  const bool is_solid = mask.is_solid_wrapped(texel(place.x), texel(place.y));
  for (std::int64_t row = texel(place.y - reach); row <= texel(place.y + reach); ++row)
    for (std::int64_t column = texel(place.x - reach); column <= texel(place.x + reach); ++column)
      if (mask.is_solid_wrapped(column, row) != is_solid) return Around::both;
  return is_solid ? Around::solid : Around::hole;
}

double texel_rounding(const Mesh& mesh, std::uint32_t triangle, const glm::dvec3& direction, double extent,
                      const glm::ivec2& size) {
  const Triangle corners = mesh.corners(triangle);
  const glm::dvec3 a = corners.points[0], edges[2] = {glm::dvec3(corners.points[1]) - a, glm::dvec3(corners.points[2]) - a};
  const glm::dvec3 normal = glm::cross(edges[0], edges[1]);
  const double area = glm::dot(normal, normal);
  const double cosine = std::abs(glm::dot(normal, direction)) / (std::sqrt(area) * glm::length(direction));
  double stretch = 0, most = 0;
  for (int axis = 0; axis < 2; ++axis) {
    const Axis texels(mesh, triangle, axis, size[axis]);
    // The gradient of the coordinate over the triangle's plane.
    const glm::dvec3 gradient = ((texels.at[1] - texels.at[0]) * glm::cross(edges[1], normal) +
                                 (texels.at[2] - texels.at[0]) * glm::cross(normal, edges[0])) /
                                area;
    stretch = std::max(stretch, glm::length(gradient));
    for (const double at : texels.at) most = std::max(most, std::abs(at));
  }
  const double rounding = 16 * 0x1p-24 * (2 * extent * stretch / cosine + most);
  return std::isfinite(rounding) ? rounding : INFINITY;
}

}  // namespace gnomon
