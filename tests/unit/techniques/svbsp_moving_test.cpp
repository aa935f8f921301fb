// The trees of svbsp follow a scene that moves: after updates they are those that a build makes, tile by tile, and tiles in
// which nothing moved stay.
#include <gnomon/changes.h>
#include <gnomon/kit/geometry/exact.h>
#include <gnomon/kit/geometry/shapes.h>
#include <gtest/gtest.h>

#include "masked.h"
#include "small_world.h"
#include "svbsp_rig.h"
#include "techniques/svbsp/forest.h"

extern "C" void gnomon_technique_area_svbsp(gnomon::Registry& registry);
extern "C" void gnomon_technique_two_pass_object(gnomon::Registry& registry);

namespace gnomon::svbsp_moving_test {

constexpr int side = 4;  // balls along a row

/// Balls in rows over a ground, moved in place by hand.
class World {
 public:
  explicit World(bool has_masks = false) {
    scene_.meshes.push_back(small_world::ground(side));
    for (int i = 0; i < side * side; ++i) {
      const glm::dvec3 center(2 * (i % side) + 1 - side, 1, 2 * (i / side) + 1 - side);
      Mesh& ball = scene_.meshes.emplace_back(tessellate(Sphere{center, 0.5f}, 8, "ball"));
      ball.shape.reset();
      ball.reach = {glm::vec3(-side - 2, 0, -side - 2), glm::vec3(side + 2, 3, side + 2)};
    }
    if (has_masks)
      scene_.meshes.push_back(
          masked::with_mask(hand_made::square(1, 2), masked::checker(4, 4), {{0, 0}, {0, 1}, {1, 1}, {1, 0}}));
    base_ = scene_.meshes;
    forget();
  }
  const Scene& scene() const { return scene_; }
  void place(std::size_t mesh, const glm::vec3& shift) {
    std::vector<glm::vec3>& points = scene_.meshes[mesh].positions;
    for (std::size_t v = 0; v < points.size(); ++v) points[v] = base_[mesh].positions[v] + shift;
    changes_.meshes[mesh].kind = MeshChange::Kind::deformed;
    ++scene_.pose_number;
  }
  /// Moves so many of the balls somewhere, one of them perhaps past the ground.
  void move(Random& random, int count) {
    for (int k = 0; k < count; ++k)
      place(1 + random.below(side * side), glm::vec3(random.uniform(glm::dvec3(-1.5, -0.4, -1.5), glm::dvec3(1.5, 1, 1.5))));
  }
  Changes take_changes() {
    Changes changes = std::move(changes_);
    forget();
    return changes;
  }

 private:
  void forget() {
    changes_ = {};
    changes_.meshes.resize(scene_.meshes.size());
  }

  Scene scene_{.name = "balls"};
  std::vector<Mesh> base_;
  Changes changes_;
};

const View view{.name = "view", .eye = {3, 7, 9}, .target = {0, 0.5f, 0}};

std::string text_of(const Counts& counts) {
  std::string text;
  for (const Count& c : counts) text += fmt::format("{} {}\n", c.name, c.value);
  return text;
}

const Light lights[] = {hand_made::point_light({-3, 6, 2}), hand_made::sun({0.375f, -1, 0.25f}),
                        hand_made::point_light({0.5f, 1.25f, 0.25f})};

/// What differs from a fresh object of the technique; `used` is relit.
void expect_as_built(void (*roll)(Registry&), const std::string& settings, Technique& used, const Scene& scene,
                     const Light& light) {
  const GBuffer gbuffer = small_world::make_gbuffer(scene, view, 32, 18);
  const small_world::Run fresh = small_world::run(roll, settings, scene, light, gbuffer);
  EXPECT_EQ(small_world::mask_of(used, gbuffer), fresh.mask);
  EXPECT_EQ(text_of(used.counts()), text_of(fresh.technique->counts()));
}

// All counts are the same, so the trees have the same nodes, depth and fragments: bit for bit those of a build.
TEST(Svbsp, follows_what_moves_as_if_built_anew) {
  for (const std::string settings : {"", "tile_size=2", "drop_edges=none", "order=face_planes", "order=bsp"})
    for (const Light& light : lights) {
      SCOPED_TRACE(settings + ", " + light.name);
      Random random(11);
      World world;
      const auto used = svbsp_rig::lit(settings, world.scene(), light);
      for (int round = 0; round < 12; ++round) {
        SCOPED_TRACE(round);
        world.move(random, round % 4);  // in each fourth round nothing moves
        used->update(world.scene(), world.take_changes());
        if (round % 5 == 3) {  // the second update without a light
          world.move(random, 2);
          used->update(world.scene(), world.take_changes());
        }
        if (round % 5 == 4) used->relight(hand_made::point_light({1, 5, 1}));
        used->relight(light);
        expect_as_built(gnomon_technique_svbsp, settings, *used, world.scene(), light);
        if (round % 6 != 5) continue;
        used->relight(light);
        expect_as_built(gnomon_technique_svbsp, settings, *used, world.scene(), light);
      }
    }
}

// Objects of several lights share what build holds; each follows for itself, though one of them misses a round.
TEST(Svbsp, objects_of_other_lights_follow) {
  Random random(12);
  World world;
  const auto first = svbsp_rig::lit("", world.scene(), lights[0]);
  const auto second = first->for_another_light();
  second->relight(lights[1]);
  for (int round = 0; round < 6; ++round) {
    SCOPED_TRACE(round);
    world.move(random, 2);
    first->update(world.scene(), world.take_changes());
    first->relight(lights[0]);
    expect_as_built(gnomon_technique_svbsp, "", *first, world.scene(), lights[0]);
    if (round == 3) continue;
    second->relight(lights[1]);
    const GBuffer gbuffer = small_world::make_gbuffer(world.scene(), view, 32, 18);
    EXPECT_EQ(small_world::mask_of(*second, gbuffer), svbsp_rig::run("", world.scene(), lights[1], gbuffer).mask);
  }
}

// A card with holes is cut once while others move, and cut anew where it moves itself.
TEST(Svbsp, pieces_of_masks_stay_while_others_move) {
  for (const auto& roll : {gnomon_technique_svbsp, gnomon_technique_two_pass_object, gnomon_technique_area_svbsp}) {
    Random random(13);
    World world(true);
    Light light = lights[0];
    if (roll == gnomon_technique_area_svbsp) light = {.name = "disc", .kind = DiscLight{{-3, 6, 2}, {3, -6, -2}, 0.25f}};
    SCOPED_TRACE(light.name);
    const hand_made::Picture picture(1, 1);
    const auto used = small_world::run(roll, "", world.scene(), light, picture.gbuffer).technique;
    for (int round = 0; round < 5; ++round) {
      SCOPED_TRACE(round);
      if (round < 4) world.move(random, round);
      if (round >= 3) world.place(world.scene().meshes.size() - 1, {0.25f * static_cast<float>(round), 0, 0});
      used->update(world.scene(), world.take_changes());
      used->relight(light);
      expect_as_built(roll, "", *used, world.scene(), light);
    }
  }
}

/// Triangles of 0.1 m in a square of 8 m, as the sun from above sees them.
struct Field {
  std::vector<svbsp::SceneTriangle> triangles;
  std::vector<std::int8_t> signs;
  std::vector<std::uint8_t> moved = {0, 0};
  static constexpr int count = 64;

