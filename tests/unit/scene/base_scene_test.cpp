// Descriptions that start from another scene: the same geometry to the bit, what replaces what, and chains that do not end.
#include "measure/scene/base_scene.h"

#include <gtest/gtest.h>

#include <cstring>
#include <fstream>

#include "measure/paths.h"
#include "measure/scene/load.h"
#include "measure/scratch_folder.h"

namespace base_scene_test {

using namespace gnomon;
namespace fs = std::filesystem;

const std::string light_a = "[[light]]\nname = \"a\"\nkind = \"point\"\nposition = [1, 2, 3]\n";
const std::string view_a = "[[view]]\nname = \"a\"\neye = [0, 0, 9]\ntarget = [0, 0, 0]\n";
const std::string path_a = "[[path]]\nname = \"a\"\nmoves = \"light\"\npositions = [[0, 9, 0], [1, 9, 0]]\nframes = 3\n";
const std::string sphere = "[[shape]]\nkind = \"sphere\"\ncenter = [0, 1, 0]\nradius = 1\n";

/// Each test writes its descriptions below a folder of its own.
class BaseScene : public testing::Test {
 protected:
  fs::path write(const std::string& name, const std::string& text) const {
    fs::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }
  /// Loads `text` as top.toml.
  Scene load(const std::string& text) const { return load_scene(write("top.toml", text).string()); }
  /// What loading it complains of, without the name of the folder.
  std::string error_of(const std::string& text) const {
    try {
      load(text);
    } catch (const Error& error) {
      std::string words = error.what();
      const std::string prefix = folder_.string() + "/";
      for (std::size_t at; (at = words.find(prefix)) != std::string::npos;) words.erase(at, prefix.size());
      return words;
    }
    return "";
  }

  const ScratchFolder scratch_ = ScratchFolder::temporary("gnomon_base");
  const fs::path& folder_ = scratch_.path();
};

template <class Item>
std::string names(const std::vector<Item>& items) {
  std::string text;
  for (const Item& item : items) text += item.name + " ";
  return text;
}

void expect_words(const std::string& text, std::initializer_list<std::string> words) {
  for (const std::string& word : words) EXPECT_NE(text.find(word), std::string::npos) << "'" << word << "' is not in: " << text;
}

bool same_bits(const std::vector<glm::vec3>& a, const std::vector<glm::vec3>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(glm::vec3)) == 0;
}

/// The first meshes of `scene` are those of `base`, to the bit.
void expect_starts_with(const Scene& scene, const Scene& base) {
  ASSERT_GE(scene.meshes.size(), base.meshes.size());
  for (std::size_t i = 0; i < base.meshes.size(); ++i) {
    const Mesh &a = scene.meshes[i], &b = base.meshes[i];
    EXPECT_EQ(a.name, b.name);
    EXPECT_TRUE(same_bits(a.positions, b.positions)) << b.name;
    EXPECT_EQ(a.triangles, b.triangles) << b.name;
    EXPECT_EQ(a.shape.has_value(), b.shape.has_value()) << b.name;
    EXPECT_EQ(a.albedo, b.albedo) << b.name;
    EXPECT_TRUE(a.casts == b.casts && a.receives == b.receives) << b.name;
  }
}

TEST_F(BaseScene, alone_it_is_the_base_under_another_name) {
  for (const std::string reference : {"composite:object=sphere,light_x=1.7", "soup:count=20", "snowman"}) {
    const Scene base = load_scene(reference), scene = load("scene = \"" + reference + "\"\n");
    EXPECT_EQ(scene.name, "top");
    EXPECT_EQ(scene.meshes.size(), base.meshes.size());
    expect_starts_with(scene, base);
    EXPECT_EQ(scene.ambient, base.ambient);
    EXPECT_EQ(names(scene.lights), names(base.lights));
    EXPECT_EQ(homogeneous(scene.lights.at(0)), homogeneous(base.lights.at(0)));
    EXPECT_EQ(names(scene.views), names(base.views));
    EXPECT_EQ(scene.views.at(0).eye, base.views.at(0).eye);
    EXPECT_EQ(names(scene.paths), names(base.paths));
    EXPECT_EQ(scene.notes, base.notes);
  }
}

