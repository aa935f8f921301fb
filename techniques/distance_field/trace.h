#pragma once
#include <gnomon/kit/geometry/box_tree.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "fields.h"
#include "penumbra.h"

namespace gnomon::distance_field {

/// A way from a point to a light.
struct Way {
  glm::dvec3 start{0}, direction{0};  ///< direction: unit
  double length = 0;                  ///< to the light, or to where no caster is any more, meters
  double widening = 0;                ///< radius of the light's cone by the distance from the start; 0: a light without area
  /// From here on casters behind the light are as near to the ray as its cone is wide. Only where the ray is within a caster
  /// does the caster count.
  double cone_end = 0;
  std::uint32_t own = no_caster;  ///< of the mesh that the start is on
};

/// Where places of a cone are in boxes: by how far along its axis.
class ConeSlabs {
 public:
  ConeSlabs() = default;
  explicit ConeSlabs(const Way& way) : start_(way.start), end_(way.length) {
    // A product by an inverse that is as good as infinite is of the sign of the other factor, or 0.
    const auto inverse = [](double slope) { return std::abs(slope) > 1e-250 ? 1 / slope : 1e250; };
    for (int k = 0; k < 3; ++k) {
      low_[k] = inverse(way.direction[k] + way.widening);
      high_[k] = inverse(way.direction[k] - way.widening);
    }
  }

  struct Range {
    double from, to;  ///< meters from the start; none where from > to
  };
  /// Where the cube around the disc across the cone at t meets a box. Along each axis it does where
  /// low <= start + t (direction + widening) and start + t (direction - widening) <= high, which are half lines of t.
  Range meets(const float* lower, const float* upper) const {
    Range range{0, end_};
    for (int k = 0; k < 3; ++k) {
      cut(range, (lower[k] - start_[k]) * low_[k], low_[k] > 0);
      cut(range, (upper[k] - start_[k]) * high_[k], high_[k] < 0);
    }
    return range;
  }

 private:
  static void cut(Range& range, double at, bool is_from) {
    if (is_from)
      range.from = std::max(range.from, at);
    else
      range.to = std::min(range.to, at);
  }

  glm::dvec3 start_{0}, low_{0}, high_{0};
  double end_ = 0;
};

/// Whether a caster's field is no measure where a way starts: the start is on it or within a voxel of it.
template <class Casters>
bool is_near(const Casters& casters, const Way& way, std::uint32_t caster) {
  if (caster == way.own) return true;
  const Bounds& box = casters.box(caster);
  const double voxel = casters.voxel(caster);
  return square_to_box(way.start, &box.min.x, &box.max.x) < voxel * voxel &&
         std::abs(casters.distance(caster, way.start)) < voxel;
}

/// Sphere tracing through the least of all distances. Steps are as long as that distance, within casters as long as the way out
/// of them, and for each caster at least a quarter of its voxel. A caster is asked only where the cone meets its box: elsewhere
/// it is farther than the cone is wide.
///
/// A surface darkens itself if its own field is asked where the way starts: rounded and interpolated distances are as often
/// negative as positive there, and the cone is narrower than any distance. So the start is not moved. Casters within a voxel of
/// it, the own one among them, are held: they shorten steps, and count from where the way comes nearer to them again. A plane
/// or a convex body that the way leaves never does.
///
/// `Casters` has tree(), over boxes outside of which distances are at least those to the box, box(caster), voxel(caster), and
/// distance(caster, point). One trace follows many ways, one after another.
template <class Casters>
class Trace {
 public:
  explicit Trace(const Casters& casters) : casters_(casters) {}
  Trace(const Casters& casters, const Way& way) : casters_(casters) { follow(way); }

  void follow(const Way& way) {
    way_ = way;
    least_ = 1;
    steps_ = 0;
    ended_ = begun_ = 0;
    met_.clear();
    if (!(way.length > 0)) return;
    find_met();
    run();
  }

  /// The least s of all steps, see share_seen: -1 .. 1.
  double least() const { return least_; }
  std::uint32_t steps() const { return steps_; }
  /// Whether a caster counted anywhere on the way.
  bool counted(std::uint32_t caster) const {
    return std::ranges::any_of(met_, [&](const Met& met) { return met.caster == caster && met.counts; });
  }

 private:
  static constexpr double fall = 0.5;         ///< voxels; above what interpolation moves a right edge by (0.42)
  static constexpr double least_step = 0.25;  ///< voxels

