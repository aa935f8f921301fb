// Which tests a pixel runs: tiles and the patches made of them, without a picture.
#include <gnomon/kit/random.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "techniques/composite_planar/patches.h"

namespace composite_planar_tiles_test {
using namespace gnomon;
using namespace composite_planar;
using composite_planar::Receiver;

GBuffer picture_of(const View& view, int width, int height) {
  GBuffer g;
  g.view = view, g.width = width, g.height = height;
  return g;
}

/// A level square of the given half side at a height.
Receiver square(double half, double height) {
  return {
      .plane = {0, 1, 0, -height},
      .sides = {glm::dvec4(1, 0, 0, half), glm::dvec4(-1, 0, 0, half), glm::dvec4(0, 0, 1, half), glm::dvec4(0, 0, -1, half)}};
}

struct PlaneTest {
  std::uint32_t plane;
  ShadowTest test;
};

struct Outcome {
  Tiles tiles;
  Patches patches;
  std::vector<PlaneTest> asked;

  std::vector<Patch> all() const {
    std::vector<Patch> all = patches.whole;
    all.insert(all.end(), patches.single.begin(), patches.single.end());
    all.insert(all.end(), patches.several.begin(), patches.several.end());
    return all;
  }
};

/// The shadows of shapes on receivers, as the technique enters them.
void enter(Outcome& o, const GBuffer& g, std::span<const Receiver> receivers, std::span<const Shape> shapes,
           const glm::dvec4& light) {
  o.asked.clear();
  o.tiles.begin(g);
  for (std::uint32_t r = 0; r < receivers.size(); ++r) {
    if (glm::dot(receivers[r].plane, glm::dvec4(glm::dvec3(g.view.eye), 1)) <= 0) continue;
    o.tiles.begin_plane(r, receivers[r].plane);
    for (const Shape& shape : shapes) {
      const PlanarShadow shadow(shape, light, receivers[r].plane);
      for (std::size_t i = 0; i < shadow.parts().size(); ++i) {
        const Polygon polygon = bound_of(shadow.parts()[i], false, light, receivers[r]);
        if (polygon.size() == 0) continue;
        o.tiles.add(static_cast<std::uint32_t>(o.asked.size()), shadow.tests()[i], polygon);
        o.asked.push_back({r, shadow.tests()[i]});
      }
    }
  }
  o.patches.make(o.tiles.sorted(), o.tiles.columns(), g.width, g.height);
}

std::vector<Shape> random_shapes(Random& random, std::uint32_t count) {
  std::vector<Shape> shapes;
  for (; count > 0; --count) {
    const glm::vec3 at = random.uniform(glm::dvec3(-3, -0.4, -3), glm::dvec3(3, 2, 3));
    const auto size = static_cast<float>(random.uniform(0.1, 1));
    const glm::vec3 axis = random.uniform(glm::dvec3(-1), glm::dvec3(1));
    switch (random.below(4)) {
      case 0:
        shapes.push_back(Sphere{at, size});
        break;
      case 1:
        shapes.push_back(Cone{at, axis, size, 1});
        break;
      case 2:
        shapes.push_back(Disc{at, axis, size});
        break;
      default:
        shapes.push_back(Box{at, at + size});
    }
  }
  return shapes;
}

// Whoever may be in the shadow of a test runs it, or is in a patch that is dark throughout; and there somebody is.
TEST(CompositeTiles, every_pixel_in_a_shadow_is_in_a_patch_that_asks_for_it) {
  const std::vector<Receiver> receivers = {square(4, 0), square(1.5, 0.7)};
  int inside = 0, in_whole = 0, pictures = 0;
  Outcome o;  // reused
  for (unsigned seed = 1; seed <= 60; ++seed) {
    Random random(seed);
    const std::vector<Shape> shapes = random_shapes(random, 1 + random.below(12));
    const glm::dvec4 light = seed % 3 ? glm::dvec4(random.uniform(glm::dvec3(-4, 0.8, -4), glm::dvec3(4, 6, 4)), 1)
                                      : glm::dvec4(random.uniform(glm::dvec3(-1, 0.05, -1), glm::dvec3(1, 1, 1)), 0);
    if (std::ranges::any_of(shapes, [&](const Shape& shape) {
          return !PlanarShadow::objection(shape, light, receivers[0].plane, ShadowForm::exact).empty();
        }))
      continue;
    ++pictures;
    const int sizes[][2] = {{320, 180}, {33, 31}, {1, 1}, {231, 130}, {40, 200}};
    const auto [width, height] = sizes[seed % 5];
    const GBuffer g = picture_of({.eye = random.uniform(glm::dvec3(-5, 0.1, -5), glm::dvec3(5, 5, 5)),
                                  .target = random.uniform(glm::dvec3(-1, 0, -1), glm::dvec3(1, 0.5, 1)),
                                  .fov_y_degrees = static_cast<float>(random.uniform(15, 110))},
                                 width, height);
    enter(o, g, receivers, shapes, light);
    const Camera camera(g.view, width, height);
    const std::vector<Patch> all = o.all();
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        for (std::uint32_t r = 0; r < receivers.size(); ++r) {
          // The point of the plane under the pixel, if the eye sees it from above, on the receiver.
          const glm::dvec3 ray = camera.ray(x + 0.5, y + 0.5);
          const double above = glm::dot(receivers[r].plane, glm::dvec4(camera.eye, 1)), t = -above / ray.y;
          if (above <= 0 || t <= 0) continue;
          const glm::dvec3 p = camera.eye + t * ray;
          if (std::ranges::any_of(receivers[r].sides,
                                  [&](const glm::dvec4& side) { return glm::dot(side, glm::dvec4(p, 1)) < 0; }))
            continue;
          std::set<std::uint32_t> asked;
          bool whole = false;
          for (const Patch& patch : all) {
            if (patch.plane != r || x < int(patch.left) || x >= int(patch.right) || y < int(patch.top) ||
                y >= int(patch.bottom))
              continue;
            whole = whole || patch.count == 0;
            for (std::uint32_t k = 0; k < patch.count; ++k) asked.insert(o.patches.lists[patch.first + k]);
          }
          bool is_dark = false;
          for (std::uint32_t n = 0; n < o.asked.size(); ++n) {
            if (o.asked[n].plane != r || !o.asked[n].test.contains(p)) continue;
            is_dark = true, ++inside;
            EXPECT_TRUE(whole || asked.contains(n)) << "seed " << seed << " pixel " << x << ' ' << y << " test " << n;
          }
          in_whole += whole;
          EXPECT_TRUE(!whole || is_dark) << "seed " << seed << " pixel " << x << ' ' << y;
        }
  }
  EXPECT_GT(pictures, 40);
  EXPECT_GT(inside, 20000);
  EXPECT_GT(in_whole, 2000);
}

// Patches of one plane are equal, the parts of a long list, or do not meet; what is dark throughout has no list beside it.
TEST(CompositeTiles, patches_of_a_plane_do_not_overlap_and_lists_have_no_test_twice) {
  const std::vector<Receiver> receivers = {square(4, 0), square(1.5, 0.7)};
  int several = 0, parted = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    Random random(seed, 3);
    const std::vector<Shape> shapes = random_shapes(random, 4 + random.below(20));
    Outcome o;
    enter(o, picture_of({.eye = {0.3f, 6, 4}, .target = {0, 0, 0}}, 300, 170), receivers, shapes, {1, 7, 0.5, 1});
    std::map<std::array<std::uint32_t, 3>, std::pair<Patch, std::set<std::uint32_t>>> cells;  // by plane, column, row of tiles
    for (const Patch& patch : o.all()) {
      EXPECT_EQ(patch.left % Tiles::side, 0u);
      EXPECT_EQ(patch.top % Tiles::side, 0u);
      EXPECT_LE(patch.right, 300u);
      EXPECT_EQ(patch.bottom, std::min<std::uint32_t>(patch.top + Tiles::side, 170));
      EXPECT_LE(patch.count, Patches::most);
      ASSERT_LE(patch.first + patch.count, o.patches.lists.size());
      several += patch.count > 1;
      for (std::uint32_t x = patch.left; x < patch.right; x += Tiles::side) {
        const auto [found, is_new] = cells.try_emplace({patch.plane, x, patch.top}, patch, std::set<std::uint32_t>{});
        if (!is_new) {
          ++parted;
          EXPECT_TRUE(found->second.first.left == patch.left && found->second.first.right == patch.right);
          EXPECT_TRUE(found->second.first.count > 0 && patch.count > 0);
        }
        for (std::uint32_t k = 0; k < patch.count; ++k) {
          const std::uint32_t test = o.patches.lists[patch.first + k];
          EXPECT_EQ(o.asked[test].plane, patch.plane);
          EXPECT_TRUE(found->second.second.insert(test).second) << "twice";
        }
      }
    }
  }
  EXPECT_GT(several, 100);
  EXPECT_GT(parted, 20);
}

