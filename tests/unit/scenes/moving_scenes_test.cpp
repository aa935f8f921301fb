// The generated scenes that move: walking_boxes, bending_tube, swarm, leaf_cards in the wind, and jumping_boxes.
#include <gnomon/kit/geometry/circling.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "generated_scene.h"
#include "measure/scene/motion.h"
#include "measure/scene/pose.h"
#include "measure/scene/posed_scene.h"

namespace moving_scenes_test {

using namespace gnomon;
using generated::make;
using generated::mesh;

struct Moving {
  const char *id, *settings, *animation, *mesh;  ///< `mesh` is one that moves
};
constexpr Moving all[] = {{"walking_boxes", "", "walk", "box_1"},
                          {"walking_boxes", "count=30", "walk", "box_30"},
                          {"walking_boxes", "walking=0.25,detail=3", "walk", "box_6"},
                          {"bending_tube", "", "bend", "tube"},
                          {"bending_tube", "joints=2,bend=150", "bend", "tube"},
                          {"swarm", "", "fly", "swarm"},
                          {"swarm", "count=3,reach=1.6", "fly", "swarm"},
                          {"leaf_cards", "wind=0.25", "wind", "leaves"}};

Scene posed(Scene scene, double seconds) {
  const std::shared_ptr<const Motion> motion = scene.motion;
  pose(scene, motion->animations.at(0), seconds);
  return scene;
}

TEST(MovingScenes, a_scene_rests_where_its_animation_begins_and_ends) {
  for (const Moving& each : all) {
    SCOPED_TRACE(fmt::format("{}:{}", each.id, each.settings));
    const Scene scene = make(each.id, each.settings);
    ASSERT_TRUE(scene.motion);
    ASSERT_EQ(scene.motion->animations.size(), 1u);
    EXPECT_EQ(scene.motion->animations[0].name, each.animation);
    EXPECT_EQ(scene.motion->animations[0].end(), 2);
    for (const double seconds : {0.0, 2.0, 99.0}) {
      const Scene at = posed(scene, seconds);
      for (std::size_t m = 0; m < scene.meshes.size(); ++m)
        EXPECT_EQ(at.meshes[m].positions, scene.meshes[m].positions) << seconds << ' ' << scene.meshes[m].name;
    }
    EXPECT_NE(mesh(posed(scene, 0.75), each.mesh).positions, mesh(scene, each.mesh).positions);
  }
}

TEST(MovingScenes, what_has_no_rig_stands_still) {
  for (const Moving& each : all) {
    const Scene scene = make(each.id, each.settings), at = posed(scene, 0.75);
    for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
      if (std::ranges::find(scene.motion->rigs, m, &Rig::mesh) != scene.motion->rigs.end()) continue;
      EXPECT_EQ(at.meshes[m].positions, scene.meshes[m].positions) << each.id << ' ' << scene.meshes[m].name;
      EXPECT_EQ(at.meshes[m].shape.has_value(), scene.meshes[m].shape.has_value());
    }
  }
}

TEST(MovingScenes, nothing_goes_below_the_ground) {
  for (const Moving& each : all) {
    const Scene scene = make(each.id, each.settings);
    for (int k = 0; k <= 32; ++k) EXPECT_GE(posed(scene, k / 16.0).bounds().min.y, 0) << each.id << ' ' << k;
  }
}

TEST(MovingScenes, circling_weights_are_cosine_and_sine) {
  const Track track = circling_weights(0, 3);
  ASSERT_EQ(track.width(), 2u);
  for (int k = 0; k <= 1000; ++k) {
    const double seconds = 3 * k / 1000.0, angle = 2 * std::numbers::pi * k / 1000;
    const std::vector<double> weights = sampled(track, seconds);
    EXPECT_NEAR(weights.at(0), std::cos(angle) - 1, 4e-6) << k;
    EXPECT_NEAR(weights.at(1), std::sin(angle), 4e-6) << k;
  }
}

