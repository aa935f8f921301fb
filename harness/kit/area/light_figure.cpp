#include <gnomon/kit/area/light_figure.h>
#include <gnomon/kit/geometry/across.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gnomon {

namespace {

std::vector<glm::dvec2> square() { return {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}; }

/// The largest sine of the height over the horizon along the way from a to b, which the point is not on. With d = a + x (b - a)
/// the derivative of n.d / |d| is zero where a linear function of x is.
double highest_between(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& n) {
  const glm::dvec3 way = b - a;
  const double along = glm::dot(n, way), start = glm::dot(n, a), turn = glm::dot(a, way);
  const double slope = along * turn - start * glm::dot(way, way), value = along * glm::dot(a, a) - start * turn;
  const auto sine = [&](double x) {
    const glm::dvec3 d = a + x * way;
    return glm::dot(n, d) / glm::length(d);
  };
  const double best = std::max(sine(0), sine(1));
  const double x = slope != 0 ? -value / slope : 0;
  return x > 0 && x < 1 ? std::max(best, sine(x)) : best;
}

/// Lambert's integral along an edge from `start` by `way`: half of the angle, times the part of the normal across both ends.
double along_edge(const glm::dvec3& start, const glm::dvec3& way, const glm::dvec3& n) {
  const glm::dvec3 across = glm::cross(start, way);
  const double sine = glm::length(across);
  return sine > 0 ? std::atan2(sine, glm::dot(start, start + way)) / sine * glm::dot(n, across) / 2 : 0;
}

/// (n0 + n1 cos t + n2 sin t) / (a + b cos t + c sin t), with d = hypot(b, c) and a - d and a + d as they come without
/// rounding.
struct RimIntegrand {
  double n0, n1, n2, a, b, c, less, more;

  /// All around.
  double whole() const {
    const double root = std::sqrt(less * more);
    return root > 0 ? 2 * std::numbers::pi / root * (n0 - (n1 * b + n2 * c) / (a + root)) : 0;
  }
  /// Over -end .. end.
  double up_to(double end) const {
    const double d = std::hypot(b, c);
    if (d <= 1e-12 * a) return (2 * n0 * end + 2 * n1 * std::sin(end)) / a;
    if (d < 1e-3 * a) return by_parts(end);
    if (!(less > 0)) return 0;
    // Turned by `turn`, what is below is a + d cos t, and what is above has a part of that, a part of its derivative and a
    // rest.
    const double turn = std::atan2(c, b), m1 = (n1 * b + n2 * c) / d, m2 = (n2 * b - n1 * c) / d;
    const double root = std::sqrt(less * more), slope = std::sqrt(less / more);
    const auto below = [&](double t) { return std::log(a + d * std::cos(t)); };
    const auto inverse = [&](double t) {  // integral of 1 / (a + d cos t), continuous
      const double turns = std::round(t / (2 * std::numbers::pi)) * std::numbers::pi;
      return 2 / root * (std::atan(slope * std::tan(t / 2 - turns)) + turns);
    };
    const double low = -end - turn, high = end - turn;
    return m1 / d * (high - low) + (n0 - a * m1 / d) * (inverse(high) - inverse(low)) - m2 / d * (below(high) - below(low));
  }

 private:
  double at(double t) const { return (n0 + n1 * std::cos(t) + n2 * std::sin(t)) / (a + b * std::cos(t) + c * std::sin(t)); }
  /// What is below is nearly a constant, and the closed form divides by d: Gauss's three points in each of 16 parts are off by
  /// less than 1e-12.
  double by_parts(double end) const {
    constexpr int parts = 16;
    constexpr double aside = 0.7745966692414834, weights[] = {5.0 / 9, 8.0 / 9, 5.0 / 9};
    double sum = 0;
    for (int k = 0; k < parts; ++k)
      for (int j = 0; j < 3; ++j) sum += weights[j] * at(end * (-1 + (2 * k + 1 + (j - 1) * aside) / parts));
    return sum * end / parts;
  }
};

}  // namespace

void clip_places(std::vector<glm::dvec2>& polygon, const glm::dvec3& line) {
  std::vector<glm::dvec2> kept;
  kept.reserve(polygon.size() + 1);
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec2 &here = polygon[i], &next = polygon[(i + 1) % polygon.size()];
    const double at_here = line_at(line, here), at_next = line_at(line, next);
    if (at_here >= 0) kept.push_back(here);
    if ((at_here > 0 && at_next < 0) || (at_here < 0 && at_next > 0))
      kept.push_back(here + at_here / (at_here - at_next) * (next - here));
  }
  polygon = std::move(kept);
}

