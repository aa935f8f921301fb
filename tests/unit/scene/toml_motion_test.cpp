// Described scenes whose meshes move: [[path]] with moves = "mesh", names of meshes, and a description at a time.
#include "measure/scene/toml_motion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>

#include "measure/paths.h"
#include "measure/scene/base_scene.h"
#include "measure/scene/blob.h"
#include "measure/scene/pose.h"
#include "measure/scratch_folder.h"

namespace toml_motion_test {

using namespace gnomon;
namespace fs = std::filesystem;

const std::string crate = "[[shape]]\nname = \"crate\"\nkind = \"box\"\nmin = [0, 0, 0]\nmax = [1, 1, 1]\n";
const std::string ball = "[[shape]]\nname = \"ball\"\nkind = \"sphere\"\ncenter = [4, 1, 0]\nradius = 0.5\nsegments = 8\n";
const std::string move = "[[path]]\nmoves = \"mesh\"\n";
const std::string two_meters = "positions = [[0, 0, 0], [2, 0, 0]]\n";

class TomlMotion : public testing::Test {
 protected:
  fs::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }
  Scene read(const std::string& text) const { return read_scene_toml(write("test.toml", text)); }
  std::string error_of(const std::string& text) const {
    try {
      read(text);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }

  const ScratchFolder scratch_ = ScratchFolder::temporary("gnomon_toml_motion");
  const fs::path& folder_ = scratch_.path();
};

void expect_words(const std::string& text, std::initializer_list<std::string> words) {
  for (const std::string& word : words) EXPECT_NE(text.find(word), std::string::npos) << "'" << word << "' is not in: " << text;
}

/// The scene at a time of an animation, of the first without a name.
Scene posed(Scene scene, double seconds, const std::string& animation = "") {
  freeze(scene, {animation, seconds});
  return scene;
}

/// Expects that each vertex of a mesh is where `place` sends it from its place at rest.
void expect_moved(const Scene& at, const Scene& rest, std::size_t mesh, const std::function<glm::dvec3(glm::dvec3)>& place,
                  double tolerance = 0) {
  for (std::size_t v = 0; v < rest.meshes[mesh].positions.size(); ++v) {
    const glm::dvec3 due = place(rest.meshes[mesh].positions[v]), is(at.meshes[mesh].positions[v]);
    EXPECT_LE(glm::distance(due, is), tolerance)
        << "mesh " << mesh << ", vertex " << v << ": " << is.x << ' ' << is.y << ' ' << is.z;
  }
}

TEST_F(TomlMotion, a_path_moves_the_mesh_that_it_names_and_no_other) {
  const Scene scene = read(crate + ball + move + "name = \"go\"\nmesh = \"crate\"\n" + two_meters);
  ASSERT_TRUE(scene.motion);
  ASSERT_EQ(scene.motion->animations.size(), 1u);
  EXPECT_EQ(scene.motion->animations[0].name, "go");
  EXPECT_EQ(scene.motion->animations[0].end(), 1) << "the default duration";
  EXPECT_EQ(scene.meshes[0].name, "crate");
  expect_moved(posed(scene, 0.25), scene, 0, [](glm::dvec3 p) { return p + glm::dvec3(0.5, 0, 0); });
  expect_moved(posed(scene, 7), scene, 0, [](glm::dvec3 p) { return p + glm::dvec3(2, 0, 0); });
  EXPECT_EQ(posed(scene, 0.25).meshes[1].positions, scene.meshes[1].positions);
  EXPECT_TRUE(posed(scene, 0.25).meshes[1].shape) << "a sphere that stands still is one";
}

TEST_F(TomlMotion, without_a_time_a_scene_is_as_if_it_had_no_path) {
  const Scene still = read(crate + ball);
  const Scene scene = read(crate + ball + move + "mesh = [\"crate\", \"ball\"]\npositions = [[1, 2, 3], [2, 0, 0]]\n");
  Scene without = scene;
  without.motion = nullptr;
  EXPECT_EQ(scene_bytes(without), scene_bytes(still));
  EXPECT_EQ(scene.motion->animations.at(0).name, "mesh") << "the default name";
  // At its first key it is where the path has it, not where the file has it.
  expect_moved(posed(scene, 0), still, 0, [](glm::dvec3 p) { return p + glm::dvec3(1, 2, 3); });
}

TEST_F(TomlMotion, keys_have_times_or_equal_steps_over_a_duration) {
  const auto times_of = [&](const std::string& more) {
    const Scene scene = read(crate + move + "mesh = \"crate\"\npositions = [[0, 0, 0], [1, 0, 0], [4, 0, 0]]\n" + more);
    return scene.motion->animations.at(0).tracks.at(0).times;
  };
  EXPECT_EQ(times_of(""), (std::vector<double>{0, 0.5, 1}));
  EXPECT_EQ(times_of("duration = 3\n"), (std::vector<double>{0, 1.5, 3}));
  EXPECT_EQ(times_of("times = [0.25, 1, 1.125]\n"), (std::vector<double>{0.25, 1, 1.125}));
}

TEST_F(TomlMotion, steps_jump_and_lines_do_not) {
  const std::string text = crate + move + "mesh = \"crate\"\ntimes = [0, 1, 2]\npositions = [[0,0,0],[4,0,0],[0,0,8]]\n";
  const Scene step = read(text + "interpolation = \"step\"\n"), linear = read(text + "interpolation = \"linear\"\n");
  expect_moved(posed(step, 0.99), step, 0, [](glm::dvec3 p) { return p; });
  expect_moved(posed(step, 1), step, 0, [](glm::dvec3 p) { return p + glm::dvec3(4, 0, 0); });
  expect_moved(posed(step, 1.99), step, 0, [](glm::dvec3 p) { return p + glm::dvec3(4, 0, 0); });
  expect_moved(posed(linear, 1.5), linear, 0, [](glm::dvec3 p) { return p + glm::dvec3(2, 0, 4); });
}

// Keys 0, 1, 4 m at 0, 1, 3 s: the tangent at 1 s is (4 - 0) / (3 - 0) = 4/3 m/s, those at the ends are 0. Half way through
// the first second: 1/2 of 1 m, and (1/8 - 1/4) of 1 s times 4/3 m/s: 1/2 - 1/6 = 1/3 m.
TEST_F(TomlMotion, cubic_keys_have_tangents_from_their_neighbors) {
  const Scene scene = read(crate + move +
                           "mesh = \"crate\"\ninterpolation = \"cubic\"\ntimes = [0, 1, 3]\n"
                           "positions = [[0, 0, 0], [1, 0, 0], [4, 0, 0]]\n");
  const Track& track = scene.motion->animations.at(0).tracks.at(0);
  ASSERT_EQ(track.width(), 3u);
  const double slope = 4 / 3.0;
  const std::vector<double> due{0,     0, 0, 0, 0, 0, 0,     0, 0,  //
                                slope, 0, 0, 1, 0, 0, slope, 0, 0,  //
                                0,     0, 0, 4, 0, 0, 0,     0, 0};
  EXPECT_EQ(track.values, due);
  expect_moved(
      posed(scene, 0.5), scene, 0, [](glm::dvec3 p) { return p + glm::dvec3(1 / 3.0, 0, 0); }, 1e-7);
}

TEST_F(TomlMotion, a_mesh_turns_about_a_point_and_moves_at_once) {
  const std::string text = crate + move + "mesh = \"crate\"\ntimes = [0, 1, 2]\n";
  const std::string turns = "rotate_degrees = [[0, 0, 0], [0, 0, 90], [0, 0, 180]]\n";
  const Scene scene = read(text + turns + "about = [1, 1, 0]\n");
  EXPECT_EQ(posed(scene, 0).meshes[0].positions, scene.meshes[0].positions);
  expect_moved(posed(scene, 2), scene, 0, [](glm::dvec3 p) { return glm::dvec3(2 - p.x, 2 - p.y, p.z); });
  // A quarter turn about z sends x to y and y to -x.
  expect_moved(
      posed(scene, 1), scene, 0, [](glm::dvec3 p) { return glm::dvec3(1 - (p.y - 1), 1 + (p.x - 1), p.z); }, 1e-6);
  const double h = std::sqrt(0.5);
  const auto eighth = [&](glm::dvec3 p) { return glm::dvec3(h * p.x - h * p.y, h * p.x + h * p.y, p.z); };
  const Scene at_origin = read(text + turns);
  expect_moved(posed(at_origin, 0.5), at_origin, 0, eighth, 1e-6);
  const Scene both = read(text + turns + "about = [1, 1, 0]\npositions = [[0, 0, 0], [0, 0, 3], [0, 5, 3]]\n");
  expect_moved(posed(both, 2), both, 0, [](glm::dvec3 p) { return glm::dvec3(2 - p.x, 7 - p.y, p.z + 3); });
}

TEST_F(TomlMotion, a_key_turns_about_x_then_y_then_z_as_a_placement_does) {
  const Placement placement{.rotate_degrees = {30, -75, 110}};
  for (const char* interpolation : {"step", "linear", "cubic"}) {
    const Scene scene = read(crate + move + "mesh = \"crate\"\nrotate_degrees = [[0, 0, 0], [30, -75, 110], [30, -75, 110]]\n" +
                             "interpolation = \"" + interpolation + "\"\n");
    expect_moved(
        posed(scene, 0.5), scene, 0, [&](glm::dvec3 p) { return placement.apply(p); }, 1e-6);
  }
}

TEST_F(TomlMotion, more_keys_turn_farther_than_half_a_turn) {
  const Scene scene =
      read(crate + move + "mesh = \"crate\"\nrotate_degrees = [[0,0,0],[0,100,0],[0,200,0],[0,300,0],[0,400,0],[0,720,0]]\n" +
           "interpolation = \"step\"\nduration = 5\n");
  expect_moved(posed(scene, 5), scene, 0, [](glm::dvec3 p) { return p; });
  const Scene around = read(crate + move + "mesh = \"crate\"\nrotate_degrees = [[0,0,0],[0,120,0],[0,240,0],[0,360,0]]\n");
  expect_moved(posed(around, 1), around, 0, [](glm::dvec3 p) { return p; });
  // Five sixths of the way from 240 to 360 degrees are 340.
  const Placement placement{.rotate_degrees = {0, 340, 0}};
  expect_moved(
      posed(around, (2 + 5 / 6.0) / 3), around, 0, [&](glm::dvec3 p) { return placement.apply(p); }, 1e-6);
}

TEST_F(TomlMotion, paths_of_one_name_are_one_animation) {
  const Scene scene = read(crate + ball + move + "name = \"go\"\nmesh = \"crate\"\n" + two_meters + move +
                           "name = \"go\"\nmesh = \"ball\"\nduration = 4\npositions = [[0, 0, 0], [0, 4, 0]]\n");
  ASSERT_EQ(scene.motion->animations.size(), 1u);
  EXPECT_EQ(scene.motion->animations[0].end(), 4);
  const Scene at = posed(scene, 0.5);
  expect_moved(at, scene, 0, [](glm::dvec3 p) { return p + glm::dvec3(1, 0, 0); });
  expect_moved(
      at, scene, 1, [](glm::dvec3 p) { return p + glm::dvec3(0, 0.5, 0); }, 1e-7);
}

TEST_F(TomlMotion, a_mesh_has_its_way_in_each_animation) {
  const std::string turn = "rotate_degrees = [[0, 0, 0], [180, 0, 0]]\ninterpolation = \"step\"\nabout = [0, 3, 0]\n";
  const Scene scene = read(crate + ball + move + "name = \"a\"\nmesh = [\"crate\", \"ball\"]\n" + turn + move +
                           "name = \"b\"\nmesh = [\"crate\"]\n" + two_meters);
  ASSERT_EQ(scene.motion->animations.size(), 2u);
  EXPECT_EQ(scene.motion->rigs.size(), 2u);
  const auto over = [](glm::dvec3 p) { return glm::dvec3(p.x, 6 - p.y, -p.z); };
  expect_moved(posed(scene, 1, "a"), scene, 0, over);
  expect_moved(posed(scene, 1, "a"), scene, 1, over, 1e-6);
  expect_moved(posed(scene, 1, "b"), scene, 0, [](glm::dvec3 p) { return p + glm::dvec3(2, 0, 0); });
  EXPECT_EQ(posed(scene, 1, "b").meshes[1].positions, scene.meshes[1].positions);
  EXPECT_EQ(posed(scene, 1).meshes[0].positions, posed(scene, 1, "a").meshes[0].positions) << "the first is the default";
}

TEST_F(TomlMotion, the_name_of_a_mesh_file_is_for_all_its_meshes) {
  write("two.obj", "o a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\no b\nv 0 0 5\nv 1 0 5\nv 0 1 5\nf 4 5 6\n");
  const Scene scene = read("[[mesh]]\nname = \"pair\"\nfile = \"two.obj\"\ntranslate = [0, 0, 1]\n" + crate + move +
                           "mesh = \"pair\"\n" + two_meters);
  ASSERT_EQ(scene.meshes.size(), 3u);
  const Scene at = posed(scene, 1);
  EXPECT_EQ(at.meshes[0].positions, scene.meshes[0].positions) << "shapes come first";
  for (const std::size_t mesh : {1, 2}) {
    expect_moved(at, scene, mesh, [](glm::dvec3 p) { return p + glm::dvec3(2, 0, 0); });
    EXPECT_EQ(scene.meshes[mesh].name, mesh == 1 ? "a" : "b") << "the file's own names stay";
  }
  EXPECT_EQ(scene.motion->nodes.size(), 1u) << "both move alike";
}

TEST_F(TomlMotion, meshes_of_the_scene_to_start_from_move_by_their_names) {
  write("base.toml", crate + ball + move + "name = \"go\"\nmesh = \"ball\"\n" + two_meters);
  const Scene scene =
      read("scene = \"base.toml\"\n" + move + "name = \"up\"\nmesh = \"crate\"\npositions = [[0,0,0],[0,3,0]]\n");
  ASSERT_EQ(scene.motion->animations.size(), 2u) << "the base's animation is there, too";
  expect_moved(posed(scene, 1, "up"), scene, 0, [](glm::dvec3 p) { return p + glm::dvec3(0, 3, 0); });
  EXPECT_EQ(posed(scene, 1, "up").meshes[1].positions, scene.meshes[1].positions);
  expect_moved(
      posed(scene, 1, "go"), scene, 1, [](glm::dvec3 p) { return p + glm::dvec3(2, 0, 0); }, 1e-6);
  EXPECT_EQ(posed(scene, 1, "go").meshes[0].positions, scene.meshes[0].positions);
  EXPECT_TRUE(read("scene = \"base.toml\"\n").motion) << "handed on";

  const std::string start = "scene = \"base.toml\"\n";
  expect_words(error_of(start + move + "name = \"up\"\nmesh = \"ball\"\n" + two_meters),
               {"path 'up' cannot move mesh 'ball'", "moves it already", "test.toml:2"});
  expect_words(error_of(start + move + "name = \"go\"\nmesh = \"crate\"\n" + two_meters), {"'go'", "unique", "test.toml:4"});
  expect_words(error_of(start + "[[path]]\nname = \"go\"\nmoves = \"light\"\nframes = 2\n" + two_meters),
               {"path 'go' has the name of an animation", "test.toml"});
  expect_words(error_of(start + crate + move + "name = \"up\"\nmesh = \"crate\"\n" + two_meters),
               {"'crate' is given 2 times", "test.toml"});
}

TEST_F(TomlMotion, a_description_with_a_time_is_a_still) {
  const std::string text = crate + move + "name = \"a\"\nmesh = \"crate\"\n" + two_meters + move +
                           "name = \"b\"\nmesh = \"crate\"\npositions = [[0, 0, 0], [0, 2, 0]]\n";
  const Scene rest = read(text);
  const Scene first = read("time = 0.5\n" + text), second = read("animation = \"b\"\ntime = 0.5\n" + text);
  EXPECT_FALSE(first.motion || second.motion);
  expect_moved(first, rest, 0, [](glm::dvec3 p) { return p + glm::dvec3(1, 0, 0); });
  expect_moved(second, rest, 0, [](glm::dvec3 p) { return p + glm::dvec3(0, 1, 0); });
  expect_words(error_of("time = -1\n" + text), {"scene.time = -1", "0 s or more", "test.toml:1"});
  expect_words(error_of("time = \"soon\"\n" + text), {"time", "number", "test.toml:1"});
  expect_words(error_of("animation = \"b\"\n" + text), {"animation = 'b'", "without time", "test.toml:1"});
  expect_words(error_of("animation = \"\"\ntime = 1\n" + text), {"animation = ''", "test.toml:1"});
  expect_words(error_of("time = 1\nanimation = \"c\"\n" + text), {"c", "a, b", "test.toml:2"});
  expect_words(error_of("time = 1\n" + crate), {"test.toml:1"});
}

TEST_F(TomlMotion, paths_of_camera_and_light_stay_beside_those_of_meshes) {
  const Scene scene = read(crate + "[[path]]\nmoves = \"camera\"\nframes = 3\n" + two_meters + move + "mesh = \"crate\"\n" +
                           two_meters + "[[path]]\nmoves = \"light\"\nframes = 4\n" + two_meters);
  ASSERT_EQ(scene.paths.size(), 2u);
  EXPECT_EQ(scene.paths[0].name, "camera");
  EXPECT_EQ(scene.paths[1].frame_count, 4);
  EXPECT_EQ(scene.motion->animations.size(), 1u);
}

TEST_F(TomlMotion, keys_of_one_kind_are_refused_in_another) {
  const std::string mesh_path = crate + move + "mesh = \"crate\"\n" + two_meters;
  expect_words(error_of(mesh_path + "frames = 3\n"), {"path has no key 'frames'", "test.toml:10"});
  expect_words(error_of("[[path]]\nmoves = \"light\"\nframes = 3\ntimes = [0, 1]\n" + two_meters),
               {"path has no key 'times'", "test.toml:4"});
  expect_words(error_of("[[path]]\nmoves = \"camera\"\nframes = 3\nmesh = \"a\"\n" + two_meters), {"path has no key 'mesh'"});
  expect_words(error_of("[[path]]\nmoves = \"scale\"\n" + two_meters), {"'scale'", "camera, light or mesh", "test.toml:2"});
}

TEST_F(TomlMotion, mistakes_of_meshes_have_a_file_and_a_line) {
  expect_words(error_of(crate + move + "mesh = \"crat\"\n" + two_meters), {"'crat'", "did you mean crate?", "test.toml:8"});
  const std::string file = (fs::absolute(data_root() / "tests/data/tetrahedron.obj")).string();
  expect_words(error_of("[[mesh]]\nfile = \"" + file + "\"\n" + move + "mesh = \"tetrahedron\"\n" + two_meters),
               {"'tetrahedron'", "has a name", "test.toml:5"});
  expect_words(error_of(crate + move + two_meters), {"lacks the key 'mesh'", "test.toml:6"});
  expect_words(error_of(crate + move + "mesh = []\n" + two_meters), {"mesh", "a list of texts", "test.toml:8"});
  expect_words(error_of(crate + move + "mesh = [\"crate\", 2]\n" + two_meters), {"mesh", "a list of texts", "test.toml:8"});
  expect_words(error_of(crate + move + "mesh = [\"crate\", \"crate\"]\n" + two_meters),
               {"'crate' twice", "different names", "test.toml:8"});
  expect_words(error_of(crate + move + "mesh = \"crate\"\n" + two_meters + move + "mesh = \"crate\"\n" + two_meters),
               {"'crate' twice", "test.toml:10"});
  // Two of one name are no mistake unless a path names them.
  expect_words(error_of(crate + crate + move + "mesh = \"crate\"\n" + two_meters),
               {"'crate' is given 2 times", "test.toml:13"});
  expect_words(
      error_of(crate + "[[mesh]]\nname = \"crate\"\nfile = \"" + file + "\"\n" + move + "mesh = \"crate\"\n" + two_meters),
      {"'crate' is given 2 times", "test.toml:11"});
}

TEST_F(TomlMotion, mistakes_of_keys_have_a_file_and_a_line) {
  const auto mistake = [&](const std::string& keys) { return error_of(crate + move + "mesh = \"crate\"\n" + keys); };
  expect_words(mistake(""), {"path 'mesh' has neither positions nor rotate_degrees", "test.toml:6"});
  expect_words(mistake("positions = [[0, 0, 0]]\n"), {"positions", "2 or more", "test.toml:9"});
  expect_words(mistake("positions = [[0, 0, 0], [1e18, 0, 0]]\n"), {"positions = 1e+18", "-1e17 .. 1e17", "test.toml:9"});
  expect_words(mistake(two_meters + "rotate_degrees = [[0, 0, 0]]\n"), {"rotate_degrees", "2 vectors", "test.toml:10"});
  expect_words(mistake(two_meters + "about = [0, 0, 0]\n"), {"about", "without rotate_degrees", "test.toml:10"});
  expect_words(mistake("rotate_degrees = [[0, 0, 0], [0, 180, 0]]\n"),
               {"180 after 0 about y at key 1", "more keys", "test.toml:9"});
  expect_words(mistake(two_meters + "times = [0]\n"), {"times", "2 numbers", "test.toml:10"});
  expect_words(mistake(two_meters + "times = [1, 0.5]\n"), {"times = 0.5 s at key 1", "test.toml:10"});
  expect_words(mistake(two_meters + "times = [1, 1]\n"), {"times = 1 s at key 1", "test.toml:10"});
  expect_words(mistake(two_meters + "times = [-1, 1]\n"), {"times = -1 s at key 0", "test.toml:10"});
  expect_words(mistake(two_meters + "times = [0, nan]\n"), {"times = nan", "test.toml:10"});
  expect_words(mistake(two_meters + "times = 1\n"), {"times", "a list of numbers", "test.toml:10"});
  expect_words(mistake(two_meters + "times = [0, 1]\nduration = 2\n"), {"duration = 2", "beside times", "test.toml:11"});
  expect_words(mistake(two_meters + "duration = 0\n"), {"duration = 0", "2e-06 s or more", "test.toml:10"});
  expect_words(mistake(two_meters + "duration = -2\n"), {"duration = -2", "2e-06 s or more", "test.toml:10"});
  expect_words(mistake(two_meters + "interpolation = \"smooth\"\n"), {"'smooth'", "step, linear or cubic", "test.toml:10"});
  expect_words(mistake(two_meters + "name = \"A walk\"\n"), {"'A walk'", "a..z", "test.toml:10"});
  expect_words(mistake(two_meters + "[[path]]\nname = \"mesh\"\nmoves = \"camera\"\nframes = 2\n" + two_meters),
               {"path.name = 'mesh'", "a path of camera or light", "test.toml:6"});
}

}  // namespace toml_motion_test