// Box 1 starts at the corner (-, -) of its plot and walks 1 m along +x in the first half second.
TEST(MovingScenes, a_box_walks_two_meters_a_second) {
  const Scene scene = make("walking_boxes");
  const std::vector<glm::vec3>& rest = mesh(scene, "box_1").positions;
  const struct {
    double seconds;
    glm::vec3 offset;
  } due[] = {{0.0625, {0.125f, 0, 0}}, {0.25, {0.5f, 0, 0}}, {0.5, {1, 0, 0}}, {0.75, {1, 0, 0.5f}},
             {1, {1, 0, 1}},           {1.25, {0.5f, 0, 1}}, {1.5, {0, 0, 1}}, {1.75, {0, 0, 0.5f}}};
  for (const auto& [seconds, offset] : due) {
    const Scene at = posed(scene, seconds);
    for (std::size_t v = 0; v < rest.size(); ++v) EXPECT_EQ(mesh(at, "box_1").positions[v], rest[v] + offset) << seconds;
  }
}

// Of 64 boxes, 1, 8, 32 and 64; the one of 1/64 is the 32nd: floor(32 / 64 + 1/2) = 1. Of 12, one is the least.
TEST(MovingScenes, a_share_of_the_boxes_walks) {
  const struct {
    const char* settings;
    std::size_t rigs;
  } due[] = {{"count=64,walking=0.015625", 1},
             {"count=64,walking=0.125", 8},
             {"count=64,walking=0.5", 32},
             {"count=64", 64},
             {"count=12,walking=0.001", 1}};
  for (const auto& [settings, rigs] : due) EXPECT_EQ(make("walking_boxes", settings).motion->rigs.size(), rigs) << settings;
  const Scene one = make("walking_boxes", "count=64,walking=0.015625");
  EXPECT_EQ(one.meshes[one.motion->rigs.at(0).mesh].name, "box_32");
}

TEST(MovingScenes, boxes_of_many_triangles_are_the_same_boxes) {
  const Scene plain = make("walking_boxes"), fine = make("walking_boxes", "detail=5");
  for (std::size_t m = 0; m < plain.meshes.size(); ++m) {
    const Mesh &box = plain.meshes[m], &divided = fine.meshes[m];
    if (!box.name.starts_with("box_")) continue;
    EXPECT_EQ(divided.triangles.size(), 12u * 5 * 5);
    EXPECT_TRUE(divided.is_closed()) << divided.name;
    EXPECT_FALSE(divided.shape);
    Bounds before, after;
    before.add(box.positions);
    after.add(divided.positions);
    EXPECT_EQ(before.min, after.min);
    EXPECT_EQ(before.max, after.max);
    // Outward: the volume below all triangles is that of the box.
    double volume = 0;
    for (std::size_t t = 0; t < divided.triangles.size(); ++t) {
      const Triangle p = divided.corners(t);
      volume += glm::dot(glm::dvec3(p.points[0]), p.normal()) / 6;  // the normal is as long as twice the area
    }
    const glm::dvec3 size = glm::dvec3(before.max) - glm::dvec3(before.min);
    EXPECT_NEAR(volume, size.x * size.y * size.z, 1e-6) << divided.name;
  }
}

// Box 3 starts at the corner (+, +) and walks along -x first, a quarter turn a leg. Its half sides are 0.25 m: in the middle of
// a leg, turned by 45 degrees, it is sqrt(2) times as wide.
TEST(MovingScenes, every_third_box_turns_as_it_walks) {
  const Scene scene = make("walking_boxes");
  const auto box_at = [&](double seconds) {
    Bounds bounds;
    bounds.add(mesh(posed(scene, seconds), "box_3").positions);
    return bounds;
  };
  const Bounds rest = box_at(0), turning = box_at(0.25), turned = box_at(0.5);
  EXPECT_NEAR(turned.min.x, rest.min.x - 1, 1e-6);
  EXPECT_NEAR(turned.max.x, rest.max.x - 1, 1e-6);
  EXPECT_NEAR(turned.min.z, rest.min.z, 1e-6);
  EXPECT_NEAR(turning.max.x - turning.min.x, std::sqrt(0.5), 1e-6);
  EXPECT_NEAR((turning.max.x + turning.min.x) / 2, (rest.max.x + rest.min.x) / 2 - 0.5, 1e-6);
  const std::vector<glm::vec3>& corners = mesh(scene, "box_3").positions;
  const Scene half = posed(scene, 1);
  const glm::vec3 middle = (rest.min + rest.max) / 2.0f, to(-1, 0, -1);
  for (std::size_t v = 0; v < corners.size(); ++v) {
    const glm::vec3 arm = corners[v] - middle;
    EXPECT_EQ(mesh(half, "box_3").positions[v], middle + to + glm::vec3(-arm.x, arm.y, -arm.z)) << "half a turn";
  }
}