  Field() {
    for (int i = 0; i < count * count; ++i) {
      const glm::vec3 at(0.125f * static_cast<float>(i % count), 0, 0.125f * static_cast<float>(i / count));
      triangles.push_back({{{at, at + glm::vec3(0, 0, 0.1f), at + glm::vec3(0.1f, 0, 0)}}, i == 1000});
      signs.push_back(static_cast<std::int8_t>(
          orient3d_sign(triangles[i].points[0], triangles[i].points[1], triangles[i].points[2], light)));
    }
  }
  void make(svbsp::Pieces& pieces, const svbsp::Moved& known = {}) const {
    const auto corners_of = [&](std::size_t i, Corner* corners) -> svbsp::Pieces::Part {
      for (int k = 0; k < 3; ++k) corners[k] = {glm::dvec3(triangles[i].points[k]), svbsp::own_edge};
      return {static_cast<std::uint32_t>(i), {corners, 3}};
    };
    pieces.make(space(), {triangles, signs}, triangles.size(), corners_of, known);
  }
  void grow(svbsp::Forest& forest, const svbsp::Pieces& pieces, const svbsp::Moved& known = {}) const {
    forest.grow(space(), pieces, {triangles, signs}, svbsp::Forest::Order::tiles, {.is_followed = true}, 8, known);
  }
  static svbsp::ProjectedSpace space() { return {light, {{0, 0, 0}, {8, 0, 8}}}; }
  static constexpr glm::dvec4 light{0, 1, 0, 0};
};

// The triangle lies in one or two tiles before and after, in each direction at most two.
TEST(Svbsp, tiles_where_nothing_moved_stay) {
  Field field;
  svbsp::Pieces pieces;
  svbsp::Forest forest;
  field.make(pieces);
  field.grow(forest, pieces);
  EXPECT_EQ(forest.kept_tile_count(), 0u);
  EXPECT_GT(forest.tile_count(), 200u);
  for (int step = 0; step < 20; ++step) {
    field.moved = {0, static_cast<std::uint8_t>(step % 5 != 4)};
    if (field.moved[1])
      for (glm::vec3& p : field.triangles[1000].points) p.x += 0.03125f;
    const svbsp::Moved moved{field.triangles, field.moved};
    forest.leave(pieces, moved);
    field.make(pieces, moved);
    field.grow(forest, pieces, moved);
    EXPECT_GE(forest.kept_tile_count(), forest.tile_count() - (field.moved[1] ? 8 : 0)) << step;
    svbsp::Pieces other_pieces;
    svbsp::Forest other;
    field.make(other_pieces);
    field.grow(other, other_pieces);
    ASSERT_EQ(forest.tile_count(), other.tile_count());
    EXPECT_EQ(forest.bytes(), other.bytes());
    for (std::uint32_t tile = 0; tile < other.tile_count(); ++tile) {
      EXPECT_EQ(forest.root(tile), other.root(tile));
      const auto &a = forest.nodes(tile), &b = other.nodes(tile);
      ASSERT_EQ(a.size(), b.size());
      for (std::size_t i = 0; i < a.size(); ++i)
        EXPECT_TRUE(a[i].x == b[i].x && a[i].y == b[i].y && a[i].offset == b[i].offset && a[i].sides[0] == b[i].sides[0] &&
                    a[i].sides[1] == b[i].sides[1]);
    }
  }
}

}  // namespace gnomon::svbsp_moving_test
