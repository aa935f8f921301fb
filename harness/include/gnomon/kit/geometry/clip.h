#pragma once
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <utility>
#include <vector>

namespace gnomon {

// The clipper of object precision: convex polygons, cut by planes. In whatever space and unit the corners are: the world and
// meters, or what a light sees.

/// Corner of a convex polygon, and the edge from it to the next corner.
struct Corner {
  glm::dvec3 at;
  std::uint32_t edge = 0;  ///< the owner's mark of the edge; both parts of a cut edge keep it
};

/// Points x with dot(normal, x) + offset = 0. With a unit normal `at` is the distance, in the unit of the corners.
struct ClipPlane {
  glm::dvec3 normal{0};
  double offset = 0;
  double at(const glm::dvec3& x) const { return normal.x * x.x + normal.y * x.y + normal.z * x.z + offset; }
  ClipPlane operator-() const { return {-normal, -offset}; }
};

/// Where a polygon lies from a plane: bit 0, some corner is farther than epsilon on the negative side; bit 1, on the positive.
enum class Lies : unsigned { within = 0, negative = 1, positive = 2, across = 3 };
/// Whether it has a part on the positive side that is farther than epsilon from the plane.
inline bool has_inside(Lies lies) { return (static_cast<unsigned>(lies) & 2) != 0; }

/// Writes every corner's value at the plane to `values`, which has room for as many; those within epsilon count as on the
/// plane.
inline Lies classify(std::span<const Corner> polygon, const ClipPlane& plane, double epsilon, double* values) {
  unsigned lies = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const double value = plane.at(polygon[i].at);
    values[i] = value;
    lies |= static_cast<unsigned>(value < -epsilon) | static_cast<unsigned>(value > epsilon) << 1;
  }
  return static_cast<Lies>(lies);
}

/// How many corners the parts of a cut polygon have.
struct CutCounts {
  std::size_t negative, positive;
};

/// Cuts a polygon that lies across a plane, by its corners' values. Each part has at most one corner more than the polygon, is
/// wound as it is, and gets `cut` as the mark of the edge along the plane. Corners within epsilon belong to both parts. The
/// point where an edge crosses is reckoned from its positive end, so that polygons on either side of the edge get the same one,
/// bit for bit.
inline CutCounts cut_polygon(std::span<const Corner> polygon, const double* values, double epsilon, std::uint32_t cut,
                             Corner* negative, Corner* positive) {
  Corner* n = negative;
  Corner* p = positive;
  const std::size_t size = polygon.size();
  for (std::size_t i = 0; i < size; ++i) {
    const std::size_t next = i + 1 < size ? i + 1 : 0;
    const Corner& corner = polygon[i];
    const double here = values[i], there = values[next];
    const bool is_negative = here<-epsilon, is_positive = here> epsilon;
    // A part ends where the next corner is not its own; its edge then runs along the plane.
    if (!is_positive) *n++ = {corner.at, !is_negative && there > epsilon ? cut : corner.edge};
    if (!is_negative) *p++ = {corner.at, !is_positive && there < -epsilon ? cut : corner.edge};
    if (is_negative && there > epsilon) {
      const glm::dvec3 at = polygon[next].at + there / (there - here) * (corner.at - polygon[next].at);
      *n++ = {at, cut};
      *p++ = {at, corner.edge};
    } else if (is_positive && there < -epsilon) {
      const glm::dvec3 at = corner.at + here / (here - there) * (polygon[next].at - corner.at);
      *n++ = {at, corner.edge};
      *p++ = {at, cut};
    }
  }
  return {static_cast<std::size_t>(n - negative), static_cast<std::size_t>(p - positive)};
}

/// A polygon that planes cut down, one after the other. Keeps its memory from one polygon to the next.
class Clipper {
 public:
  void start() { count_ = 0; }
  void add(const Corner& corner) {
    if (polygon_.size() == count_) polygon_.resize(2 * count_ + 8);
    polygon_[count_++] = corner;
  }
  void start(std::span<const Corner> corners) {
    start();
    for (const Corner& corner : corners) add(corner);
  }

  /// Leaves what lies on the positive side of a plane, if the polygon lies across it, with `cut` as the mark of the edge along
  /// the plane. Says how it lay; of what does not lie across a plane nothing is cut off.
  Lies keep_positive(const ClipPlane& plane, double epsilon, std::uint32_t cut = 0) {
    if (kept_.size() <= count_) kept_.resize(2 * count_ + 8);
    if (rest_.size() <= count_) {
      rest_.resize(2 * count_ + 8);
      values_.resize(2 * count_ + 8);
    }
    const Lies lies = classify(corners(), plane, epsilon, values_.data());
    if (lies != Lies::across) return lies;
    const CutCounts counts = cut_polygon(corners(), values_.data(), epsilon, cut, rest_.data(), kept_.data());
    count_ = counts.positive;
    rest_count_ = counts.negative;
    std::swap(polygon_, kept_);
    return lies;
  }

  std::span<const Corner> corners() const { return {polygon_.data(), count_}; }
  std::span<Corner> corners() { return {polygon_.data(), count_}; }
  /// What the last cut took away.
  std::span<const Corner> cut_off() const { return {rest_.data(), rest_count_}; }

 private:
  std::vector<Corner> polygon_, kept_, rest_;
  std::vector<double> values_;
  std::size_t count_ = 0, rest_count_ = 0;
};

}  // namespace gnomon