// A plot is 2 m wide, its corners are the middles of columns of 0.125 m, and the corner of a box is at most 0.25 sqrt(2) m from
// the box's middle.
TEST(MovingScenes, boxes_walk_in_their_plots_and_between_columns) {
  for (const int count : {1, 2, 12, 100}) {
    const Scene scene = make("walking_boxes", fmt::format("count={}", count));
    EXPECT_EQ(scene.meshes.size(), 2u + count);
    const int side = static_cast<int>(std::ceil(std::sqrt(count)));
    for (int k = 0; k < 32; ++k) {
      const Scene at = posed(scene, k / 16.0);
      for (int i = 0; i < count; ++i) {
        const glm::vec2 plot(2 * (i % side) + 1 - side, 2 * (i / side) + 1 - side);
        for (const glm::vec3& p : mesh(at, fmt::format("box_{}", i + 1)).positions) {
          const glm::vec2 aside = glm::abs(glm::vec2(p.x, p.z) - plot);
          EXPECT_LT(std::max(aside.x, aside.y), 0.86f);
          EXPECT_GT(glm::distance(aside, glm::vec2(1)), 0.125f);
        }
      }
    }
  }
}

// After half a second, each of nine joints 1/3 m apart but the first has turned by 120 / 8 = 15 degrees toward +x. The tube's
// upper end belongs to the last joint: it is at the sum over k = 0 .. 8 of (sin 15 k, cos 15 k) / 3.
TEST(MovingScenes, a_tube_bends_as_its_joints_say) {
  const Scene scene = make("bending_tube");
  const std::size_t top = mesh(scene, "tube").positions.size() - 1;
  glm::dvec3 due(0);
  for (int k = 0; k < 9; ++k) due += glm::dvec3(std::sin(glm::radians(15.0 * k)), std::cos(glm::radians(15.0 * k)), 0) / 3.0;
  EXPECT_NEAR(glm::distance(glm::dvec3(mesh(posed(scene, 0.5), "tube").positions[top]), due), 0, 1e-6);
  due.x = -due.x;
  EXPECT_NEAR(glm::distance(glm::dvec3(mesh(posed(scene, 1.5), "tube").positions[top]), due), 0, 1e-6);
  EXPECT_EQ(mesh(posed(scene, 1), "tube").positions, mesh(scene, "tube").positions);
}

TEST(MovingScenes, a_bent_tube_is_still_closed_and_fixed_at_its_foot) {
  for (const char* settings : {"", "joints=2", "joints=64,rings=20", "rings=2,segments=3"}) {
    const Scene scene = make("bending_tube", settings);
    Mesh bent = mesh(posed(scene, 0.5), "tube");
    finish(bent);
    EXPECT_TRUE(bent.facts.closed()) << settings;
    EXPECT_EQ(bent.facts.degenerate_count, 0u) << settings;
    for (std::size_t v = 0; v < bent.positions.size(); ++v)
      if (const glm::vec3& rest = mesh(scene, "tube").positions[v]; rest.y == 0) {
        EXPECT_EQ(bent.positions[v], rest) << settings;
      }
  }
}

