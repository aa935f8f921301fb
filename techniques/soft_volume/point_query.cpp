#include "point_query.h"

#include <gnomon/kit/vectorized.h>

#include <algorithm>

namespace gnomon::soft_volume {

namespace {

struct Columns {
  const float* column[8];
};

/// Clears what has both planes on one side of the point by more than rounding.
GNOMON_VECTORIZED void keep_silhouettes(Columns p, std::size_t count, const float* point, std::uint8_t* __restrict stays) {
  const float x = point[0], y = point[1], z = point[2], slack = point[3];
  for (std::size_t i = 0; i < count; ++i) {
    const float first = p.column[0][i] * x + p.column[1][i] * y + p.column[2][i] * z + p.column[3][i];
    const float second = p.column[4][i] * x + p.column[5][i] * y + p.column[6][i] * z + p.column[7][i];
    const bool before = (first > slack) & (second > slack), behind = (first < -slack) & (second < -slack);
    stays[i] = static_cast<std::uint8_t>(!(before | behind));
  }
}

/// Clears what has both ends below zero in one of five rows, of four numbers each.
GNOMON_VECTORIZED void keep_before_light(Columns c, std::size_t count, const float* rows, std::uint8_t* __restrict stays) {
  for (std::size_t i = 0; i < count; ++i) {
    const float ax = c.column[0][i], ay = c.column[1][i], az = c.column[2][i], bx = c.column[3][i], by = c.column[4][i],
                bz = c.column[5][i];
    bool beside = false;
    for (int k = 0; k < 5; ++k) {
      const float* const row = rows + 4 * k;
      const float a = row[0] * ax + row[1] * ay + row[2] * az, b = row[0] * bx + row[1] * by + row[2] * bz;
      beside |= (a < row[3]) & (b < row[3]);
    }
    stays[i] &= static_cast<std::uint8_t>(!beside);
  }
}

}  // namespace

void EdgeFilter::set(const Casters& casters, std::span<const std::uint32_t> edges, std::size_t regular_count,
                     const Bounds& points) {
  edges_.assign(edges.begin(), edges.end());
  regular_count_ = regular_count;
  middle_ = 0.5 * (glm::dvec3(points.min) + glm::dvec3(points.max));
  for (std::vector<float>& column : planes_) column.resize(regular_count);
  for (std::vector<float>& column : corners_) column.resize(edges.size());
  stays_.resize(edges.size());
  double reach = 0;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const CasterEdge& edge = casters.edge(edges[i]);
    const glm::dvec3 a = glm::dvec3(casters.position(edge.low)) - middle_,
                     b = glm::dvec3(casters.position(edge.high)) - middle_;
    for (int k = 0; k < 3; ++k) {
      corners_[k][i] = static_cast<float>(a[k]);
      corners_[3 + k][i] = static_cast<float>(b[k]);
    }
    reach = std::max({reach, extent(a), extent(b)});
    if (i >= regular_count) continue;
    for (int side = 0; side < 2; ++side) {
      const glm::dvec4& plane = casters.plane(side == 0 ? edge.first : edge.second);
      for (int k = 0; k < 3; ++k) planes_[4 * side + k][i] = static_cast<float>(plane[k]);
      planes_[4 * side + 3][i] = static_cast<float>(glm::dot(glm::dvec3(plane), middle_) + plane.w);
    }
  }
  reach_ = static_cast<float>(reach + glm::length(glm::dvec3(points.max) - glm::dvec3(points.min)));
}

void EdgeFilter::find(const glm::vec3& point, const LightDepth& depth, std::vector<std::uint32_t>& found) {
  found.clear();
  if (edges_.empty()) return;
  const glm::dvec3 p = glm::dvec3(point) - middle_;
  // A height is the sum of four numbers up to 2 * reach, each of which errs by a few 2^-24 of itself; so is that of rows below.
  // The point's own rounding, that of the middle and that of double add what the coordinates themselves are rounded by.
  const float slack = 0x1p-19f * reach_ + static_cast<float>(0x1p-40 * (extent(point) + extent(middle_)));
  // A point's own triangle faces it neither way, however far rounding has put the point off.
  const auto off_own = static_cast<float>(0x1p-19 * (extent(point) + extent(middle_)));
  const float place[4] = {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z), slack + off_own};
  std::fill(stays_.begin(), stays_.end(), std::uint8_t{1});
  Columns planes{}, corners{};
  for (int k = 0; k < 8; ++k) planes.column[k] = planes_[k].data();
  for (int k = 0; k < 6; ++k) corners.column[k] = corners_[k].data();
  keep_silhouettes(planes, regular_count_, place, stays_.data());
  const glm::dvec3 rows[5] = {depth.row_x(), depth.row_w() - depth.row_x(), depth.row_y(), depth.row_w() - depth.row_y(),
                              depth.row_w()};
  float numbers[20];
  for (int k = 0; k < 5; ++k) {
    // In this unit rows keep within float32.
    const double size = glm::abs(rows[k].x) + glm::abs(rows[k].y) + glm::abs(rows[k].z);
    for (int c = 0; c < 3; ++c) numbers[4 * k + c] = static_cast<float>(rows[k][c] / size);
    numbers[4 * k + 3] = static_cast<float>(glm::dot(rows[k], p) / size) - slack;
  }
  keep_before_light(corners, edges_.size(), numbers, stays_.data());
  for (std::size_t i = 0; i < edges_.size(); ++i)
    if (stays_[i]) found.push_back(edges_[i]);
}

void PointQuery::start(const Casters& casters, const Lamp& lamp, const PixelGroup& points) {
  casters_ = &casters;
  lamp_ = &lamp;
  cache_ = {};
  hint_ = 0xffffffffu;
  find_level(0, points);
}