TEST_F(BaseScene, lights_views_and_paths_replace_the_bases_and_geometry_is_added) {
  write("base.toml", "name = \"base\"\nambient = 0.3\n" + sphere + light_a + view_a + path_a);
  const std::string start = "scene = \"base.toml\"\n";
  const auto renamed = [](std::string text) { return text.replace(text.find("\"a\""), 3, "\"b\""); };
  const auto all = [](const Scene& s) { return names(s.lights) + names(s.views) + names(s.paths); };
  EXPECT_EQ(all(load(start)), "a a a ");
  EXPECT_EQ(all(load(start + renamed(light_a))), "b a a ");
  EXPECT_EQ(all(load(start + renamed(view_a))), "a b a ");
  EXPECT_EQ(all(load(start + renamed(path_a))), "a a b ");
  EXPECT_EQ(all(load(start + light_a)), "a a a ") << "the base's light of the same name is gone: no clash";
  EXPECT_EQ(load(start).ambient, 0.3f);
  EXPECT_EQ(load("ambient = 0.1\n" + start).ambient, 0.1f);
  EXPECT_EQ(load("name = \"mine\"\n" + start).name, "mine");
  const Scene more = load(start + "[[shape]]\nkind = \"box\"\nmin = [2, 0, 0]\nmax = [3, 1, 1]\n");
  EXPECT_EQ(names(more.meshes), "sphere_0 box_1 ");
  expect_starts_with(more, load_scene((folder_ / "base.toml").string()));
}

TEST_F(BaseScene, files_are_relative_to_the_description_that_names_them) {
  fs::create_directories(folder_ / "meshes");
  fs::copy(data_root() / "tests/data/tetrahedron.ply", folder_ / "meshes/t.ply");
  write("meshes/placed.toml",
        "[[mesh]]\nfile = \"t.ply\"\nscale = 0.7\nrotate_degrees = [11, 23, 41]\ntranslate = [0.1, 0.2, 0.3]\n");
  write("deep/er/middle.toml", "scene = \"../../meshes/placed.toml\"\n" + light_a);
  const Scene placed = load_scene((folder_ / "meshes/placed.toml").string());
  const Scene scene = load("scene = \"deep/er/middle.toml\"\n" + view_a);
  EXPECT_EQ(scene.meshes.size(), 1u);
  expect_starts_with(scene, placed);
  EXPECT_EQ(names(scene.lights) + names(scene.views), "a a ");
  // A mesh file, not placed at all.
  expect_starts_with(load("scene = \"meshes/t.ply\"\n"), load_scene((folder_ / "meshes/t.ply").string()));
}

TEST_F(BaseScene, framing_fills_only_what_neither_brings) {
  fs::copy(data_root() / "tests/data/tetrahedron.obj", folder_ / "t.obj");
  fs::copy(data_root() / "tests/data/tetrahedron.mtl", folder_ / "tetrahedron.mtl");
  const std::string start = "scene = \"t.obj\"\n";
  const Scene base = load_scene((folder_ / "t.obj").string());
  ASSERT_EQ(base.notes.size(), 2u);
  const Scene bare = load(start), lit = load(start + light_a), seen = load(start + view_a),
              both = load(start + light_a + view_a);
  EXPECT_EQ(bare.notes, base.notes);
  EXPECT_EQ(bare.views.at(0).eye, base.views.at(0).eye);
  EXPECT_EQ(lit.notes, std::vector{base.notes[0]});
  EXPECT_EQ(names(lit.lights) + names(lit.views), "a view ");
  EXPECT_EQ(seen.notes, std::vector{base.notes[1]});
  EXPECT_EQ(names(seen.lights) + names(seen.views), "point sun a ");
  EXPECT_TRUE(both.notes.empty());
}

TEST_F(BaseScene, cameras_and_lights_of_a_base_file_are_the_bases) {
  fs::copy(data_root() / "tests/data/tetrahedron.glb", folder_ / "t.glb");
  const std::string start = "scene = \"t.glb\"\n";
  EXPECT_EQ(names(load(start).views), "front_camera ");
  EXPECT_EQ(names(load(start + view_a).views), "a ");
  EXPECT_EQ(load(start + view_a).lights.size(), 3u);
  EXPECT_EQ(names(load(start + light_a).lights), "a ");
  // Those of a mesh of this file come beside its own, as without a base.
  EXPECT_EQ(names(load("scene = \"snowman\"\n" + view_a + "[[mesh]]\nfile = \"t.glb\"\n").views), "a front_camera ");
}