LightFigure::LightFigure(const LightShape& shape, const glm::dvec3& point, const glm::dvec3& normal) : normal_(normal) {
  glm::dvec3 center = shape.center - point;
  half_u_ = shape.half_u;
  half_v_ = shape.half_v;
  is_disc_ = shape.form != LightShape::Form::rectangle;
  if (is_disc_) {
    glm::dvec3 axis;
    double radius = shape.radius;
    if (shape.is_flat()) {
      axis = shape.front();
    } else {
      // Tangents from the distance d touch a sphere of radius r in a circle at d - r^2 / d, of radius r sqrt(1 - r^2 / d^2).
      const double square = glm::dot(center, center), share = radius * radius / square;
      if (!(share < 1)) return;
      axis = center / std::sqrt(square);
      center *= 1 - share;
      radius *= std::sqrt(1 - share);
    }
    // Along u the height over the horizon grows, along v it stays.
    const glm::dvec3 level = glm::cross(axis, normal);
    const Across across = glm::dot(level, level) > 1e-24 ? Across(axis, normal) : Across(axis);
    half_u_ = radius * across.v;
    half_v_ = radius * across.u;
    if (glm::dot(half_u_, normal) < 0) half_u_ = -half_u_;
  }
  center_ = center;
  axis_ = glm::cross(half_u_, half_v_);
  horizon_ = {glm::dot(normal, center_), glm::dot(normal, half_u_), glm::dot(normal, half_v_)};
  const glm::dvec3 front = is_disc_ && shape.is_one_sided ? shape.across : axis_;
  const double before = -glm::dot(front, center_);  // of the plane: positive where the point is on the front's side
  if (shape.is_one_sided ? !(before > 0) : before == 0) return;
  if (is_disc_) {
    const double rise = std::hypot(horizon_.y, horizon_.z);
    if (!(horizon_.x + rise > 0)) return;
    horizon_.y = rise;
    horizon_.z = 0;
    const double start = horizon_.x < rise ? -horizon_.x / rise : -1;  // s of the horizon
    box_.low.x = start;
    const double wide = start > 0 ? std::sqrt(1 - start * start) : 1;
    box_.low.y = -wide;
    box_.high.y = wide;
  } else if (!(horizon_.x > std::abs(horizon_.y) + std::abs(horizon_.z))) {  // else all four corners are above it
    std::vector<glm::dvec2> seen = square();
    clip_places(seen, horizon_);
    if (seen.size() < 3) return;
    box_ = {seen[0], seen[0]};
    for (const glm::dvec2& place : seen) box_.add(place);
    if (!(box_.low.x < box_.high.x && box_.low.y < box_.high.y)) return;
  }
  is_seen_ = true;
}

double LightFigure::irradiance() const {
  if (!is_seen_) return 0;
  const double distance = glm::length(center_), size = glm::length(half_u_) + glm::length(half_v_);
  const bool is_cut = !(horizon_.x > std::abs(horizon_.y) + std::abs(horizon_.z));
  // So small a figure is one place; the sum over its outline would lose digits.
  if (size < 1e-5 * distance && !is_cut) return (is_disc_ ? std::numbers::pi : 4) * weight(center_);
  if (!is_disc_) return of_rectangle(is_cut);
  // The rim is r = center + cos t half_u + sin t half_v. With h the height over the disc's plane and `aside` the distance from
  // its axis, |r|^2 is between h^2 + (aside - radius)^2 and h^2 + (aside + radius)^2.
  const double radius = glm::length(half_u_), h = glm::dot(center_, glm::normalize(axis_));
  const double aside = glm::length(center_ - h * glm::normalize(axis_));
  const RimIntegrand rim{.n0 = glm::dot(normal_, axis_),
                         .n1 = glm::dot(normal_, glm::cross(center_, half_v_)),
                         .n2 = -glm::dot(normal_, glm::cross(center_, half_u_)),
                         .a = h * h + aside * aside + radius * radius,
                         .b = 2 * glm::dot(center_, half_u_),
                         .c = 2 * glm::dot(center_, half_v_),
                         .less = h * h + (aside - radius) * (aside - radius),
                         .more = h * h + (aside + radius) * (aside + radius)};
  const double start = box_.low.x;
  if (start <= -1) return std::abs(rim.whole()) / 2;
  // Where the horizon cuts it, the chord closes what is left.
  const double wide = std::sqrt(std::max(0.0, 1 - start * start));
  return std::abs(rim.up_to(std::acos(start)) / 2 + along_edge(at({start, wide}), -2 * wide * half_v_, normal_));
}

double LightFigure::of_rectangle(bool is_cut) const {
  if (!is_cut) {
    const glm::dvec3 u = 2.0 * half_u_, v = 2.0 * half_v_;
    return std::abs(along_edge(at({-1, -1}), u, normal_) + along_edge(at({1, -1}), v, normal_) +
                    along_edge(at({1, 1}), -u, normal_) + along_edge(at({-1, 1}), -v, normal_));
  }
  double sum = 0;
  std::vector<glm::dvec2> seen = square();
  clip_places(seen, horizon_);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const glm::dvec2 way = seen[(i + 1) % seen.size()] - seen[i];
    sum += along_edge(at(seen[i]), way.x * half_u_ + way.y * half_v_, normal_);
  }
  return std::abs(sum);
}

double LightFigure::highest() const {
  // The plane's place straight above the point, where there is one, is its highest.
  const double rise = glm::dot(normal_, axis_);
  if (rise != 0) {
    const double distance = glm::dot(center_, axis_) / rise;
    const glm::dvec3 off = distance * normal_ - center_;
    const glm::dvec3 u = glm::cross(half_v_, axis_), v = glm::cross(axis_, half_u_);
    const glm::dvec2 place(glm::dot(off, u) / glm::dot(half_u_, u), glm::dot(off, v) / glm::dot(half_v_, v));
    const bool is_inside = is_disc_ ? glm::dot(place, place) <= 1 : std::max(std::abs(place.x), std::abs(place.y)) <= 1;
    if (distance > 0 && is_inside) return 1;
  }
  std::vector<glm::dvec2> outline = is_disc_ ? std::vector<glm::dvec2>() : square();
  constexpr int corner_count = 64;
  for (int k = 0; is_disc_ && k < corner_count; ++k) {
    const double angle = 2 * std::numbers::pi * k / corner_count;
    outline.emplace_back(std::cos(angle), std::sin(angle));
  }
  double best = -1;
  for (std::size_t k = 0; k < outline.size(); ++k)
    best = std::max(best, highest_between(at(outline[k]), at(outline[(k + 1) % outline.size()]), normal_));
  return best;
}

}  // namespace gnomon
