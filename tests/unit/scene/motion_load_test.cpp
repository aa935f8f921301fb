// Scenes of glTF files that move, and of descriptions that start from such, as --scene names them.
#include <gtest/gtest.h>

#include <fstream>

#include "../error_words.h"
#include "../formats/gltf_made.h"
#include "measure/scene/load.h"
#include "measure/scratch_folder.h"

namespace motion_load_test {

using namespace gnomon;
using error_words::error_of, error_words::expect_words;
namespace fs = std::filesystem;

/// A folder with folk.gltf: a square, which in a second of `walk` moves by 2 along z, and a second one, which grows from no
/// size to 1.
struct Folder {
  ScratchFolder scratch = ScratchFolder::temporary("gnomon_motion");
  const fs::path& path = scratch.path();

  Folder() {
    gltf_made::Gltf file;
    file.add_square();
    file.primitive()["mode"] = 5;  // two triangles
    const std::size_t times = file.accessor(std::vector<float>{0, 1}, "SCALAR", 1);
    const std::size_t moves = file.accessor(std::vector<float>{0, 0, 0, 0, 0, 2}, "VEC3", 3);
    const std::size_t sizes = file.accessor(std::vector<float>{0, 0, 0, 1, 1, 1}, "VEC3", 3);
    file.json["scenes"][0]["nodes"] = {0, 1};
    file.json["nodes"] = Json::array({json_object({{"mesh", 0}}), json_object({{"mesh", 0}, {"scale", {0, 0, 0}}})});
    Json animation = json_object({{"name", "walk"}, {"channels", Json::array()}, {"samplers", Json::array()}});
    const auto add_channel = [&](std::size_t node, const char* path, std::size_t output) {
      const std::size_t sampler = animation["samplers"].size();
      animation["channels"].push_back(json_object({{"sampler", sampler}, {"target", {{"node", node}, {"path", path}}}}));
      animation["samplers"].push_back(json_object({{"input", times}, {"output", output}}));
    };
    add_channel(0, "translation", moves);
    add_channel(1, "scale", sizes);
    file.json["animations"] = Json::array({animation});
    file.json["buffers"] = Json::array({json_object({{"byteLength", file.bytes.size()}, {"uri", "folk.bin"}})});
    write("folk.bin", file.bytes);
    write("folk.gltf", json_text(file.json));
  }
  std::string write(const std::string& name, const std::string& bytes) const {
    std::ofstream(path / name, std::ios::binary) << bytes;
    return (path / name).string();
  }
  Scene load(const std::string& name) const { return load_scene((path / name).string()); }
};

TEST(motion_load, a_file_is_as_it_stands_without_a_time_and_posed_with_one) {
  const Folder folder;
  const Scene rest = folder.load("folk.gltf");
  ASSERT_EQ(rest.meshes.size(), 2u) << "the second square has no size, and will have one";
  EXPECT_EQ(rest.meshes[1].triangles.size(), 2u);
  EXPECT_EQ(rest.meshes[1].facts.boundary_edge_count, 4u) << "as it will be";
  EXPECT_FALSE(error_words::has_note(rest, "without area"));
  ASSERT_TRUE(rest.motion);
  ASSERT_EQ(rest.motion->animations.size(), 1u);
  EXPECT_EQ(rest.motion->animations[0].name, "walk");
  EXPECT_EQ(rest.motion->rigs.size(), 2u);
  EXPECT_EQ(rest.meshes[0].positions[0].z, 0);

  const Scene still = folder.load("folk.gltf@walk=0.5");
  EXPECT_FALSE(still.motion);
  ASSERT_EQ(still.meshes.size(), 2u);
  EXPECT_EQ(still.meshes[0].positions[0].z, 1);
  EXPECT_EQ(still.meshes[1].positions[3], glm::vec3(0.5f, 0.5f, 0));
  EXPECT_EQ(folder.load("folk.gltf@0.5").meshes[0].positions, still.meshes[0].positions) << "the first animation";
}

TEST(motion_load, a_description_hands_the_motion_of_its_base_and_of_its_files_on) {
  const Folder folder;
  folder.write("two.toml",
               "scene = \"folk.gltf\"\n[[mesh]]\nfile = \"folk.gltf\"\nscale = 2\ntranslate = [5, 0, 0]\n"
               "[[light]]\nname = \"a\"\nkind = \"point\"\nposition = [0, 9, 0]\n");
  const Scene rest = folder.load("two.toml");
  ASSERT_TRUE(rest.motion);
  ASSERT_EQ(rest.motion->animations.size(), 2u);
  EXPECT_EQ(rest.motion->animations[1].name, "walk_2");
  ASSERT_EQ(rest.meshes.size(), 4u) << "two of the base, two of the file";
  EXPECT_EQ(rest.motion->rigs.at(2).mesh, 2u);

  const Scene first = folder.load("two.toml@walk=1"), second = folder.load("two.toml@walk_2=1");
  ASSERT_EQ(first.meshes.size(), 3u) << "base, its second square, the file's first";
  EXPECT_EQ(first.meshes[0].positions[3], glm::vec3(1, 1, 2));
  EXPECT_EQ(first.meshes[2].positions[3], glm::vec3(7, 2, 0));
  ASSERT_EQ(second.meshes.size(), 3u) << "the base's first, the file's two";
  EXPECT_EQ(second.meshes[0].positions[3], glm::vec3(1, 1, 0));
  EXPECT_EQ(second.meshes[1].positions[3], glm::vec3(7, 2, 4)) << "2 along z, scaled by 2";
}

TEST(motion_load, a_description_may_start_from_a_time) {
  const Folder folder;
  folder.write("still.toml", "scene = \"folk.gltf@1\"\n");
  const Scene still = folder.load("still.toml");
  EXPECT_FALSE(still.motion);
  ASSERT_EQ(still.meshes.size(), 2u);
  EXPECT_EQ(still.meshes[0].positions[0].z, 2);
}

TEST(motion_load, an_animation_that_is_not_there_is_refused_with_those_that_are) {
  const Folder folder;
  const auto error_of = [&](const std::string& name) { return error_words::error_of([&] { folder.load(name); }); };
  error_words::expect_words(error_of("folk.gltf@wolk=1"), {"wolk", "did you mean walk?"});
  folder.write("wall.toml", "[[shape]]\nkind = \"box\"\nmin = [0, 0, 0]\nmax = [1, 1, 1]\n");
  error_words::expect_words(error_of("wall.toml@1"), {"no animation"});
}

TEST(motion_load, stills_without_view_and_light_are_framed_as_the_scene_at_rest) {
  const Folder folder;
  const Scene rest = folder.load("folk.gltf");
  for (const char* time : {"0", "0.5", "1"}) {
    const Scene still = folder.load(fmt::format("folk.gltf@{}", time));
    EXPECT_EQ(still.views[0].eye, rest.views[0].eye) << time;
    EXPECT_EQ(still.views[0].target, rest.views[0].target) << time;
    EXPECT_EQ(std::get<PointLight>(still.lights[0].kind).position, std::get<PointLight>(rest.lights[0].kind).position) << time;
    EXPECT_NE(std::ranges::find(still.notes, "no view given: view 'view' frames the whole scene"), still.notes.end());
  }
}

TEST(motion_load, a_still_that_others_start_from_is_framed_with_what_they_add) {
  const Folder folder;
  const std::string box = "[[shape]]\nkind = 'box'\nmin = [-50, -50, -50]\nmax = [50, 50, 50]\n";
  folder.write("still.toml", "scene = 'folk.gltf@0.5'\n" + box);
  folder.write("rest.toml", "scene = 'folk.gltf'\n" + box);
  EXPECT_EQ(folder.load("still.toml").views[0].eye, folder.load("rest.toml").views[0].eye);
}

TEST(motion_load, errors_of_a_pose_name_the_file) {
  const Folder folder;
  expect_words(error_of([&] { folder.load("folk.gltf@run=1"); }), {"folk.gltf: ", "run"});
}

}  // namespace motion_load_test
