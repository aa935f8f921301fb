#include "visible_area.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

namespace gnomon::area_svbsp {

namespace {

constexpr int round_corners = 64;
constexpr double least_area = 4e-13;  ///< of a part of the figure, whose area is 4 or pi
constexpr std::size_t few = 12;       ///< regions that are cut away without halving

double line_at(const glm::dvec3& line, const glm::dvec2& place) { return line.x + line.y * place.x + line.z * place.y; }

/// The regular polygon around the unit circle, or the one with half a turn of a side between them inside of it.
std::vector<glm::dvec2> round_polygon(bool is_around) {
  std::vector<glm::dvec2> corners;
  const double radius = is_around ? 1 / std::cos(std::numbers::pi / round_corners) : 1;
  for (int k = 0; k < round_corners; ++k) {
    const double angle = 2 * std::numbers::pi / round_corners * (is_around ? k + 0.5 : k);
    corners.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
  }
  return corners;
}

struct Box {
  glm::dvec2 low, high;
};
Box box_of(std::span<const glm::dvec2> polygon) {
  Box box{polygon[0], polygon[0]};
  for (const glm::dvec2& corner : polygon) {
    box.low = glm::min(box.low, corner);
    box.high = glm::max(box.high, corner);
  }
  return box;
}

}  // namespace

void VisibleArea::start(const LightFigure& face) {
  face_ = &face;
  axis_ = glm::cross(face.half_u(), face.half_v());
  plane_ = glm::dot(axis_, face.center());
  regions_.clear();
}

void VisibleArea::add(const CasterPolygon& polygon, const glm::dvec3& point) {
  glm::dvec3 to[4];
  double least = INFINITY, most = -INFINITY;
  for (std::uint32_t k = 0; k < polygon.count; ++k) {
    to[k] = glm::dvec3(polygon.corners[k]) - point;
    const double before = plane_ > 0 ? plane_ - glm::dot(axis_, to[k]) : glm::dot(axis_, to[k]) - plane_;
    least = std::min(least, before);
    most = std::max(most, before);
  }
  const double turn = glm::dot(glm::cross(to[0], to[1]), to[2]);
  if (turn == 0 || most <= 0) return;  // only what is before the light's plane, on the point's side, can hide it
  Region region;
  const auto add_line = [&](const glm::dvec3& across, double offset) {
    region.lines[region.count++] =
        (turn > 0 ? 1.0 : -1.0) * glm::dvec3(glm::dot(across, face_->center()) - offset, glm::dot(across, face_->half_u()),
                                             glm::dot(across, face_->half_v()));
  };
  for (std::uint32_t k = 0; k < polygon.count; ++k) add_line(glm::cross(to[k], to[(k + 1) % polygon.count]), 0);
  if (least < 0) {  // across the light's plane: only places beyond its own plane are hidden
    const glm::dvec3 normal = glm::cross(to[1] - to[0], to[2] - to[0]);
    add_line(normal, glm::dot(normal, to[0]));
  }
  // What misses the box of the figure is no region.
  const LightFigure::Box& box = face_->box();
  for (std::uint32_t k = 0; k < region.count; ++k) {
    const glm::dvec3& line = region.lines[k];
    if (!(line_at(line, {line.y > 0 ? box.high.x : box.low.x, line.z > 0 ? box.high.y : box.low.y}) > 0)) return;
  }
  regions_.push_back(region);
}

double VisibleArea::share() {
  if (regions_.empty()) return 1;
  if (!face_->is_disc()) {
    const auto [all, lit] = seen_of({{-1, -1}, {1, -1}, {1, 1}, {-1, 1}});
    return all > 0 ? std::min(lit / all, 1.0) : 1;
  }
  static const std::vector<glm::dvec2> inside = round_polygon(false), around = round_polygon(true);
  const auto [all_inside, lit_inside] = seen_of(inside);
  const auto [all_around, lit_around] = seen_of(around);
  const double all = all_inside + 2 * all_around;
  return all > 0 ? std::min((lit_inside + 2 * lit_around) / all, 1.0) : 1;
}

std::pair<double, double> VisibleArea::seen_of(std::vector<glm::dvec2> figure) {
  const auto is_below = [&](const glm::dvec2& place) { return line_at(face_->horizon(), place) < 0; };
  if (std::ranges::any_of(figure, is_below)) clip_places(figure, face_->horizon());
  if (figure.size() < 3) return {0, 0};
  corners_.assign(figure.begin(), figure.end());
  lists_.resize(regions_.size());
  for (std::size_t i = 0; i < lists_.size(); ++i) lists_[i] = static_cast<std::uint32_t>(i);
  const Part whole{0, figure.size()};
  const double all = twice_area(whole);
  return {all, seen(whole, {0, lists_.size()}, 2 * lists_.size(), 2 * lists_.size())};
}

double VisibleArea::twice_area(const Part& part) const {
  double sum = 0;
  const std::span<const glm::dvec2> polygon = corners(part);
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    const glm::dvec2 a = polygon[i - 1] - polygon[0], b = polygon[i] - polygon[0];
    sum += a.x * b.y - a.y * b.x;
  }
  return std::abs(sum);
}

