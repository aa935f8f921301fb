// Imports of good and damaged mesh files, placement, framing, and what --scene may say.
#include "measure/scene/load.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <set>
#include <tuple>

#include "error_words.h"
#include "measure/paths.h"
#include "measure/scene/import.h"
#include "measure/scratch_folder.h"

namespace load_test {

using namespace gnomon;
using error_words::error_of;
namespace fs = std::filesystem;

/// A folder that is gone at the end of the test.
struct Folder {
  ScratchFolder scratch = ScratchFolder::temporary("gnomon_load");
  const fs::path& path = scratch.path();
  fs::path write(const std::string& name, const std::string& bytes) const {
    std::ofstream(path / name, std::ios::binary) << bytes;
    return path / name;
  }
};

fs::path data(const std::string& name) { return data_root() / "tests/data" / name; }

std::string read(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

Scene import(const fs::path& file, const Placement& placement = {}) {
  Scene scene;
  import_file(file, placement, scene);
  return scene;
}

std::string import_error(const fs::path& file) {
  return error_of([&] { import(file); });
}

/// Asserts that the text holds every word.
void expect_words(const std::string& text, std::initializer_list<std::string> words) {
  for (const std::string& word : words) EXPECT_NE(text.find(word), std::string::npos) << "'" << word << "' is not in: " << text;
}

/// Triangles as sorted corners, the smallest corner first, winding kept.
using Corner = std::tuple<float, float, float>;
std::multiset<std::array<Corner, 3>> triangles_of(const Scene& scene) {
  std::multiset<std::array<Corner, 3>> result;
  for (const Mesh& mesh : scene.meshes)
    for (const glm::uvec3& t : mesh.triangles) {
      std::array<Corner, 3> corners;
      for (int k = 0; k < 3; ++k) {
        const glm::vec3& p = mesh.positions[t[k]];
        corners[k] = {p.x, p.y, p.z};
      }
      std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
      result.insert(corners);
    }
  return result;
}

double area(const Scene& scene) {
  double sum = 0;
  for (const Mesh& mesh : scene.meshes)
    for (const glm::uvec3& t : mesh.triangles) {
      const glm::dvec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
      sum += glm::length(glm::cross(b - a, c - a)) / 2;
    }
  return sum;
}

constexpr const char* ply_head =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n";

TEST(Import, every_format_gives_the_same_tetrahedron) {
  // Corners (0,0,0), (1,0,0), (0,1,0), (0,0,1), counter-clockwise from outside.
  const Corner o{0, 0, 0}, x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  const std::multiset<std::array<Corner, 3>> expected = {{o, y, x}, {o, x, z}, {o, z, y}, {z, x, y}};
  for (const char* extension : {"obj", "ply", "stl", "off", "gltf", "glb"}) {
    Scene scene = import(data(std::string("tetrahedron.") + extension));
    EXPECT_EQ(triangles_of(scene), expected) << extension;
    finish_scene(scene, "test");
    EXPECT_TRUE(scene.meshes.at(0).facts.closed()) << extension;
    EXPECT_EQ(scene.meshes.at(0).positions.size(), 4u) << extension << ": equal positions become one vertex";
  }
}

TEST(Import, material_color_is_the_albedo) {
  for (const char* name : {"tetrahedron.obj", "tetrahedron.gltf"})
    EXPECT_EQ(import(data(name)).meshes.at(0).albedo, glm::vec3(0.25f, 0.5f, 0.75f)) << name;
  EXPECT_EQ(import(data("tetrahedron.ply")).meshes.at(0).albedo, glm::vec3(0.7f)) << "no material: the default";
}

TEST(Import, gltf_camera_and_lights_are_honored) {
  for (const char* name : {"tetrahedron.gltf", "tetrahedron.glb"}) {
    const Scene scene = import(data(name));
    ASSERT_EQ(scene.views.size(), 1u);
    EXPECT_EQ(scene.views[0].name, "front_camera");
    EXPECT_EQ(scene.views[0].eye, glm::vec3(0, 1, 5));
    // It looks along -z: the target shares x and y with the eye.
    EXPECT_EQ(glm::vec2(scene.views[0].target), glm::vec2(0, 1));
    EXPECT_LT(scene.views[0].target.z, 5);
    EXPECT_NEAR(scene.views[0].fov_y_degrees, glm::degrees(0.5), 1e-4) << "yfov = 0.5 in the file";
    ASSERT_EQ(scene.lights.size(), 3u);
    EXPECT_EQ(scene.lights[0].name, "key_light");
    EXPECT_EQ(std::get<PointLight>(scene.lights[0].kind).position, glm::vec3(1, 2, 3));
    // A rotation of -90 degrees about x takes -z to -y.
    const auto& spot = std::get<SpotLight>(scene.lights[1].kind);
    EXPECT_EQ(spot.position, glm::vec3(0, 4, 0));
    EXPECT_NEAR(glm::distance(spot.direction, glm::vec3(0, -1, 0)), 0, 1e-6);
    EXPECT_NEAR(spot.inner_degrees, glm::degrees(0.25), 1e-4);
    EXPECT_NEAR(spot.outer_degrees, glm::degrees(0.5), 1e-4);
    EXPECT_NEAR(glm::distance(std::get<DirectionalLight>(scene.lights[2].kind).direction, glm::vec3(0, -1, 0)), 0, 1e-6);
  }
}

TEST(Import, placement_moves_cameras_and_lights_along) {
  const Placement placement{.scale = glm::dvec3(2), .rotate_degrees = {0, 90, 0}, .translate = {10, 0, 0}};
  const Scene scene = import(data("tetrahedron.glb"), placement);
  // Rotation by 90 degrees about y takes (x, y, z) to (z, y, -x): eye 2 (0,1,5) -> (10,2,0) -> + (10,0,0); -z -> -x.
  EXPECT_EQ(scene.views.at(0).eye, glm::vec3(20, 2, 0));
  EXPECT_LT(scene.views.at(0).target.x, 20);
  EXPECT_EQ(std::get<PointLight>(scene.lights.at(0).kind).position, glm::vec3(16, 4, -2));
}

TEST(Import, concave_polygon_keeps_its_area) {
  // arrow.obj: shaft 4 x 2, head with base 4 and height 3: 8 + 6. A fan from its first corner would cover more.
  const Scene scene = import(data("arrow.obj"));
  EXPECT_EQ(scene.triangle_count(), 5u);
  EXPECT_DOUBLE_EQ(area(scene), 14);
}

TEST(Placement, applies_scale_rotations_and_translation_in_that_order_exactly) {
  const Placement placement{.scale = {2, 3, 4}, .rotate_degrees = {90, 90, 90}, .translate = {100, 200, 300}};
  // (1,1,1) -> scale (2,3,4) -> about x: (2,-4,3) -> about y: (3,-4,-2) -> about z: (4,3,-2) -> + t.
  EXPECT_EQ(placement.apply({1, 1, 1}), glm::dvec3(104, 203, 298));
}

TEST(Placement, rounds_once) {
  // float(0.1 + 0.6) and 0.1f + 0.6f, the sum of rounded numbers, differ by one bit.
  const Placement placement{.scale = glm::dvec3(0.1), .rotate_degrees = {0, 0, 0}, .translate = glm::dvec3(0.6)};
  const Scene scene = import(data("tetrahedron.ply"), placement);
  EXPECT_EQ(scene.bounds().max, glm::vec3(static_cast<float>(0.1 * 1.0 + 0.6)));
}

TEST(ImportErrors, files_that_cannot_be_opened) {
  const Folder folder;
  expect_words(import_error(folder.path / "none.obj"), {"none.obj", "does not exist"});
  fs::create_directory(folder.path / "folder.obj");
  expect_words(import_error(folder.path / "folder.obj"), {"directory"});
  expect_words(import_error(folder.write("empty.obj", "")), {"empty.obj", "is empty"});
  expect_words(import_error(folder.write("picture.xyzzy", "1")), {"'.xyzzy'", "obj, ply"});
  expect_words(import_error(folder.write("noise.ply", "this is no mesh")), {"noise.ply"});
  ASSERT_EQ(mkfifo((folder.path / "pipe.obj").c_str(), 0600), 0);
  expect_words(import_error(folder.path / "pipe.obj"), {"not a regular file"});
}

TEST(ImportErrors, files_without_faces) {
  const Folder folder;
  expect_words(import_error(folder.write("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n")), {"points.obj"});
  expect_words(import_error(folder.write("lines.obj", "v 0 0 0\nv 1 0 0\nl 1 2\n")), {"has no faces"});
  expect_words(import_error(folder.write("none.off", "OFF\n0 0 0\n")), {"none.off"});
}

TEST(ImportErrors, coordinates_that_are_no_numbers_name_mesh_and_vertex) {
  const Folder folder;
  for (const char* bad : {"nan", "inf", "1e50", "1e31"}) {
    const std::string body = std::string("0 0 0\n1 0 0\n0 ") + bad + " 0\n3 0 1 2\n";
    expect_words(import_error(folder.write("bad.ply", ply_head + body)), {"bad.ply", "mesh '", "vertex 2", "1e17"});
  }
}

TEST(ImportErrors, indices_out_of_range_are_refused) {
  const Folder folder;
  expect_words(import_error(folder.write("bad.ply", std::string(ply_head) + "0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n")),
               {"bad.ply:13", "face 0", "vertex 7", "0 .. 2"});
  expect_words(import_error(folder.write("bad.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n")),
               {"bad.off:6", "face 0", "vertex 7", "0 .. 2"});
  expect_words(import_error(folder.write("bad.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n")),
               {"bad.obj:4", "vertex 9", "1 .. 3"});
}

TEST(ImportErrors, truncated_files_are_refused_wherever_they_are_cut) {
  // A cut inside the last bytes that only end a line or pad the file loses nothing; before them it is always an error.
  const Folder folder;
  for (const char* name : {"tetrahedron.ply", "tetrahedron.off", "tetrahedron.stl", "tetrahedron.glb", "tetrahedron.gltf"}) {
    const std::string whole = read(data(name));
    const std::size_t last = whole.size() - (whole.ends_with("tetrahedron\n") ? 16 : 4);
    for (std::size_t size = 1; size < last; size += 1 + whole.size() / 23)
      EXPECT_NE(import_error(folder.write(name, whole.substr(0, size))), "") << name << " cut to " << size << " bytes";
  }
}

TEST(ImportErrors, a_binary_ply_cut_anywhere_is_refused) {
  // Three vertices of 12 bytes, one face of 1 + 3 * 4; all zero bytes but the count of corners.
  const Folder folder;
  const std::string head =
      "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  std::string body(36 + 1 + 12, '\0');
  body[36] = 3;
  for (std::size_t size = 0; size < body.size(); ++size)
    expect_words(import_error(folder.write("cut.ply", head + body.substr(0, size))), {"cut.ply", "truncated"});
}

TEST(ImportErrors, a_binary_stl_shorter_than_its_count_is_refused) {
  const Folder folder;
  std::string bytes(84 + 50, '\0');
  bytes[80] = 2;
  expect_words(import_error(folder.write("short.stl", bytes)), {"134 bytes", "184", "truncated"});
}

TEST(ImportErrors, a_missing_gltf_buffer_is_refused) {
  const Folder folder;
  const std::string text = R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":72,"uri":"none.bin"}]})";
  expect_words(import_error(folder.write("buffer.gltf", text)), {"none.bin", "does not exist"});
}

TEST(ImportChild, its_end_is_an_error_that_says_how) {
  using importing::output_of_fork;
  const auto end_of = [](const std::function<int(int)>& body) { return error_of([&] { output_of_fork("file.obj", body); }); };
  expect_words(end_of([](int) -> int { std::abort(); }), {"file.obj", "crashed", "Abort"});
  expect_words(end_of([](int) -> int { return raise(SIGKILL); }), {"file.obj", "memory"});
  expect_words(end_of([](int) { return 7; }), {"file.obj", "status 7"});
  expect_words(end_of([](int) -> int {
                 alarm(1);
                 for (;;) pause();
               }),
               {"file.obj", "did not finish"});
  EXPECT_EQ(output_of_fork("x", [](int fd) { return write(fd, "abc", 3) == 3 ? 0 : 1; }).size(), 3u);
}

TEST(Framing, sees_all_vertices_and_stands_outside) {
  Scene scene = import(data("tetrahedron.obj"), {.scale = {5, 1, 40}, .translate = {300, -20, 1}});
  add_framing(scene);
  ASSERT_EQ(scene.views.size(), 1u);
  ASSERT_EQ(scene.lights.size(), 2u);
  EXPECT_EQ(scene.lights[0].name, "point");
  EXPECT_EQ(scene.lights[1].name, "sun");
  EXPECT_EQ(scene.notes.size(), 2u);
  const View& view = scene.views[0];
  const glm::dvec3 eye(view.eye), forward = glm::normalize(glm::dvec3(view.target) - eye);
  const glm::dvec3 right = glm::normalize(glm::cross(forward, glm::dvec3(view.up))), up = glm::cross(right, forward);
  const double slope = std::tan(glm::radians(view.fov_y_degrees / 2.0));
  const Bounds bounds = scene.bounds();
  for (const glm::vec3& p : scene.meshes.at(0).positions) {
    const glm::dvec3 q = glm::dvec3(p) - eye;
    const double depth = glm::dot(q, forward);
    EXPECT_GT(depth, 0);
    EXPECT_LT(std::abs(glm::dot(q, right)), depth * slope);
    EXPECT_LT(std::abs(glm::dot(q, up)), depth * slope);
  }
  const glm::vec3 light = std::get<PointLight>(scene.lights[0].kind).position;
  EXPECT_GT(light.y, bounds.max.y);
  check(scene.lights[1], "test");
}

TEST(LoadScene, an_unknown_id_names_the_nearest) {
  expect_words(error_of([] { load_scene("bunnny"); }), {"bunnny", "did you mean bunny?", "dragon", "terrain"});
  expect_words(error_of([] { load_scene("bunny:size=3"); }), {"bunny", "no parameters"});
}

TEST(LoadScene, takes_a_mesh_file_and_frames_it) {
  const Scene scene = load_scene(data("tetrahedron.obj").string());
  EXPECT_EQ(scene.name, "tetrahedron");
  EXPECT_EQ(scene.views.size(), 1u);
  EXPECT_EQ(scene.lights.size(), 2u);
}

TEST(LoadScene, every_listed_scene_has_a_title_and_a_summary) {
  std::set<std::string> ids;
  for (const SceneListing& listing : list_scenes()) {
    EXPECT_TRUE(ids.insert(listing.id).second) << listing.id;
    EXPECT_FALSE(listing.title.empty()) << listing.id;
    EXPECT_FALSE(listing.summary.empty()) << listing.id;
  }
  EXPECT_TRUE(ids.contains("bunny"));
}

TEST(FinishScene, refuses_what_no_technique_could_take) {
  const auto error = [](auto spoil) {
    Scene scene = import(data("tetrahedron.obj"));
    add_framing(scene);
    spoil(scene);
    return error_of([&] { finish_scene(scene, "here"); });
  };
  EXPECT_EQ(error([](Scene&) {}), "");
  expect_words(error([](Scene& s) { s.meshes.clear(); }), {"no geometry", "here"});
  expect_words(error([](Scene& s) { s.meshes[0].positions[1].y = NAN; }), {"vertex 1", "nan"});
  expect_words(error([](Scene& s) { s.meshes[0].triangles[2].z = 9; }), {"triangle 2", "index 9", "0 .. 3"});
  expect_words(error([](Scene& s) { s.lights[1].name = "point"; }), {"'point'", "twice"});
  expect_words(error([](Scene& s) { s.views[0].name = "My View"; }), {"'My View'"});
  expect_words(error([](Scene& s) { s.views[0].eye = s.views[0].target; }), {"eye = target"});
  expect_words(error([](Scene& s) { s.views[0].up = s.views[0].target - s.views[0].eye; }), {"line of sight"});
  expect_words(error([](Scene& s) { s.lights[0].kind = SphereLight{.radius = 0}; }), {"radius = 0"});
  expect_words(error([](Scene& s) { s.lights[0].kind = RectLight{.half_u = {1, 0, 0}, .half_v = {2, 0, 0}}; }), {"no area"});
  expect_words(error([](Scene& s) { s.lights[0].kind = DirectionalLight{glm::vec3(0)}; }), {"direction"});
}

// A generator gives float32: what is left of its directions is kept, at a length that can be squared.
TEST(FinishScene, directions_of_generators_may_have_any_length) {
  for (const float length : {0x1p-120f, 0x1p-60f, 0x1p40f, 0x1p120f}) {
    Scene scene = import(data("tetrahedron.obj"));
    add_framing(scene);
    const glm::vec3 way(-1, -3, 2);
    scene.lights[0].kind = SpotLight{.position = {0, 5, 0}, .direction = length * way};
    scene.lights[1].kind = DirectionalLight{length * way};
    scene.views[0].up = length * way;
    finish_scene(scene, "here");
    for (const glm::vec3& v : {std::get<SpotLight>(scene.lights[0].kind).direction,
                               std::get<DirectionalLight>(scene.lights[1].kind).direction, scene.views[0].up}) {
      EXPECT_GE(extent(v), 1) << length;
      EXPECT_LE(extent(v), 10) << length;
      EXPECT_LT(glm::distance(glm::normalize(v), glm::normalize(way)), 1e-6) << length;
    }
  }
}

}  // namespace load_test
