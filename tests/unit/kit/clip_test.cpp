// The clipper: parts on paper, and what holds for every cut.
#include <gnomon/kit/geometry/clip.h>
#include <gnomon/kit/random.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>
#include <vector>

namespace gnomon::clip_test {

constexpr std::uint32_t cut = 99;
constexpr double epsilon = 1e-10;

struct Parts {
  std::vector<Corner> negative, positive;
  Lies lies;
};

/// Both parts; each has at most one corner more than the polygon.
Parts cut_by(const std::vector<Corner>& polygon, const ClipPlane& plane, double within = epsilon) {
  std::vector<double> values(polygon.size());
  Parts parts;
  parts.lies = classify(polygon, plane, within, values.data());
  parts.negative.resize(polygon.size() + 1), parts.positive.resize(polygon.size() + 1);
  const CutCounts counts = cut_polygon(polygon, values.data(), within, cut, parts.negative.data(), parts.positive.data());
  EXPECT_LE(counts.negative, polygon.size() + 1);
  EXPECT_LE(counts.positive, polygon.size() + 1);
  parts.negative.resize(counts.negative), parts.positive.resize(counts.positive);
  return parts;
}

std::vector<glm::dvec3> points(const std::vector<Corner>& polygon) {
  std::vector<glm::dvec3> all;
  for (const Corner& corner : polygon) all.push_back(corner.at);
  return all;
}
std::vector<std::uint32_t> edges(const std::vector<Corner>& polygon) {
  std::vector<std::uint32_t> all;
  for (const Corner& corner : polygon) all.push_back(corner.edge);
  return all;
}
glm::dvec3 area_vector(const std::vector<Corner>& polygon) {
  glm::dvec3 sum(0);
  for (std::size_t i = 2; i < polygon.size(); ++i)
    sum += glm::cross(polygon[i - 1].at - polygon[0].at, polygon[i].at - polygon[0].at);
  return sum / 2.0;
}

using Points = std::vector<glm::dvec3>;
using Edges = std::vector<std::uint32_t>;

const std::vector<Corner> square = {{{0, 0, 0}, 1}, {{4, 0, 0}, 2}, {{4, 4, 0}, 3}, {{0, 4, 0}, 4}};

// x >= 1 of the square, and what is left of it; a plane beside the polygon takes nothing.
TEST(Clip, a_clipper_holds_both_parts_of_a_cut) {
  Clipper clipper;
  clipper.start(square);
  EXPECT_EQ(clipper.keep_positive({.normal = {1, 0, 0}, .offset = -1}, epsilon, cut), Lies::across);
  const Parts parts = cut_by(square, {.normal = {1, 0, 0}, .offset = -1});
  const std::span<const Corner> kept = clipper.corners(), taken = clipper.cut_off();
  EXPECT_EQ(points({kept.begin(), kept.end()}), points(parts.positive));
  EXPECT_EQ(edges({kept.begin(), kept.end()}), edges(parts.positive));
  EXPECT_EQ(points({taken.begin(), taken.end()}), points(parts.negative));
  EXPECT_EQ(edges({taken.begin(), taken.end()}), edges(parts.negative));
  EXPECT_EQ(clipper.keep_positive({.normal = {1, 0, 0}, .offset = 9}, epsilon, cut), Lies::positive);
  EXPECT_EQ(clipper.corners().size(), 4u);
}

TEST(Clip, a_polygon_lies_on_sides_within_epsilon_or_across) {
  double values[4];
  const auto lies = [&](double offset) { return classify(square, {.normal = {1, 0, 0}, .offset = offset}, 0.5, values); };
  EXPECT_EQ(lies(1), Lies::positive);
  EXPECT_EQ(values[0], 1);
  EXPECT_EQ(values[1], 5);
  EXPECT_EQ(lies(0.5), Lies::positive);   // two corners on the plane, by just epsilon
  EXPECT_EQ(lies(-0.5), Lies::positive);  // the same from the other side
  EXPECT_EQ(lies(-0.75), Lies::across);
  EXPECT_EQ(lies(-3.5), Lies::negative);
  EXPECT_EQ(lies(-5), Lies::negative);
  EXPECT_EQ(classify(square, {.normal = {0, 0, 1}, .offset = 0.25}, 0.5, values), Lies::within);
}

// x = 1 cuts the edges 1 and 3. Each part keeps them, and closes with the cut.
TEST(Clip, a_square_on_paper) {
  const Parts parts = cut_by(square, {.normal = {1, 0, 0}, .offset = -1});
  EXPECT_EQ(parts.lies, Lies::across);
  EXPECT_EQ(points(parts.negative), (Points{{0, 0, 0}, {1, 0, 0}, {1, 4, 0}, {0, 4, 0}}));
  EXPECT_EQ(edges(parts.negative), (Edges{1, cut, 3, 4}));
  EXPECT_EQ(points(parts.positive), (Points{{1, 0, 0}, {4, 0, 0}, {4, 4, 0}, {1, 4, 0}}));
  EXPECT_EQ(edges(parts.positive), (Edges{1, 2, 3, cut}));
}

// x = y goes through two corners, which belong to both parts as they are, up to epsilon off the plane as well.
TEST(Clip, corners_on_the_plane_belong_to_both_parts) {
  for (const double off : {0.0, 0.9, -0.9}) {
    std::vector<Corner> polygon = square;
    polygon[2].at.x += off * epsilon;
    const Parts parts = cut_by(polygon, {.normal = {1, -1, 0}, .offset = 0});
    EXPECT_EQ(points(parts.positive), (Points{polygon[0].at, polygon[1].at, polygon[2].at}));
    EXPECT_EQ(edges(parts.positive), (Edges{1, 2, cut}));
    EXPECT_EQ(points(parts.negative), (Points{polygon[0].at, polygon[2].at, polygon[3].at}));
    EXPECT_EQ(edges(parts.negative), (Edges{cut, 3, 4}));
  }
}

// 4 x = y goes through the first corner, and through the edge from (4, 4) to (0, 4) at x = 1.
TEST(Clip, a_cut_from_a_corner_to_an_edge) {
  const Parts parts = cut_by(square, {.normal = {4, -1, 0}, .offset = 0});
  EXPECT_EQ(points(parts.negative), (Points{{0, 0, 0}, {1, 4, 0}, {0, 4, 0}}));
  EXPECT_EQ(edges(parts.negative), (Edges{cut, 3, 4}));
  EXPECT_EQ(points(parts.positive), (Points{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {1, 4, 0}}));
  EXPECT_EQ(edges(parts.positive), (Edges{1, 2, 3, cut}));
}

// Corners just epsilon off the plane are on it, as `classify` has it: x = y with half a meter of epsilon, the third corner at
// the value -1/2 or 1/2.
TEST(Clip, just_epsilon_is_on_the_plane) {
  for (const double x : {3.5, 4.5}) {
    std::vector<Corner> polygon = square;
    polygon[2].at.x = x;
    const Parts parts = cut_by(polygon, {.normal = {1, -1, 0}, .offset = 0}, 0.5);
    EXPECT_EQ(points(parts.positive), (Points{polygon[0].at, polygon[1].at, polygon[2].at}));
    EXPECT_EQ(points(parts.negative), (Points{polygon[0].at, polygon[2].at, polygon[3].at}));
  }
}

// An edge of half epsilon from the plane x = y on belongs to both parts, with its own mark; the cut is between its far end, or
// its near one, and the first corner.
TEST(Clip, a_short_edge_within_epsilon_keeps_its_mark) {
  const std::vector<Corner> polygon = {
      {{0, 0, 0}, 1}, {{4, 0, 0}, 2}, {{4, 4, 0}, 3}, {{4 - epsilon / 2, 4, 0}, 4}, {{0, 4, 0}, 5}};
  const Parts parts = cut_by(polygon, {.normal = {1, -1, 0}, .offset = 0});
  EXPECT_EQ(edges(parts.positive), (Edges{1, 2, 3, cut}));
  EXPECT_EQ(edges(parts.negative), (Edges{cut, 3, 4, 5}));
}

using Key = std::tuple<double, double, double>;
std::set<Key> keys(const std::vector<Corner>& polygon) {
  std::set<Key> all;
  for (const Corner& corner : polygon) all.insert({corner.at.x, corner.at.y, corner.at.z});
  return all;
}

/// A convex polygon in a random plane: an ellipse, in up to nine corners.
std::vector<Corner> random_polygon(Random& random) {
  const glm::dvec3 center = random.uniform(glm::dvec3(-1), glm::dvec3(1)), u = random.uniform(glm::dvec3(-1), glm::dvec3(1)),
                   v = random.uniform(glm::dvec3(-1), glm::dvec3(1));
  const std::uint32_t count = 3 + random.below(7);
  std::vector<Corner> polygon;
  for (std::uint32_t k = 0; k < count; ++k) {
    const double angle = 6.283185307179586 * (k + random.uniform(0.1, 0.9)) / count;
    polygon.push_back({center + std::cos(angle) * u + std::sin(angle) * v, k});
  }
  return polygon;
}

// Through random planes, and planes through one or two corners: parts share the two ends of the cut bit for bit and nothing
// else; their areas add up as vectors, which is their winding too; their corners lie on their sides; only the edge of the cut
// has its mark, and each of the others lies on the edge whose mark it has.
TEST(Clip, parts_make_up_the_polygon) {
  Random random(1);
  int across = 0, through_corners = 0;
  for (int round = 0; round < 20'000; ++round) {
    const std::vector<Corner> polygon = random_polygon(random);
    const auto pick = [&] { return polygon[random.below(static_cast<std::uint32_t>(polygon.size()))].at; };
    const bool by_corners = round % 2;
    const glm::dvec3 p = by_corners ? pick() : random.uniform(glm::dvec3(-1), glm::dvec3(1)),
                     q = by_corners ? pick() : random.uniform(glm::dvec3(-1), glm::dvec3(1)),
                     r = random.uniform(glm::dvec3(-1), glm::dvec3(1));
    glm::dvec3 normal = glm::cross(q - p, r - p);
    if (glm::length(normal) < 0.01) continue;
    normal = glm::normalize(normal);
    const ClipPlane plane{normal, -glm::dot(normal, p)};
    const Parts parts = cut_by(polygon, plane);
    if (parts.lies != Lies::across) continue;
    ++across;
    ASSERT_GE(parts.negative.size(), 3u);
    ASSERT_GE(parts.positive.size(), 3u);
    through_corners += parts.negative.size() + parts.positive.size() < polygon.size() + 4;

    const glm::dvec3 whole = area_vector(polygon), negative = area_vector(parts.negative),
                     positive = area_vector(parts.positive);
    EXPECT_LT(glm::length(negative + positive - whole), 1e-9);
    EXPECT_GT(glm::dot(negative, whole), 0);
    EXPECT_GT(glm::dot(positive, whole), 0);

    const std::set<Key> a = keys(parts.negative), b = keys(parts.positive);
    std::vector<Key> shared;
    std::ranges::set_intersection(a, b, std::back_inserter(shared));
    EXPECT_EQ(shared.size(), 2u);

    for (const double side : {-1.0, 1.0}) {
      const std::vector<Corner>& part = side < 0 ? parts.negative : parts.positive;
      int marks = 0;
      for (std::size_t i = 0; i < part.size(); ++i) {
        const glm::dvec3 at = part[i].at, next = part[(i + 1) % part.size()].at;
        EXPECT_GT(side * plane.at(at), -1.1 * epsilon);
        if (part[i].edge == cut) {
          ++marks;
          EXPECT_LT(std::max(std::abs(plane.at(at)), std::abs(plane.at(next))), 1.1 * epsilon);
        } else {
          const glm::dvec3 from = polygon[part[i].edge].at, to = polygon[(part[i].edge + 1) % polygon.size()].at;
          const glm::dvec3 along = glm::normalize(to - from);
          EXPECT_LT(glm::length(glm::cross(along, at - from)) + glm::length(glm::cross(along, next - from)), 1e-9);
          EXPECT_GT(glm::dot(along, next - at), 0);
        }
      }
      EXPECT_EQ(marks, 1);
    }
  }
  EXPECT_GT(across, 5000);
  EXPECT_GT(through_corners, 1000);
}

// Two triangles share an edge, which each of them runs in its own direction: the point of a cut on it is one point, so that
// no crack opens. (A plane turned about may round it otherwise.)
TEST(Clip, neighbors_get_the_same_point_on_their_edge) {
  Random random(2);
  int across = 0;
  for (int round = 0; round < 20'000; ++round) {
    const auto any = [&] { return random.uniform(glm::dvec3(-1), glm::dvec3(1)); };
    const glm::dvec3 a = any(), b = any(), left = any(), right = any(), normal = glm::normalize(any());
    const ClipPlane plane{normal, random.uniform(-0.5, 0.5)};
    if (!(plane.at(a) * plane.at(b) < 0)) continue;
    ++across;
    // The shared edge has the mark 7 in both; what crosses it is where that edge begins or ends anew.
    const std::vector<Corner> first = {{a, 7}, {b, 1}, {left, 2}}, second = {{b, 7}, {a, 3}, {right, 4}};
    std::set<Key> found;
    for (const std::vector<Corner>& polygon : {first, second}) {
      const Parts parts = cut_by(polygon, plane, 0);
      for (const std::vector<Corner>& part : {parts.negative, parts.positive})
        for (std::size_t i = 0; i < part.size(); ++i) {
          if (part[i].edge != 7) continue;
          for (const glm::dvec3& end : {part[i].at, part[(i + 1) % part.size()].at})
            if (end != a && end != b) found.insert({end.x, end.y, end.z});
        }
    }
    EXPECT_EQ(found.size(), 1u);
  }
  EXPECT_GT(across, 3000);
}

// The square 0 .. 4 loses what is left of x = 1 and above y = 3; a plane beyond it changes nothing and one before it says so.
// Then another polygon in the same clipper.
TEST(Clip, a_clipper_keeps_what_is_inside_all_planes) {
  Clipper clipper;
  const std::vector<Corner> square = {{{0, 0, 0}, 1}, {{4, 0, 0}, 2}, {{4, 4, 0}, 3}, {{0, 4, 0}, 4}};
  clipper.start(square);
  EXPECT_EQ(clipper.keep_positive({{1, 0, 0}, -1}, epsilon, cut), Lies::across);
  EXPECT_EQ(clipper.keep_positive({{1, 0, 0}, 5}, epsilon, cut), Lies::positive);
  EXPECT_EQ(clipper.keep_positive(-ClipPlane{{0, 1, 0}, -3}, epsilon, cut), Lies::across);
  const std::vector<Corner> kept(clipper.corners().begin(), clipper.corners().end());
  EXPECT_EQ(points(kept), (std::vector<glm::dvec3>{{1, 0, 0}, {4, 0, 0}, {4, 3, 0}, {1, 3, 0}}));
  EXPECT_EQ(kept[2].edge, cut);
  EXPECT_EQ(kept[3].edge, cut);
  EXPECT_FALSE(has_inside(clipper.keep_positive({{1, 0, 0}, -9}, epsilon)));
  EXPECT_EQ(clipper.corners().size(), 4u);
  clipper.start();
  for (const glm::dvec3& p : {glm::dvec3(0, 0, 0), glm::dvec3(2, 0, 0), glm::dvec3(0, 2, 0)}) clipper.add({p});
  EXPECT_EQ(clipper.keep_positive({{0, 0, 1}}, epsilon), Lies::within);
  EXPECT_TRUE(has_inside(clipper.keep_positive({{-1, 0, 0}, 1}, epsilon)));
  EXPECT_EQ(clipper.corners().size(), 4u);
}

// Its buffers take turns: once they have the size that the polygons need, no cut allocates.
TEST(Clip, a_clipper_does_not_grow) {
  Clipper clipper;
  std::set<const Corner*> places;
  for (int i = 0; i < 1000; ++i) {
    clipper.start();
    for (const glm::dvec3& p : {glm::dvec3(0, 0, 0), glm::dvec3(2, 0, 0), glm::dvec3(0, 2, 0)}) clipper.add({p});
    for (const glm::dvec3& normal : {glm::dvec3(-1, 0, 0), glm::dvec3(0, -1, 0)})
      EXPECT_EQ(clipper.keep_positive({normal, 1}, epsilon), Lies::across);
    places.insert(clipper.corners().data());
  }
  EXPECT_LE(places.size(), 2u);
}

}  // namespace gnomon::clip_test
