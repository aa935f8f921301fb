// Described scenes: defaults, exact values, and a file and line for every mistake.
#include <gnomon/kit/geometry/shapes.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <fstream>

#include "measure/paths.h"
#include "measure/scene/base_scene.h"
#include "measure/scene/load.h"

namespace scene_toml_test {

using namespace gnomon;
namespace fs = std::filesystem;

/// Reads `text` as a scene file named test.toml.
Scene read(const std::string& text) {
  std::string folder = (fs::temp_directory_path() / "gnomon_toml_XXXXXX").string();
  const fs::path path = mkdtemp(folder.data());
  std::ofstream(path / "test.toml") << text;
  struct Remove {
    fs::path path;
    ~Remove() { fs::remove_all(path); }
  } remove{path};
  return read_scene_toml(path / "test.toml");
}

std::string error_of(const std::string& text) {
  try {
    read(text);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

void expect_words(const std::string& text, std::initializer_list<std::string> words) {
  for (const std::string& word : words) EXPECT_NE(text.find(word), std::string::npos) << "'" << word << "' is not in: " << text;
}

const std::string sphere = "[[shape]]\nkind = \"sphere\"\ncenter = [0, 1, 0]\nradius = 1\n";

TEST(SceneToml, defaults_are_those_of_the_contract) {
  const Scene scene =
      read(sphere + "[[light]]\nkind = \"point\"\nposition = [1, 2, 3]\n[[view]]\neye = [0, 0, 9]\ntarget = [0, 0, 0]\n");
  EXPECT_EQ(scene.name, "test");
  EXPECT_EQ(scene.ambient, 0.15f);
  const Mesh& mesh = scene.meshes.at(0);
  EXPECT_TRUE(mesh.casts && mesh.receives);
  EXPECT_EQ(mesh.albedo, glm::vec3(0.7f));
  EXPECT_EQ(mesh.triangles.size(), tessellate(*mesh.shape, 64, "").triangles.size());
  EXPECT_EQ(scene.lights.at(0).intensity, 1);
  EXPECT_EQ(scene.views.at(0).up, glm::vec3(0, 1, 0));
  EXPECT_EQ(scene.views.at(0).fov_y_degrees, 45);
}

TEST(SceneToml, whole_numbers_may_be_of_any_size) {
  // 2^53 + 1 is no double; the float nearest to it is 2^53, and to ten times that, 10 2^53.
  const std::string point = sphere + "[[light]]\nkind = \"point\"\nposition = ";
  const Scene scene = read(point + "[9007199254740993, -90071992547409930, 1]\n");
  EXPECT_EQ(std::get<PointLight>(scene.lights.at(0).kind).position, glm::vec3(0x1p53f, -0x1.4p56f, 1));
  const Scene bright = read(point + "[0, 4, 0]\nintensity = 9223372036854775807\n");
  EXPECT_EQ(bright.lights.at(0).intensity, 0x1p63f);
}

TEST(SceneToml, reads_every_kind_of_shape_and_light) {
  const Scene scene = read(R"(
name = "all"
ambient = 0.2
[[shape]]
kind = "cone"
base = [0, 0, 0]
axis = [0, 2, 0]
radius = 1
height = 3
segments = 12
[[shape]]
kind = "disc"
center = [0, 0, 0]
normal = [0, 1, 0]
radius = 2
casts = false
[[shape]]
kind = "triangle"
points = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
receives = false
[[shape]]
kind = "box"
min = [0, 0, 0]
max = [1, 2, 3]
albedo = [1, 0, 0.5]
[[light]]
name = "a"
kind = "spot"
position = [0, 5, 0]
direction = [0, -1, 0]
inner_degrees = 10
outer_degrees = 20
[[light]]
name = "b"
kind = "rect"
center = [0, 5, 0]
half_u = [1, 0, 0]
half_v = [0, 0, 2]
[[light]]
name = "c"
kind = "disc"
center = [0, 5, 0]
normal = [0, -1, 0]
radius = 0.5
[[light]]
name = "d"
kind = "sphere"
center = [0, 5, 0]
radius = 0.25
intensity = 2
[[light]]
name = "e"
kind = "directional"
direction = [0, -7, 0]
[[path]]
moves = "camera"
positions = [[0, 0, 1], [0, 0, 2]]
frames = 30
)");
  EXPECT_EQ(scene.name, "all");
  EXPECT_EQ(scene.meshes.size(), 4u);
  EXPECT_FALSE(scene.meshes[1].casts);
  EXPECT_FALSE(scene.meshes[2].receives);
  EXPECT_EQ(std::get<Box>(*scene.meshes[3].shape).max, glm::vec3(1, 2, 3));
  ASSERT_EQ(scene.lights.size(), 5u);
  EXPECT_EQ(std::get<SpotLight>(scene.lights[0].kind).outer_degrees, 20);
  EXPECT_EQ(std::get<RectLight>(scene.lights[1].kind).half_v, glm::vec3(0, 0, 2));
  EXPECT_EQ(scene.lights[3].intensity, 2);
  EXPECT_EQ(std::get<DirectionalLight>(scene.lights[4].kind).direction, glm::vec3(0, -7, 0));
}

TEST(SceneToml, plane_faces_its_normal_and_turns_about_it) {
  const auto plane_of = [](const std::string& normal, const std::string& more) {
    const Scene scene =
        read("[[shape]]\nkind = \"plane\"\ncenter = [1, 2, 3]\nnormal = " + normal + "\nsize = [4, 6]\n" + more);
    return std::get<Plane>(*scene.meshes.at(0).shape);
  };
  // A floor: width along x, depth along z, cross(u, v) = +y.
  const Plane floor = plane_of("[0, 5, 0]", "");
  EXPECT_EQ(floor.half_u, glm::vec3(2, 0, 0));
  EXPECT_EQ(floor.half_v, glm::vec3(0, 0, -3));
  for (const char* normal : {"[0, 5, 0]", "[1, 0, 0]", "[0, 0, -1]", "[1, -2, 3]"})
    for (const char* turn : {"", "rotate_degrees = 30\n", "rotate_degrees = 90\n"}) {
      const Plane plane = plane_of(normal, turn);
      glm::vec3 n;
      std::sscanf(normal, "[%f, %f, %f]", &n.x, &n.y, &n.z);
      const glm::vec3 across = glm::cross(plane.half_u, plane.half_v);
      EXPECT_NEAR(glm::dot(glm::normalize(across), glm::normalize(n)), 1, 1e-6) << normal << turn;
      EXPECT_NEAR(glm::length(plane.half_u), 2, 1e-6);
      EXPECT_NEAR(glm::length(plane.half_v), 3, 1e-6);
    }
}

TEST(SceneToml, mesh_files_are_relative_to_the_description) {
  const fs::path folder = fs::absolute(data_root() / "tests/data");
  const Scene scene = read("[[mesh]]\nfile = \"" + (folder / "tetrahedron.obj").string() +
                           "\"\nscale = [1, 2, 3]\ntranslate = [0, 0, 1]\nalbedo = [0.1, 0.2, 0.3]\ncasts = false\n");
  EXPECT_EQ(scene.bounds().max, glm::vec3(1, 2, 4));
  EXPECT_EQ(scene.meshes.at(0).albedo, glm::vec3(0.1f, 0.2f, 0.3f)) << "a given albedo overrides the material's";
  EXPECT_FALSE(scene.meshes[0].casts);
  expect_words(error_of("\n[[mesh]]\nfile = \"none.obj\"\n"), {"none.obj", "does not exist", "test.toml:3"});
}

TEST(SceneToml, a_scene_that_is_not_fetched_says_how_to_fetch_it) {
  try {
    read("[[mesh]]\nfile = \"cache:no_such_scene/x.obj\"\n");
    FAIL();
  } catch (const SceneNotFetched& error) {
    EXPECT_STREQ(error.what(), "scene no_such_scene is not fetched: run scripts/fetch_scenes no_such_scene");
  }
}

TEST(SceneToml, mistakes_have_a_file_and_a_line) {
  const std::string light = "[[light]]\nname = \"a\"\nkind = \"point\"\nposition = [0, 0, 0]\n";
  expect_words(error_of("nmae = \"x\"\n"), {"'nmae'", "'name'", "test.toml:1"});
  expect_words(error_of("[[shape]]\nkind = \"sphere\"\ncenter = [0, 0, 0]\nraduis = 1\n"),
               {"'raduis'", "'radius'", "test.toml:4"});
  expect_words(error_of("[[shape]]\nkind = \"spere\"\n"), {"'spere'", "sphere", "test.toml:2"});
  expect_words(error_of("[[shape]]\nkind = \"sphere\"\nradius = 1\n"), {"lacks", "'center'", "test.toml:1"});
  expect_words(error_of(sphere + "segments = 2\n"), {"segments = 2", "3 .. 4096", "test.toml:5"});
  expect_words(error_of(sphere + "segments = 12.5\n"), {"segments", "whole number", "test.toml:5"});
  expect_words(error_of(sphere + "casts = 1\n"), {"casts", "true or false", "test.toml:5"});
  expect_words(error_of(sphere + "albedo = [2, 0, 0]\n"), {"albedo = [2, 0, 0]", "0 .. 1", "test.toml:5"});
  expect_words(error_of("ambient = 2\n"), {"ambient = 2", "0 .. 1", "test.toml:1"});
  expect_words(error_of("[[shape]]\nkind = \"sphere\"\ncenter = [0, 0]\nradius = 1\n"), {"center", "[x, y, z]", "test.toml:3"});
  expect_words(error_of("[[shape]]\nkind = \"sphere\"\ncenter = [0, nan, 0]\nradius = 1\n"), {"center", "nan", "test.toml:3"});
  expect_words(error_of("[[shape]]\nkind = \"sphere\"\ncenter = [0, 0, 0]\nradius = 0\n"), {"radius = 0", "test.toml:4"});
  expect_words(error_of("[[shape]]\nkind = \"box\"\nmin = [0, 0, 0]\nmax = [0, 1, 1]\n"), {"box", "test.toml:1"});
  expect_words(error_of("[[shape]]\nkind = \"triangle\"\npoints = [[0,0,0],[1,1,1],[2,2,2]]\n"), {"triangle", "test.toml:1"});
  expect_words(error_of(light + light), {"'a'", "unique", "test.toml:6"});
  expect_words(error_of("[[light]]\nname = \"A b\"\nkind = \"point\"\nposition = [0, 0, 0]\n"), {"'A b'", "test.toml:2"});
  expect_words(
      error_of("[[light]]\nname = \"a\"\nkind = \"rect\"\ncenter = [0, 0, 0]\nhalf_u = [1, 0, 0]\nhalf_v = [2, 0, 0]\n"),
      {"no area", "test.toml:1"});
  expect_words(
      error_of("[[light]]\nname = \"a\"\nkind = \"spot\"\nposition = [0,0,0]\ndirection = [0,1,0]\nouter_degrees = 90\n"),
      {"outer_degrees = 90", "test.toml:1"});
  expect_words(error_of("\n[[view]]\nname = \"v\"\neye = [1, 1, 1]\ntarget = [1, 1, 1]\n"), {"eye = target", "test.toml:2"});
  expect_words(error_of("[view]\neye = [1, 1, 1]\n"), {"[[view]]", "test.toml:1"});
  expect_words(error_of("[[path]]\nmoves = \"eye\"\npositions = [[0,0,0],[1,0,0]]\nframes = 3\n"),
               {"'eye'", "camera, light or mesh", "test.toml:2"});
  expect_words(error_of("[[path]]\nmoves = \"light\"\npositions = [[0,0,0]]\nframes = 3\n"), {"positions", "2 or more"});
  const std::string steps = "[[path]]\nmoves = \"light\"\npositions = [[0,0,0],[1,0,0],[2,0,0]]\nframes = 2\n";
  expect_words(error_of(steps + "steps = true\n"), {"positions = 3 vectors", "2 .. 2 vectors", "2 frames", "test.toml:3"});
  expect_words(error_of(steps + "steps = 1\n"), {"steps", "true or false", "test.toml:5"});
  for (const char* const name : {"camera_slide", "light_slide", "camera_jump", "light_jump"})
    expect_words(error_of(steps + fmt::format("name = \"{}\"\n", name)), {name, "every scene has a path", "test.toml:5"});
  expect_words(error_of("name = \n"), {"test.toml:1"});
}

TEST(SceneToml, a_path_in_steps_jumps) {
  const std::string path = "[[path]]\nmoves = \"light\"\npositions = [[0,1,0],[2,1,0]]\nframes = 5\n";
  const Path steps = read(path + "steps = true\n").paths.at(0);
  EXPECT_EQ(steps.frame_count, 5);
  EXPECT_EQ(steps.positions, (std::vector<glm::vec3>{{0, 1, 0}, {2, 1, 0}, {2, 1, 0}, {2, 1, 0}, {2, 1, 0}}));
  EXPECT_EQ(read(path + "steps = false\n").paths.at(0).positions, (std::vector<glm::vec3>{{0, 1, 0}, {2, 1, 0}}));
}

// Only the way matters: where float32 would lose squares of it, a power of ten is taken out before it is rounded. What is no
// longer and no shorter than usual stays as it is written.
TEST(SceneToml, directions_may_have_any_length) {
  const auto scene_with = [](const std::string& direction) {
    return read("[[shape]]\nkind = \"disc\"\ncenter = [0, 0, 0]\nradius = 1\nnormal = " + direction +
                "\n[[light]]\nname = \"a\"\nkind = \"directional\"\ndirection = " + direction +
                "\n[[light]]\nname = \"b\"\nkind = \"spot\"\nposition = [0, 5, 0]\ndirection = " + direction +
                "\n[[light]]\nname = \"c\"\nkind = \"disc\"\ncenter = [0, 5, 0]\nradius = 1\nnormal = " + direction +
                "\n[[view]]\nname = \"v\"\neye = [5, 5, 9]\ntarget = [0, 0, 0]\nup = " + direction + "\n");
  };
  const auto directions_of = [](const Scene& scene) {
    return std::vector<glm::vec3>{std::get<Disc>(*scene.meshes[0].shape).normal,
                                  std::get<DirectionalLight>(scene.lights[0].kind).direction,
                                  std::get<SpotLight>(scene.lights[1].kind).direction,
                                  std::get<DiscLight>(scene.lights[2].kind).normal, scene.views[0].up};
  };
  for (const char* length : {"e-300", "e-100", "e-38", "e-30", "e-20", "e-7", "e7", "e20", "e29"}) {
    const std::string direction = fmt::format("[-1{0}, -3{0}, 2{0}]", length);
    EXPECT_EQ(directions_of(scene_with(direction)), std::vector(5, glm::vec3(-1, -3, 2))) << direction;
  }
  for (const float length : {1e-5f, 0.1f, 7.0f, 3e5f}) {
    const glm::vec3 written = length * glm::vec3(-1, -3, 2);
    EXPECT_EQ(directions_of(scene_with(fmt::format("[{}, {}, {}]", written.x, written.y, written.z))), std::vector(5, written));
  }
  const std::string sun = "[[light]]\nname = \"a\"\nkind = \"directional\"\ndirection = ";
  expect_words(error_of(sun + "[0, 0, 0]\n"), {"direction = [0, 0, 0] is not a direction", "test.toml:4"});
  expect_words(error_of(sun + "[0, 1e-400, 0]\n"), {"test.toml:4"});
  expect_words(error_of(sun + "[0, inf, 0]\n"), {"direction = inf", "test.toml:4"});
  expect_words(error_of(sun + "[0, nan, 0]\n"), {"direction = nan", "test.toml:4"});
  expect_words(error_of(sun + "[0, 1e31, 0]\n"), {"1e+31", "-1e30 .. 1e30", "test.toml:4"});
}

TEST(SceneToml, described_scenes_of_the_house_are_sound_or_not_fetched) {
  for (const fs::directory_entry& entry : fs::directory_iterator(data_root() / "scenes")) {
    if (entry.path().extension() != ".toml") continue;
    try {
      const Scene scene = load_scene(entry.path().string());
      EXPECT_EQ(scene.name, entry.path().stem().string());
      EXPECT_EQ(scene.lights.at(0).name, "point");
      EXPECT_EQ(scene.lights.at(1).name, "sun");
      EXPECT_EQ(scene.views.at(0).name, "view");
    } catch (const SceneNotFetched&) {
    }
  }
}

}  // namespace scene_toml_test
