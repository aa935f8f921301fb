// Words over the picture get out of each other's way.
#include "app/viewer/label_places.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace label_places_test {

using gnomon::viewer::LabelPlaces;
using Place = glm::dvec2;

TEST(label_places, the_first_free_corner_is_taken) {
  LabelPlaces places({100, 50});
  places.take({10, 10}, {30, 10});
  const Place corners[] = {{35, 15}, {90, 30}, {40, 15}, {0, 30}};
  EXPECT_EQ(places.put(corners, {20, 10}), Place(40, 15)) << "the first covers words, the second leaves the picture";
  EXPECT_EQ(places.put(corners, {20, 10}), Place(0, 30));
  EXPECT_EQ(places.put(corners, {20, 10}), std::nullopt) << "rather none than one over others";
}

TEST(label_places, words_that_touch_at_an_edge_do_not_cover_each_other) {
  LabelPlaces places({100, 50});
  places.take({10, 10}, {30, 10});
  for (const Place& beside : {Place(40, 10), Place(10, 20), Place(0, 10), Place(10, 0)})
    EXPECT_TRUE(places.is_free(beside, {10, 10})) << beside.x << ' ' << beside.y;
  EXPECT_FALSE(places.is_free({39.9, 19.9}, {10, 10}));
}

TEST(label_places, words_that_have_to_be_read_go_below_all_that_they_would_cover) {
  LabelPlaces places({100, 50});
  places.take({0, 0}, {100, 12});
  places.take({40, 12}, {20, 10});
  EXPECT_EQ(places.put_below({30, 5}, {20, 10}), Place(30, 22)) << "below the first it would cover the second";
  EXPECT_EQ(places.put_below({70, 20}, {20, 10}), Place(70, 20)) << "free as it is";
  EXPECT_EQ(places.put_below({30, 25}, {20, 40}), Place(30, 32)) << "beyond the picture, too";
}

RC_GTEST_PROP(label_places, no_two_words_share_a_pixel, ()) {
  LabelPlaces places({200, 200});
  std::vector<std::pair<Place, Place>> taken;
  const int count = *rc::gen::inRange(1, 30);
  for (int k = 0; k < count; ++k) {
    const Place corner(*rc::gen::inRange(-20, 200), *rc::gen::inRange(-20, 200)),
        extent(*rc::gen::inRange(1, 60), *rc::gen::inRange(1, 30));
    std::optional<Place> put = corner;
    if (*rc::gen::inRange(0, 2) == 0)
      put = places.put_below(corner, extent);
    else
      put = places.put(std::span(&corner, 1), extent);
    if (!put) continue;
    for (const auto& [low, high] : taken)
      RC_ASSERT(put->x >= high.x || put->y >= high.y || put->x + extent.x <= low.x || put->y + extent.y <= low.y);
    taken.emplace_back(*put, *put + extent);
  }
}

}  // namespace label_places_test
