#pragma once
#include <gnomon/kit/area/area_rays.h>
#include <gnomon/kit/random.h>

#include <string_view>
#include <vector>

namespace gnomon {

// Where samples of a light with area go, in one of four patterns:
//   random           anywhere
//   stratified       one into each of as many cells of equal area
//   low_discrepancy  a sequence that fills the light evenly (Scramble)
//   interleaved      the same sequence; who gives it sixteen seeds, one for every fourth pixel along x and y, gives neighbors
//                    other places and pixels that are four apart the same

/// The names of the patterns, for a parameter.
std::vector<std::string_view> pattern_names();

/// Of sixteen sets of places the one of a pixel, with pattern interleaved.
inline std::uint32_t interleaved_set(std::size_t x, std::size_t y) { return static_cast<std::uint32_t>(y % 4 * 4 + x % 4); }

/// The seed of the places that a pixel has, or a set of pixels: `own` is its number.
inline std::uint64_t places_seed(int seed, std::uint64_t own) { return (static_cast<std::uint64_t>(seed) << 32) + own; }

/// `count` places of the unit square, sixteen at a time.
class PatternPlaces {
 public:
  PatternPlaces(std::string_view pattern, int count, std::uint64_t seed);
  /// Places 16 * group .. 16 * group + 15, those from `count` on without meaning. Groups come in order, from 0 on.
  Squares next(std::uint32_t group);

 private:
  glm::dvec2 in_stratum(std::uint32_t index, double x, double y) const;

  std::string_view pattern_;
  std::uint32_t count_, columns_ = 1;
  Scramble scramble_;
  Random random_;
};

/// The place of the unit disc for one of the square -1 .. 1: equal areas become equal areas (Shirley and Chiu 1997).
glm::dvec2 place_in_disc(const glm::dvec2& square);

/// `count` points of a light with area, the same for whoever looks: world space, meters, rounded once to float32. On a
/// rectangle they lie where those of PatternPlaces lie on its figure, on a disc as on a figure that is seen along its axis, on
/// a sphere all over its surface. Throws Error on a light without area.
std::vector<glm::vec3> light_points(const Light& light, std::string_view pattern, int count, std::uint64_t seed);

/// Whether points of the light count by how they lie to a pixel: of spheres, but for those so small beside their place that
/// float32 does not tell the points apart, which are as good as one point.
bool has_far_side(const Light& light);

/// How much a point of the light counts, seen from a pixel: as much as the share of the light's figure that it represents. 0
/// where it is below the pixel's horizon, behind a one-sided light, or on the far side of a sphere. Of a flat light all others
/// count 1; of a sphere they count by how much of the disc that is seen its surface fills there.
class PointWeights {
 public:
  PointWeights(const Light& light, const glm::dvec3& position, const glm::dvec3& normal);
  /// Whether the light is seen at all, if nothing is between; else all weights are 0.
  bool is_seen() const { return is_seen_; }
  float at(const glm::vec3& light_point) const {
    const glm::dvec3 to = glm::dvec3(light_point) - position_;
    if (!(is_seen_ && glm::dot(normal_, to) > 0)) return 0;
    if (!(per_distance_ > 0)) return 1;
    // A cone of directions fills a piece of the surface that grows with its distance squared over its cosine, and a piece of
    // the disc by its distance along the axis over the cube of its cosine.
    const double facing = -glm::dot(glm::dvec3(light_point) - center_, to) * per_distance_ * per_radius_;
    const double along = glm::dot(to, axis_) * per_distance_;
    return facing > 0 && along > 0 ? static_cast<float>(facing / (along * along * along)) : 0;
  }

 private:
  glm::dvec3 position_, normal_;
  glm::dvec3 center_{0}, axis_{0};            ///< of a sphere; the axis from the pixel to it, of length 1
  double per_distance_ = 0, per_radius_ = 0;  ///< one over the distance to the disc; 0: the light is flat
  bool is_seen_ = false;
};

}  // namespace gnomon
