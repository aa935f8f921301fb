#pragma once
#include <gnomon/kit/area/light_figure.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <tuple>

#include "casters.h"

namespace gnomon::area_svbsp {

/// Some elements of a vector.
struct Slice {
  std::size_t first, count;
};

/// How much of a light's area one point sees past polygons, in closed form: from the point every polygon hides a convex region
/// of the light's figure, bounded by the lines in which planes through the point and its edges meet the figure's plane. The
/// figure is halved until few regions reach into a part, and there they are cut away; the area of what is left is a sum over
/// its contour. The time grows as the number of polygons, not as its square. Keeps its memory from one point to the next.
///
/// A disc lies between polygons of 64 corners, inside and around, and two thirds of what is between them belong to it; this
/// errs by 1e-6.
class VisibleArea {
 public:
  /// `figure` must be seen, and outlive what follows.
  void start(const LightFigure& figure) {
    figure_ = &figure;
    axis_ = glm::cross(figure.half_u(), figure.half_v());
    plane_ = glm::dot(axis_, figure.center());
    regions_.clear();
  }
  /// A polygon between, with the point. One whose plane holds the point hides nothing.
  void add(const CasterPolygon& polygon, const glm::dvec3& point) {
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
          (turn > 0 ? 1.0 : -1.0) * glm::dvec3(glm::dot(across, figure_->center()) - offset,
                                               glm::dot(across, figure_->half_u()), glm::dot(across, figure_->half_v()));
    };
    for (std::uint32_t k = 0; k < polygon.count; ++k) add_line(glm::cross(to[k], to[(k + 1) % polygon.count]), 0);
    if (least < 0) {  // across the light's plane: only places beyond its own plane are hidden
      const glm::dvec3 normal = glm::cross(to[1] - to[0], to[2] - to[0]);
      add_line(normal, glm::dot(normal, to[0]));
    }
    // What misses the box of the figure is no region.
    const LightFigure::Box& box = figure_->box();
    for (std::uint32_t k = 0; k < region.count; ++k) {
      const glm::dvec3& line = region.lines[k];
      if (!(line_at(line, {line.y > 0 ? box.high.x : box.low.x, line.z > 0 ? box.high.y : box.low.y}) > 0)) return;
    }
    regions_.push_back(region);
  }
  /// Of the figure above the horizon.
  double share() {
    if (regions_.empty()) return 1;
    if (!figure_->is_disc()) {
      const auto [all, lit] = seen_of({{-1, -1}, {1, -1}, {1, 1}, {-1, 1}});
      return all > 0 ? std::min(lit / all, 1.0) : 1;
    }
    static const std::vector<glm::dvec2> inside = round_polygon(false), around = round_polygon(true);
    const auto [all_inside, lit_inside] = seen_of(inside);
    const auto [all_around, lit_around] = seen_of(around);
    const double all = all_inside + 2 * all_around;
    return all > 0 ? std::min((lit_inside + 2 * lit_around) / all, 1.0) : 1;
  }

 private:
  static constexpr int round_corners = 64;
  static constexpr double least_area = 4e-13;  ///< of a part of the figure, whose area is 4 or pi
  static constexpr std::size_t few = 12;       ///< regions that are cut away without halving

  /// The regular polygon around the unit circle, or the one inside of it, half a side turned against the other.
  static std::vector<glm::dvec2> round_polygon(bool is_around) {
    std::vector<glm::dvec2> corners;
    const double radius = is_around ? 1 / std::cos(std::numbers::pi / round_corners) : 1;
    for (int k = 0; k < round_corners; ++k) {
      const double angle = 2 * std::numbers::pi / round_corners * (is_around ? k + 0.5 : k);
      corners.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
    }
    return corners;
  }

