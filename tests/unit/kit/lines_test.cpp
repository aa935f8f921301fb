// Lines over a picture, and those of silhouettes.
#include <gnomon/kit/geometry/camera.h>
#include <gnomon/kit/pictures/lines.h>
#include <gtest/gtest.h>

#include "small_world.h"

namespace lines_test {

using namespace small_world;

const glm::vec3 red(1, 0, 0), green(0, 1, 0);

/// Upward 2 x 2 square at height 0 from straight above, at (0, 4, 0). With tan(fov / 2) = 1/2, 80 x 40 pixels show x from -4 to
/// 4 and z from -2 to 2 at height 0: 10 pixels a meter; the square covers columns 30 .. 49 and rows 10 .. 29.
class Lines : public testing::Test {
 protected:
  static constexpr int width = 80, height = 40;
  View view{.eye = {0, 4, 0}, .target = {0, 0, 0}, .up = {0, 0, -1}, .fov_y_degrees = 53.1301024f};
  Scene scene;
  GBuffer gbuffer;

  Lines() {
    scene.meshes = {ground(1)};
    gbuffer = make_gbuffer(scene, view, width, height);
  }

  std::vector<float> draw(const std::vector<Line>& lines) const {
    std::vector<float> picture(gbuffer.size() * 3, 0.25f);
    draw_lines(lines, gbuffer, picture);
    return picture;
  }
  enum State { untouched, hidden, visible };
  static State state(const std::vector<float>& picture, std::size_t i, const glm::vec3& color) {
    const glm::vec3 c(picture[3 * i], picture[3 * i + 1], picture[3 * i + 2]), before(0.25f);
    return c == before ? untouched : c == color ? visible : c == (before + color) / 2.0f ? hidden : State(-1);
  }
};

// z = 0.02 is 0.2 pixels below the middle of the picture, the border of rows 19 and 20, whose centers are 0.7 and 0.3 away:
// these two rows, and all columns whose centers lie between the ends.
TEST_F(Lines, a_visible_line_is_two_pixels_wide_from_end_to_end) {
  const auto picture = draw({{{-0.52, 0, 0.02}, {0.67, 0, 0.02}, red}});
  // Columns: 10 * (4 - 0.52) = 34.8 to 46.7.
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      EXPECT_EQ(state(picture, width * y + x, red), (y == 19 || y == 20) && x >= 35 && x <= 46 ? visible : untouched)
          << x << ", " << y;
}

// x = 3 t, y = -t: the line goes below the square at its middle, and is seen again where the way from the eye to it passes the
// square's border. Under the middle row, but for some places beside what is derived to a few hundredths.
TEST_F(Lines, what_a_surface_hides_is_dotted_and_nothing_else) {
  const Line line{{-1.5, 0.5, 0}, {1.5, -0.5, 0}, green};
  const auto picture = draw({line});
  const Camera camera(view, width, height);
  int hidden_count = 0, covered = 0;
  for (int x = 0; x < width; ++x) {
    const std::size_t i = width * 20 + x;
    // The place on the line under a column: x = 3 t, y = -t, at distance 4 + t; column 40 + 40 * 3 t / (4 + t).
    const double c = (x + 0.5 - 40) / 40, t = 4 * c / (3 - c);
    const bool is_on_line = std::abs(t) < 0.5 - 0.05, is_over_square = x >= 30 && x < 50;
    if (!is_on_line) {
      if (std::abs(t) > 0.55) {
        EXPECT_EQ(state(picture, i, green), untouched) << x;
      }
    } else if (t > 0.02 && is_over_square) {
      ++covered;
      EXPECT_NE(state(picture, i, green), visible) << x;
      hidden_count += state(picture, i, green) == hidden;
    } else if (t < 0 || !is_over_square) {
      EXPECT_EQ(state(picture, i, green), visible) << x;
    }
  }
  EXPECT_GE(covered, 8);
  EXPECT_GE(hidden_count, covered / 2 - 2) << "every other two pixels";
  EXPECT_LE(hidden_count, covered / 2 + 2);
}

// 3 mm beneath a surface 4 m away is less than a thousandth, 5 mm is more.
TEST_F(Lines, a_line_within_a_thousandth_of_its_distance_lies_on_the_surface) {
  for (const auto& [depth, wanted] : {std::pair(0.003, true), {0.005, false}}) {
    const auto picture = draw({{{-0.5, -depth, 0}, {0.5, -depth, 0}, red}});
    int count = 0;
    for (std::size_t i = 0; i < gbuffer.size(); ++i) count += state(picture, i, red) == visible;
    EXPECT_EQ(count > 0, wanted);
  }
}

// A visible line stays, whatever hidden ones come after it; of two visible ones the later is seen.
TEST_F(Lines, visible_parts_are_over_hidden_ones_and_later_lines_over_earlier_ones) {
  const Line on{{-0.5, 0, 0}, {0.5, 0, 0}, red}, below{{-0.5, -1, 0}, {0.5, -1, 0}, green},
      across{{0, 0, -0.5}, {0, 0, 0.5}, green};
  const std::size_t middle = width * 20 + 40, beside = width * 20 + 43;
  EXPECT_EQ(draw({on, below}), draw({below, on}));
  EXPECT_EQ(state(draw({on, below}), beside, red), visible);
  EXPECT_EQ(state(draw({on, across}), middle, green), visible);
  EXPECT_EQ(state(draw({across, on}), middle, red), visible);
}

// From behind the eye to a point that is seen: drawn from the picture's border on. Wholly behind, in the eye, at an end without
// length, or not finite: nothing, and nothing is written beside the picture.
TEST_F(Lines, what_is_behind_the_eye_or_beside_the_picture_is_not_drawn) {
  const std::vector<float> empty = draw({});
  for (const Line& line : {Line{{-1, 5, 0}, {1, 6, 0}, red}, Line{{0, 4, 0}, {0, 4, 0}, red}, Line{{30, 0, 0}, {40, 0, 9}, red},
                           Line{{-90, 0, 0}, {0, 90, 50}, red}, Line{{NAN, 0, 0}, {0, 0, 0}, red}})
    EXPECT_EQ(draw({line}), empty);
  const auto picture = draw({{{3, 8, 0}, {0.5, 0, 0}, red}});
  // It passes the eye's height at x = 1.75, to its right: what is seen of it comes in from the right border.
  EXPECT_EQ(state(picture, width * 20 + width - 1, red), visible);
  EXPECT_EQ(state(picture, width * 20 + 46, red), visible);
  EXPECT_EQ(state(picture, width * 20 + 43, red), untouched);
}

// All of a line through the eye is seen at one place, 5.5 pixels right of the middle and 0.5 below, whichever end the eye is.
TEST_F(Lines, a_line_that_ends_in_the_eye_is_a_point) {
  const glm::dvec3 eye(0, 4, 0), on_square(0.55, 0, 0.05);
  for (const Line& line : {Line{on_square, eye, red}, Line{eye, on_square, red}})
    EXPECT_EQ(state(draw({line}), width * 20 + 45, red), visible);
}

// Points at the middle of a pixel of the square, of the background, beside the picture and behind the eye. Beneath the square a
// point is hidden from 4 mm on, as a line is; and just inside the square's border the pixel beside it shows nothing that hides.
TEST_F(Lines, points_are_seen_by_the_rule_of_lines) {
  const SeenPoints is_seen(gbuffer);
  EXPECT_TRUE(is_seen({0.05, 0, 0.05}));
  EXPECT_TRUE(is_seen({0.05, 1, 0.05}));
  EXPECT_TRUE(is_seen({0.05, -0.003, 0.05}));
  EXPECT_FALSE(is_seen({0.05, -0.005, 0.05}));
  EXPECT_FALSE(is_seen({0.05, -1, 0.05}));
  EXPECT_TRUE(is_seen({2.05, -1, 0.05}));     // beside the square
  EXPECT_TRUE(is_seen({0.95, -0.01, 0.05}));  // in its last column of pixels
  EXPECT_FALSE(is_seen({0.85, -0.01, 0.05}));
  for (const glm::dvec3& p : {glm::dvec3(4.05, 0, 0), {0, 0, -2.05}, {0, 5, 0}, {0, 4, 0}, glm::dvec3(NAN)})
    EXPECT_FALSE(is_seen(p));
}

// Random lines and planes, against the definition: a pixel is painted only if the line passes it by less than one pixel; and
// one whose center the line passes within a half, with both ends well in the picture, is painted unless something hides it.
TEST_F(Lines, random_lines_paint_the_pixels_that_they_pass) {
  Random random(11);
  const Camera camera(view, width, height);
  const GBuffer nothing = make_gbuffer(Scene{}, view, width, height);
  for (int round = 0; round < 200; ++round) {
    const auto point = [&] {
      return camera.eye + camera.ray(random.uniform(2.0, 78.0), random.uniform(2.0, 38.0)) * random.uniform(1.0, 9.0);
    };
    const Line line{point(), point(), red};
    std::vector<float> picture(gbuffer.size() * 3, 0.25f);
    draw_lines({&line, 1}, nothing, picture);
    const auto seen = [&](const glm::dvec3& p) {
      const glm::dvec3 v = p - camera.eye;
      const double z = glm::dot(v, camera.forward);
      return glm::dvec2(40 + 40 * glm::dot(v, camera.right) / z, 20 - 40 * glm::dot(v, camera.up) / z);
    };
    const glm::dvec2 a = seen(line.from), b = seen(line.to), way = b - a;
    for (std::size_t i = 0; i < gbuffer.size(); ++i) {
      const glm::dvec2 center(static_cast<double>(i % width) + 0.5, static_cast<double>(i / width) + 0.5);
      const double share = std::clamp(glm::dot(center - a, way) / glm::dot(way, way), 0.0, 1.0);
      const double distance = glm::distance(center, a + share * way);
      const bool is_painted = state(picture, i, red) == visible;
      if (distance > 1.01) {
        EXPECT_FALSE(is_painted) << round << ", " << i;
      }
      if (distance < 0.49 && share > 0 && share < 1 && glm::length(way) > 2 && share * glm::length(way) > 1 &&
          (1 - share) * glm::length(way) > 1) {
        EXPECT_TRUE(is_painted) << round << ", " << i;
      }
    }
  }
}

// A box from straight above shows its top: four edges, each of one side quad. A single triangle, open: three. Two triangles
// that fold like a roof over the light's direction, both seen: the ridge is no edge; seen from the side so that one is turned
// away and the other not, the ridge counts 2 and the four borders 1 each.
TEST(SilhouetteLines, color_by_how_many_side_quads_start) {
  const auto lines_of = [](Mesh mesh, const glm::dvec4& light) {
    Scene scene;
    scene.meshes = {std::move(mesh)};
    const EdgeAdjacency adjacency(scene);
    Silhouette silhouette;
    adjacency.find_silhouette(light, silhouette);
    return silhouette_lines(adjacency, silhouette);
  };
  const auto count = [](const std::vector<Line>& lines, const glm::vec3& color) {
    return std::ranges::count(lines, color, &Line::color);
  };
  const glm::vec3 one = silhouette_color(1), two = silhouette_color(2);
  const std::vector<Line> top = lines_of(box({-1, 0, -1}, {1, 1, 1}), {0, 9, 0, 1});
  EXPECT_EQ(top.size(), 4u);
  EXPECT_EQ(count(top, one), 4);
  for (const Line& line : top) EXPECT_TRUE(line.from.y == 1 && line.to.y == 1 && glm::distance(line.from, line.to) == 2);

  const Mesh roof = make_mesh({{0, 1, -1}, {0, 1, 1}, {-1, 0, 0}, {1, 0, 0}}, {{0, 2, 1}, {0, 1, 3}});
  EXPECT_EQ(lines_of(roof, {0, 9, 0, 1}).size(), 4u);
  const std::vector<Line> side = lines_of(roof, {9, 0, 0, 1});
  EXPECT_EQ(count(side, one), 4);
  EXPECT_EQ(count(side, two), 1);
  EXPECT_EQ(side.size(), 5u);

  // Three triangles around one edge, all wound alike along it, count 3 there.
  const Mesh fan = make_mesh({{0, 0, -1}, {0, 0, 1}, {1, 0, 0}, {1, 1, 0}, {1, -1, 0}}, {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}});
  const std::vector<Line> three = lines_of(fan, {0.5, 9, 0, 1});
  EXPECT_EQ(count(three, silhouette_color(3)), 1);
  EXPECT_EQ(silhouette_color(3), silhouette_color(7));
}

TEST(SilhouetteLines, legend_has_the_colors_of_the_lines) {
  const DebugLayer layer = silhouette_layer();
  ASSERT_EQ(layer.legend.size(), 3u);
  for (int count = 1; count <= 3; ++count) EXPECT_EQ(glm::vec3(layer.legend[count - 1].color), silhouette_color(count));
}

}  // namespace lines_test
