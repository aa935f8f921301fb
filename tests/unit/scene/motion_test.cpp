#include "measure/scene/motion.h"

#include <gnomon/error.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "error_words.h"
#include "measure/scene/load.h"
#include "measure/scene/motion_data.h"
#include "moving_world.h"

namespace motion_test {

using namespace gnomon;

const Path bent{"bent", Path::Moves::camera, {{0, 0, 0}, {2, 0, 0}, {2, 4, 0}}, 5};

TEST(motion, keys_are_passed_at_equal_steps_in_straight_lines) {
  // Five frames over two pieces: 0, 1/2, 1, 3/2, 2 keys along.
  const View view{.name = "view", .eye = {9, 9, 9}, .target = {0, 0, -5}};
  const glm::vec3 due[] = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 2, 0}, {2, 4, 0}};
  for (int frame = 0; frame < 5; ++frame) {
    const View moved = view_at(bent, view, frame);
    EXPECT_EQ(moved.eye, due[frame]) << frame;
    EXPECT_EQ(moved.target, view.target);
  }
}

TEST(motion, a_path_moves_the_camera_or_the_light_and_leaves_the_other) {
  Path path = bent;
  const Light point{.name = "point", .kind = PointLight{{1, 2, 3}}};
  EXPECT_EQ(std::get<PointLight>(light_at(path, point, 3).kind).position, glm::vec3(1, 2, 3));
  path.moves = Path::Moves::light;
  EXPECT_EQ(std::get<PointLight>(light_at(path, point, 3).kind).position, glm::vec3(2, 2, 0));
  const View view{.name = "view", .eye = {9, 9, 9}};
  EXPECT_EQ(view_at(path, view, 3).eye, view.eye);
  const Light rect{.name = "rect", .kind = RectLight{{0, 5, 0}, {1, 0, 0}, {0, 0, 1}}};
  EXPECT_EQ(std::get<RectLight>(light_at(path, rect, 1).kind).center, glm::vec3(1, 0, 0));
}

TEST(motion, a_directional_light_may_pass_ways_of_any_length) {
  const Light sun{.name = "sun", .kind = DirectionalLight{{0, -1, 0}}};
  for (const float length : {0x1p-100f, 1.0f, 0x1p100f}) {
    const Path path{"way", Path::Moves::light, {length * glm::vec3(-2, -4, 0), length * glm::vec3(2, -4, 0)}, 3};
    const glm::vec3 direction = std::get<DirectionalLight>(light_at(path, sun, 1).kind).direction;
    EXPECT_EQ(glm::normalize(direction), glm::vec3(0, -1, 0)) << length;
    EXPECT_LE(extent(direction), 10);
    check_frames(path, sun, View{}, Scene{}, "here");
  }
}

TEST(motion, every_scene_has_slides_of_one_percent) {
  Scene scene;
  Mesh mesh;
  mesh.positions = {{-1, 0, -1}, {1, 0, -1}, {0, 2, 1}};
  scene.meshes = {mesh};
  const Light point{.name = "point", .kind = PointLight{{0, 11, 0}}};
  const Light sun{.name = "sun", .kind = DirectionalLight{{0, -3, 4}}};
  const View view{.name = "view", .eye = {0, 0, 8}, .target = {0, 0, -2}};

  const Path camera = find_path(scene, "camera_slide", point, view);
  const glm::vec3 end = view_at(camera, view, camera.frame_count - 1).eye;
  EXPECT_EQ(view_at(camera, view, 0).eye, view.eye);
  EXPECT_NEAR(end.x, 0.1, 1e-6) << "1 % of 10 m to the target, to the right";
  EXPECT_NEAR(end.z, 8, 1e-6);

  const Path light = find_path(scene, "light_slide", point, view);
  const glm::vec3 moved = std::get<PointLight>(light_at(light, point, light.frame_count - 1).kind).position;
  EXPECT_NEAR(glm::distance(moved, glm::vec3(0, 11, 0)), 0.1, 1e-6) << "1 % of 10 m to the middle (0, 1, 0)";

  const Path turn = find_path(scene, "light_slide", sun, view);
  const auto direction = glm::normalize(std::get<DirectionalLight>(light_at(turn, sun, turn.frame_count - 1).kind).direction);
  EXPECT_NEAR(std::acos(glm::dot(direction, glm::normalize(glm::vec3(0, -3, 4)))), 0.01, 1e-4);
}