TEST(MovingScenes, triangles_of_a_swarm_keep_their_form_and_stay_within_reach) {
  for (const double reach : {0.05, 1.6}) {
    const Scene scene = make("swarm", fmt::format("count=500,reach={}", reach));
    const Mesh& rest = mesh(scene, "swarm");
    double farthest = 0;
    for (int k = 0; k < 20; ++k) {
      const Scene at = posed(scene, k / 10.0);
      const Mesh& swarm = mesh(at, "swarm");
      for (std::size_t t = 0; t < rest.triangles.size(); ++t) {
        const glm::dvec3 way = glm::dvec3(swarm.positions[3 * t]) - glm::dvec3(rest.positions[3 * t]);
        farthest = std::max(farthest, glm::length(way));
        for (std::size_t v = 3 * t; v < 3 * t + 3; ++v)
          EXPECT_NEAR(glm::distance(glm::dvec3(swarm.positions[v]), glm::dvec3(rest.positions[v]) + way), 0, 1e-6);
      }
    }
    EXPECT_LE(farthest, reach);
    EXPECT_GT(farthest, 0.6 * reach) << "500 ways: some are nearly as long as they may be";
  }
  EXPECT_EQ(mesh(make("swarm", "reach=0.01"), "swarm").positions, mesh(make("swarm", "reach=1"), "swarm").positions);
}

TEST(MovingScenes, leaves_stand_still_without_wind_and_keep_their_places_in_it) {
  const Scene calm = make("leaf_cards"), windy = make("leaf_cards", "wind=0.5");
  EXPECT_FALSE(calm.motion);
  EXPECT_EQ(mesh(calm, "leaves").positions, mesh(windy, "leaves").positions);
  EXPECT_EQ(mesh(calm, "leaves").uv, mesh(windy, "leaves").uv);
}

// 160 cards are 0.4 m long each. Vertices of a card: both ends of its lower edge, then both of its upper one.
TEST(MovingScenes, the_tips_of_cards_sway_and_their_feet_stand_still) {
  const Scene scene = make("leaf_cards", "wind=0.5");
  const std::vector<glm::vec3>& rest = mesh(scene, "leaves").positions;
  double farthest = 0;
  for (int k = 0; k < 20; ++k) {
    const Scene at = posed(scene, k / 10.0);
    const std::vector<glm::vec3>& now = mesh(at, "leaves").positions;
    for (std::size_t v = 0; v < rest.size(); v += 4) {
      EXPECT_EQ(now[v], rest[v]);
      EXPECT_EQ(now[v + 1], rest[v + 1]);
      const glm::dvec3 right = glm::dvec3(now[v + 2]) - glm::dvec3(rest[v + 2]);
      const glm::dvec3 left = glm::dvec3(now[v + 3]) - glm::dvec3(rest[v + 3]);
      EXPECT_NEAR(glm::distance(right, left), 0, 1e-6) << "a card stays in a plane";
      farthest = std::max(farthest, glm::length(right));
    }
  }
  EXPECT_LE(farthest, 0.5 * 0.4 + 1e-6);
  EXPECT_GT(farthest, 0.3 * 0.4);
}

// Frame 0 of 60 Hz is at rest, frame 1 at the new place, and so are all others up to the last one.
TEST(MovingScenes, a_box_jumps_once_between_the_first_two_frames) {
  const struct {
    const char* settings;
    glm::vec3 by;
    std::vector<std::string> jumping;
  } due[] = {{"", {0.5f, 0, 0}, {"box_5"}},
             {"count=1,distance=0.75", {0.75f, 0, 0}, {"box_1"}},
             {"count=4,all=true,distance=0.125", {0.125f, 0, 0}, {"box_1", "box_2", "box_3", "box_4"}}};
  for (const auto& [settings, by, jumping] : due) {
    SCOPED_TRACE(settings);
    const Scene scene = make("jumping_boxes", settings);
    const Path path = find_path(scene, "jump", scene.lights[0], scene.views[0]);
    ASSERT_EQ(path.frame_count, 81);
    for (const int frame : {0, 1, 2, 40, 80}) {
      const Scene at = posed(scene, pose_at(path, frame)->seconds);
      for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
        const bool jumps = std::ranges::find(jumping, scene.meshes[m].name) != jumping.end();
        std::vector<glm::vec3> expected = scene.meshes[m].positions;
        for (glm::vec3& p : expected) p += frame > 0 && jumps ? by : glm::vec3(0);
        EXPECT_EQ(at.meshes[m].positions, expected) << scene.meshes[m].name << ", frame " << frame;
      }
    }
  }
}

}  // namespace moving_scenes_test
