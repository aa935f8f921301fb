#include "point_query.h"

#include <algorithm>
#include <cmath>

namespace gnomon::penumbra_wedge {

namespace {

/// The light's center, where it is clear of the horizon, else a place half as high over it as the light's highest one: a
/// way along the own surface may meet what is beside the point.
glm::dvec2 first_base(const LightFigure& figure) {
  const glm::dvec3& horizon = figure.horizon();
  const double rise = std::abs(horizon.y) + std::abs(horizon.z);
  if (4 * horizon.x > horizon.x + rise) return {0, 0};
  return (rise - horizon.x) / (2 * rise) * glm::sign(glm::dvec2(horizon.y, horizon.z));
}

/// Then places spread evenly over what is seen (Roberts 2018), as long as they are on the light.
std::optional<glm::dvec2> base_of(const LightFigure& figure, int attempt) {
  const auto part = [&](double step) { return std::fmod(0.5 + attempt * step, 1.0); };
  const glm::dvec2 square(part(0.7548776662466927), part(0.5698402909980532));
  const glm::dvec2 place = attempt == 0 ? first_base(figure) : figure.box().at(square);
  return figure.holds(place) ? std::optional(place) : std::nullopt;
}

}  // namespace

void PointQuery::start(const Casters& casters, const Outline& outline, const PixelGroup& points) {
  casters_ = &casters;
  outline_ = &outline;
  hint_ = 0xffffffffu;
  level_ = 0;
  if (levels_.empty()) levels_.resize(1);
  Level& now = levels_[0];
  Beam beam(points.box, outline.hull.box);
  if (points.above) beam.cut_below(points.above->normal, points.above->height);
  now.wedges.clear();
  now.is_empty = !casters.any_in(beam, [&](std::uint32_t triangle) { return outline.silhouette.facing[triangle] != 0; });
  if (!now.is_empty) outline.wedges.find(beam, points.box, now.wedges);
}

void PointQuery::narrow(std::size_t level, const PixelGroup& points) {
  if (levels_.size() <= level) levels_.resize(level + 1);
  level_ = level;
  levels_[level].is_empty = levels_[level - 1].is_empty;
  outline_->wedges.narrow(points.box, levels_[level - 1].wedges, levels_[level].wedges);
}

double PointQuery::share(const NumberedReceiver& receiver, const LightFigure& figure, Tally& tally) {
  ++tally.points;
  const Level& level = levels_[level_];
  held_.clear();
  at_base_ = 0;
  coverage_.set(figure);
  if (level.is_empty) {
    coverage_.start(figure, {0, 0});
    return 1;
  }
  tally.tests += level.wedges.size();
  for (const std::uint32_t number : level.wedges)
    if (outline_->wedges.all()[number].holds(receiver.point)) held_.push_back(number);
  tally.contributions += held_.size();
  // Where no base will do the point lies in the plane of everything, and the last one has to.
  constexpr int attempts = 32;
  for (int attempt = 0; attempt < attempts; ++attempt)
    if (const auto base = base_of(figure, attempt); base && try_base(receiver, figure, *base, tally)) break;
  return std::clamp(1 - (at_base_ + coverage_.mean()), 0.0, 1.0);
}

bool PointQuery::try_base(const NumberedReceiver& receiver, const LightFigure& figure, const glm::dvec2& base, Tally& tally) {
  coverage_.start(figure, base);
  ++tally.rays;
  const bool is_alone = held_.empty() && outline_->crossing.empty();
  const auto layers = casters_->layers(outline_->silhouette, receiver, coverage_.to_base(), is_alone, hint_);
  at_base_ = layers.value_or(0);
  const bool is_sure = add_wedges(receiver);
  return add_crossing(receiver) && is_sure && layers;
}

bool PointQuery::add_wedges(const NumberedReceiver& receiver) {
  const glm::dvec3 p(receiver.point);
  bool is_sure = true;
  for (const std::uint32_t number : held_) {
    const Wedge& wedge = outline_->wedges.all()[number];
    // Edges of the own triangle lie on the horizon, and bodies left out whole have none.
    if (receiver.has_triangle() ? casters_->is_own_edge(receiver, wedge.low, wedge.high)
                                : receiver.own_count > 0 && casters_->mesh_of_part(wedge.part) == receiver.mesh)
      continue;
    is_sure &= coverage_.add_edge(coverage_.project(glm::dvec3(casters_->position(wedge.low)) - p),
                                  coverage_.project(glm::dvec3(casters_->position(wedge.high)) - p), wedge.count);
  }
  return is_sure;
}

bool PointQuery::add_crossing(const NumberedReceiver& receiver) {
  bool is_sure = true;
  for (const std::uint32_t triangle : outline_->crossing) {
    if (casters_->leaves_out(receiver, triangle)) continue;
    Coverage::Projected corners[3];
    bool is_swapped[3];
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t vertex = casters_->vertex(triangle, k);
      corners[k] = coverage_.project(glm::dvec3(casters_->position(vertex)) - glm::dvec3(receiver.point));
      is_swapped[k] = vertex > casters_->vertex(triangle, (k + 1) % 3);
    }
    is_sure &= coverage_.add_section(corners, is_swapped, outline_->silhouette.facing[triangle]);
  }
  return is_sure;
}

}  // namespace gnomon::penumbra_wedge
