#include <gmpxx.h>
#include <gnomon/kit/geometry/exact.h>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace gnomon {

namespace {

/// The vector between two float32 points, a row of a determinant, with the points, so that it can be had exactly. All
/// coordinates are float32 values in doubles.
struct PointDifference {
  glm::dvec3 from, to, vector;
  PointDifference(const glm::dvec3& a, const glm::dvec3& b) : from(a), to(b), vector(b - a) {}
};

/// From a point to a homogeneous one: the difference of two points, or the direction itself.
PointDifference difference(const glm::dvec3& from, const glm::dvec4& to) {
  assert(to.w == 0 || to.w == 1);
  assert(glm::dvec3(glm::vec3(to)) == glm::dvec3(to));
  return {to.w == 0 ? glm::dvec3(0) : from, glm::dvec3(to)};
}

template <class Number>
Number determinant(const Number u[3], const Number v[3], const Number w[3]) {
  return u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) + u[2] * (v[0] * w[1] - v[1] * w[0]);
}

template <class Number>
int sign(const Number& x) {
  return (x > 0) - (x < 0);
}

/// The row on the lattice of 2^-40 of the power of two that bounds its coordinates; nothing when it is not on it. Each row
/// may have its own scale, since a positive factor leaves the sign of a determinant. Every row whose coordinates are multiples
/// of 2^-36 up to 16 is on its lattice.
struct LatticeRow {
  __int128 k[3];
};
std::optional<LatticeRow> on_lattice(const PointDifference& row) {
  double largest = 0;
  for (int i = 0; i < 3; ++i) largest = std::max({largest, std::abs(row.from[i]), std::abs(row.to[i])});
  if (largest == 0) return LatticeRow{};
  int exponent;
  if (std::frexp(largest, &exponent) == 0.5) --exponent;  // now largest <= 2^exponent
  const double scale = std::ldexp(1.0, 40 - exponent);
  LatticeRow result;
  for (int i = 0; i < 3; ++i) {
    const double a = row.from[i] * scale, b = row.to[i] * scale;  // exact, at most 2^40
    const auto from = static_cast<std::int64_t>(a), to = static_cast<std::int64_t>(b);
    if (static_cast<double>(from) != a || static_cast<double>(to) != b) return std::nullopt;
    result.k[i] = to - from;
  }
  return result;
}

/// Every float32 is an integer times 2^-149.
struct BigRow {
  mpz_class k[3];
  explicit BigRow(const PointDifference& row) {
    for (int i = 0; i < 3; ++i) k[i] = mpz_class(row.to[i] * 0x1p149) - mpz_class(row.from[i] * 0x1p149);
  }
};

/// Exact sign where the double filter is silent.
///
/// On the lattice: coordinates are at most 2^40, so differences are at most 2^41, their products 2^82, a difference of two
/// products 2^83, times a difference 2^124, and the sum of three of those stays below 2^126 < 2^127.
[[gnu::noinline]] int exact_sign(const PointDifference& u, const PointDifference& v, const PointDifference& w,
                                 SignTally* tally) {
  const auto ku = on_lattice(u), kv = on_lattice(v), kw = on_lattice(w);
  if (ku && kv && kw) {
    if (tally) ++tally->lattice;
    return sign(determinant(ku->k, kv->k, kw->k));
  }
  if (tally) ++tally->big;
  return sign(determinant<mpz_class>(BigRow(u).k, BigRow(v).k, BigRow(w).k));
}

