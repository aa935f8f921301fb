#include "measure/score/near_places.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace near_places_test {

using gnomon::NearPlaces;

/// The same by asking every place.
double distance_of_all(const std::vector<glm::dvec3>& places, const glm::dvec3& from) {
  double least = INFINITY;
  for (const glm::dvec3& place : places) least = std::min(least, std::sqrt(glm::dot(place - from, place - from)));
  return least;
}

TEST(near_places, finds_what_asking_every_place_finds) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> in(-3, 3);
  for (const std::size_t count : {1u, 2u, 8u, 9u, 10u, 17u, 100u, 3000u})
    for (const int dimensions : {1, 2, 3}) {  // on a line, on a plane, in space
      const auto draw = [&] {
        return glm::dvec3(in(random), dimensions > 1 ? in(random) : 1, dimensions > 2 ? in(random) : 2);
      };
      std::vector<glm::dvec3> places;
      while (places.size() < count) places.push_back(draw());
      const NearPlaces near(places);
      for (int k = 0; k < 200; ++k) {
        const glm::dvec3 from(in(random), in(random), in(random));
        EXPECT_EQ(near.distance(from), distance_of_all(places, from)) << count << ' ' << dimensions;
      }
      EXPECT_EQ(near.distance(places[count / 2]), 0);
    }
}

TEST(near_places, places_may_coincide_and_lie_on_a_grid) {
  std::vector<glm::dvec3> places(50, glm::dvec3(1, 2, 3));
  EXPECT_EQ(NearPlaces(places).distance({1, 2, 7}), 4);
  for (int x = 0; x < 20; ++x)
    for (int y = 0; y < 20; ++y) places.emplace_back(x, y, 0);
  const NearPlaces near(places);
  for (int x = -2; x < 22; ++x) EXPECT_EQ(near.distance({x + 0.5, 3.5, 0}), distance_of_all(places, {x + 0.5, 3.5, 0})) << x;
}

}  // namespace near_places_test
