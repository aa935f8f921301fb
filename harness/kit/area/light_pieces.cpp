#include <gnomon/kit/area/light_pieces.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace gnomon {

namespace {

/// Twice the area of the smallest piece that is kept.
constexpr double least_area = 4e-13;

/// Corners of the polygon around the unit circle whose sides touch it. A place within `least_radius` is inside the polygon that
/// is inscribed where they touch.
struct RoundCorners {
  std::array<glm::dvec2, LightPieces::round_corners> around;
  double least_radius = std::cos(std::numbers::pi / LightPieces::round_corners);
  RoundCorners() {
    const double step = 2 * std::numbers::pi / LightPieces::round_corners;
    for (int k = 0; k < LightPieces::round_corners; ++k)
      around[k] = glm::dvec2(std::cos(step * (k + 0.5)), std::sin(step * (k + 0.5))) / least_radius;
  }
};
const RoundCorners round_figure;

}  // namespace

void LightPieces::add(std::span<const glm::dvec2> polygon) {
  if (polygon.size() < 3 || std::abs(twice_area(polygon)) < least_area) return;
  Piece piece{
      static_cast<std::uint32_t>(corners_.size()), static_cast<std::uint32_t>(polygon.size()), {polygon[0], polygon[0]}};
  for (const glm::dvec2& corner : polygon) piece.box.add(corner);
  corners_.insert(corners_.end(), polygon.begin(), polygon.end());
  live_corners_ += polygon.size();
  pieces_.push_back(piece);
}

void LightPieces::start(const LightFigure& figure) {
  figure_ = &figure;
  pieces_.clear();
  corners_.clear();
  live_corners_ = 0;
  is_whole_ = true;
  if (figure.is_disc())
    whole_.assign(round_figure.around.begin(), round_figure.around.end());
  else
    whole_ = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  const auto is_below = [&](const glm::dvec2& place) { return line_at(figure.horizon(), place) < 0; };
  if (std::ranges::any_of(whole_, is_below)) clip_places(whole_, figure.horizon());
  add(whole_);
}

void LightPieces::subtract(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const double turn = glm::dot(glm::cross(a, b), c);
  if (turn == 0) return;
  // Only what is before the light's plane, on the point's side, can cover it.
  const glm::dvec3 axis = glm::cross(figure_->half_u(), figure_->half_v());
  const double plane = glm::dot(axis, figure_->center());
  const auto before = [&](const glm::dvec3& corner) {
    return plane > 0 ? plane - glm::dot(axis, corner) : glm::dot(axis, corner) - plane;
  };
  const auto [least, most] = std::minmax({before(a), before(b), before(c)});
  if (most <= 0) return;
  const auto line_of = [&](const glm::dvec3& across, double offset) {
    const double sign = turn > 0 ? 1 : -1;
    return sign * glm::dvec3(glm::dot(across, figure_->center()) - offset, glm::dot(across, figure_->half_u()),
                             glm::dot(across, figure_->half_v()));
  };
  std::array<glm::dvec3, 4> lines = {line_of(glm::cross(a, b), 0), line_of(glm::cross(b, c), 0), line_of(glm::cross(c, a), 0)};
  // Of a triangle across the light's plane only places beyond its own plane are covered, which the two planes' common line
  // tells: corners cut off where its sides meet the light's plane would lie as near to each other as a side is to touching it.
  const bool is_across = least < 0;
  if (is_across) {
    const glm::dvec3 normal = glm::cross(b - a, c - a);  // dot(normal, a) is turn
    lines[3] = line_of(normal, glm::dot(normal, a));
  }
  subtract_region(std::span(lines.data(), is_across ? 4 : 3));
}

void LightPieces::subtract_region(std::span<const glm::dvec3> lines) {
  const auto misses = [&](const Piece& piece) {
    for (const glm::dvec3& line : lines) {
      const glm::dvec2 best(line.y > 0 ? piece.box.high.x : piece.box.low.x, line.z > 0 ? piece.box.high.y : piece.box.low.y);
      if (!(line_at(line, best) > 0)) return true;
    }
    return false;
  };
  // From the last to the first: what takes the place of a piece has been looked at, or is new and outside.
  for (std::size_t k = pieces_.size(); k-- > 0;) {
    const Piece piece = pieces_[k];
    if (misses(piece) || !cut(piece, lines)) continue;
    is_whole_ = false;
    live_corners_ -= piece.count;
    pieces_[k] = pieces_.back();
    pieces_.pop_back();
  }
  if (corners_.size() > 1024 + 4 * live_corners_) pack();
}

