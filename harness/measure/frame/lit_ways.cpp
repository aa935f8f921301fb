#include "measure/frame/lit_ways.h"

#include <algorithm>

#include "measure/frame/classify.h"
#include "measure/frame/light_rays.h"

namespace gnomon {

namespace {

/// Nearer to the light than so many times the reach all is touched: directions say nothing there.
constexpr double near = 128;

int cell_of(double at, int side) { return !(at > -1) ? 0 : static_cast<int>(std::min((at + 1) / 2 * side, side - 1.0)); }

/// The least distance of a segment from the origin.
double distance_of(const glm::dvec3& a, const glm::dvec3& b) {
  const glm::dvec3 along = b - a;
  const double length2 = glm::dot(along, along);
  const double share = length2 > 0 ? std::clamp(-glm::dot(a, along) / length2, 0.0, 1.0) : 0;
  return glm::length(a + share * along);
}

}  // namespace

LitWays::LitWays(const GBuffer& gbuffer, const glm::dvec4& light, std::span<const float> reference, double reach)
    : light_(light), reach_(reach), farthest_(static_cast<std::size_t>(face_count()) * side * side, -INFINITY) {
  const auto for_lit = [&](const auto& visit) {
    for (std::size_t i = 0; i < gbuffer.size(); ++i)
      if (!gbuffer.is_background(i) && is_lit(reference[i])) visit(from_light(gbuffer.position(i)));
  };
  if (light.w == 0) {
    axes_[2] = -glm::normalize(glm::dvec3(light));
    std::ranges::copy(across(axes_[2]), axes_);
    glm::dvec2 low(INFINITY), high(-INFINITY);
    for_lit([&](const glm::dvec3& p) {
      const glm::dvec2 at(glm::dot(p, axes_[0]), glm::dot(p, axes_[1]));
      low = glm::min(low, at);
      high = glm::max(high, at);
    });
    if (low.x > high.x) return;
    middle_ = (low + high) / 2.0;
    half_ = glm::max((high - low) / 2.0, glm::dvec2(reach));
  }
  for_lit([&](const glm::dvec3& p) {
    int face = 0;
    if (light_.w != 0) {
      if (p == glm::dvec3(0)) return;  // what touches a way without length is near the light
      const glm::dvec3 size = glm::abs(p);
      const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
      face = 2 * axis + (p[axis] < 0);
    }
    const glm::dvec3 at = seen(face, p);
    float& farthest = farthest_[(static_cast<std::size_t>(face) * side + cell_of(at.y, side)) * side + cell_of(at.x, side)];
    farthest = std::max(farthest, std::nextafter(static_cast<float>(at.z), INFINITY));
  });
}

glm::dvec3 LitWays::from_light(const glm::dvec3& point) const {
  return light_.w != 0 ? point - glm::dvec3(light_) / light_.w : point;
}

glm::dvec3 LitWays::seen(int face, const glm::dvec3& p) const {
  if (light_.w == 0)
    return {(glm::dvec2(glm::dot(p, axes_[0]), glm::dot(p, axes_[1])) - middle_) / half_, glm::dot(p, axes_[2])};
  const int axis = face / 2;
  const double along = face % 2 ? -p[axis] : p[axis];
  return {p[(axis + 1) % 3] / along, p[(axis + 2) % 3] / along, along};
}

bool LitWays::may_touch(const glm::dvec3& a, const glm::dvec3& b) const {
  const glm::dvec3 from = from_light(a), to = from_light(b);
  if (light_.w != 0 && distance_of(from, to) < near * reach_) return true;
  for (int face = 0; face < face_count(); ++face)
    if (may_touch(face, from, to)) return true;
  return false;
}

bool LitWays::may_touch(int face, glm::dvec3 a, glm::dvec3 b) const {
  glm::dvec2 pad = reach_ / half_;
  if (light_.w != 0) {
    // What of it lies before the light, along the face's axis. All that the face shows of it is farther than half of `near`.
    const double least = near / 2 * reach_, sign = face % 2 ? -1 : 1;
    const int axis = face / 2;
    const bool is_a_before = sign * a[axis] < least, is_b_before = sign * b[axis] < least;
    if (is_a_before && is_b_before) return false;
    if (is_a_before || is_b_before) {
      glm::dvec3 border = a + (sign * least - a[axis]) / (b[axis] - a[axis]) * (b - a);
      border[axis] = sign * least;
      (is_a_before ? a : b) = border;
    }
    pad = glm::dvec2(4 * reach_ / std::min(std::abs(a[axis]), std::abs(b[axis])));
  }
  const glm::dvec3 one = seen(face, a), other = seen(face, b);
  const glm::dvec2 low = glm::min(glm::dvec2(one), glm::dvec2(other)) - pad - 1e-9,
                   high = glm::max(glm::dvec2(one), glm::dvec2(other)) + pad + 1e-9;
  if (!(low.x <= high.x && low.y <= high.y)) return true;  // no numbers
  if (high.x < -1 || high.y < -1 || low.x > 1 || low.y > 1) return false;
  const int left = cell_of(low.x, side), right = cell_of(high.x, side), bottom = cell_of(low.y, side),
            top = cell_of(high.y, side);
  constexpr int most_cells = 4096;
  if ((right - left + 1) * (top - bottom + 1) > most_cells) return true;
  const double nearest = std::min(one.z, other.z) - 4 * reach_;
  for (int row = bottom; row <= top; ++row)
    for (int column = left; column <= right; ++column)
      if (farthest_[(static_cast<std::size_t>(face) * side + row) * side + column] >= nearest) return true;
  return false;
}

}  // namespace gnomon