  /// A caster that the cone meets.
  struct Met {
    ConeSlabs::Range range;
    std::uint32_t caster;
    bool counts;  ///< of one that is held: from where the distance has fallen by half a voxel
    double voxel;
    double highest;  ///< of the distances so far to one that is held
  };
  /// Distances at one point.
  struct Found {
    double counted = INFINITY;  ///< least of the casters that count, signed
    double step = INFINITY;     ///< least magnitude of all, but for each a part of its voxel
  };

  void find_met() {
    const ConeSlabs cone(way_);
    const auto meets = [&](const float* lower, const float* upper) {
      const ConeSlabs::Range range = cone.meets(lower, upper);
      return range.from <= range.to;
    };
    casters_.tree().each(meets, [&](std::uint32_t place) {
      const std::uint32_t caster = casters_.tree().order()[place];
      const Bounds& box = casters_.box(caster);
      const ConeSlabs::Range range = cone.meets(&box.min.x, &box.max.x);
      if (range.from > range.to) return false;
      const bool counts = !is_near(casters_, way_, caster);
      // One that is held shortens steps all the way: so what is thinner than a voxel is found more often.
      met_.push_back({counts ? range : ConeSlabs::Range{0, way_.length}, caster, counts, casters_.voxel(caster), -INFINITY});
      return false;
    });
    std::ranges::sort(met_, {}, [](const Met& met) { return std::pair(met.range.from, met.caster); });
  }

  void ask(Met& met, const glm::dvec3& p, Found& found) const {
    if (met.counts) {
      const double reach = std::max(found.counted, 0.0);
      const Bounds& box = casters_.box(met.caster);
      if (square_to_box(p, &box.min.x, &box.max.x) > reach * reach) return;
    }
    const double distance = casters_.distance(met.caster, p);
    if (!met.counts) {
      met.highest = std::max(met.highest, distance);
      met.counts = distance < met.highest - fall * met.voxel;
    }
    if (met.counts) found.counted = std::min(found.counted, distance);
    found.step = std::min(found.step, std::max(std::abs(distance), least_step * met.voxel));
  }

  /// A distance at a place of the way in radii of the cone there, -1 .. 1.
  double radii_at(double distance, double along) const {
    if (along > way_.cone_end && distance > 0) return 1;
    const double radius = along * way_.widening;
    return radius > 0 ? std::clamp(distance / radius, -1.0, 1.0) : distance > 0 ? 1 : -1;
  }
  /// Casters that are met before the next step begin.
  Found look_at(double along) {
    const glm::dvec3 p = way_.start + along * way_.direction;
    Found found;
    for (std::size_t i = ended_; i < begun_; ++i) ask(met_[i], p, found);
    for (; begun_ < met_.size() && met_[begun_].range.from < along + found.step; ++begun_) ask(met_[begun_], p, found);
    ++steps_;
    least_ = std::min(least_, radii_at(found.counted, along));
    return found;
  }
  void end_those_before(double along) {
    for (std::size_t i = ended_; i < begun_; ++i)
      if (met_[i].range.to < along) std::swap(met_[i], met_[ended_++]);
  }

  void run() {
    double before = 0;  // the distance at the last step, where the step was as long
    double last = 0;    // where the last step began
    for (double t = 0; t < way_.length && least_ > -1;) {
      end_those_before(way_.widening > 0 ? last
                                         : t);  // under a light with area, what was nearest between both steps is looked for
      if (ended_ == begun_) {
        if (begun_ == met_.size()) return;
        t = std::max(t, met_[begun_].range.from);
        before = 0;
        if (!(t < way_.length)) return;
      }
      const Found found = look_at(t);
      // Between both steps the way may have come nearer. Elsewhere the circles meet before the last step, if at all. Along a
      // plane nothing is where they meet: the distance there is asked, not computed.
      if (before > 0 && found.counted > 0 && found.counted * found.counted < 2 * before * before) {
        const Approach nearest = closest_approach(before, found.counted, t);
        if (radii_at(nearest.distance, nearest.along) < least_) look_at(nearest.along);
      }
      // The share of t is what double tells apart; it counts where a caster is smaller than that.
      const double step = std::max(found.step, t * 0x1p-40);
      before = found.counted == step && step < INFINITY ? step : 0;
      last = t;
      // Past the end of the cone distances say nothing: the last one is that at its end.
      if (t < way_.cone_end && t + step > way_.cone_end && way_.cone_end < way_.length) {
        t = way_.cone_end;
        before = 0;
      } else {
        t += step;
      }
    }
  }

  const Casters& casters_;
  Way way_;
  double least_ = 1;
  std::uint32_t steps_ = 0;
  std::vector<Met> met_;  ///< those that have ended, those that have begun, and the others as they are met
  std::size_t ended_ = 0, begun_ = 0;
};

}  // namespace gnomon::distance_field
