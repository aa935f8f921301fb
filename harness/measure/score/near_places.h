#pragma once
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace gnomon {

/// Places in space, asked for the nearest one to a point.
class NearPlaces {
 public:
  /// At least one, all of them finite; several may coincide.
  explicit NearPlaces(std::vector<glm::dvec3> places);
  /// From a point to the nearest place, in the unit of both.
  double distance(const glm::dvec3& from) const;

 private:
  void split(std::size_t begin, std::size_t end);
  void search(std::size_t begin, std::size_t end, const glm::dvec3& from, double& least) const;

  /// A balanced tree: the middle of a range divides it along its axis, the lower half is before it.
  std::vector<glm::dvec3> places_;
  std::vector<std::uint8_t> axes_;  ///< of the middle of each range
};

}  // namespace gnomon
