#include "measure/scene/blob.h"

#include <gnomon/error.h>
#include <gnomon/kit/geometry/shapes.h>
#include <gtest/gtest.h>

#include <fstream>

#include "measure/scene/fields.h"
#include "measure/scratch_folder.h"

namespace blob_test {

using namespace gnomon;
namespace fs = std::filesystem;

std::size_t file_count(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

/// Something in every field, every kind of shape and light.
Scene full_scene() {
  Scene scene;
  scene.name = "full";
  scene.ambient = 0.25f;
  const Shape shapes[] = {Sphere{{1, 2, 3}, 4},
                          Cone{{0, 1, 0}, {0, 2, 0}, 1, 2},
                          Disc{{0, 0, 1}, {1, 1, 0}, 2},
                          Triangle{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}},
                          Plane{},
                          Box{}};
  for (const Shape& shape : shapes)
    scene.meshes.push_back(painted(tessellate(shape, 5, std::string(kind_name(shape))), {0.1f, 0.2f, 0.3f}));
  scene.meshes[1].casts = false;
  scene.meshes[2].receives = false;
  scene.meshes[3].shape.reset();
  scene.lights = {{"a", PointLight{{1, 2, 3}}, 2},
                  {"b", SpotLight{{1, 2, 3}, {0, -2, 0}, 10, 25}},
                  {"c", DirectionalLight{{3, -1, 0}}},
                  {"d", RectLight{{1, 1, 1}, {2, 0, 0}, {0, 0, 3}}},
                  {"e", DiscLight{{0, 9, 0}, {0, -1, 0}, 2}},
                  {"f", SphereLight{{0, 9, 0}, 2}}};
  scene.views = {{"v", {1, 2, 3}, {4, 5, 6}, {0, 0, 1}, 33}, {}};
  scene.notes = {"one", ""};
  return scene;
}

TEST(blob, a_flag_that_is_neither_true_nor_false_is_refused) {
  const std::byte bytes[] = {std::byte{2}};
  bool flag = false;
  EXPECT_THROW(FieldReader(bytes, "too short")(flag), Error);
}

TEST(blob, a_count_takes_no_memory_for_what_is_not_there) {
  FieldWriter writer;
  writer(std::uint64_t{40});
  writer.bytes.resize(48);  // 40 texts would need 8 bytes each
  std::vector<std::string> texts;
  FieldReader reader(writer.bytes, "too short");
  EXPECT_THROW(reader.list(texts, [](auto& io, auto& text) { io(text); }), Error);
  EXPECT_LE(texts.size(), 6u);
}

TEST(blob, a_scene_comes_back_as_it_was) {
  const Scene scene = full_scene(), back = scene_from_bytes(scene_bytes(scene));
  EXPECT_EQ(back.name, "full");
  EXPECT_EQ(back.ambient, 0.25f);
  ASSERT_EQ(back.meshes.size(), 6u);
  for (std::size_t m = 0; m < 6; ++m) {
    const Mesh &a = scene.meshes[m], &b = back.meshes[m];
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.positions, b.positions);
    EXPECT_EQ(a.triangles, b.triangles);
    EXPECT_EQ(a.casts, b.casts);
    EXPECT_EQ(a.receives, b.receives);
    EXPECT_EQ(a.albedo, b.albedo);
    EXPECT_EQ(a.facts.boundary_edge_count, b.facts.boundary_edge_count);
    ASSERT_EQ(a.shape.has_value(), b.shape.has_value());
    EXPECT_EQ(a.shape ? a.shape->index() : 99, b.shape ? b.shape->index() : 99);
  }
  EXPECT_EQ(std::get<Sphere>(*back.meshes[0].shape).radius, 4);
  ASSERT_EQ(back.lights.size(), 6u);
  for (std::size_t l = 0; l < 6; ++l) {
    EXPECT_EQ(scene.lights[l].name, back.lights[l].name);
    EXPECT_EQ(kind_name(scene.lights[l]), kind_name(back.lights[l]));
    EXPECT_EQ(homogeneous_of_center(scene.lights[l]), homogeneous_of_center(back.lights[l]));
  }
  EXPECT_EQ(std::get<SpotLight>(back.lights[1].kind).outer_degrees, 25);
  EXPECT_EQ(back.views.at(0).up, glm::vec3(0, 0, 1));
  EXPECT_EQ(back.notes, scene.notes);
  // Whatever is not compared above would show here.
  EXPECT_EQ(scene_bytes(back), scene_bytes(scene));
}

