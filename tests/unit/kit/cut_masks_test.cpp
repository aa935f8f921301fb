// Alpha masks cut into polygons: what is solid, how the pieces join, and how many there are.
#include <gnomon/error.h>
#include <gnomon/kit/geometry/cut_masks.h>
#include <gnomon/kit/geometry/edges.h>
#include <gnomon/kit/geometry/holes.h>
#include <gnomon/kit/geometry/receiver.h>
#include <gtest/gtest.h>

#include "masked.h"

namespace gnomon::cut_masks_test {

constexpr std::size_t many = 1'000'000;

Scene scene_of(std::vector<Mesh> meshes) {
  Scene scene;
  scene.name = "test";
  scene.meshes = std::move(meshes);
  return scene;
}

/// Twice the area.
double size_of(const Triangle& triangle) { return glm::length(triangle.normal()); }

double size_of_pieces(const CutMasks& cut, std::uint32_t source) {
  double sum = 0;
  const TriangleNumbers numbers(cut.scene());
  const auto [first, last] = cut.pieces_of(source);
  for (std::uint32_t piece = first; piece < last; ++piece) {
    const std::uint32_t mesh = numbers.mesh_of(piece);
    sum += size_of(cut.scene().meshes[mesh].corners(piece - numbers.first_of(mesh)));
  }
  return sum;
}

/// How often pieces of a triangle hold a point of it, by the signs of its weights in each.
int count_around(const CutMasks& cut, std::uint32_t source, const glm::dvec3& point) {
  int count = 0;
  const TriangleNumbers numbers(cut.scene());
  const auto [first, last] = cut.pieces_of(source);
  for (std::uint32_t piece = first; piece < last; ++piece) {
    const std::uint32_t mesh = numbers.mesh_of(piece);
    const Triangle corners = cut.scene().meshes[mesh].corners(piece - numbers.first_of(mesh));
    const glm::dvec3 normal = corners.normal();
    bool is_inside = true;
    for (int k = 0; k < 3; ++k) {
      const glm::dvec3 a(corners.points[k]), b(corners.points[(k + 1) % 3]);
      is_inside &= glm::dot(glm::cross(b - a, point - a), normal) > 0;
    }
    count += is_inside;
  }
  return count;
}

TEST(CutMasks, scenes_without_casting_holes_are_taken_as_they_are) {
  Scene scene = scene_of({hand_made::square(1, 0), masked::card(1, 1, masked::checker(4, 4))});
  scene.meshes[1].casts = false;
  const CutMasks cut(scene, many);
  EXPECT_FALSE(cut.is_cut());
  EXPECT_EQ(&cut.scene(), &scene);
  EXPECT_EQ(cut.source(3), 3u);
  EXPECT_EQ(cut.piece_count(), 0u);
  EXPECT_EQ(cut.bytes(), 0u);
  EXPECT_EQ(cut_count(scene, many).pieces, 0u);
  EXPECT_FALSE(CutMasks(scene).is_cut());
}

TEST(CutMasks, meshes_and_triangles_keep_their_numbers) {
  const Scene scene = scene_of({masked::card(1, 1, masked::mask_of({"#.", "##"})), hand_made::square(4, 0),
                                masked::card(1, 2, masked::mask_of({"#."}))});
  for (const CutMasks::Drawn drawn : {CutMasks::Drawn::triangles, CutMasks::Drawn::pieces}) {
    const CutMasks cut(scene, many, drawn);
    ASSERT_TRUE(cut.is_cut());
    ASSERT_EQ(cut.scene().meshes.size(), 5u);
    EXPECT_EQ(&cut.original(), &scene);
    EXPECT_FALSE(cut.scene().has_alpha_masks());
    for (const std::size_t m : {0, 1, 2}) {
      const Mesh& mesh = cut.scene().meshes[m];
      EXPECT_EQ(mesh.casts, m == 1);
      EXPECT_TRUE(mesh.receives);
      EXPECT_EQ(mesh.positions, scene.meshes[m].positions);
      EXPECT_EQ(mesh.triangles.size(), scene.meshes[m].triangles.size());
      EXPECT_EQ(mesh.triangles == scene.meshes[m].triangles, drawn == CutMasks::Drawn::triangles || m == 1);
    }
    for (const std::size_t m : {3, 4}) {
      EXPECT_TRUE(cut.scene().meshes[m].casts);
      EXPECT_FALSE(cut.scene().meshes[m].receives);
    }
    EXPECT_EQ(cut.first_piece(), 6u);
    EXPECT_EQ(cut.scene().triangle_count(), 6 + cut.piece_count());
    for (std::uint32_t number = 0; number < 6; ++number) {
      EXPECT_EQ(cut.source(number), number);
      const auto [first, last] = cut.pieces_of(number);
      EXPECT_EQ(first == last, number == 2 || number == 3) << number;
      for (std::uint32_t piece = first; piece < last; ++piece) EXPECT_EQ(cut.source(piece), number);
    }
  }
}

// A card of 2 m x 2 m has 4 m2; of its 64 texels half are solid, and of each half of the card half of them.
TEST(CutMasks, pieces_are_as_large_as_the_solid_texels) {
  const Scene scene = scene_of({masked::card(1, 1, masked::checker(8, 8))});
  const CutMasks cut(scene, many);
  EXPECT_NEAR(size_of_pieces(cut, 0) + size_of_pieces(cut, 1), 2 * 2, 1e-6);
  EXPECT_EQ(cut_count(scene, many).pieces, cut.piece_count());
}

TEST(CutMasks, a_solid_mask_leaves_the_triangle_whole_and_an_empty_one_nothing) {
  const Scene scene = scene_of(
      {masked::card(1, 1, masked::mask_of({"##", "##"}), 1000), masked::card(1, 2, masked::mask_of({"..", ".."}), 1000)});
  const CutMasks cut(scene, many);
  EXPECT_EQ(cut.piece_count(), 2u);
  ASSERT_EQ(cut.scene().meshes.size(), 3u);
  for (std::uint32_t t = 0; t < 2; ++t)
    for (int k = 0; k < 3; ++k) EXPECT_EQ(cut.scene().meshes[2].corners(t).points[k], scene.meshes[0].corners(t).points[k]);
}

// Random cards, wrapped all ways: a point of a triangle is in one piece where its texel is solid, and in none where it is not.
// A point within 1e-4 of a texel from a border is left out.
TEST(CutMasks, points_are_in_a_piece_where_their_texel_is_solid) {
  Random random(3);
  int solid = 0, holes = 0;
  for (int round = 0; round < 60; ++round) {
    const auto wrap_u = masked::wraps[random.below(3)], wrap_v = masked::wraps[random.below(3)];
    const int width = 1 + static_cast<int>(random.below(9)), height = 1 + static_cast<int>(random.below(9));
    Mesh mesh = masked::random_cards(random, 1, 3, 2, masked::random_mask(random, width, height, wrap_u, wrap_v));
    const std::uint32_t kind = random.below(4);
    // Along one line of the mask, and in one point of it.
    for (glm::vec2& uv : mesh.uv) {
      if (kind == 0) uv.y = 0.3f * uv.x;
      if (kind == 1) uv = mesh.uv[0];
    }
    const Scene scene = scene_of({mesh});
    const CutMasks cut(scene, many);
    for (std::uint32_t t = 0; t < 2; ++t)
      for (int i = 0; i < 100; ++i) {
        double b = random.uniform(0.001, 0.999), c = random.uniform(0.001, 0.999);
        if (b + c >= 0.999) continue;
        const glm::dvec3 weights(1 - b - c, b, c);
        glm::dvec3 point(0);
        glm::dvec2 place(0);
        for (int k = 0; k < 3; ++k) {
          const std::uint32_t vertex = mesh.triangles[t][k];
          point += weights[k] * glm::dvec3(mesh.positions[vertex]);
          place += weights[k] * glm::dvec2(width, height) * glm::dvec2(mesh.uv[vertex]);
        }
        const Around found = around(*mesh.alpha_mask, {place.x, place.y}, 1e-4);
        const glm::dvec2 off = glm::abs(place - glm::round(place));
        if (found == Around::both || std::min(off.x, off.y) < 1e-4) continue;
        (found == Around::solid ? solid : holes) += 1;
        // A point on an edge between two pieces is in neither.
        const int count = count_around(cut, t, point);
        EXPECT_EQ(count, found == Around::solid ? 1 : 0) << "round " << round << ", place " << place.x << ", " << place.y;
      }
  }
  EXPECT_GT(solid, 1000);
  EXPECT_GT(holes, 1000);
}

// The whole card is one place of the mask: texels of 1/8 m, and corners that float32 holds exactly. The open edges of its
// pieces are then as long as the borders between solid texels and holes or the card's end, and every other edge has two
// triangles.
TEST(CutMasks, pieces_of_a_card_leave_no_edge_open_but_those_of_holes) {
  Random random(5);
  for (int round = 0; round < 40; ++round) {
    constexpr int side = 16;
    const auto mask = masked::random_mask(random, side, side);
    const Scene scene = scene_of({masked::card(1, 1, mask)});
    const CutMasks cut(scene, many);
    const EdgeAdjacency adjacency(cut.scene());
    double open = 0;
    for (const EdgeAdjacency::IrregularEdge& edge : adjacency.irregular_edges())
      if (edge.side_count == 1)
        open += glm::distance(glm::dvec3(adjacency.positions()[edge.low]), glm::dvec3(adjacency.positions()[edge.high]));
    const auto is_solid = [&](int x, int y) { return x >= 0 && y >= 0 && x < side && y < side && mask->is_solid(x, y); };
    int borders = 0;
    for (int y = -1; y < side; ++y)
      for (int x = -1; x < side; ++x) {
        borders += is_solid(x, y) != is_solid(x + 1, y);
        borders += is_solid(x, y) != is_solid(x, y + 1);
      }
    EXPECT_NEAR(open, borders / 8.0, 1e-6) << "round " << round;
  }
}

// Triangle (0,2,0) (4,2,0) (0,2,4) with places (0,0) (1,0) (0,1), met at (5/3, 2, 4/3): 8 x 8 texels a hole, 4 x 4 solid. A
// centimeter beside it, because the edge between a texel's two pieces runs through the point.
TEST(CutMasks, the_texel_on_paper_is_a_hole_and_then_solid) {
  for (const int side : {4, 8}) {
    const Scene scene = scene_of({masked::triangle_on_paper(masked::checker(side, side))});
    const CutMasks cut(scene, many);
    EXPECT_EQ(count_around(cut, 0, {5.0 / 3 + 0.01, 2, 4.0 / 3}), side == 4 ? 1 : 0);
  }
}

TEST(CutMasks, too_many_pieces_are_counted_and_refused) {
  // Of 32 solid texels without a common border each is two triangles, and those on the diagonal are cut by it.
  const Scene scene = scene_of({masked::card(1, 1, masked::checker(8, 8))});
  const CutCount all = cut_count(scene, many);
  EXPECT_FALSE(all.is_more);
  EXPECT_GE(all.pieces, 64u);
  EXPECT_TRUE(cut_count(scene, 5).is_more);
  EXPECT_FALSE(cut_count(scene, all.pieces).is_more);
  EXPECT_THROW(CutMasks(scene, all.pieces - 1), Error);
  EXPECT_EQ(CutMasks(scene, all.pieces).piece_count(), all.pieces);
  // Repeated so often that its texels are never read.
  EXPECT_TRUE(cut_count(scene_of({masked::card(1, 1, masked::checker(8, 8), 1e6f)}), many).is_more);
}

}  // namespace gnomon::cut_masks_test