// A jump goes the way of the slide, five times as far, and nothing is between its two places.
TEST(motion, every_scene_has_jumps_of_five_percent) {
  Scene scene;
  Mesh mesh;
  mesh.positions = {{-1, 0, -1}, {1, 0, -1}, {0, 2, 1}};
  scene.meshes = {mesh};
  const Light rect{.name = "rect", .kind = RectLight{{1, 11, 0}, {0.5f, 0, 0}, {0, 0, 0.5f}}};
  const Light sun{.name = "sun", .kind = DirectionalLight{{0, -3, 4}}};
  const View view{.name = "view", .eye = {0, 0, 8}, .target = {0, 0, -2}};

  const Path camera = find_path(scene, "camera_jump", sun, view);
  ASSERT_EQ(camera.frame_count, 81);
  EXPECT_EQ(camera.frame_rate, 60);
  EXPECT_EQ(view_at(camera, view, 0).eye, view.eye);
  EXPECT_NEAR(view_at(camera, view, 1).eye.x, 0.5, 1e-6) << "5 % of 10 m to the target, to the right";
  EXPECT_EQ(view_at(camera, view, 1).target, view.target);

  const Path light = find_path(scene, "light_jump", rect, view);
  ASSERT_EQ(light.frame_count, 81);
  const auto rect_at = [&](int frame) { return std::get<RectLight>(light_at(light, rect, frame).kind); };
  const glm::vec3 start = std::get<RectLight>(rect.kind).center, end = rect_at(1).center;
  EXPECT_EQ(rect_at(0).center, start);
  EXPECT_NEAR(glm::distance(start, end), 0.05 * std::sqrt(101), 1e-6) << "5 % of the way to the middle (0, 1, 0)";
  EXPECT_EQ(rect_at(1).half_u, glm::vec3(0.5f, 0, 0)) << "all of the light moves, and does not turn";
  for (int frame = 1; frame < 81; ++frame) {
    ASSERT_EQ(view_at(camera, view, frame).eye, view_at(camera, view, 1).eye) << frame;
    ASSERT_EQ(rect_at(frame).center, end) << frame;
  }

  const Path turn = find_path(scene, "light_jump", sun, view);
  const auto direction = glm::normalize(std::get<DirectionalLight>(light_at(turn, sun, 1).kind).direction);
  EXPECT_NEAR(std::acos(glm::dot(direction, glm::normalize(glm::vec3(0, -3, 4)))), std::atan(0.05), 1e-4);
}

// With a position for each frame, frame n is at key n to the bit: (frames - 1) * n / (frames - 1) is exact.
TEST(motion, steps_are_positions_of_frames_and_the_last_one_is_kept) {
  const std::vector<glm::vec3> places{{0.1f, 0, 0}, {0.7f, 1e-7f, 0}, {-3, 0, 0.3f}};
  const View view{.name = "view", .eye = {9, 9, 9}, .target = {0, 0, -5}};
  for (const int frames : {3, 4, 7, 81, 1000}) {
    const Path path{"steps", Path::Moves::camera, stepped(places, frames), frames};
    for (int frame = 0; frame < frames; ++frame)
      ASSERT_EQ(view_at(path, view, frame).eye, places[static_cast<std::size_t>(std::min(frame, 2))]) << frames << ' ' << frame;
  }
  EXPECT_EQ(stepped({{1, 2, 3}}, 2), (std::vector<glm::vec3>{{1, 2, 3}, {1, 2, 3}}));
}