// From 10 m straight above, 320 pixels of a field of view of 2 atan(1) are 20 m: a pixel is 1/16 m, a tile 2 m. The sun stands
// in the zenith. A plate from x = -5 to 5, z = -0.9 to 0.9 reaches, a pixel wider, from column -5 * 16 + 160 = 80 to 240 and
// row 145.6 to 174.4: tiles 2 .. 7 of rows 4 and 5, of which none is filled. Its patches are one for each row, 192 wide.
TEST(CompositeTiles, tiles_side_by_side_with_one_list_are_one_patch) {
  const std::vector<Receiver> receivers = {square(9, 0)};
  const GBuffer g = picture_of({.eye = {0, 10, 0}, .target = {0, 0, 0}, .up = {0, 0, -1}, .fov_y_degrees = 90}, 320, 320);
  const auto plate = [](float x, float z) { return Shape(Plane{{0, 1, 0}, {x, 0, 0}, {0, 0, z}}); };
  const glm::dvec4 zenith(0, 1, 0, 0);
  Outcome o;
  enter(o, g, receivers, std::vector{plate(5, 0.9f)}, zenith);
  EXPECT_TRUE(o.patches.whole.empty() && o.patches.several.empty());
  ASSERT_EQ(o.patches.single.size(), 2u);
  for (std::uint32_t k = 0; k < 2; ++k) {
    const Patch& patch = o.patches.single[k];
    EXPECT_EQ(patch.left, 64u);
    EXPECT_EQ(patch.right, 256u);
    EXPECT_EQ(patch.top, 128 + 32 * k);
    EXPECT_EQ(patch.bottom, patch.top + 32);
  }
  // With it a second one, x = -3.5 to 3.5, columns 104 to 216, and z = -2.9 to 2.9, rows 113.6 to 206.4: it is in tiles 3 .. 6
  // of rows 3 .. 6, and fills tiles 4 and 5 (columns 128 to 192) of rows 4 and 5. In rows 3 and 6 it is alone.
  enter(o, g, receivers, std::vector{plate(5, 0.9f), plate(3.5f, 2.9f)}, zenith);
  ASSERT_EQ(o.patches.whole.size(), 2u);
  EXPECT_EQ(o.patches.whole[0].left, 128u);
  EXPECT_EQ(o.patches.whole[0].right, 192u);
  ASSERT_EQ(o.patches.several.size(), 4u);  // tiles 3 and 6 of both rows
  for (const Patch& patch : o.patches.several) {
    EXPECT_EQ(patch.right - patch.left, 32u);
    EXPECT_EQ(patch.count, 2u);
    EXPECT_EQ(o.patches.lists[patch.first], 0u);
    EXPECT_EQ(o.patches.lists[patch.first + 1], 1u);
  }
  EXPECT_EQ(o.patches.single.size(), 4u + 2u);  // the ends of the first plate, and rows 3 and 6
}

