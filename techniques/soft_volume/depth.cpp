#include "depth.h"

#include <gnomon/kit/vectorized.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace gnomon::soft_volume {

namespace {

GNOMON_VECTORIZED void add_lines(const LightDepth::Line* lines, std::size_t line_count, const double* __restrict x,
                                 const double* __restrict y, std::size_t count, double* __restrict depth) {
  for (std::size_t i = 0; i < line_count; ++i) {
    const LightDepth::Line line = lines[i];
    for (std::size_t k = 0; k < count; ++k) {
      const double across = line.dx * (y[k] - line.y) - line.dy * (x[k] - line.x);
      const bool counts = (y[k] >= line.low) & (y[k] < line.high) & (across < 0);
      depth[k] += counts ? line.jump : 0.0;
    }
  }
}

GNOMON_VECTORIZED void add_steps(const LightDepth::Step* steps, std::size_t step_count, const double* __restrict y,
                                 std::size_t count, double* __restrict depth) {
  for (std::size_t i = 0; i < step_count; ++i) {
    const LightDepth::Step step = steps[i];
    for (std::size_t k = 0; k < count; ++k) depth[k] += y[k] >= step.low ? step.jump : 0.0;
  }
}

}  // namespace

/// A way d is w * (center + s * half_u + t * half_v): the inverse of the matrix with these columns, by cross products.
void LightDepth::set(const LightFigure& figure) {
  lines_.clear();
  steps_.clear();
  const glm::dvec3 &u = figure.half_u(), &v = figure.half_v(), &c = figure.center();
  const glm::dvec3 axis = glm::cross(u, v);
  const double volume = glm::dot(axis, c);
  const glm::dvec3 s = glm::cross(v, c) / volume, t = glm::cross(c, u) / volume;
  w_ = axis / volume;
  const glm::dvec2 low = figure.box().low, size = figure.box().high - low;
  x_ = (s - low.x * w_) / size.x;
  y_ = (t - low.y * w_) / size.y;
  turn_ = volume < 0 ? 1 : -1;  // u, v and the way back to the point are right-handed, or not
}

LightDepth::Corner LightDepth::corner(const glm::dvec3& d) const {
  Corner corner{glm::dot(x_, d), glm::dot(y_, d), glm::dot(w_, d), false};
  // Rounding of the product; what lies in the light's plane hides nothing of it.
  corner.is_beyond = corner.w + 0x1p-48 * (1 + glm::dot(glm::abs(w_), glm::abs(d))) >= 1;
  return corner;
}

/// Where the edge meets the light's plane.
LightDepth::Corner LightDepth::cut(const Corner& a, const Corner& b) {
  const double share = std::clamp((1 - a.w) / (b.w - a.w), 0.0, 1.0);
  return {a.x + share * (b.x - a.x), a.y + share * (b.y - a.y), 1, false};
}

void LightDepth::add_edge(const Corner& a, const Corner& b, int jump) {
  if (!a.is_beyond || !b.is_beyond) add_line(a.is_beyond ? cut(a, b) : a, b.is_beyond ? cut(a, b) : b, jump);
}

void LightDepth::add_section(const Corner (&corners)[3], const bool (&is_swapped)[3], int facing) {
  Corner out, in;
  bool is_cut = false;
  for (int k = 0; k < 3; ++k) {
    const Corner &a = corners[k], &b = corners[(k + 1) % 3];
    if (a.is_beyond == b.is_beyond) continue;
    is_cut = true;
    (b.is_beyond ? out : in) = is_swapped[k] ? cut(b, a) : cut(a, b);
  }
  if (is_cut) add_line(out, in, facing);
}

/// What of the edge may pass before the box, in rows: first the part with -1 <= x, y <= 2, which is before the point, then that
/// right of the side x = 0.
void LightDepth::add_line(const Corner& from, const Corner& to, int jump) {
  const auto rejects = [](double a, double b) { return a < 0 && b < 0; };
  if (rejects(from.x, to.x) || rejects(from.y, to.y) || rejects(from.w - from.x, to.w - to.x) ||
      rejects(from.w - from.y, to.w - to.y) || rejects(from.w, to.w))
    return;
  Corner a = from, b = to;
  // Far beside the box a division would leave too few digits for the line.
  const auto is_near = [](const Corner& c) { return std::max(std::abs(c.x), std::abs(c.y)) <= 16 * c.w; };
  if (!is_near(a) || !is_near(b)) {
    const auto clip = [&](auto&& inside) {
      const double at_a = inside(a), at_b = inside(b);
      if (at_a < 0 && at_b < 0) return false;
      if (at_a >= 0 && at_b >= 0) return true;
      const double share = at_a / (at_a - at_b);
      (at_a < 0 ? a : b) = {a.x + share * (b.x - a.x), a.y + share * (b.y - a.y), a.w + share * (b.w - a.w), false};
      return true;
    };
    if (!clip([](const Corner& c) { return c.x + c.w; }) || !clip([](const Corner& c) { return 2 * c.w - c.x; }) ||
        !clip([](const Corner& c) { return c.y + c.w; }) || !clip([](const Corner& c) { return 2 * c.w - c.y; }))
      return;
    if (!(a.w > 0 && b.w > 0)) return;
  }
  double ax = a.x / a.w, ay = a.y / a.w, bx = b.x / b.w, by = b.y / b.w;
  double m = turn_ * jump;
  double low = std::min(ay, by), high = std::max(ay, by);
  if ((ax < 0) != (bx < 0)) {
    const double height = std::clamp(ay + ax / (ax - bx) * (by - ay), low, high);
    if (height > 0 && height < 1) steps_.push_back({height, ax < 0 ? m : -m});
    ((ax < 0) == (ay < by) ? low : high) = height;
  } else if (ax < 0) {
    return;
  }
  if (!(low < high) || high <= 0 || low >= 1) return;
  // A line that runs up has m on its left, so places on its right have as much less; one that runs down, more.
  if (ay > by) {
    std::swap(ax, bx);
    std::swap(ay, by);
  } else {
    m = -m;
  }
  if (std::min(ax, bx) >= 1) return;
  lines_.push_back({ax, ay, bx - ax, by - ay, low, high, m});
}

void LightDepth::find(const Places& places, std::vector<double>& depths) const {
  depths.assign(places.size(), 0.0);
  add_steps(steps_.data(), steps_.size(), places.y.data(), places.size(), depths.data());
  add_lines(lines_.data(), lines_.size(), places.x.data(), places.y.data(), places.size(), depths.data());
}

}  // namespace gnomon::soft_volume