TEST(blob, every_change_that_a_technique_can_see_changes_the_bytes) {
  const std::string hash = content_hash(scene_bytes(full_scene()));
  const auto changed = [&](auto change) {
    Scene scene = full_scene();
    change(scene);
    return content_hash(scene_bytes(scene)) != hash;
  };
  EXPECT_FALSE(changed([](Scene&) {}));
  EXPECT_TRUE(changed([](Scene& s) { s.meshes[0].positions[0].x = std::nextafter(s.meshes[0].positions[0].x, 9.0f); }));
  EXPECT_TRUE(changed([](Scene& s) { s.meshes[0].casts = false; }));
  EXPECT_TRUE(changed([](Scene& s) { s.meshes[0].receives = false; }));
  EXPECT_TRUE(changed([](Scene& s) { s.meshes[0].shape.reset(); }));
  EXPECT_TRUE(changed([](Scene& s) { std::get<Sphere>(*s.meshes[0].shape).radius = 5; }));
  EXPECT_TRUE(changed([](Scene& s) { std::swap(s.meshes[0], s.meshes[1]); }));
  EXPECT_TRUE(changed([](Scene& s) { s.lights[1].intensity = 3; }));
  EXPECT_TRUE(changed([](Scene& s) { s.views[0].fov_y_degrees = 34; }));
}

// Under a light without area the hash is that of the scene before it had any with area: kept records stay true.
TEST(blob, a_light_with_area_is_no_part_of_what_other_lights_rows_know) {
  const Scene scene = full_scene();
  Scene hard = scene;
  std::erase_if(hard.lights, [](const Light& light) { return has_area(light); });
  ASSERT_EQ(hard.lights.size(), 3u);
  Scene bare = hard;  // what the loader said of a file is no part of it either
  bare.notes.clear();
  bare.meshes[0].facts.degenerate_count = 0;
  hard.meshes[0].facts.degenerate_count = 7;
  const Light &point = scene.lights[0], &sun = scene.lights[2], &rect = scene.lights[3], &disc = scene.lights[4];
  EXPECT_EQ(scene_hash(hard, point), content_hash(scene_bytes(bare)));
  EXPECT_EQ(scene_hash(scene, point), scene_hash(hard, point));
  EXPECT_EQ(scene_hash(scene, sun), scene_hash(hard, point));
  EXPECT_NE(scene_hash(scene, rect), scene_hash(scene, point));
  EXPECT_NE(scene_hash(scene, rect), scene_hash(scene, disc));
  Scene other = scene;
  std::get<RectLight>(other.lights[3].kind).center.x = 5;
  EXPECT_EQ(scene_hash(other, point), scene_hash(scene, point));
  EXPECT_EQ(scene_hash(other, disc), scene_hash(scene, disc));
  EXPECT_NE(scene_hash(other, other.lights[3]), scene_hash(scene, rect));
  std::get<PointLight>(other.lights[0].kind).position.x = 5;
  EXPECT_NE(scene_hash(other, sun), scene_hash(scene, sun));
  EXPECT_NE(scene_hash(other, disc), scene_hash(scene, disc));
}

TEST(blob, bytes_that_end_early_or_have_another_layout_are_errors) {
  std::vector<std::byte> bytes = scene_bytes(full_scene());
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_THROW(scene_from_bytes(std::span(bytes).first(size)), Error) << size;
  bytes[0] ^= std::byte{0x40};
  EXPECT_THROW(scene_from_bytes(bytes), Error);
}

TEST(blob, content_hash_is_32_hex_digits) {
  const std::string hash = content_hash(std::string("gnomon"));
  EXPECT_EQ(hash.size(), 32u);
  EXPECT_EQ(hash.find_first_not_of("0123456789abcdef"), std::string::npos);
  EXPECT_NE(hash, content_hash(std::string("gnomom")));
}

TEST(blob, a_file_is_written_whole_into_folders_made_for_it) {
  const ScratchFolder folder = ScratchFolder::temporary("gnomon_blob");
  const fs::path file = folder.path() / "a/b/file";
  write_file(file, std::string("old and longer"));
  write_file(file, std::string("new"));
  const auto mapped = MappedFile::open(file);
  EXPECT_EQ(std::string(reinterpret_cast<const char*>(mapped->bytes().data()), mapped->bytes().size()), "new");
  EXPECT_EQ(std::distance(fs::directory_iterator(file.parent_path()), fs::directory_iterator()), 1);
  write_file(file, std::string());
  EXPECT_TRUE(MappedFile::open(file)->bytes().empty());
}

TEST(blob, a_reader_keeps_the_file_that_it_opened) {
  const ScratchFolder folder = ScratchFolder::temporary("gnomon_blob");
  write_file(folder.path() / "file", std::string("before"));
  const auto mapped = MappedFile::open(folder.path() / "file");
  write_file(folder.path() / "file", std::string("x"));
  EXPECT_EQ(std::string(reinterpret_cast<const char*>(mapped->bytes().data()), mapped->bytes().size()), "before");
}

TEST(blob, what_cannot_be_written_is_an_error_that_leaves_nothing) {
  const ScratchFolder folder = ScratchFolder::temporary("gnomon_blob");
  std::ofstream(folder.path() / "plain") << "a file, not a folder";
  EXPECT_THROW(write_file(folder.path() / "plain/file", std::string("x")), Error);
  fs::create_directories(folder.path() / "taken/inside");
  EXPECT_THROW(write_file(folder.path() / "taken", std::string("x")), Error);
  EXPECT_EQ(file_count(folder.path()), 2u);
  EXPECT_THROW(write_file("/dev/full/x", std::string("x")), Error);
  EXPECT_THROW(MappedFile::open(folder.path() / "nothing"), Error);
}

}  // namespace blob_test
