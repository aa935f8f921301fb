#include <gnomon/kit/pictures/painter.h>

#include <algorithm>
#include <cassert>
#include <limits>

namespace gnomon {

namespace {

/// The first of `count` pixels of a row, or rows, whose center is not before a place; `count` when there is none.
int first_from(double place, int count) {
  const double first = std::ceil(place - 0.5);
  return first <= 0 ? 0 : first >= count ? count : static_cast<int>(first);
}

const glm::dvec3& place_of(const Corner& corner) { return corner.at; }
const glm::dvec3& place_of(const glm::dvec3& corner) { return corner; }

}  // namespace

Painter::Painter(const Camera& camera)
    : eye_(camera.eye),
      forward_(camera.forward),
      width_(camera.width),
      height_(camera.height),
      guard_(4.0 * camera.width, 4.0 * camera.height) {
  // Camera::ray turned round; a pixel is as wide as it is high.
  const double pixels = camera.height / (2 * camera.tan_y);
  right_ = camera.right * pixels;
  down_ = -camera.up * pixels;
}

template <class Point>
std::span<const PixelSpan> Painter::spans_of(std::span<const Point> corners) {
  spans_.clear();
  polygon_.start();
  // Clipping by planes through the eye that only cut what is far outside the picture leaves most polygons as they are, and what
  // is left of an edge is the same for both polygons on it. All four together leave nothing behind the eye.
  const auto beyond = [this](const glm::dvec3& p) {
    return static_cast<unsigned>(p.x < -guard_.x * p.z) | static_cast<unsigned>(p.x > guard_.x * p.z) << 1 |
           static_cast<unsigned>(p.y < -guard_.y * p.z) << 2 | static_cast<unsigned>(p.y > guard_.y * p.z) << 3;
  };
  unsigned some = 0, all = ~0u;
  double nearest = std::numeric_limits<double>::infinity(), farthest = 0;
  for (const Point& corner : corners) {
    const glm::dvec3 from_eye = place_of(corner) - eye_;
    const glm::dvec3 p(glm::dot(from_eye, right_), glm::dot(from_eye, down_), glm::dot(from_eye, forward_));
    assert(std::isfinite(p.x + p.y + p.z));
    polygon_.add({p});
    some |= beyond(p);
    all &= beyond(p);
    nearest = std::min(nearest, p.z);
    farthest = std::max(farthest, p.z);
  }
  if (corners.size() < 3 || all || farthest <= 0) return {};
  // So near to the eye there are only polygons whose plane holds it.
  if (nearest < 1e-12 * farthest) some |= 16;
  const ClipPlane planes[] = {
      {{1, 0, guard_.x}}, {{-1, 0, guard_.x}}, {{0, 1, guard_.y}}, {{0, -1, guard_.y}}, {{0, 0, 1}, -1e-12 * farthest}};
  for (unsigned k = 0; k < 5; ++k)
    if ((some >> k & 1) && !has_inside(polygon_.keep_positive(planes[k], 0))) return {};
  scan();
  return spans_;
}

template std::span<const PixelSpan> Painter::spans_of(std::span<const Corner> corners);
template std::span<const PixelSpan> Painter::spans_of(std::span<const glm::dvec3> corners);

/// Where the polygon's edges cross the middle of each row.
void Painter::scan() {
  places_.clear();
  double highest = std::numeric_limits<double>::infinity(), lowest = -highest;
  for (const Corner& corner : polygon_.corners()) {
    const glm::dvec3& p = corner.at;
    places_.push_back({p.x / p.z + 0.5 * width_, p.y / p.z + 0.5 * height_});
    highest = std::min(highest, places_.back().y);
    lowest = std::max(lowest, places_.back().y);
  }
  const int top = first_from(highest, height_), bottom = first_from(lowest, height_);
  if (top >= bottom) return;
  rows_.assign(static_cast<std::size_t>(bottom - top), {width_, 0});
  for (std::size_t k = 0; k < places_.size(); ++k) {
    glm::dvec2 a = places_[k], b = places_[k + 1 < places_.size() ? k + 1 : 0];
    if (a.y > b.y) std::swap(a, b);  // both polygons on the edge do the same sums
    const int end = first_from(b.y, height_);
    for (int y = first_from(a.y, height_); y < end; ++y) {
      const double across = a.x + (y + 0.5 - a.y) * ((b.x - a.x) / (b.y - a.y));
      const int x = first_from(std::clamp(across, std::min(a.x, b.x), std::max(a.x, b.x)), width_);
      auto& [begin, finish] = rows_[static_cast<std::size_t>(y - top)];
      begin = std::min(begin, x);
      finish = std::max(finish, x);
    }
  }
  for (int y = top; y < bottom; ++y) {
    const auto [begin, end] = rows_[static_cast<std::size_t>(y - top)];
    const std::size_t first = static_cast<std::size_t>(y) * static_cast<std::size_t>(width_);
    if (begin < end) spans_.push_back({first + static_cast<std::size_t>(begin), first + static_cast<std::size_t>(end)});
  }
}

}  // namespace gnomon
