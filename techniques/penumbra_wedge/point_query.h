#pragma once
#include <gnomon/kit/add_up.h>
#include <gnomon/kit/pixel_groups.h>

#include "casters.h"
#include "coverage.h"
#include "wedges.h"

namespace gnomon::penumbra_wedge {

/// Work of a resolve.
struct Tally {
  std::uint64_t points = 0;         ///< queried
  std::uint64_t rays = 0;           ///< ways to a base
  std::uint64_t tests = 0;          ///< of a point against a wedge
  std::uint64_t contributions = 0;  ///< wedges that held their point
  Tally& operator+=(const Tally& other) {
    return add_up(*this, other, &Tally::points, &Tally::rays, &Tally::tests, &Tally::contributions);
  }
};

/// What a light has of its own, the same for all points.
struct Outline {
  Silhouette silhouette;  ///< from the light's center
  LightHull hull;
  Wedges wedges;
  std::vector<std::uint32_t> crossing;  ///< triangles that may cross the light
};

/// Decides how much points see of a light, a few neighbors at a time. One for each thread.
class PointQuery {
 public:
  /// Casters and outline outlive the query.
  void start(const Casters& casters, const Outline& outline, const PixelGroup& points);
  /// The same for a part of the points of the level above, which was started last; the first level is 0.
  void narrow(std::size_t level, const PixelGroup& points);
  std::size_t wedge_count() const { return levels_[level_].wedges.size(); }

  /// The share that the outline leaves of the light: what is seen at the base, and what every wedge adds to it or takes from
  /// it. `figure` must be seen.
  double share(const NumberedReceiver& receiver, const LightFigure& figure, Tally& tally);

  // Of the last point:
  std::size_t holding_count() const { return held_.size(); }
  /// How many layers of casters are before a place, by the same edges.
  int layers_at(const glm::dvec2& place) const { return at_base_ + coverage_.at(place); }

 private:
  struct Level {
    bool is_empty = true;
    std::vector<std::uint32_t> wedges;
  };
  /// Finds the layers at a base and adds the regions of all edges; false where double cannot tell all signs.
  bool try_base(const NumberedReceiver& receiver, const LightFigure& figure, const glm::dvec2& base, Tally& tally);
  bool add_wedges(const NumberedReceiver& receiver);
  bool add_crossing(const NumberedReceiver& receiver);

  const Casters* casters_ = nullptr;
  const Outline* outline_ = nullptr;
  std::vector<Level> levels_;
  std::size_t level_ = 0;
  std::uint32_t hint_ = 0xffffffffu;
  std::vector<std::uint32_t> held_;
  Coverage coverage_;
  int at_base_ = 0;
};

}  // namespace gnomon::penumbra_wedge
