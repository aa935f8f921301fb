// The generated scenes whose casters have holes: leaf_cards, chain_link.
#include <gnomon/kit/geometry/holes.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "generated_scene.h"

namespace holes_scenes_test {

using namespace gnomon;
using generated::make;
using generated::mesh;

/// Meters of a pixel of a picture of 360 rows, across the way to the view's target.
double pixel_at_target(const Scene& scene, std::string_view name) {
  const View& view = *std::ranges::find(scene.views, name, &View::name);
  const double distance = glm::distance(glm::dvec3(view.eye), glm::dvec3(view.target));
  return 2 * distance * std::tan(glm::radians(view.fov_y_degrees / 2.0)) / 360;
}

/// Meters of a texel along u, by the first two corners of the first card.
double texel_width(const Mesh& mesh) {
  const double meters = glm::distance(glm::dvec3(mesh.positions[0]), glm::dvec3(mesh.positions[1]));
  return meters / (std::abs(double{mesh.uv[1].x} - mesh.uv[0].x) * mesh.alpha_mask->width());
}

/// Whether a way along z through (x, y, 0) meets something solid of a mesh in the plane z = 0.
bool is_solid_through(const Mesh& mesh, float x, float y) {
  return is_solid_at(mesh, 0, {.point = {x, y, -1}, .light = {0, 0, 1, 0}});
}

TEST(HolesScenes, cards_have_masks_and_all_else_is_solid) {
  for (const auto& [id, masked] : {std::pair{"leaf_cards", "leaves"}, std::pair{"chain_link", "links"}}) {
    const Scene scene = make(id);
    EXPECT_TRUE(scene.has_alpha_masks());
    for (const Mesh& each : scene.meshes) {
      SCOPED_TRACE(each.name);
      EXPECT_EQ(each.alpha_mask != nullptr, each.name == masked);
      EXPECT_EQ(each.uv.size(), each.alpha_mask ? each.positions.size() : 0u);
    }
    EXPECT_FALSE(mesh(scene, masked).is_closed());
    EXPECT_TRUE(mesh(scene, masked).casts);
  }
}

TEST(HolesScenes, cards_without_masks_are_the_same_cards_solid) {
  for (const auto& [id, masked] : {std::pair{"leaf_cards", "leaves"}, std::pair{"chain_link", "links"}}) {
    const Scene holes = make(id), solid = make(id, "masks=false");
    EXPECT_FALSE(solid.has_alpha_masks());
    EXPECT_TRUE(mesh(solid, masked).uv.empty());
    EXPECT_EQ(mesh(solid, masked).positions, mesh(holes, masked).positions);
    EXPECT_EQ(mesh(solid, masked).triangles, mesh(holes, masked).triangles);
  }
}

// What the two views are for: a map that is filtered by distance errs differently where a texel of the mask is larger than a
// pixel and where it is smaller.
TEST(HolesScenes, texels_are_larger_than_near_pixels_and_smaller_than_far_ones) {
  for (const auto& [id, masked] : {std::pair{"leaf_cards", "leaves"}, std::pair{"chain_link", "links"}}) {
    SCOPED_TRACE(id);
    const Scene scene = make(id);
    const double texel = texel_width(mesh(scene, masked));
    EXPECT_GT(texel, 1.5 * pixel_at_target(scene, "near"));
    EXPECT_LT(1.5 * texel, pixel_at_target(scene, "far"));
  }
}

TEST(HolesScenes, same_settings_make_the_same_masks_and_places) {
  for (const auto& [id, masked] : {std::pair{"leaf_cards", "leaves"}, std::pair{"chain_link", "links"}}) {
    const Scene a = make(id), b = make(id);
    EXPECT_EQ(mesh(a, masked).uv, mesh(b, masked).uv);
    EXPECT_TRUE(std::ranges::equal(mesh(a, masked).alpha_mask->bits(), mesh(b, masked).alpha_mask->bits()));
    EXPECT_TRUE(std::ranges::equal(mesh(a, masked).alpha_mask->alpha(), mesh(b, masked).alpha_mask->alpha()));
  }
}

TEST(HolesScenes, leaf_cards_are_as_many_as_asked_and_keep_their_area) {
  for (const int count : {1, 7, 160, 2000}) {
    const Scene scene = make("leaf_cards", fmt::format("count={}", count));
    const Mesh& leaves = mesh(scene, "leaves");
    EXPECT_EQ(leaves.triangles.size(), 2u * count);
    double area = 0;
    for (std::size_t i = 0; i < leaves.triangles.size(); ++i) area += glm::length(leaves.corners(i).normal()) / 2;
    // 160 squares of 0.4 m; at most 0.6 m a side where they are few.
    EXPECT_NEAR(area, std::min(160 * 0.16, count * 0.36), 1e-4);
    for (const glm::vec3& p : leaves.positions) EXPECT_GT(p.y, 0);
  }
}

TEST(HolesScenes, leaf_cards_cross_in_pairs_along_their_stems) {
  const Scene scene = make("leaf_cards");
  const Mesh& leaves = mesh(scene, "leaves");
  for (std::size_t card = 0; card + 1 < leaves.triangles.size() / 2; card += 2) {
    const glm::dvec3 a = leaves.corners(2 * card).normal(), b = leaves.corners(2 * card + 2).normal();
    EXPECT_NEAR(glm::dot(glm::normalize(a), glm::normalize(b)), 0, 1e-5);
    const auto foot = [&](std::size_t of) {
      return 0.5 * (glm::dvec3(leaves.positions[4 * of]) + glm::dvec3(leaves.positions[4 * of + 1]));
    };
    EXPECT_NEAR(glm::distance(foot(card), foot(card + 1)), 0, 1e-6);
  }
}

TEST(HolesScenes, a_leaf_card_is_a_third_leaves_at_every_resolution) {
  for (const int texels : {8, 16, 64, 300, 1024}) {
    SCOPED_TRACE(texels);
    const Scene scene = make("leaf_cards", fmt::format("texels={}", texels));
    const AlphaMask& mask = *mesh(scene, "leaves").alpha_mask;
    EXPECT_EQ(mask.width(), texels);
    EXPECT_GT(mask.coverage(), 0.2);
    EXPECT_LT(mask.coverage(), 0.4);
    // Cut off nowhere but at the foot of the stem.
    for (int i = 0; i < texels; ++i) {
      EXPECT_FALSE(mask.is_solid(i, 0));
      EXPECT_FALSE(mask.is_solid(0, i));
      EXPECT_FALSE(mask.is_solid(texels - 1, i));
    }
    EXPECT_TRUE(std::ranges::any_of(mask.alpha(), [](std::uint8_t alpha) { return alpha > 0 && alpha < 255; }));
  }
}

// Bands of width w along both diagonals of a unit square: each family covers sqrt(2) w of it, and its parts cross the other
// family as often as they cross anything. So p + p - p^2 with p = sqrt(2) w.
TEST(HolesScenes, chain_link_wires_cover_what_their_width_says) {
  for (const double wire : {0.004, 0.008, 0.02}) {
    const Scene scene = make("chain_link", fmt::format("texels=512,wire={}", wire));
    const double p = std::sqrt(2.0) * wire / 0.1;
    EXPECT_NEAR(mesh(scene, "links").alpha_mask->coverage(), 2 * p - p * p, 0.01) << wire;
  }
}

TEST(HolesScenes, chain_link_wires_never_vanish) {
  for (const char* settings : {"wire=0.0005,texels=8", "wire=0.0005,size=1,texels=8", "wire=0.0005,size=1,texels=512"}) {
    const Scene scene = make("chain_link", settings);
    const AlphaMask& mask = *mesh(scene, "links").alpha_mask;
    for (int i = 0; i < mask.width(); ++i) {
      EXPECT_TRUE(mask.is_solid(i, i)) << settings;
      EXPECT_TRUE(mask.is_solid(i, mask.width() - 1 - i)) << settings;
    }
  }
}

// Meshes are 0.1 m wide and 1 / 0.1 = 10 of them lie between x = 0 and x = 1; the fence's upper edge, where v = 0, is at
// y = 1.65. Wires cross at whole (u, v) and at halves of both; halfway between two crossings in a row is the middle of a hole.
TEST(HolesScenes, chain_link_repeats_its_mesh_over_each_panel) {
  const Scene scene = make("chain_link");
  const Mesh& links = mesh(scene, "links");
  EXPECT_EQ(links.triangles.size(), 6u);
  EXPECT_EQ(links.alpha_mask->wrap_u(), AlphaMask::Wrap::repeat);
  EXPECT_EQ(links.uv[2], glm::vec2(20, 0));
  EXPECT_EQ(links.uv[0], glm::vec2(0, 16));
  for (int i = 1; i < 20; ++i)
    for (int j = 1; j < 16; ++j) {
      // Of the first panel, whose left edge is at x = -3; a little aside, so that rounding moves nothing into another texel.
      const float x = -3 + 0.1f * i + 0.001f, y = 1.65f - 0.1f * j - 0.001f;
      EXPECT_TRUE(is_solid_through(links, x, y));
      EXPECT_TRUE(is_solid_through(links, x + 0.05f, y - 0.05f));
      EXPECT_FALSE(is_solid_through(links, x + 0.05f, y));
      EXPECT_FALSE(is_solid_through(links, x, y - 0.05f));
    }
}

TEST(HolesScenes, chain_link_has_a_panel_between_any_two_posts) {
  for (const int panels : {1, 3, 16}) {
    const Scene scene = make("chain_link", fmt::format("panels={}", panels));
    EXPECT_EQ(mesh(scene, "links").triangles.size(), 2u * panels);
    Bounds links, posts;
    links.add(mesh(scene, "links").positions);
    posts.add(mesh(scene, "posts").positions);
    EXPECT_NEAR(links.max.x, panels, 1e-6);
    EXPECT_NEAR(posts.max.x, panels + 0.03, 1e-5);
    EXPECT_NEAR(posts.min.x, -panels - 0.03, 1e-5);
    EXPECT_LT(posts.max.z, links.min.z);
  }
}

}  // namespace holes_scenes_test
