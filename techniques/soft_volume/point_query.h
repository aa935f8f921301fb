#pragma once
#include <gnomon/kit/add_up.h>
#include <gnomon/kit/area/light_points.h>
#include <gnomon/kit/pixel_groups.h>

#include <span>
#include <vector>

#include "casters.h"
#include "depth.h"

namespace gnomon::soft_volume {

/// Work of a resolve.
struct Tally {
  std::uint64_t points = 0;  ///< queried
  std::uint64_t rays = 0;    ///< reference rays
  std::uint64_t edges = 0;   ///< silhouette edges that pass before the light, over the points
  std::uint64_t looked = 0;  ///< edges looked at, over the points
  Tally& operator+=(const Tally& other) {
    return add_up(*this, other, &Tally::points, &Tally::rays, &Tally::edges, &Tally::looked);
  }
};

/// Which places of the light a point samples, see PatternPlaces.
struct Pattern {
  std::string_view name;
  int count = 64;
  std::uint64_t seed = 1;
};

/// Edges that points near to each other may need, ready for a quick look: float32 numbers about a place among the points. What
/// it cannot tell stays.
class EdgeFilter {
 public:
  /// `edges` as Casters::find_edges gives them, with the number of regular ones, for points in a box.
  void set(const Casters& casters, std::span<const std::uint32_t> edges, std::size_t regular_count, const Bounds& points);
  /// Edges that may be silhouette edges for a point in the box, and may pass before the light of `depth`.
  void find(const glm::vec3& point, const LightDepth& depth, std::vector<std::uint32_t>& found);
  std::size_t size() const { return edges_.size(); }

 private:
  std::vector<std::uint32_t> edges_;
  std::size_t regular_count_ = 0;
  glm::dvec3 middle_{0};
  float reach_ = 0;  ///< largest coordinate of a vertex about the middle, plus that of a point
  std::vector<float> planes_[8], corners_[6];
  std::vector<std::uint8_t> stays_;
};

/// Decides the places of a light for points, a few neighbors at a time. One for each thread.
class PointQuery {
 public:
  /// A light's box, and the triangles that reach into it.
  struct Lamp {
    Bounds box;
    std::vector<std::uint32_t> crossing;
  };
  /// Points see a lamp; casters and lamp outlive the query.
  void start(const Casters& casters, const Lamp& lamp, const PixelGroup& points);
  /// The same for a part of the points of the level above, which was started last; the first level is 0.
  void narrow(std::size_t level, const PixelGroup& points) { find_level(level, points); }
  /// Edges that the points of the last level look at.
  std::size_t edge_count() const { return edge_count_; }
  /// Makes ready for `share` of the points of the last level.
  void get_ready(const Bounds& points);

  /// The share of the places above the horizon that is seen; 1 where there is none. `figure` must be seen.
  double share(const NumberedReceiver& receiver, const LightFigure& figure, const Pattern& pattern, Tally& tally);

  /// Finds all places of the last point, where `share` needed fewer.
  void find_all_places(const LightFigure& figure, const Pattern& pattern);

  // Of the last point:
  std::uint32_t place_count() const { return static_cast<std::uint32_t>(places_.size()); }
  glm::dvec2 place(const LightFigure& figure, std::uint32_t k) const { return figure.box().at({places_.x[k], places_.y[k]}); }
  bool is_seen(std::uint32_t k) const { return !is_dark_ && (depths_.empty() || depths_[k] == least_); }
  std::size_t line_count() const { return depth_.line_count(); }

 private:
  /// Finds places from number `from` to before `to` that are on the light and above the horizon; all before `from` were found.
  void find_places(const LightFigure& figure, PatternPlaces& places, std::uint32_t from, std::uint32_t to);
  Way way(const NumberedReceiver& receiver, const LightFigure& figure, std::uint32_t k, Tally& tally);
  /// By the reference ray: to the first of the least deep places whose way is sure.
  bool is_blocked(const NumberedReceiver& receiver, const LightFigure& figure, Tally& tally);
  void add_edges(const NumberedReceiver& receiver);
  void add_crossing(const NumberedReceiver& receiver);

  /// What the points of a level may need.
  struct Level {
    bool is_empty = true;
    std::size_t regular_count = 0;
    std::vector<std::uint32_t> edges;
  };
  void find_level(std::size_t level, const PixelGroup& points);

  const Casters* casters_ = nullptr;
  const Lamp* lamp_ = nullptr;
  std::vector<Level> levels_;
  std::size_t level_ = 0, edge_count_ = 0;
  std::vector<std::uint32_t> kept_;
  EdgeFilter filter_;
  CoplanarCache cache_;
  std::uint32_t hint_ = 0xffffffffu;
  LightDepth depth_;
  Places places_;
  std::vector<double> depths_;  ///< of the places; empty where all are alike
  double least_ = 0;
  bool is_dark_ = false;
};

}  // namespace gnomon::soft_volume
