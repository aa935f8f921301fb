// Nearest of many places: a tree of halves, each along the longest side of its box.
#include "measure/score/near_places.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gnomon {

namespace {

/// Ranges of so many are compared one by one.
constexpr std::size_t leaf_size = 8;

std::size_t middle_of(std::size_t begin, std::size_t end) { return begin + (end - begin) / 2; }

double square(const glm::dvec3& v) { return glm::dot(v, v); }

}  // namespace

NearPlaces::NearPlaces(std::vector<glm::dvec3> places) : places_(std::move(places)), axes_(places_.size()) {
  split(0, places_.size());
}

void NearPlaces::split(std::size_t begin, std::size_t end) {
  if (end - begin <= leaf_size) return;
  glm::dvec3 low = places_[begin], high = low;
  for (std::size_t i = begin; i < end; ++i) {
    low = glm::min(low, places_[i]);
    high = glm::max(high, places_[i]);
  }
  const glm::dvec3 size = high - low;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const std::size_t middle = middle_of(begin, end);
  const auto at = [&](std::size_t i) { return places_.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(at(begin), at(middle), at(end),
                   [axis](const glm::dvec3& p, const glm::dvec3& q) { return p[axis] < q[axis]; });
  axes_[middle] = static_cast<std::uint8_t>(axis);
  split(begin, middle);
  split(middle + 1, end);
}

void NearPlaces::search(std::size_t begin, std::size_t end, const glm::dvec3& from, double& least) const {
  if (end - begin <= leaf_size) {
    for (std::size_t i = begin; i < end; ++i) least = std::min(least, square(places_[i] - from));
    return;
  }
  const std::size_t middle = middle_of(begin, end);
  least = std::min(least, square(places_[middle] - from));
  const double past = from[axes_[middle]] - places_[middle][axes_[middle]];
  const auto lower = [&] { search(begin, middle, from, least); };
  const auto upper = [&] { search(middle + 1, end, from, least); };
  past < 0 ? lower() : upper();
  if (past * past < least) past < 0 ? upper() : lower();
}

double NearPlaces::distance(const glm::dvec3& from) const {
  double least = std::numeric_limits<double>::infinity();
  search(0, places_.size(), from, least);
  return std::sqrt(least);
}

}  // namespace gnomon
