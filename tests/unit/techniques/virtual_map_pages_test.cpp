// Which pages a picture needs, and which triangles they draw.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "device/context.h"
#include "map_scenes.h"
#include "techniques/virtual_map/draw_lists.h"
#include "techniques/virtual_map/pool.h"
#include "walking_world.h"

namespace virtual_map_pages_test {
using namespace gnomon;
using namespace gnomon::virtual_map;

TEST(VirtualMapPages, an_address_gives_back_what_it_was_made_of) {
  for (const int face : {0, 5})
    for (const int level : {0, 11})
      for (const glm::ivec2 page : {glm::ivec2(0), glm::ivec2(2047, 0), glm::ivec2(17, 2047)}) {
        const PageAddress address = PageAddress::of(face, level, page);
        EXPECT_NE(address.word, PageAddress::none);
        EXPECT_EQ(address.face(), face);
        EXPECT_EQ(address.level(), level);
        EXPECT_EQ(address.page(), page);
      }
}

// Of pages of 128 texels level 10 is one page: 2^17 / 2^10 = 128.
TEST(VirtualMapPages, a_raised_page_holds_the_one_below) {
  EXPECT_EQ(top_level(128), 10);
  const PageAddress page = PageAddress::of(3, 2, {201, 77});
  EXPECT_EQ(page.raised(1, 10), PageAddress::of(3, 3, {100, 38}));
  EXPECT_EQ(page.raised(4, 10), PageAddress::of(3, 6, {12, 4}));
  EXPECT_EQ(page.raised(20, 10), PageAddress::of(3, 10, {0, 0}));
}

// A block of 8 x 8 pages fits into 16 after one raise (4 x 4), into 15 after two (2 x 2).
TEST(VirtualMapPages, levels_rise_until_there_is_room) {
  std::vector<std::uint32_t> asked(1000, PageAddress::none);
  for (int k = 0; k < 20000; ++k) asked.push_back(PageAddress::of(0, 4, {8 + k % 8, 16 + k / 8 % 8}).word);
  for (const auto& [room, raised, pages] : {std::tuple(64, 0, 64), {63, 1, 16}, {16, 1, 16}, {15, 2, 4}, {3, 3, 1}}) {
    const PageTable table = pages_of(asked, std::size_t(room), 10);
    EXPECT_EQ(table.asked_count, 64);
    EXPECT_EQ(table.raised, raised);
    ASSERT_EQ(table.pages.size(), std::size_t(pages));
    EXPECT_TRUE(std::ranges::is_sorted(table.pages));
    for (std::uint32_t k = 0; k < table.pages.size(); ++k) EXPECT_EQ(table.index(table.pages[k]), k);
    EXPECT_EQ(table.level_count(), 1);
  }
}

TEST(VirtualMapPages, every_slot_has_a_place_of_its_own) {
  for (const int page_size : {64, 128, 256})
    for (const std::size_t count : {0, 1, 100, 5000, 32768}) {
      const PoolLayout layout(count, page_size);
      EXPECT_LE(layout.rows * page_size, PoolLayout::most_height);
      std::set<std::uint32_t> words;
      for (std::uint32_t slot = 0; slot < count; ++slot) {
        const glm::ivec3 place = layout.place(slot);
        EXPECT_LT(place.x, layout.columns());
        EXPECT_LT(place.y, layout.rows);
        EXPECT_LT(place.z, layout.layers);
        words.insert(layout.word(slot));
      }
      EXPECT_EQ(words.size(), count);
      // No more than a row of pages a layer is left over.
      EXPECT_LE(layout.columns() * layout.rows * layout.layers,
                static_cast<int>(count) + layout.columns() * (layout.layers + 1));
    }
}

/// Pages (x, y) of level 5, from (0, 0) to (side - 1, side - 1).
std::vector<PageAddress> square_of_pages(int side) {
  std::vector<PageAddress> pages;
  for (int k = 0; k < side * side; ++k) pages.push_back(PageAddress::of(0, 5, {k % side, k / side}));
  return pages;
}

// Steps are a quarter of the power of two below: 1 .. 8, 10, 12, 14, 16, 20 rows.
TEST(VirtualMapPages, room_in_steps_is_up_to_a_quarter_more) {
  for (const auto& [rows, stepped] : {std::pair(1, 1), {7, 7}, {8, 8}, {9, 10}, {13, 14}, {17, 20}, {64, 64}})
    EXPECT_EQ(PoolLayout(std::size_t(16 * rows), 128, PoolLayout::Room::in_steps).rows, stepped);
  for (const int page_size : {64, 128, 256})
    for (const std::size_t count : {0, 100, 700, 5000, 32768}) {
      const PoolLayout exact(count, page_size), stepped(count, page_size, PoolLayout::Room::in_steps);
      EXPECT_GE(stepped.slot_count(), exact.slot_count());
      EXPECT_LE(stepped.slot_count(), 1.25 * exact.slot_count() + stepped.columns() * stepped.layers);
      EXPECT_LE(stepped.rows * page_size, PoolLayout::most_height);
    }
}

// Also where each slot is taken: 400 pages of 128 fill 25 rows, of 28.
TEST(VirtualMapPages, pages_with_slots_of_their_own_have_places_of_their_own) {
  for (const int page_size : {64, 128, 256})
    for (const int side : {4, 16, 20, 50}) {
      const std::vector<PageAddress> pages = square_of_pages(side);
      std::vector<std::uint8_t> moving(pages.size());
      for (std::size_t k = 0; k < moving.size(); ++k) moving[k] = k % 3 == 0;
      const PoolLayout layout(pages, page_size, moving);
      std::set<std::uint32_t> words;
      for (std::uint32_t k = 0; k < pages.size(); ++k) {
        EXPECT_LT(layout.slot(k), layout.slot_count());
        words.insert(layout.word(k));
      }
      EXPECT_EQ(words.size(), pages.size());
    }
}

// Of 400 pages ten go and ten others come, as where something walks through the picture.
TEST(VirtualMapPages, few_slots_change_with_other_pages) {
  for (const int side : {16, 20}) {  // in rows that are all taken, and in some that are not
    const std::vector<PageAddress> before = square_of_pages(side);
    std::vector<PageAddress> after(before.begin() + 10, before.end());
    for (int k = 0; k < 10; ++k) after.push_back(PageAddress::of(0, 5, {side + k, 3}));
    std::ranges::sort(after);
    const std::vector<std::uint8_t> moving(before.size());
    const PageTable old_table{.pages = before}, table{.pages = after};
    const PoolLayout old_layout(before, 128, moving), layout(after, 128, moving);
    const std::vector<std::uint8_t> kept =
        StillPages(old_table, old_layout, moving, AlphaRule::texel).kept(table, layout, moving, AlphaRule::texel);
    EXPECT_GT(std::ranges::count(kept, 1), 0.75 * double(before.size())) << side;
    for (std::uint32_t k = 0; k < table.pages.size(); ++k) {
      const auto old = std::ranges::lower_bound(before, after[k]);
      const bool stays = old != before.end() && *old == after[k] &&
                         old_layout.place(static_cast<std::uint32_t>(old - before.begin())) == layout.place(k);
      EXPECT_EQ(kept[k] != 0, stays) << side << ' ' << k;
    }
  }
}

TEST(VirtualMapPages, a_page_that_a_moving_caster_touches_does_not_stay) {
  const PageTable table{.pages = square_of_pages(4)};
  const std::size_t count = table.pages.size();
  const auto kept = [&](std::span<const std::uint8_t> before, std::span<const std::uint8_t> after, AlphaRule rule) {
    const PoolLayout old_layout(table.pages, 128, before), layout(table.pages, 128, after);
    return StillPages(table, old_layout, before, AlphaRule::texel).kept(table, layout, after, rule);
  };
  std::vector<std::uint8_t> none(count), first(count), last(count);
  first.front() = last.back() = 1;
  EXPECT_EQ(std::ranges::count(kept(none, none, AlphaRule::texel), 1), std::ptrdiff_t(count));
  EXPECT_EQ(std::ranges::count(kept(none, none, AlphaRule::mips), 1), 0);
  for (const auto& [before, after] : {std::pair(first, last), {first, none}, {none, last}, {last, last}}) {
    const std::vector<std::uint8_t> are_kept = kept(before, after, AlphaRule::texel);
    for (std::size_t k = 0; k < count; ++k)
      if (before[k] != 0 || after[k] != 0) {
        EXPECT_EQ(are_kept[k], 0) << k;
      }
    EXPECT_GT(std::ranges::count(are_kept, 1), 0);
  }
  EXPECT_EQ(StillPages().kept(table, PoolLayout(table.pages, 128, none), none, AlphaRule::texel), none);
  const std::vector<std::uint8_t> no_flags;  // of a scene in which nothing moves
  const PoolLayout plain(table.pages, 128, no_flags);
  EXPECT_TRUE(plain.slots.empty());
  EXPECT_EQ(StillPages(table, plain, no_flags, AlphaRule::texel).bytes(), 0u);
}

// A ray from the light through a texel's center that meets a triangle must find it in the list of the texel's page. Among them
// are triangles that go through the light's plane, whose corners lie behind the faces that see them.
TEST(VirtualMapPages, every_triangle_over_a_texel_is_in_the_list_of_its_page) {
  process_context();
  for (const unsigned seed : {1u, 2u}) {
    const Scene scene = map_scenes::soup_over_ground(seed);
    const SceneBuffers& buffers = scene_buffers(scene);
    const MeshBoxes boxes = mesh_boxes(scene);
    for (const Light& light : map_scenes::all_kinds) {
      const LightCamera camera = finest_camera(light, boxes);
      std::vector<std::uint32_t> asked;
      for (std::size_t face = 0; face < camera.images.size(); ++face)
        if (camera.images[face].layer >= 0)
          for (const int level : {7, 10})
            for (int k = 0; k < 1 << 2 * (10 - level); ++k)
              asked.push_back(PageAddress::of(int(face), level, {k % (1 << (10 - level)), k / (1 << (10 - level))}).word);
      const PageTable table = pages_of(asked, asked.size(), 10);
      const Footprints footprints = footprints_of(scene, solid_parts(scene), camera);
      DrawLists lists;
      fill(lists, scene, buffers, camera, footprints, table, 128);
      std::size_t met = 0;
      for (std::size_t slot = 0; slot < table.pages.size(); ++slot) {
        const PageAddress page = table.pages[slot];
        const LightImage image = at_level(camera.images[page.face()], page.level());
        std::set<std::pair<std::uint32_t, std::uint32_t>> listed;
        for (const std::size_t bin : {2 * slot, 2 * slot + 1})
          for (const std::uint32_t item : lists.bins.of(bin))
            listed.insert({footprints.all[item].mesh, footprints.all[item].triangle});
        for (int k = 0; k < 64; ++k) {
          const glm::ivec2 texel = page.page() * 128 + glm::ivec2(k % 8, k / 8) * 16 + 5;
          const Tap ray = image.tap(glm::dvec2(texel) + 0.5, image.near, 1);
          for (std::uint32_t m = 0; m < scene.meshes.size(); ++m)
            for (std::uint32_t t = 0; t < scene.meshes[m].triangles.size(); ++t) {
              const Mesh& mesh = scene.meshes[m];
              const glm::uvec3 c = mesh.triangles[t];
              const double hit = small_world::intersect(ray.origin, ray.direction, mesh.positions[c.x], mesh.positions[c.y],
                                                        mesh.positions[c.z]);
              const bool is_met = hit < INFINITY && (hit > 0 || !image.is_perspective);
              const glm::dvec3 a = mesh.positions[c.x], b = mesh.positions[c.y], d = mesh.positions[c.z];
              const bool is_away = m == 2 && glm::dot(glm::cross(b - a, d - a), ray.direction) > 0;
              // Beyond its pyramid, or the cone, no page of a face is requested.
              const glm::dvec3 at = ray.origin + hit * ray.direction;
              const bool is_asked = camera.space.face_of(at) == page.face() && in_spot_cone(light, at);
              if (!is_met || !is_asked || is_away) continue;
              ++met;
              EXPECT_TRUE(listed.contains({m, t})) << light.name << " mesh " << m << " triangle " << t;
            }
        }
      }
      EXPECT_GT(met, 100) << light.name;
      // The lists are not everything that there is.
      if (camera.space.is_parallel()) {
        EXPECT_LT(lists.triangle_count(), 0.5 * double(footprints.all.size() * table.pages.size()));
      }
    }
  }
  release_inputs();
}

// A sliver from page (0, 0) to page (2, 1): its box meets six pages, it crosses four.
TEST(VirtualMapPages, a_sliver_is_drawn_in_the_pages_that_it_crosses) {
  process_context();
  const Light down{.name = "sun", .kind = DirectionalLight{{0, -1, 0}}};
  Scene scene;
  scene.meshes = {small_world::ground(2)};
  const LightImage image = at_level(finest_camera(down, mesh_boxes(scene)).images.at(0), 8);
  const auto place = [&](double across, double along) {
    return glm::vec3(image.tap(128.0 * glm::dvec2(across, along), 0, 1).origin) * glm::vec3(1, 0, 1) + glm::vec3(0, 0.5f, 0);
  };
  scene.meshes.push_back(small_world::make_mesh({place(0.1, 0.1), place(2.9, 1.9), place(2.85, 1.9)}, {{0, 1, 2}}));
  const LightCamera camera = finest_camera(down, mesh_boxes(scene));
  std::vector<std::uint32_t> asked;
  for (int k = 0; k < 16; ++k) asked.push_back(PageAddress::of(0, 8, {k % 4, k / 4}).word);
  const PageTable table = pages_of(asked, asked.size(), 10);
  const SceneBuffers& buffers = scene_buffers(scene);
  const Footprints footprints = footprints_of(scene, solid_parts(scene), camera);
  DrawLists lists;
  fill(lists, scene, buffers, camera, footprints, table, 128);
  std::set<std::pair<int, int>> crossed;
  for (std::size_t slot = 0; slot < table.pages.size(); ++slot)
    for (const std::size_t bin : {2 * slot, 2 * slot + 1})
      for (const std::uint32_t item : lists.bins.of(bin))
        if (footprints.all[item].mesh == 1) crossed.emplace(table.pages[slot].page().x, table.pages[slot].page().y);
  EXPECT_EQ(crossed, (std::set<std::pair<int, int>>{{0, 0}, {1, 0}, {1, 1}, {2, 1}}));
  release_inputs();
}

// The second box moves up, the ground and the first box stand still. Casters are in order, also where a face sees none of one.
TEST(VirtualMapPages, footprints_of_what_stands_still_hold_in_a_later_pose) {
  Scene scene = walking_world::walking_scene();
  PosedScene posed(scene);
  posed.go_to(walking_world::in_row(0, "lift"));
  MovingMeshes moving;
  moving.build(scene);
  const MeshBoxes boxes = mesh_boxes(scene);
  std::vector<Light> lights = scene.lights;
  lights.push_back({.name = "low", .kind = PointLight{{0.25f, 1.75f, 2}}});
  for (const Light& light : lights) {
    posed.go_to(walking_world::in_row(0, "lift"));
    const LightCamera camera = finest_camera(light, boxes);
    const Footprints before = footprints_of(scene, solid_parts(scene), camera);
    posed.go_to(walking_world::in_row(0.5, "lift"));
    const SolidParts solid = solid_parts(scene);
    const Footprints all = footprints_of(scene, solid, camera);
    const Footprints kept = footprints_of(scene, solid, camera, EarlierFootprints{before, moving});
    EXPECT_EQ(kept.begin, all.begin) << light.name;
    ASSERT_EQ(kept.all.size(), all.all.size()) << light.name;
    bool has_moved = false;
    for (std::size_t i = 0; i < all.all.size(); ++i) {
      const Footprint &a = kept.all[i], &b = all.all[i];
      EXPECT_TRUE(a.mesh == b.mesh && a.triangle == b.triangle && a.low == b.low && a.high == b.high) << light.name << ' ' << i;
      has_moved = has_moved || i >= before.all.size() || before.all[i].low != b.low;
    }
    EXPECT_TRUE(has_moved) << light.name;
  }
}

}  // namespace virtual_map_pages_test