/// Sign of det(u, v, w).
///
/// The filter, with e = 2^-53 and "a factor" short for some (1 + d) with |d| <= e. A computed difference of two floats is the
/// true one times a factor (exact, if their exponents are less than 29 apart). Each of the six terms of the computed
/// determinant is then the true term times at most eight factors: three differences, the inner product, the inner
/// subtraction, the outer product, two additions. So the error is at most g P, where P is the sum of the true terms'
/// absolute values and g = (1 + e)^8 - 1; the computed P, made by as many operations, is at least (1 - e)^8 P. Hence
///
///   |error| <= ((1 + e)^8 - 1) / (1 - e)^8 * computed P < (8 + 200 e) e * computed P,
///
/// and 9 e leaves room for the rounding of the bound itself. Nothing overflows or underflows on the way: differences lie
/// between 2^-149 and 2^129, products of two between 2^-298 and 2^258 and thus on the lattice 2^-351 (53 bits below), their
/// differences too, and products of three lie between 2^-500 and 2^389.
/// All products zero means each term is truly zero, and so is the determinant.
inline int determinant_sign(const PointDifference& row_u, const PointDifference& row_v, const PointDifference& row_w,
                            SignTally* tally) {
  const glm::dvec3 &u = row_u.vector, &v = row_v.vector, &w = row_w.vector;
  const double yz = v.y * w.z, zy = v.z * w.y, zx = v.z * w.x, xz = v.x * w.z, xy = v.x * w.y, yx = v.y * w.x;
  const double value = u.x * (yz - zy) + u.y * (zx - xz) + u.z * (xy - yx);
  const double sum = std::abs(u.x) * (std::abs(yz) + std::abs(zy)) + std::abs(u.y) * (std::abs(zx) + std::abs(xz)) +
                     std::abs(u.z) * (std::abs(xy) + std::abs(yx));
  const double bound = 9 * 0x1p-53 * sum;
  if (value > bound) return 1;
  if (value < -bound) return -1;
  return sum == 0 ? 0 : exact_sign(row_u, row_v, row_w, tally);
}

}  // namespace

int orient3d_sign(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::dvec4& d, SignTally* tally) {
  return determinant_sign({a, b}, {a, c}, difference(a, d), tally);
}

int orient3d_sign(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::vec3& d, SignTally* tally) {
  return determinant_sign({a, b}, {a, c}, {a, d}, tally);
}

bool coplanar(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::vec3& d) {
  return orient3d_sign(a, b, c, d) == 0;
}

bool coplanar(const Triangle& triangle, const glm::vec3* other) {
  const glm::vec3* p = triangle.points;
  return std::all_of(other, other + 3, [p](const glm::vec3& q) { return coplanar(p[0], p[1], p[2], q); });
}

// With the point at the origin let u, v, w be the corners and d the way to the light. If u, v, w are independent, write
// d = i u + j v + k w; by Cramer's rule det(v, w, d), det(w, u, d), det(u, v, d) are i, j, k times det(u, v, w). The ray meets
// the closed triangle exactly when i, j, k >= 0, that is, when no determinant has the sign opposite to det(u, v, w); a zero
// among them is an edge, two are a vertex. If u, v, w are dependent, the point is on the plane, which is then not crossed.
// A ray that meets the triangle does so before a light at finite distance when that light is strictly beyond the plane.
Crossing crosses(const Segment& segment, const Triangle& triangle, SignTally* tally) {
  const glm::dvec3 p(segment.point), a(triangle.points[0]), b(triangle.points[1]), c(triangle.points[2]);
  const PointDifference u(p, a), v(p, b), w(p, c), d = difference(p, segment.light);
  const int ab = determinant_sign(u, v, d, tally), bc = determinant_sign(v, w, d, tally);
  if (ab * bc < 0) return Crossing::none;
  const int ca = determinant_sign(w, u, d, tally);
  if (ab * ca < 0 || bc * ca < 0) return Crossing::none;
  const int side = determinant_sign(u, v, w, tally);
  if (side == 0 || ab + bc + ca == 0 || side * (ab + bc + ca) < 0) return Crossing::none;
  // orient3d(a, b, c, point) is -side, since ((b - a) x (c - a)) . (-a) = -det(a, b, c).
  if (segment.light.w != 0 && determinant_sign({a, b}, {a, c}, difference(a, segment.light), tally) != side)
    return Crossing::none;
  return ab * bc * ca == 0 ? Crossing::degenerate : Crossing::crosses;
}

}  // namespace gnomon