TEST(motion, a_frame_that_cannot_be_is_named) {
  const auto trouble = [](const Path& path, const Light& light, const View& view) -> std::string {
    try {
      check_frames(path, light, view, Scene{}, "little");
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  const Light point{.name = "point", .kind = PointLight{{1, 2, 3}}}, sun{.name = "sun", .kind = DirectionalLight{{0, -1, 0}}};
  const View view{.name = "view", .eye = {0, 0, 8}, .target = {2, 1, 0}, .up = {0, 0, 1}};
  // The middle piece of `bent` goes from (2, 0, 0) to (2, 4, 0); with nine frames, the sixth is at (2, 1, 0).
  Path path = bent;
  path.frame_count = 9;
  EXPECT_EQ(trouble(path, point, view), "view 'view': eye = (2, 1, 0) is at its target (scene little, path bent, frame 5)");
  path.frame_count = 5;
  EXPECT_EQ(trouble(path, point, view), "") << "between the frames it may be anywhere";
  path.moves = Path::Moves::light;
  EXPECT_EQ(trouble(path, point, view), "") << "a point light may be anywhere";
  EXPECT_EQ(trouble(path, sun, view),
            "light 'sun': direction = (0, 0, 0) is not a direction (scene little, path bent, frame 0)");
  // A thousandth of a meter off is a direction; rounding is none.
  path.positions = {{-1, 0, 0}, {1, 0, 1e-3f}};
  EXPECT_EQ(trouble(path, sun, view), "");
  path.positions = {{-1, 0, 0}, {1, 0, 1e-9f}};
  EXPECT_NE(trouble(path, sun, view), "");
}

TEST(motion, the_scenes_own_paths_come_first_and_a_wrong_name_is_said) {
  Scene scene;
  scene.name = "little";
  Path own = bent;
  own.name = "camera_slide";
  scene.paths = {own};
  const Light light{.name = "point", .kind = PointLight{}};
  EXPECT_EQ(find_path(scene, "camera_slide", light, View{}).frame_count, 5);
  try {
    find_path(scene, "camera_slid", light, View{});
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("scene little has no path camera_slid; did you mean camera_slide?"),
              std::string::npos);
  }
}

// --- animations ---

const Light lamp{.name = "lamp", .kind = PointLight{{0, 4, 0}}};

/// The moving world, whose animation `walk` ends at this time.
Scene ending_at(double seconds) {
  Scene scene = moving_world::scene();
  Motion motion = moving_world::motion_of(scene);
  for (Track& track : motion.animations[0].tracks) track.times[1] = seconds;
  moving_world::set_motion(scene, std::move(motion));
  return scene;
}

TEST(motion, an_animation_is_a_path_of_60_frames_a_second_to_its_last_key) {
  const Path path = find_path(moving_world::scene(), "walk", lamp, View{});
  EXPECT_EQ(path.moves, Path::Moves::geometry);
  EXPECT_EQ(path.name, "walk");
  EXPECT_EQ(path.frame_count, 121) << "2 s, both ends";
  EXPECT_EQ(path.start, 0);
  EXPECT_EQ(path.frame_rate, 60);
  EXPECT_TRUE(path.positions.empty());
  const auto frames = [](double seconds) { return find_path(ending_at(seconds), "walk", lamp, View{}).frame_count; };
  EXPECT_EQ(frames(0.001), 2);
  EXPECT_EQ(frames(0.51), 32) << "30.6 frames";
  EXPECT_EQ(frames(166), 9961);
  EXPECT_EQ(frames(1e300), 10'000);
}

TEST(motion, an_animation_moves_neither_light_nor_camera) {
  const Scene scene = moving_world::scene();
  const View view{.name = "view", .eye = {9, 9, 9}};
  const Path path = find_path(scene, "walk", lamp, view);
  EXPECT_EQ(std::get<PointLight>(light_at(path, lamp, 7).kind).position, glm::vec3(0, 4, 0));
  EXPECT_EQ(view_at(path, view, 7).eye, view.eye);
}

TEST(motion, a_wrong_name_is_said_with_the_animations) {
  const auto error = error_words::error_of([] { find_path(moving_world::scene(), "wolk", lamp, View{}); });
  error_words::expect_words(error, {"did you mean walk?", "camera_slide, light_slide, camera_jump, light_jump, walk, sleep"});
}

TEST(motion, a_path_and_an_animation_of_one_name_are_refused_at_load) {
  Scene scene = moving_world::scene();
  scene.paths = {{"walk", Path::Moves::light, {{0, 0, 0}, {1, 0, 0}}, 3}};
  const auto error = error_words::error_of([&] { finish_scene(scene, "here"); });
  error_words::expect_words(error, {"here: path 'walk' and animation 'walk'"});
}

TEST(motion, the_first_frame_at_which_a_mesh_cannot_be_is_named) {
  Scene scene = moving_world::scene();
  Path path = find_path(scene, "walk", lamp, View{});
  path.frame_rate = 4;
  path.frame_count = 9;
  check_frames(path, lamp, View{}, scene, "world");
  Motion motion = moving_world::motion_of(scene);
  motion.animations[0].tracks[0].values = {0, 0, 0, 8e17, 0, 0};  // 1e17 m, the limit, are passed after an eighth of the way
  moving_world::set_motion(scene, std::move(motion));
  const auto error = error_words::error_of([&] { check_frames(path, lamp, View{}, scene, "world"); });
  error_words::expect_words(error, {"mesh 'm1', vertex 0", "at 0.5 s", "(scene world, path walk, frame 2)"});
  EXPECT_EQ(scene.meshes[1].positions, moving_world::scene().meshes[1].positions);
  path.frame_count = 2;
  check_frames(path, lamp, View{}, scene, "world");
}

}  // namespace motion_test