void PointQuery::find_level(std::size_t level, const PixelGroup& points) {
  const auto& above = points.above;
  if (levels_.size() <= level) levels_.resize(level + 1);
  Level& now = levels_[level];
  const Beam beam(points.box, lamp_->box);
  Beam upper = beam;
  if (above) upper.cut_below(above->normal, above->height);
  now.is_empty = (level > 0 && levels_[level - 1].is_empty) || !casters_->any_in(upper, [](std::uint32_t) { return true; });
  now.edges.clear();
  now.regular_count = 0;
  if (!now.is_empty) {
    // Where some of the light is below the horizon, the way from its corner to a place may lead past edges there, too.
    const Bounds& box = lamp_->box;
    const glm::dvec3 half = 0.5 * (glm::dvec3(box.max) - glm::dvec3(box.min)), middle = glm::dvec3(box.min) + half;
    const bool is_above = above && glm::dot(above->normal, middle) - glm::dot(glm::abs(above->normal), half) > above->highest;
    const Beam& cut = is_above ? upper : beam;
    now.regular_count = level == 0 ? casters_->find_edges(cut, points.box, now.edges)
                                   : casters_->narrow_edges(cut, points.box, levels_[level - 1].edges, now.edges);
  }
  level_ = level;
  edge_count_ = now.edges.size();
}

void PointQuery::get_ready(const Bounds& points) {
  const Level& now = levels_[level_];
  filter_.set(*casters_, now.edges, now.regular_count, points);
}

double PointQuery::share(const NumberedReceiver& receiver, const LightFigure& figure, const Pattern& pattern, Tally& tally) {
  ++tally.points;
  is_dark_ = false;
  depths_.clear();
  places_.clear();
  depth_.set(figure);
  if (levels_[level_].is_empty) return 1;
  tally.looked += filter_.size();
  filter_.find(receiver.point, depth_, kept_);
  add_edges(receiver);
  add_crossing(receiver);
  tally.edges += depth_.line_count();

  PatternPlaces places(pattern.name, pattern.count, pattern.seed);
  const auto count = static_cast<std::uint32_t>(pattern.count);
  if (depth_.is_flat()) {
    for (std::uint32_t from = 0; from < count; from += 16) {
      const std::uint32_t known = place_count();
      find_places(figure, places, from, std::min(from + 16, count));
      for (std::uint32_t k = known; k < place_count(); ++k)
        if (const Way one = way(receiver, figure, k, tally); one != Way::unsure) {
          is_dark_ = one == Way::blocked;
          return is_dark_ ? 0 : 1;
        }
    }
    is_dark_ = place_count() > 0;
    return is_dark_ ? 0 : 1;
  }
  find_places(figure, places, 0, count);
  if (place_count() == 0) return 1;
  depth_.find(places_, depths_);
  least_ = *std::ranges::min_element(depths_);
  is_dark_ = is_blocked(receiver, figure, tally);
  return is_dark_ ? 0 : static_cast<double>(std::ranges::count(depths_, least_)) / place_count();
}

void PointQuery::find_places(const LightFigure& figure, PatternPlaces& places, std::uint32_t from, std::uint32_t to) {
  for (std::uint32_t first = from; first < to; first += 16) {
    const Squares squares = places_on(figure, places.next(first / 16));
    for (std::uint32_t k = 0; k < std::min(to - first, 16u); ++k) {
      if (!figure.holds(figure.box().at({squares.x[k], squares.y[k]}))) continue;
      places_.x.push_back(squares.x[k]);
      places_.y.push_back(squares.y[k]);
    }
  }
}

void PointQuery::find_all_places(const LightFigure& figure, const Pattern& pattern) {
  if (!depths_.empty()) return;
  places_.clear();
  PatternPlaces places(pattern.name, pattern.count, pattern.seed);
  find_places(figure, places, 0, static_cast<std::uint32_t>(pattern.count));
}

Way PointQuery::way(const NumberedReceiver& receiver, const LightFigure& figure, std::uint32_t k, Tally& tally) {
  ++tally.rays;
  return casters_->way(receiver, figure.at(place(figure, k)), cache_, hint_);
}

bool PointQuery::is_blocked(const NumberedReceiver& receiver, const LightFigure& figure, Tally& tally) {
  for (std::uint32_t k = 0; k < place_count(); ++k) {
    if (depths_[k] != least_) continue;
    if (const Way one = way(receiver, figure, k, tally); one != Way::unsure) return one == Way::blocked;
  }
  return true;
}

void PointQuery::add_edges(const NumberedReceiver& receiver) {
  const glm::dvec3 p = receiver.point;
  for (const std::uint32_t number : kept_) {
    const CasterEdge& edge = casters_->edge(number);
    const int jump = casters_->multiplicity(receiver, number, cache_);
    if (jump == 0) continue;
    depth_.add_edge(depth_.corner(glm::dvec3(casters_->position(edge.low)) - p),
                    depth_.corner(glm::dvec3(casters_->position(edge.high)) - p), jump);
  }
}

void PointQuery::add_crossing(const NumberedReceiver& receiver) {
  for (const std::uint32_t triangle : lamp_->crossing) {
    const int facing = casters_->facing(receiver, triangle, cache_);
    if (facing == 0) continue;
    LightDepth::Corner corners[3];
    bool is_swapped[3];
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t vertex = casters_->vertex(triangle, k);
      corners[k] = depth_.corner(glm::dvec3(casters_->position(vertex)) - glm::dvec3(receiver.point));
      is_swapped[k] = vertex > casters_->vertex(triangle, (k + 1) % 3);
    }
    depth_.add_section(corners, is_swapped, facing);
  }
}

}  // namespace gnomon::soft_volume