  /// Where all lines are positive: line.x + line.y * s + line.z * t, by the coordinates of the figure.
  struct Region {
    std::uint32_t count = 0;
    glm::dvec3 lines[5];
  };
  std::span<const glm::dvec2> corners(const Slice& part) const { return {corners_.data() + part.first, part.count}; }
  double twice_area(const Slice& part) const { return std::abs(gnomon::twice_area(corners(part))); }
  /// Twice the area of a part that no region of the list hides. `last` and `before` regions reached into the part that this is
  /// half of, and into the one that that was half of.
  double seen(Slice part, Slice list, std::size_t last, std::size_t before) {
    LightFigure::Box box{corners_[part.first], corners_[part.first]};
    for (const glm::dvec2& corner : corners(part)) box.add(corner);
    const std::size_t corner_count = corners_.size(), list_size = lists_.size();
    for (std::size_t k = 0; k < list.count; ++k) {
      const Region& region = regions_[lists_[list.first + k]];
      bool misses = false, hides = true;
      for (std::uint32_t i = 0; i < region.count && !misses; ++i) {
        const glm::dvec3& line = region.lines[i];
        const double x = line.y * (line.y > 0 ? box.high.x : box.low.x),
                     other_x = line.y * (line.y > 0 ? box.low.x : box.high.x);
        const double y = line.z * (line.z > 0 ? box.high.y : box.low.y),
                     other_y = line.z * (line.z > 0 ? box.low.y : box.high.y);
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
    const Slice here{list_size, lists_.size() - list_size};
    double sum = 0;
    // Where many regions meet in one place, halving leaves as many.
    if (here.count <= few || 4 * here.count > 3 * before) {
      const std::vector<std::uint32_t> regions(lists_.begin() + static_cast<std::ptrdiff_t>(here.first), lists_.end());
      sum = seen_past(part, regions);
    } else {
      const glm::dvec2 size = box.high - box.low, middle = 0.5 * (box.low + box.high);
      const auto [low, high] = divide(part, size.x > size.y ? glm::dvec3(-middle.x, 1, 0) : glm::dvec3(-middle.y, 0, 1));
      for (const Slice& half : {low, high})
        if (half.count >= 3 && twice_area(half) >= least_area) sum += seen(half, here, here.count, last);
    }
    corners_.resize(corner_count);
    lists_.resize(list_size);
    return sum;
  }
  double seen_past(Slice part, std::span<const std::uint32_t> regions) {
    const std::size_t corner_count = corners_.size();
    for (std::size_t k = 0; k < regions.size(); ++k) {
      const Region& region = regions_[regions[k]];
      const auto is_beyond = [&](const glm::dvec3& line) {
        return std::ranges::none_of(corners(part), [&](const glm::dvec2& place) { return line_at(line, place) > 0; });
      };
      if (std::any_of(region.lines, region.lines + region.count, is_beyond)) continue;
      // What is beyond one line after the other; if nothing is left inside them the part stays whole.
      Slice outside[5], inside = part;
      std::uint32_t i = 0;
      for (; i < region.count; ++i) {
        std::tie(outside[i], inside) = divide(inside, region.lines[i]);
        if (inside.count < 3 || twice_area(inside) < least_area) break;
      }
      double sum = 0;
      if (i == region.count)
        for (const Slice& rest : std::span(outside, region.count))
          if (rest.count >= 3 && twice_area(rest) >= least_area) sum += seen_past(rest, regions.subspan(k + 1));
      corners_.resize(corner_count);
      if (i == region.count) return sum;
    }
    return twice_area(part);
  }
  /// The parts where a line is negative and positive, at the end of corners_.
  std::pair<Slice, Slice> divide(const Slice& part, const glm::dvec3& line) {
    const std::size_t first = corners_.size(), room = part.count + 2;
    corners_.resize(first + 2 * room);
    Slice negative{first, 0}, positive{first + room, 0};
    const auto put = [&](Slice& to, const glm::dvec2& place) { corners_[to.first + to.count++] = place; };
    divide_places(
        corners(part), line, [&](const glm::dvec2& place) { put(positive, place); },
        [&](const glm::dvec2& place) { put(negative, place); });
    return {negative, positive};
  }
  /// Of a figure with these corners, what is above the horizon: twice its area, and twice of what is seen.
  std::pair<double, double> seen_of(std::vector<glm::dvec2> figure) {
    const auto is_below = [&](const glm::dvec2& place) { return line_at(figure_->horizon(), place) < 0; };
    if (std::ranges::any_of(figure, is_below)) clip_places(figure, figure_->horizon());
    if (figure.size() < 3) return {0, 0};
    corners_.assign(figure.begin(), figure.end());
    lists_.resize(regions_.size());
    for (std::size_t i = 0; i < lists_.size(); ++i) lists_[i] = static_cast<std::uint32_t>(i);
    const Slice whole{0, figure.size()};
    const double all = twice_area(whole);
    return {all, seen(whole, {0, lists_.size()}, 2 * lists_.size(), 2 * lists_.size())};
  }

  const LightFigure* figure_ = nullptr;
  glm::dvec3 axis_{0};
  double plane_ = 0;
  std::vector<Region> regions_;
  std::vector<glm::dvec2> corners_;
  std::vector<std::uint32_t> lists_;
};

}  // namespace gnomon::area_svbsp
