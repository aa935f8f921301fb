#include <gnomon/kit/across.h>
#include <gnomon/kit/light_face.h>

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

LightFace::LightFace(const Light& light, const glm::dvec3& point, const glm::dvec3& normal) : normal_(normal) {
  bool one_sided = false;
  if (const auto* rect = std::get_if<RectLight>(&light.kind)) {
    center_ = glm::dvec3(rect->center) - point;
    half_u_ = rect->half_u;
    half_v_ = rect->half_v;
    one_sided = rect->emits == Emits::in_front;
  } else {
    is_disc_ = true;
    glm::dvec3 axis;
    double radius = 0;
    if (const auto* disc = std::get_if<DiscLight>(&light.kind)) {
      center_ = glm::dvec3(disc->center) - point;
      axis = glm::normalize(glm::dvec3(disc->normal));
      radius = disc->radius;
      one_sided = disc->emits == Emits::in_front;
    } else {
      // Tangents from the distance d touch a sphere of radius r in a circle at d - r^2 / d, of radius r sqrt(1 - r^2 / d^2).
      const auto& sphere = std::get<SphereLight>(light.kind);
      const glm::dvec3 to = glm::dvec3(sphere.center) - point;
      const double square = glm::dot(to, to), share = static_cast<double>(sphere.radius) * sphere.radius / square;
      if (!(share < 1)) return;
      center_ = (1 - share) * to;
      axis = to / std::sqrt(square);
      radius = sphere.radius * std::sqrt(1 - share);
    }
    // Along u the height over the horizon grows, along v it stays.
    const glm::dvec3 level = glm::cross(axis, normal);
    const Across across = glm::dot(level, level) > 1e-24 ? Across(axis, normal) : Across(axis);
    half_u_ = radius * across.v;
    half_v_ = radius * across.u;
    if (glm::dot(half_u_, normal) < 0) half_u_ = -half_u_;
  }
  axis_ = glm::cross(half_u_, half_v_);
  horizon_ = {glm::dot(normal, center_), glm::dot(normal, half_u_), glm::dot(normal, half_v_)};
  const glm::dvec3 front = is_disc_ && one_sided ? glm::dvec3(std::get<DiscLight>(light.kind).normal) : axis_;
  const double before = -glm::dot(front, center_);  // of the plane: positive where the point is on the front's side
  if (one_sided ? !(before > 0) : before == 0) return;
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
    for (const glm::dvec2& place : seen) {
      box_.low = glm::min(box_.low, place);
      box_.high = glm::max(box_.high, place);
    }
    if (!(box_.low.x < box_.high.x && box_.low.y < box_.high.y)) return;
  }
  is_seen_ = true;
}

double LightFace::highest() const {
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
  std::vector<glm::dvec2> outline;
  if (!is_disc_) outline = square();
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
