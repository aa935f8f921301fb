#include "coverage.h"

#include <gnomon/kit/geometry/sure_sign.h>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace gnomon::penumbra_wedge {

namespace {

/// Inside is on the left of the way from a to b.
glm::dvec3 line_through(const glm::dvec2& a, const glm::dvec2& b, double side) {
  const glm::dvec2 way = b - a;
  return side * glm::dvec3(way.y * a.x - way.x * a.y, -way.y, way.x);
}

double angle_between(const glm::dvec2& a, const glm::dvec2& b) { return std::atan2(cross(a, b), glm::dot(a, b)); }

/// Twice the signed area that the triangle of the origin, a and b has in the unit disc: sectors where the way from a to b is
/// outside, a triangle where it is inside.
double twice_in_disc(const glm::dvec2& a, const glm::dvec2& b) {
  const glm::dvec2 way = b - a;
  const double square = glm::dot(way, way), along = glm::dot(a, way), root = along * along - square * (glm::dot(a, a) - 1);
  if (square == 0) return 0;
  if (root <= 0) return angle_between(a, b);
  const double half = std::sqrt(root), enter = (-along - half) / square, leave = (-along + half) / square;
  if (enter >= 1 || leave <= 0) return angle_between(a, b);
  const glm::dvec2 from = enter > 0 ? a + enter * way : a, to = leave < 1 ? a + leave * way : b;
  return (enter > 0 ? angle_between(a, from) : 0) + cross(from, to) + (leave < 1 ? angle_between(to, b) : 0);
}

}  // namespace

Figure::Figure(const LightFigure& figure)
    : corners_{{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}}, count_(4), is_disc_(figure.is_disc()) {
  clip(figure.horizon());
}

void Figure::clip(const glm::dvec3& line) {
  std::array<double, most_corners> at;
  bool is_inside = true;
  for (int k = 0; k < count_; ++k) {
    at[k] = line_at(line, corners_[k]);
    is_inside &= at[k] >= 0;
  }
  if (is_inside) return;
  assert(count_ < most_corners);
  const std::array<glm::dvec2, most_corners> whole = corners_;
  int kept = 0;
  for (int k = 0; k < count_; ++k) {
    const int next = k + 1 < count_ ? k + 1 : 0;
    if (at[k] >= 0) corners_[kept++] = whole[k];
    if ((at[k] > 0 && at[next] < 0) || (at[k] < 0 && at[next] > 0))
      corners_[kept++] = whole[k] + at[k] / (at[k] - at[next]) * (whole[next] - whole[k]);
  }
  count_ = kept;
}

double Figure::area() const {
  if (count_ < 3) return 0;
  double twice = 0;
  for (int k = 0; k < count_; ++k) {
    const glm::dvec2 &a = corners_[k], &b = corners_[k + 1 < count_ ? k + 1 : 0];
    twice += is_disc_ ? twice_in_disc(a, b) : cross(a - corners_[0], b - corners_[0]);
  }
  return std::max(twice / 2, 0.0);
}

/// A way d is w * (center + s * half_u + t * half_v): the inverse of the matrix with these columns, by cross products.
void Coverage::set(const LightFigure& figure) {
  seen_.emplace(figure);
  area_ = seen_->area();
  const glm::dvec3 &u = figure.half_u(), &v = figure.half_v(), &c = figure.center();
  const glm::dvec3 axis = glm::cross(u, v);
  const double volume = glm::dot(axis, c);
  s_ = glm::cross(v, c) / volume;
  t_ = glm::cross(c, u) / volume;
  w_ = axis / volume;
  turn_ = volume > 0 ? 1 : -1;
}

void Coverage::start(const LightFigure& figure, const glm::dvec2& base) {
  regions_.clear();
  base_ = base;
  to_base_ = figure.at(base);
}

Coverage::Projected Coverage::project(const glm::dvec3& to) const {
  Projected vertex{to, glm::dot(s_, to), glm::dot(t_, to), glm::dot(w_, to), false};
  // Rounding of the product; what lies in the light's plane hides nothing of it.
  vertex.is_beyond = vertex.w + 0x1p-48 * (1 + glm::dot(glm::abs(w_), glm::abs(to))) >= 1;
  return vertex;
}

