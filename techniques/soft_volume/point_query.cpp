#include "point_query.h"

#include <algorithm>

namespace gnomon::soft_volume {

void PointQuery::start(const Casters& casters, const Lamp& lamp, const PixelGroup& points) {
  casters_ = &casters;
  lamp_ = &lamp;
  cache_ = {};
  hint_ = 0xffffffffu;
  find_level(0, points);
}

void PointQuery::find_level(std::size_t level, const PixelGroup& points) {
  const std::optional<PixelGroup::Above>& above = points.above;
  if (levels_.size() <= level) levels_.resize(level + 1);
  Level& now = levels_[level];
  const Beam beam(points.box, lamp_->box);
  Beam upper = beam;
  if (above) upper.cut_below(above->normal, above->height);
  now.is_empty = (level > 0 && levels_[level - 1].is_empty) || !casters_->has_triangles(upper);
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

double PointQuery::share(const NumberedReceiver& receiver, const LightFigure& face, const Pattern& pattern, Tally& tally) {
  ++tally.points;
  is_dark_ = false;
  depths_.clear();
  places_.x.clear();
  places_.y.clear();
  if (depth_)
    depth_->set(face);
  else
    depth_.emplace(face);
  if (levels_[level_].is_empty) return 1;
  tally.looked += filter_.size();
  filter_.find(receiver.point, *depth_, kept_);
  add_edges(receiver);
  add_crossing(receiver);
  tally.edges += depth_->line_count();

  PatternPlaces places(pattern.name, pattern.count, pattern.seed);
  const auto count = static_cast<std::uint32_t>(pattern.count);
  if (depth_->is_flat()) {
    for (std::uint32_t from = 0; from < count; from += 16) {
      const std::uint32_t known = place_count();
      find_places(face, places, from, std::min(from + 16, count));
      for (std::uint32_t k = known; k < place_count(); ++k)
        if (const Way one = way(receiver, face, k, tally); one != Way::unsure) {
          is_dark_ = one == Way::blocked;
          return is_dark_ ? 0 : 1;
        }
    }
    is_dark_ = place_count() > 0;
    return is_dark_ ? 0 : 1;
  }
  find_places(face, places, 0, count);
  if (place_count() == 0) return 1;
  depth_->find(places_, depths_);
  least_ = *std::ranges::min_element(depths_);
  is_dark_ = is_blocked(receiver, face, tally);
  if (is_dark_) return 0;
  return static_cast<double>(std::ranges::count(depths_, least_)) / place_count();
}

void PointQuery::find_places(const LightFigure& face, PatternPlaces& places, std::uint32_t from, std::uint32_t to) {
  for (std::uint32_t first = from; first < to; first += 16) {
    const Squares squares = places_on(face, places.next(first / 16));
    for (std::uint32_t k = 0; k < std::min(to - first, 16u); ++k) {
      const glm::dvec2 square(squares.x[k], squares.y[k]);
      if (!face.holds(face.box().low + square * (face.box().high - face.box().low))) continue;
      places_.x.push_back(square.x);
      places_.y.push_back(square.y);
    }
  }
}

void PointQuery::find_all_places(const LightFigure& face, const Pattern& pattern) {
  if (!depths_.empty()) return;
  places_.x.clear();
  places_.y.clear();
  PatternPlaces places(pattern.name, pattern.count, pattern.seed);
  find_places(face, places, 0, static_cast<std::uint32_t>(pattern.count));
}

Way PointQuery::way(const NumberedReceiver& receiver, const LightFigure& face, std::uint32_t k, Tally& tally) {
  ++tally.rays;
  return casters_->way(receiver, face.at(place(face, k)), cache_, hint_);
}

bool PointQuery::is_blocked(const NumberedReceiver& receiver, const LightFigure& face, Tally& tally) {
  for (std::uint32_t k = 0; k < place_count(); ++k) {
    if (depths_[k] != least_) continue;
    if (const Way one = way(receiver, face, k, tally); one != Way::unsure) return one == Way::blocked;
  }
  return true;
}

void PointQuery::add_edges(const NumberedReceiver& receiver) {
  const glm::dvec3 p = receiver.point;
  for (const std::uint32_t number : kept_) {
    const CasterEdge& edge = casters_->edge(number);
    const int jump = casters_->multiplicity(receiver, number, cache_);
    if (jump == 0) continue;
    depth_->add_edge(depth_->corner(glm::dvec3(casters_->position(edge.low)) - p),
                     depth_->corner(glm::dvec3(casters_->position(edge.high)) - p), jump);
  }
}

void PointQuery::add_crossing(const NumberedReceiver& receiver) {
  const EdgeAdjacency& adjacency = casters_->adjacency();
  for (const std::uint32_t triangle : lamp_->crossing) {
    const int facing = casters_->facing(receiver, triangle, cache_);
    if (facing == 0) continue;
    LightDepth::Corner corners[3];
    bool is_swapped[3];
    std::uint32_t vertex[3];
    for (int k = 0; k < 3; ++k) vertex[k] = adjacency.first_at_position()[adjacency.triangles()[triangle][k]];
    for (int k = 0; k < 3; ++k) {
      corners[k] = depth_->corner(glm::dvec3(adjacency.positions()[vertex[k]]) - glm::dvec3(receiver.point));
      is_swapped[k] = vertex[k] > vertex[(k + 1) % 3];
    }
    depth_->add_section(corners, is_swapped, facing);
  }
}

}  // namespace gnomon::soft_volume