TEST_F(BaseScene, a_mistake_says_where_once) {
  EXPECT_EQ(error_of("\nscene = 3\n"), "scene.scene = a number is not a text (top.toml:2)");
  EXPECT_EQ(error_of("scene = \"\"\n"), "scene.scene = '' is not the id or the file of a scene (top.toml:1)");
  expect_words(error_of("name = \"x\"\nscene = \"bunnny\"\n"),
               {"scene bunnny does not exist; did you mean bunny?", "top.toml:2"});
  expect_words(error_of("scene = \"soup:cout=5\"\n"), {"cout", "did you mean count?", "top.toml:1"});
  expect_words(error_of("secne = \"soup\"\n"), {"'secne'", "did you mean 'scene'?", "top.toml:1"});
  EXPECT_EQ(error_of("scene = \"gone.toml\"\n"), "gone.toml: does not exist (named in top.toml:1)");
  expect_words(error_of("scene = \"gone.ply\"\n"), {"gone.ply", "does not exist", "(named in top.toml:1)"});
  expect_words(error_of("scene = \"./gone\"\n"), {"gone", "does not exist", "(named in top.toml:1)"});
  write("a.toml", "\nscene = \"b.toml\"\n");
  write("b.toml", sphere + "raduis = 1\n");
  expect_words(error_of("scene = \"a.toml\"\n"), {"'raduis'", "(b.toml:5) (named in a.toml:2)"});
  EXPECT_EQ(error_of("scene = \"a.toml\"\n").find("top.toml"), std::string::npos);
  write("empty.toml", "name = \"nothing\"\n");
  expect_words(error_of("scene = \"empty.toml\"\n"), {"no geometry", "top.toml"});
}

TEST_F(BaseScene, a_chain_that_comes_back_is_refused) {
  EXPECT_EQ(error_of("scene = \"top.toml\"\n"), "scene comes back to itself: top.toml names top.toml (named in top.toml:1)");
  write("a.toml", "scene = \"b.toml\"\n");
  write("b.toml", "\nscene = \"a.toml\"\n");
  EXPECT_EQ(error_of("scene = \"a.toml\"\n"),
            "scene comes back to itself: a.toml names b.toml names a.toml (named in b.toml:2)");
  // The same file by another way.
  fs::create_directories(folder_ / "in");
  fs::create_symlink(folder_, folder_ / "in/out");
  expect_words(error_of("scene = \"in/out/top.toml\"\n"), {"comes back to itself"});
}

TEST_F(BaseScene, chains_may_be_long_but_not_endless) {
  write("0.toml", sphere);
  for (int i = 1; i <= 64; ++i) write(std::to_string(i) + ".toml", "scene = \"" + std::to_string(i - 1) + ".toml\"\n");
  // 64 descriptions: 63 below the first.
  EXPECT_EQ(error_of("scene = \"62.toml\"\n"), "");
  EXPECT_EQ(error_of("scene = \"63.toml\"\n"),
            "0.toml: more than 64 descriptions, each of which names the next as its scene (named in 1.toml:1)");
}

TEST_F(BaseScene, what_is_not_fetched_is_said_as_of_the_base_itself) {
  write("a.toml", "[[mesh]]\nfile = \"cache:no_such_scene/x.obj\"\n");
  for (const char* text : {"scene = \"a.toml\"\n", "scene = \"cache:no_such_scene/x.obj\"\n"}) {
    try {
      load(text);
      FAIL();
    } catch (const SceneNotFetched& error) {
      EXPECT_STREQ(error.what(), "scene no_such_scene is not fetched: run scripts/fetch_scenes no_such_scene");
    }
    EXPECT_FALSE(is_fetched((folder_ / "top.toml").string()));
  }
}

TEST_F(BaseScene, what_needs_no_fetched_file_is_fetched) {
  for (const char* text : {"scene = \"soup:count=5\"\n", "scene = \"snowman\"\n", "scene = \"gone.toml\"\n",
                           "scene = \"unknown\"\n", "scene = \"top.toml\"\n", "scene = 3\n", "scene = \n", ""})
    EXPECT_TRUE(is_fetched(write("top.toml", text).string())) << text;
}

}  // namespace base_scene_test