bool LightPieces::cut(const Piece& piece, std::span<const glm::dvec3> lines) {
  const auto whole = corners(piece);
  rest_.assign(whole.begin(), whole.end());
  const std::size_t piece_count = pieces_.size(), corner_count = corners_.size(), live_count = live_corners_;
  for (const glm::dvec3& line : lines) {
    inside_.clear();
    outside_.clear();
    divide_places(
        rest_, line, [&](const glm::dvec2& place) { inside_.push_back(place); },
        [&](const glm::dvec2& place) { outside_.push_back(place); });
    add(outside_);
    rest_.swap(inside_);
    if (rest_.size() >= 3 && std::abs(twice_area(rest_)) >= least_area) continue;
    // All of it is outside one line: it stays whole, whatever other lines have cut off.
    pieces_.resize(piece_count);
    corners_.resize(corner_count);
    live_corners_ = live_count;
    return false;
  }
  return true;
}

void LightPieces::pack() {
  std::vector<glm::dvec2> packed;
  packed.reserve(2 * live_corners_);
  for (Piece& piece : pieces_) {
    const auto kept = corners(piece);
    piece.first = static_cast<std::uint32_t>(packed.size());
    packed.insert(packed.end(), kept.begin(), kept.end());
  }
  corners_.swap(packed);
}

LightPieces::Measure LightPieces::measure(std::span<const glm::dvec2> polygon) const {
  Measure result{std::abs(twice_area(polygon)), 0};
  glm::dvec3 here = figure_->at(polygon[0]);
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec3 next = figure_->at(polygon[i + 1 < polygon.size() ? i + 1 : 0]);
    const glm::dvec3 across = glm::cross(here, next);
    const double sine = glm::length(across);
    if (sine > 0) result.irradiance += std::atan2(sine, glm::dot(here, next)) / sine * glm::dot(figure_->normal(), across);
    here = next;
  }
  result.irradiance = std::abs(result.irradiance);
  return result;
}

void LightPieces::add_measures(std::span<const glm::dvec2> polygon, Measures& sums) const {
  const Measure all = measure(polygon);
  Measure core = all;
  const double radius = round_figure.least_radius;
  const auto is_inside = [&](const glm::dvec2& place) { return glm::dot(place, place) <= radius * radius; };
  if (figure_->is_disc() && !std::ranges::all_of(polygon, is_inside)) {
    std::vector<glm::dvec2> kept(polygon.begin(), polygon.end());
    for (int k = 0; k < round_corners && !kept.empty(); ++k) {
      const glm::dvec2 across = round_figure.around[k] * radius;  // unit, toward the middle of a side
      const auto is_beyond = [&](const glm::dvec2& place) { return glm::dot(across, place) > radius; };
      if (std::ranges::any_of(kept, is_beyond)) clip_places(kept, {radius, -across.x, -across.y});
    }
    core = kept.size() >= 3 ? measure(kept) : Measure();
  }
  sums.core += core;
  sums.rim += {all.area - core.area, all.irradiance - core.irradiance};
}

LightShares LightPieces::shares() const {
  if (is_whole_) return {};
  Measures seen, all;
  if (!is_gone()) add_measures(whole_, all);
  for (const Piece& piece : pieces_) add_measures(corners(piece), seen);
  // Which part of the rim belongs to the light is undecided: the bounds take what makes the share least and most.
  const auto share = [&](double Measure::*what) {
    const double lit = seen.core.*what, lit_rim = seen.rim.*what;
    const double dark = std::max(all.core.*what - lit, 0.0), dark_rim = std::max(all.rim.*what - lit_rim, 0.0);
    const auto of = [](double part, double other) { return part + other > 0 ? part / (part + other) : 0; };
    constexpr double in_circle = 2.0 / 3;  // of the rim: its parts within and beyond the circle are as n^-2 / 6 to n^-2 / 12
    return LightShare{of(lit, dark + dark_rim), of(lit + in_circle * lit_rim, dark + in_circle * dark_rim),
                      of(lit + lit_rim, dark)};
  };
  return {share(&Measure::area), share(&Measure::irradiance)};
}

}  // namespace gnomon
