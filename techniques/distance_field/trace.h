#pragma once
#include <gnomon/kit/geometry/box_tree.h>

#include <array>
#include <span>

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

/// A caster whose field is no measure yet, because the way starts on its surface or within a voxel of it.
struct Held {
  std::uint32_t caster;
  double highest;       ///< of its distances so far
  bool counts = false;  ///< from where the distance has fallen by half a voxel
};

/// Sphere tracing through the least of all distances. Steps are as long as that distance, within casters as long as the way out
/// of them, and for each caster at least a quarter of its voxel.
///
/// A surface darkens itself if its own field is asked where the way starts: rounded and interpolated distances are as often
/// negative as positive there, and the cone is narrower than any distance. So the start is not moved. Casters within a voxel of
/// it, the own one among them, are held: they shorten steps, and count from where the way comes nearer to them again. A plane
/// or a convex body that the way leaves never does.
///
/// `Casters` has tree(), over boxes outside of which distances are at least those to the box, voxel(caster), largest_voxel()
/// and distance(caster, point).
template <class Casters>
class Trace {
 public:
  Trace(const Casters& casters, const Way& way) : casters_(casters), way_(way) {
    if (way.length > 0) run();
  }

  /// The least s of all steps, see share_seen: -1 .. 1.
  double least() const { return least_; }
  std::uint32_t steps() const { return steps_; }
  std::span<const Held> held() const { return {held_.data(), held_count_}; }

 private:
  static constexpr double fall = 0.5;         ///< voxels; above what interpolation moves a right edge by (0.42)
  static constexpr double least_step = 0.25;  ///< voxels

  /// Distances at one point.
  struct Found {
    double counted = INFINITY;  ///< least of the casters that count, signed
    double step = INFINITY;     ///< least magnitude of all, but for each a part of its voxel
    void take(double distance, double voxel, bool counts) {
      if (counts) counted = std::min(counted, distance);
      step = std::min(step, std::max(std::abs(distance), least_step * voxel));
    }
  };

  void hold(std::uint32_t caster, double distance) {
    held_[held_count_] = {caster, distance};
    ++held_count_;
  }
  bool is_held(std::uint32_t caster) const {
    for (const Held& held : this->held())
      if (held.caster == caster) return true;
    return false;
  }
  /// More casters than fit are within a voxel only where voxels are larger than the casters; those count from the start.
  void hold_near() {
    if (way_.own != no_caster) hold(way_.own, casters_.distance(way_.own, way_.start));
    const double reach = casters_.largest_voxel();
    const auto meets = [&](const float* lower, const float* upper) {
      return square_to_box(way_.start, lower, upper) < reach * reach;
    };
    casters_.tree().each(meets, [&](std::uint32_t place) {
      const std::uint32_t caster = casters_.tree().order()[place];
      if (held_count_ == held_.size() || caster == way_.own) return false;
      const double distance = casters_.distance(caster, way_.start);
      if (std::abs(distance) < casters_.voxel(caster)) hold(caster, distance);
      return false;
    });
  }

  Found look(const glm::dvec3& p) {
    Found found;
    for (Held& held : std::span(held_.data(), held_count_)) {
      const double distance = casters_.distance(held.caster, p), voxel = casters_.voxel(held.caster);
      held.highest = std::max(held.highest, distance);
      if (distance < held.highest - fall * voxel) held.counts = true;
      found.take(distance, voxel, held.counts);
    }
    const auto may_be_less = [&](const float* lower, const float* upper) {
      const double reach = std::max(found.counted, 0.0);
      return square_to_box(p, lower, upper) <= reach * reach;
    };
    casters_.tree().each(may_be_less, [&](std::uint32_t place) {
      const std::uint32_t caster = casters_.tree().order()[place];
      if (!is_held(caster)) found.take(casters_.distance(caster, p), casters_.voxel(caster), true);
      return false;
    });
    return found;
  }

  /// A distance at a place of the way in radii of the cone there, -1 .. 1.
  double radii_at(double distance, double along) const {
    if (along > way_.cone_end && distance > 0) return 1;
    const double radius = along * way_.widening;
    return radius > 0 ? std::clamp(distance / radius, -1.0, 1.0) : distance > 0 ? 1 : -1;
  }
  Found look_at(double along) {
    const Found found = look(way_.start + along * way_.direction);
    ++steps_;
    least_ = std::min(least_, radii_at(found.counted, along));
    return found;
  }

  void run() {
    hold_near();
    double before = 0;  // the distance at the last step, where the step was as long
    for (double t = 0; t < way_.length && least_ > -1;) {
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
  const Way& way_;
  double least_ = 1;
  std::uint32_t steps_ = 0;
  std::array<Held, 16> held_{};
  std::size_t held_count_ = 0;
};

}  // namespace gnomon::distance_field