// Six plates one above the other have one list of six: a patch of four and one of two; five, one of four and one of one.
TEST(CompositeTiles, long_lists_are_parted) {
  const GBuffer g = picture_of({.eye = {0, 10, 0}, .target = {0, 0, 0}, .up = {0, 0, -1}, .fov_y_degrees = 90}, 320, 320);
  for (const std::uint32_t count : {4u, 5u, 6u, 9u}) {
    std::vector<Shape> plates;
    for (std::uint32_t k = 0; k < count; ++k) plates.push_back(Plane{{0, 0.5f + 0.1f * k, 0}, {0.7f, 0, 0}, {0, 0, 0.7f}});
    Outcome o;
    enter(o, g, std::vector{square(9, 0)}, plates, {0, 1, 0, 0});
    const std::uint32_t rest = count % Patches::most, rows = 2;
    EXPECT_EQ(o.patches.several.size(), rows * (count / Patches::most + (rest > 1))) << count;
    EXPECT_EQ(o.patches.single.size(), rows * (rest == 1)) << count;
    EXPECT_EQ(o.patches.lists.size(), rows * count);
  }
}

TEST(CompositeTiles, nothing_behind_the_eye_or_beside_the_picture_is_entered) {
  const std::vector<Shape> ball = {Sphere{{0, 1, 0}, 0.5f}};
  const std::vector<Receiver> receivers = {square(9, 0)};
  Outcome o;
  for (const glm::vec3& target : {glm::vec3(12, 1, 0), glm::vec3(6, 8, 0), glm::vec3(6, 1, 8)}) {
    enter(o, picture_of({.eye = {6, 2, 0}, .target = target}, 100, 100), receivers, ball, {0, 5, 0, 1});
    EXPECT_EQ(o.patches.size(), 0u);
    EXPECT_EQ(o.asked.size(), 1u);
  }
  enter(o, picture_of({.eye = {6, 2, 0}, .target = {0, 0, 0}}, 100, 100), receivers, ball, {0, 5, 0, 1});
  EXPECT_GT(o.patches.size(), 0u);
}

}  // namespace composite_planar_tiles_test
