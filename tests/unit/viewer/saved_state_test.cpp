// What the viewer saves: descriptions that give back the very floats, and a command line that a shell splits into its words.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <bit>
#include <cstdio>
#include <fstream>

#include "app/viewer/saving.h"
#include "measure/scene/load.h"
#include "measure/scratch_folder.h"

namespace saved_state_test {

using namespace gnomon;
using viewer::Selection;
namespace fs = std::filesystem;

/// A folder that is gone at the end of the test, and this process works in it until then.
struct Folder {
  ScratchFolder scratch = ScratchFolder::temporary("gnomon_saved");
  const fs::path& path = scratch.path();
  const fs::path before = fs::current_path();
  Folder() { fs::current_path(path); }
  ~Folder() { fs::current_path(before); }
};

void write(const fs::path& file, const std::string& text) {
  if (file.has_parent_path()) fs::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << text;
}

std::string read(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// The state as it is read back from where it was saved.
Scene saved_and_loaded(const Selection& state, const fs::path& file) {
  const std::string text = viewer::state_toml(state, file);  // before its folder is there
  write(file, text);
  return load_scene(file.string());
}

template <class... Values>
std::string bits(const Values&... values) {
  std::string text;
  const auto add = [&](float value) { text += fmt::format("{:08x} ", std::bit_cast<std::uint32_t>(value)); };
  const auto each = [&](const auto& value) {
    if constexpr (std::is_same_v<std::decay_t<decltype(value)>, float>)
      add(value);
    else
      for (int k = 0; k < 3; ++k) add(value[k]);
  };
  (each(values), ...);
  return text;
}

/// Every float of a light, by its bits.
std::string bits_of(const Light& light) {
  struct Visitor {
    std::string operator()(const PointLight& l) const { return bits(l.position); }
    std::string operator()(const SpotLight& l) const { return bits(l.position, l.direction, l.inner_degrees, l.outer_degrees); }
    std::string operator()(const DirectionalLight& l) const { return bits(l.direction); }
    std::string operator()(const RectLight& l) const { return bits(l.center, l.half_u, l.half_v); }
    std::string operator()(const DiscLight& l) const { return bits(l.center, l.normal, l.radius); }
    std::string operator()(const SphereLight& l) const { return bits(l.center, l.radius); }
  };
  return fmt::format("{} {} {} {}", light.name, kind_name(light), std::visit(Visitor{}, light.kind), bits(light.intensity));
}
std::string bits_of(const View& v) { return v.name + ' ' + bits(v.eye, v.target, v.up, v.fov_y_degrees); }

/// Whatever the size of the test case is.
template <class Value>
Value any_of(Value low, Value high) {
  return *rc::gen::resize(rc::kNominalSize, rc::gen::inRange(low, high));
}

/// Any float below 2^56, tiny ones and both zeros too.
float any_float() {
  const auto exponent = any_of(0u, 127u + 56u);
  const std::uint32_t fraction = *rc::gen::element(0u, 1u, 0x7fffffu, any_of(0u, 0x800000u));
  return std::bit_cast<float>(any_of(0u, 2u) << 31 | exponent << 23 | fraction);
}
glm::vec3 any_vector() { return {any_float(), any_float(), any_float()}; }
float any_size() { return std::max(std::abs(any_float()), std::bit_cast<float>(1u)); }

Light any_light() {
  Light light{.name = *rc::gen::element<std::string>("a", "key_light", "0", "_"), .kind = PointLight{any_vector()}};
  light.intensity = any_size();
  switch (any_of(0, 6)) {
    case 1: {
      const float outer = std::clamp(any_size(), 1e-30f, 89.9f);
      light.kind = SpotLight{any_vector(), any_vector(), std::min(std::abs(any_float()), outer), outer};
      break;
    }
    case 2:
      light.kind = DirectionalLight{any_vector()};
      break;
    case 3:
      light.kind = RectLight{any_vector(), any_vector(), any_vector()};
      break;
    case 4:
      light.kind = DiscLight{any_vector(), any_vector(), any_size()};
      break;
    case 5:
      light.kind = SphereLight{any_vector(), any_size()};
      break;
  }
  return light;
}

View any_view() {
  return {.name = *rc::gen::element<std::string>("v", "front_2"),
          .eye = any_vector(),
          .target = any_vector(),
          .up = any_vector(),
          .fov_y_degrees = std::clamp(any_size(), 1e-30f, 179.9f)};
}

template <class Item>
bool is_sound(const Item& item) {
  try {
    check(item, "");
    return true;
  } catch (const Error&) {
    return false;
  }
}

Selection some_state() {
  Selection state{
      .scene = "single_triangle", .light = {.name = "sun", .kind = DirectionalLight{}}, .width = 960, .height = 540};
  state.sides[0].technique = "shadow_map";
  return state;
}

RC_GTEST_PROP(saved_state, every_light_and_view_comes_back_to_the_bit, ()) {
  Selection state = some_state();
  state.light = usable(any_light());
  state.view = usable(any_view());
  RC_PRE(is_sound(state.light) && is_sound(state.view));
  RC_TAG(std::string(kind_name(state.light)));
  const Folder folder;
  const Scene scene = saved_and_loaded(state, "saved/scene.toml");
  RC_ASSERT(scene.lights.size() == 1u && scene.views.size() == 1u);
  RC_ASSERT(bits_of(scene.lights[0]) == bits_of(state.light));
  RC_ASSERT(bits_of(scene.views[0]) == bits_of(state.view));
  RC_ASSERT(scene.notes.empty());
}

// Only those that are shown: all of the saved scene's lights are then those of the picture.
TEST(saved_state, lights_that_are_shown_together_come_back_together) {
  Selection state = some_state();
  state.together = {{.name = "lamp", .kind = PointLight{{0, 4, 0}}},
                    state.light,
                    {.name = "bulb", .kind = SphereLight{{1, 4, 1}, 0.25f}, .intensity = 0.5f}};
  state.light.kind = DirectionalLight{{0.5f, -1, 0}};  // moved
  state.view = {.name = "v", .eye = {0, 1, 5}};
  const Folder folder;
  const Scene scene = saved_and_loaded(state, "saved/scene.toml");
  ASSERT_EQ(scene.lights.size(), 3u);
  const std::vector<Light> shown = viewer::lights_of(state);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(bits_of(scene.lights[k]), bits_of(shown[k]));
  EXPECT_EQ(bits_of(shown[1]), bits_of(state.light));
  EXPECT_NE(viewer::render_command(state, {}, "saved/scene.toml", "again").find(" --light all+ "), std::string::npos);
}

TEST(saved_state, numbers_have_the_fewest_digits_that_come_back) {
  const Folder folder;
  const auto intensity = [&](float value) {
    Selection state = some_state();
    state.light.intensity = value;
    const Scene scene = saved_and_loaded(state, "scene.toml");
    EXPECT_EQ(bits(scene.lights.at(0).intensity), bits(value));
    const std::string text = read("scene.toml"), key = "intensity = ";
    const std::size_t at = text.find(key) + key.size();
    return text.substr(at, text.find('\n', at) - at);
  };
  EXPECT_EQ(intensity(1), "1");
  EXPECT_EQ(intensity(0.1f), "0.1");
  EXPECT_EQ(intensity(1 / 3.0f), "0.33333334");
  EXPECT_EQ(intensity(1e20f), "1e+20");
  EXPECT_EQ(intensity(0x1p53f + 0x1p30f), "9007200000000000") << "whole numbers beyond 2^53 too";
  EXPECT_EQ(intensity(123456792), "123456790") << "floats are 8 apart there";
  EXPECT_EQ(intensity(std::bit_cast<float>(1u)), "1e-45");
  // 7.038531e-26 is nearest to this float, but the double nearest to that text lies halfway to the next float, which is even.
  EXPECT_EQ(static_cast<float>(7.038531e-26), std::bit_cast<float>(0x15ae43feu));
  EXPECT_GT(intensity(std::bit_cast<float>(0x15ae43fdu)).size(), std::string("7.038531e-26").size());
}

TEST(saved_state, zeros_keep_their_sign) {
  Selection state = some_state();
  state.light.kind = DirectionalLight{{-0.0f, -1, 0}};
  const Folder folder;
  const Scene scene = saved_and_loaded(state, "scene.toml");
  EXPECT_TRUE(std::signbit(std::get<DirectionalLight>(scene.lights.at(0).kind).direction.x));
  EXPECT_FALSE(std::signbit(std::get<DirectionalLight>(scene.lights.at(0).kind).direction.z));
}

TEST(saved_state, the_first_line_is_title_and_summary) {
  Selection state = some_state();
  state.scene = "composite:object=sphere";
  const std::string text = viewer::state_toml(state, "x/scene.toml");
  EXPECT_EQ(text.substr(0, text.find("[[")),
            "# Saved state: \"composite:object=sphere\" under light 'sun', seen from view 'view'.\n"
            "scene = \"composite:object=sphere\"\n\n");
}

/// Names of files as nobody should choose them: anything but a slash and zero, UTF-8.
std::string any_name() {
  static const std::vector<std::string> parts = {
      "a",      " ",      "'", "\"", "\\", "$HOME", "`id`", "\n", "\t", "\x7f",   "\x1b",  "#",     "=",   "é",       "日", "😀",
      "\u2028", "\u0085", ";", "*",  "~",  "-",     "!",    "%",  ": ", "cache:", "[1,2]", "{a,b}", "'''", "\\u0041", "."};
  const auto chosen = *rc::gen::nonEmpty(
      rc::gen::container<std::vector<int>>(rc::gen::resize(rc::kNominalSize, rc::gen::inRange(0, int(parts.size())))));
  std::string name;
  for (const int part : chosen) name += parts[static_cast<std::size_t>(part)];
  if (name.size() > 100) name = "long";
  return name == "." || name == ".." ? "dots" : name;
}

const std::string lone_sphere = "[[shape]]\nkind = \"sphere\"\ncenter = [0, 1, 0]\nradius = 1\n";

RC_GTEST_PROP(saved_state, scenes_of_any_file_name_are_found_again, ()) {
  const Folder folder;
  Selection state = some_state();
  const fs::path base = any_name() + "_a/" + any_name() + ".toml", saved = any_name() + "_b/01/scene.toml";
  write(base, lone_sphere);
  state.scene = *rc::gen::element(base.string(), fs::absolute(base).string(), "./" + base.string());
  const Scene scene = saved_and_loaded(state, *rc::gen::element(saved, fs::absolute(saved)));
  RC_ASSERT(scene.meshes.size() == 1u);
  RC_ASSERT(scene.lights.at(0).name == "sun");
}

TEST(saved_state, folders_move_together) {
  const Folder folder;
  write("all/scenes/base.toml", lone_sphere);
  Selection state = some_state();
  state.scene = "all/scenes/base.toml";
  saved_and_loaded(state, "all/saved/01/scene.toml");
  EXPECT_NE(read("all/saved/01/scene.toml").find("scene = \"../../scenes/base.toml\"\n"), std::string::npos);
  fs::rename("all", "moved");
  EXPECT_EQ(load_scene("moved/saved/01/scene.toml").meshes.size(), 1u);
  // In one folder a name of its own, which is no id.
  state.scene = "moved/base";
  EXPECT_NE(viewer::state_toml(state, "moved/scene.toml").find("scene = \"./base\"\n"), std::string::npos);
}

TEST(saved_state, a_still_keeps_its_time) {
  const Folder folder;
  write("all/base.toml", lone_sphere);
  Selection state = some_state();
  state.scene = "all/base.toml@walk=1.5";
  EXPECT_NE(viewer::state_toml(state, "all/01/scene.toml").find("scene = \"../base.toml@walk=1.5\"\n"), std::string::npos);
  state.scene = "walking_boxes@0.25";
  EXPECT_NE(viewer::state_toml(state, "all/01/scene.toml").find("scene = \"walking_boxes@0.25\"\n"), std::string::npos);
}

// Seconds are in the fewest digits that read back.
TEST(saved_state, a_frame_of_an_animation_is_saved_as_a_still) {
  const Folder folder;
  Selection state = some_state();
  state.scene = "walking_boxes:count=4";
  state.at = RowPose{.animation = "walk", .seconds = 7 / 60.0, .frames = 121};
  const Scene scene = saved_and_loaded(state, "01/scene.toml");
  const Scene still = load_scene(fmt::format("walking_boxes:count=4@walk={}", 7 / 60.0));
  ASSERT_EQ(scene.meshes.size(), still.meshes.size());
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) EXPECT_EQ(scene.meshes[m].positions, still.meshes[m].positions) << m;
  EXPECT_FALSE(scene.motion);
  EXPECT_NE(read("01/scene.toml").find("walking_boxes:count=4@walk=0.11666666666666667"), std::string::npos);
}

TEST(saved_state, links_lead_where_they_did) {
  const Folder folder;
  // A link to a folder elsewhere: `..` from there is not where the link is. And a linked description, with its mesh beside it.
  fs::create_directories("real/runs");
  fs::create_directory_symlink("real/runs", "runs");
  write("scenes/mesh.toml", lone_sphere);
  write("store/0815.toml", "scene = \"mesh.toml\"\n");
  fs::create_symlink("../store/0815.toml", "scenes/linked.toml");
  Selection state = some_state();
  state.scene = "scenes/linked.toml";
  EXPECT_EQ(saved_and_loaded(state, "runs/01/scene.toml").meshes.size(), 1u);
}

TEST(saved_state, a_saved_state_can_be_saved_again) {
  const Folder folder;
  Selection state = some_state();
  saved_and_loaded(state, "out/01/scene.toml");
  state.scene = "out/01/scene.toml";
  state.light = {.name = "moon", .kind = PointLight{{1, 2, 3}}};
  const Scene scene = saved_and_loaded(state, "out/02/scene.toml");
  EXPECT_EQ(scene.meshes.size(), load_scene("single_triangle").meshes.size());
  ASSERT_EQ(scene.lights.size(), 1u);
  EXPECT_EQ(scene.lights[0].name, "moon");
}

TEST(saved_state, a_name_that_is_no_text_is_refused) {
  Selection state = some_state();
  state.scene = "./latin1_\xe9.toml";
  EXPECT_THROW(viewer::state_toml(state, "scene.toml"), Error);
}

TEST(render_command, is_the_line_that_one_would_type) {
  Selection state = some_state();
  EXPECT_EQ(viewer::render_command(state, {}, "saved/01/scene.toml", "saved/01/again"),
            "gnomon render --scene saved/01/scene.toml --technique shadow_map --light sun --view view --size 960x540 "
            "--out saved/01/again");
  const std::vector<std::string> plugins = {"./a b.so", "c.so"};
  state.sides[0].settings = "resolution=2048,filter=pcf";
  state.truth = Truth::mesh;
  EXPECT_EQ(viewer::render_command(state, plugins, "it's.toml", "-out"),
            "gnomon --plugin './a b.so' --plugin c.so render --scene 'it'\\''s.toml' --technique "
            "shadow_map:resolution=2048,filter=pcf --light sun --view view --size 960x540 --truth mesh --out ./-out");
}

RC_GTEST_PROP(render_command, a_shell_reads_back_every_word, ()) {
  const auto word = [] {  // any bytes but zero, UTF-8 or not
    const auto bytes = *rc::gen::nonEmpty(rc::gen::container<std::string>(rc::gen::arbitrary<char>()));
    std::string text;
    for (const char c : bytes) text += c == 0 ? '\'' : c;
    return *rc::gen::element(text, any_name());
  };
  Selection state = some_state();
  const std::vector<std::string> plugins = {word(), word()};
  state.sides[0].technique = word();
  state.sides[0].settings = word();
  const std::string scene = word(), out = word();
  const Folder folder;
  write("line.sh", "gnomon() { printf '%s\\0' \"$@\"; }\n" + viewer::render_command(state, plugins, scene, out) + "\n");
  RC_ASSERT(std::system("LC_ALL=C /bin/sh line.sh > words 2> errors") == 0);
  RC_ASSERT(read("errors").empty());
  const auto path = [](const std::string& text) { return text.starts_with('-') ? "./" + text : text; };
  std::string expected;
  for (const std::string& w : {std::string("--plugin"), path(plugins[0]), std::string("--plugin"), path(plugins[1]),
                               std::string("render"), std::string("--scene"), path(scene), std::string("--technique"),
                               written(state.sides[0]), std::string("--light"), state.light.name, std::string("--view"),
                               state.view.name, std::string("--size"), std::string("960x540"), std::string("--out"), path(out)})
    expected += w + '\0';
  RC_ASSERT(read("words") == expected);
}

}  // namespace saved_state_test