double VisibleArea::seen(Part part, List list, std::size_t last, std::size_t before) {
  const Box box = box_of(corners(part));
  const std::size_t corner_count = corners_.size(), list_size = lists_.size();
  for (std::size_t k = 0; k < list.count; ++k) {
    const Region& region = regions_[lists_[list.first + k]];
    bool misses = false, hides = true;
    for (std::uint32_t i = 0; i < region.count && !misses; ++i) {
      const glm::dvec3& line = region.lines[i];
      const double x = line.y * (line.y > 0 ? box.high.x : box.low.x), other_x = line.y * (line.y > 0 ? box.low.x : box.high.x);
      const double y = line.z * (line.z > 0 ? box.high.y : box.low.y), other_y = line.z * (line.z > 0 ? box.low.y : box.high.y);
      misses = !(line.x + x + y > 0);
      hides &= line.x + other_x + other_y >= 0;
    }
    if (misses) continue;
    if (hides) {
      lists_.resize(list_size);
      return 0;
    }
    lists_.push_back(lists_[list.first + k]);
  }
  const List here{list_size, lists_.size() - list_size};
  double sum = 0;
  // Where many regions meet in one place, halving leaves as many.
  if (here.count <= few || 4 * here.count > 3 * before) {
    const std::vector<std::uint32_t> regions(lists_.begin() + static_cast<std::ptrdiff_t>(here.first), lists_.end());
    sum = seen_past(part, regions);
  } else {
    const glm::dvec2 size = box.high - box.low, middle = 0.5 * (box.low + box.high);
    const auto [low, high] = divide(part, size.x > size.y ? glm::dvec3(-middle.x, 1, 0) : glm::dvec3(-middle.y, 0, 1));
    for (const Part& half : {low, high})
      if (half.count >= 3 && twice_area(half) >= least_area) sum += seen(half, here, here.count, last);
  }
  corners_.resize(corner_count);
  lists_.resize(list_size);
  return sum;
}

double VisibleArea::seen_past(Part part, std::span<const std::uint32_t> regions) {
  const std::size_t corner_count = corners_.size();
  for (std::size_t k = 0; k < regions.size(); ++k) {
    const Region& region = regions_[regions[k]];
    const auto is_beyond = [&](const glm::dvec3& line) {
      return std::ranges::none_of(corners(part), [&](const glm::dvec2& place) { return line_at(line, place) > 0; });
    };
    if (std::any_of(region.lines, region.lines + region.count, is_beyond)) continue;
    // What is beyond one line after the other; if nothing is left inside them the part stays whole.
    Part outside[5], inside = part;
    std::uint32_t i = 0;
    for (; i < region.count; ++i) {
      std::tie(outside[i], inside) = divide(inside, region.lines[i]);
      if (inside.count < 3 || twice_area(inside) < least_area) break;
    }
    double sum = 0;
    if (i == region.count)
      for (const Part& rest : std::span(outside, region.count))
        if (rest.count >= 3 && twice_area(rest) >= least_area) sum += seen_past(rest, regions.subspan(k + 1));
    corners_.resize(corner_count);
    if (i == region.count) return sum;
  }
  return twice_area(part);
}

std::pair<VisibleArea::Part, VisibleArea::Part> VisibleArea::divide(const Part& part, const glm::dvec3& line) {
  const std::size_t first = corners_.size(), room = part.count + 2;
  corners_.resize(first + 2 * room);
  Part negative{first, 0}, positive{first + room, 0};
  const auto put = [&](Part& to, const glm::dvec2& place) { corners_[to.first + to.count++] = place; };
  const glm::dvec2* const polygon = corners_.data() + part.first;
  double at_here = line_at(line, polygon[0]);
  for (std::size_t i = 0; i < part.count; ++i) {
    const glm::dvec2 here = polygon[i], next = polygon[i + 1 < part.count ? i + 1 : 0];
    const double at_next = line_at(line, next);
    if (at_here >= 0) put(positive, here);
    if (at_here <= 0) put(negative, here);
    if ((at_here > 0 && at_next < 0) || (at_here < 0 && at_next > 0)) {
      const bool leaves = at_here > 0;
      const glm::dvec2 &in = leaves ? here : next, &out = leaves ? next : here;
      const double at_in = std::max(at_here, at_next), at_out = std::min(at_here, at_next);
      const glm::dvec2 crossing = in + at_in / (at_in - at_out) * (out - in);
      put(positive, crossing);
      put(negative, crossing);
    }
    at_here = at_next;
  }
  return {negative, positive};
}

}  // namespace gnomon::area_svbsp