/// Where the edge meets the light's plane.
Coverage::Projected Coverage::cut(const Projected& a, const Projected& b) {
  const double share = std::clamp((1 - a.w) / (b.w - a.w), 0.0, 1.0);
  return {a.to + share * (b.to - a.to), a.x + share * (b.x - a.x), a.y + share * (b.y - a.y), 1, false};
}

bool Coverage::add_edge(const Projected& a, const Projected& b, int count) {
  if (a.is_beyond && b.is_beyond) return true;
  const auto is_beside = [](double at_a, double at_b) { return at_a < 0 && at_b < 0; };
  if (is_beside(a.w + a.x, b.w + b.x) || is_beside(a.w - a.x, b.w - b.x) || is_beside(a.w + a.y, b.w + b.y) ||
      is_beside(a.w - a.y, b.w - b.y))
    return true;
  // The base is on the left of the edge, where (a, b, base) is a right-handed system, in right-handed coordinates.
  double volume;
  const int side = turn_ * sure_sign(a.to, b.to, to_base_, volume);
  // An edge in line with the point has no width.
  if (side == 0) return glm::length(glm::cross(a.to, b.to)) <= 0x1p-45 * glm::length(a.to) * glm::length(b.to);
  add_region(a.is_beyond ? cut(a, b) : a, b.is_beyond ? cut(a, b) : b, side, count);
  return true;
}

bool Coverage::add_section(const Projected (&corners)[3], const bool (&is_swapped)[3], int facing) {
  Projected out, in;
  bool is_cut = false;
  for (int k = 0; k < 3; ++k) {
    const Projected &a = corners[k], &b = corners[(k + 1) % 3];
    if (a.is_beyond == b.is_beyond) continue;
    is_cut = true;
    (b.is_beyond ? out : in) = is_swapped[k] ? cut(b, a) : cut(a, b);
  }
  if (!is_cut) return true;
  const glm::dvec2 a = glm::dvec2(out.x, out.y) - base_, b = glm::dvec2(in.x, in.y) - base_;
  const double across = cross(a, b);
  // Cut points err by some 2^-50 of the light's size and their own distance from it.
  if (std::abs(across) <= 0x1p-40 * (1 + glm::length(a)) * (1 + glm::length(b))) return glm::distance(a, b) < 0x1p-40;
  add_region(out, in, across > 0 ? 1 : -1, facing);
  return true;
}

void Coverage::add_region(Projected a, Projected b, int side, int count) {
  // Far beside the light a division would leave too few digits, and at w = 0 none: only the part close to it matters.
  const auto is_near = [](const Projected& p) { return std::max(std::abs(p.x), std::abs(p.y)) <= 16 * p.w; };
  if (!is_near(a) || !is_near(b)) {
    for (int line = 0; line < 4; ++line) {
      const auto inside = [&](const Projected& p) { return 2 * p.w + (line & 1 ? -1 : 1) * (line & 2 ? p.y : p.x); };
      const double at_a = inside(a), at_b = inside(b);
      if (at_a < 0 && at_b < 0) return;
      if (at_a >= 0 && at_b >= 0) continue;
      const double share = at_a / (at_a - at_b);
      Projected& out = at_a < 0 ? a : b;
      out = {out.to, a.x + share * (b.x - a.x), a.y + share * (b.y - a.y), a.w + share * (b.w - a.w), out.is_beyond};
    }
  }
  if (!(a.w > 0 && b.w > 0)) return;
  const glm::dvec2 from(a.x / a.w, a.y / a.w), to(b.x / b.w, b.y / b.w);
  // The base has `count` more than what is past the edge where it is on its left, as the light sees it.
  regions_.push_back({{line_through(base_, from, side), line_through(base_, to, -side), line_through(from, to, -side)},
                      -side * turn_ * count});
}

double Coverage::mean() const {
  double sum = 0;
  for (const Region& region : regions_) {
    Figure part = *seen_;
    // The line that most often leaves nothing comes first.
    part.clip(region.lines[2]);
    part.clip(region.lines[0]);
    part.clip(region.lines[1]);
    sum += region.layers * part.area();
  }
  return area_ > 0 ? sum / area_ : 0;
}

int Coverage::at(const glm::dvec2& place) const {
  int layers = 0;
  for (const Region& region : regions_)
    if (std::ranges::all_of(region.lines, [&](const glm::dvec3& line) { return line_at(line, place) >= 0; }))
      layers += region.layers;
  return layers;
}

}  // namespace gnomon::penumbra_wedge
