// The table of keys: every key that is promised, each once, and what the keyboard makes of it.
#include "app/viewer/keys.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <gnomon/error.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <sstream>

namespace keys_test {

using namespace gnomon;
using namespace gnomon::viewer;

std::span<const KeyRow> key_rows() { return key_table().rows(); }
const KeyRow* find_key(int key, int modifiers) { return key_table().find(key, modifiers); }
/// Of a text that presses keys alone.
std::vector<const KeyRow*> parse_keys(const std::string& text) {
  std::vector<const KeyRow*> keys;
  for (const ScriptStep& step : key_table().parse(text)) keys.push_back(std::get<const KeyRow*>(step));
  return keys;
}

const KeyRow& row_of(const KeyEffect& effect) {
  for (const KeyRow& row : key_rows())
    if (row.effect == effect) return row;
  throw std::logic_error("an effect without a key");
}

// The letters of Pljaskovic et al.: K, L, T, U change the object, Y, X, C, A, S, D move the camera, V, B, N, M the light.
TEST(viewer_keys, the_letters_of_the_paper_do_what_they_did_there) {
  std::map<std::string, std::string> groups;
  for (const char letter : std::string_view("KLTUYXCASDVBNM")) {
    const KeyRow* row = find_key(letter, 0);  // GLFW's codes of letters are ASCII
    ASSERT_TRUE(row) << letter;
    EXPECT_EQ(row->name, std::string(1, letter));
    groups[row->group] += letter;
    EXPECT_EQ(row->is_held, row->group != "Scene composite") << letter;
  }
  EXPECT_EQ(groups, (std::map<std::string, std::string>{{"Scene composite", "KLTU"}, {"Camera", "YXCASD"}, {"Light", "VBNM"}}));
  EXPECT_TRUE(find_key(GLFW_KEY_K, 0)->effect == KeyEffect(SceneSetting{"composite", "object", "circle"}));
  EXPECT_TRUE(find_key(GLFW_KEY_L, 0)->effect == KeyEffect(SceneSetting{"composite", "object", "triangle"}));
  EXPECT_TRUE(find_key(GLFW_KEY_T, 0)->effect == KeyEffect(SceneSetting{"composite", "object", "sphere"}));
  EXPECT_TRUE(find_key(GLFW_KEY_U, 0)->effect == KeyEffect(SceneSetting{"composite", "object", "cone"}));
}

TEST(viewer_keys, every_key_has_its_action) {
  const std::pair<const char*, KeyEffect> promised[] = {{"A", OrbitSteps{.right = -1}},
                                                        {"D", OrbitSteps{.right = 1}},
                                                        {"S", OrbitSteps{.up = 1}},
                                                        {"X", OrbitSteps{.up = -1}},
                                                        {"Y", ZoomSteps{1}},
                                                        {"C", ZoomSteps{-1}},
                                                        {"V", LightSteps{.x = -1}},
                                                        {"B", LightSteps{.x = 1}},
                                                        {"N", LightSteps{.y = -1}},
                                                        {"M", LightSteps{.y = 1}},
                                                        {"Up", FlySteps{.forward = 1}},
                                                        {"Down", FlySteps{.forward = -1}},
                                                        {"Left", FlySteps{.right = -1}},
                                                        {"Right", FlySteps{.right = 1}},
                                                        {"Page Up", FlySteps{.up = 1}},
                                                        {"Page Down", FlySteps{.up = -1}},
                                                        {"F1", Action::help},
                                                        {"H", Action::help},
                                                        {"1", Layout::left},
                                                        {"2", Layout::right},
                                                        {"3", Layout::split},
                                                        {"4", Layout::flicker},
                                                        {"5", Paint::shaded},
                                                        {"6", Paint::mask},
                                                        {"7", Paint::difference},
                                                        {"8", Paint::kinds},
                                                        {"9", Paint::causes},
                                                        {"0", Paint::classes},
                                                        {",", Action::technique_before},
                                                        {".", Action::technique_after},
                                                        {"Tab", Action::swap_sides},
                                                        {"W", ParameterSteps{.rows = 1}},
                                                        {"Q", ParameterSteps{.rows = -1}},
                                                        {"-", ParameterSteps{.values = -1}},
                                                        {"=", ParameterSteps{.values = 1}},
                                                        {"G", Action::layer_after},
                                                        {"I", Action::contours},
                                                        {"P", Action::profile},
                                                        {"O", Action::silhouettes},
                                                        {"Z", Action::magnifier},
                                                        {"F2", Action::panels},
                                                        {"Home", Action::reset_view},
                                                        {"End", Action::reset_light},
                                                        {"E", Action::all_lights},
                                                        {"Space", Action::play},
                                                        {"[", FrameSteps{-1}},
                                                        {"]", FrameSteps{1}},
                                                        {"Ctrl+S", Action::save},
                                                        {"Ctrl+C", Action::copy_command},
                                                        {"F12", Action::screenshot},
                                                        {"Ctrl+Q", Action::quit},
                                                        {"Escape", Action::cancel},
                                                        {"K", SceneSetting{"composite", "object", "circle"}},
                                                        {"L", SceneSetting{"composite", "object", "triangle"}},
                                                        {"T", SceneSetting{"composite", "object", "sphere"}},
                                                        {"U", SceneSetting{"composite", "object", "cone"}}};
  std::set<Action> done;
  for (const auto& [name, effect] : promised) {
    const std::vector<const KeyRow*> keys = parse_keys(name);
    ASSERT_EQ(keys.size(), 1u) << name;
    EXPECT_TRUE(keys[0]->effect == effect) << name;
    if (const auto* action = std::get_if<Action>(&effect)) done.insert(*action);
  }
  EXPECT_EQ(std::size(promised), key_rows().size());  // and no others
  // `cancel` is the last of the enumeration: none was forgotten.
  EXPECT_EQ(done.size(), static_cast<std::size_t>(Action::cancel) + 1);
}

TEST(viewer_keys, rows_are_told_apart_by_key_and_by_name) {
  std::set<std::pair<int, int>> keys;
  std::set<std::string> names;
  for (const KeyRow& row : key_rows()) {
    EXPECT_TRUE(keys.insert({row.key, row.modifiers}).second) << row.name;
    EXPECT_TRUE(names.insert(row.name).second) << row.name;
    EXPECT_EQ(find_key(row.key, row.modifiers), &row) << row.name;
    EXPECT_EQ(row.name.starts_with("Ctrl+"), row.modifiers == GLFW_MOD_CONTROL) << row.name;
    EXPECT_TRUE(row.sentence.ends_with('.')) << row.name;
    EXPECT_LE(row.sentence.size(), 80u) << row.name;  // one line of the help
  }
}

TEST(viewer_keys, groups_and_effects_stand_together) {
  const std::span<const KeyRow> rows = key_rows();
  std::set<std::string> groups;
  std::vector<KeyEffect> effects;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (i == 0 || rows[i].group != rows[i - 1].group) {
      EXPECT_TRUE(groups.insert(rows[i].group).second) << rows[i].name;
    }
    if (i == 0 || rows[i].effect != rows[i - 1].effect) {
      EXPECT_EQ(std::ranges::count(effects, rows[i].effect), 0) << rows[i].name;
      effects.push_back(rows[i].effect);
    }
  }
  EXPECT_EQ(groups, (std::set<std::string>{"Scene composite", "Camera", "Light", "Animation", "Compare", "Parameters", "Layers",
                                           "State", "Window"}));
}

TEST(viewer_keys, modifiers_count_locks_do_not) {
  EXPECT_TRUE(find_key(GLFW_KEY_S, 0)->effect == KeyEffect(OrbitSteps{.up = 1}));
  EXPECT_TRUE(find_key(GLFW_KEY_S, GLFW_MOD_CONTROL)->effect == KeyEffect(Action::save));
  EXPECT_TRUE(find_key(GLFW_KEY_S, GLFW_MOD_CONTROL | GLFW_MOD_CAPS_LOCK | GLFW_MOD_NUM_LOCK)->effect ==
              KeyEffect(Action::save));
  EXPECT_TRUE(find_key(GLFW_KEY_S, GLFW_MOD_CAPS_LOCK)->effect == KeyEffect(OrbitSteps{.up = 1}));
  EXPECT_EQ(find_key(GLFW_KEY_S, GLFW_MOD_ALT), nullptr);
  EXPECT_EQ(find_key(GLFW_KEY_S, GLFW_MOD_CONTROL | GLFW_MOD_ALT), nullptr);
  EXPECT_EQ(find_key(GLFW_KEY_S, GLFW_MOD_CONTROL | GLFW_MOD_SHIFT), nullptr);
  EXPECT_EQ(find_key(GLFW_KEY_K, GLFW_MOD_CONTROL), nullptr);
  EXPECT_EQ(find_key(GLFW_KEY_K, GLFW_MOD_SHIFT), nullptr);
  EXPECT_EQ(find_key(GLFW_KEY_F5, 0), nullptr);
  EXPECT_EQ(find_key(GLFW_KEY_UNKNOWN, 0), nullptr);
  // Who flies with one hand and is about to pan with Shift and the other goes on flying.
  for (const KeyRow& row : key_rows())
    EXPECT_EQ(find_key(row.key, row.modifiers | GLFW_MOD_SHIFT), row.is_held ? &row : nullptr) << row.name;
}

TEST(viewer_keys, names_are_read_whatever_their_case_and_blanks) {
  for (const KeyRow& row : key_rows()) {
    const std::string name(row.name);
    std::string small, tight;
    for (const char c : name) small += static_cast<char>(std::tolower(c));
    for (const char c : name)
      if (c != ' ') tight += c;
    for (const std::string& text : {name, small, tight, "  " + name + "\t"})
      EXPECT_EQ(parse_keys(text), std::vector{&row}) << text;
  }
  EXPECT_TRUE(parse_keys("").empty());
  EXPECT_TRUE(parse_keys(" \n ").empty());
  std::string names;
  for (const KeyRow* row : parse_keys("k v v Ctrl+S page up UP pageDown down ,")) names += std::string(row->name) + '|';
  EXPECT_EQ(names, "K|V|V|Ctrl+S|Page Up|Up|Page Down|Down|,|");
}

RC_GTEST_PROP(viewer_keys, any_row_of_names_is_read_back, ()) {
  const auto picks = *rc::gen::container<std::vector<std::size_t>>(rc::gen::inRange<std::size_t>(0, key_rows().size()));
  std::string text;
  std::vector<const KeyRow*> due;
  for (const std::size_t i : picks) {
    due.push_back(&key_rows()[i]);
    text += key_rows()[i].name + ' ';
  }
  RC_ASSERT(parse_keys(text) == due);
}

TEST(viewer_keys, an_unknown_name_is_refused_with_the_nearest) {
  const auto words = [](const std::string& text) -> std::string {
    try {
      parse_keys(text);
      return "nothing";
    } catch (const Error& error) {
      return error.what();
    }
  };
  EXPECT_TRUE(words("k Ctr+S l").starts_with("there is no key Ctr+S; did you mean Ctrl+S? There are: K L ")) << words("Ctr+S");
  EXPECT_TRUE(words("PgeUp").starts_with("there is no key PgeUp; did you mean Page Up? "));
  EXPECT_TRUE(words("page").starts_with("there is no key page; did you mean "));  // half a name is none
  EXPECT_TRUE(words("ESCAP").starts_with("there is no key ESCAP; did you mean Escape? "));
}

// The sign "=" is a key where it stands alone; within a word it sets a parameter, whose name keeps its case.
TEST(viewer_keys, a_script_presses_keys_and_sets_parameters) {
  const std::vector<ScriptStep> steps = key_table().parse("k left.resolution=512 = scene.object=a=b -");
  ASSERT_EQ(steps.size(), 5u);
  EXPECT_EQ(std::get<const KeyRow*>(steps[0])->name, "K");
  EXPECT_EQ(std::get<ParameterSetting>(steps[1]), (ParameterSetting{"left.resolution", "512"}));
  EXPECT_EQ(std::get<const KeyRow*>(steps[2])->name, "=");
  EXPECT_EQ(std::get<ParameterSetting>(steps[3]), (ParameterSetting{"scene.object", "a=b"}));
  EXPECT_EQ(std::get<const KeyRow*>(steps[4])->name, "-");
  EXPECT_THROW(key_table().parse("left.resolution="), Error);
}

TEST(viewer_keys, the_page_has_every_key_once) {
  std::istringstream table(key_table().markdown());
  std::vector<std::string> lines;
  for (std::string line; std::getline(table, line);) lines.push_back(line);
  ASSERT_GT(lines.size(), 2u);
  EXPECT_EQ(lines[1], "| --- | --- | --- | --- |");
  const auto bars = [](const std::string& line) { return std::count(line.begin(), line.end(), '|'); };
  for (const std::string& line : lines) EXPECT_EQ(bars(line), 5) << line;
  for (const KeyRow& row : key_rows()) {
    const auto has_it = [&](const std::string& line) { return line.find(fmt::format("`{}`", row.name)) != std::string::npos; };
    EXPECT_EQ(std::ranges::count_if(lines, has_it), 1) << row.name;
  }
  EXPECT_EQ(lines[2], "| Scene composite | `K` | Shadowed object: circle. |  |");
  EXPECT_NE(key_table().markdown().find("|  | `D` | Around the target to the right, 5 degrees. | goes on |\n"),
            std::string::npos);
  EXPECT_NE(key_table().markdown().find("| Window | `F1`, `H` | This help on or off. |  |\n"), std::string::npos);
}

class Lamps final : public SceneGenerator {
  Number<int> count{this, "count", 1, {.min = 1, .max = 9}, Stage::build, "How many."};

 public:
  Scene make() const override { return {}; }
};

/// A scene that declares these keys; what it refuses, it refuses as hall.
SceneEntry lamps(const std::string& id, std::vector<SceneKey> keys) {
  return {
      id, {.title = "Lamps", .summary = "Lamps.", .keys = std::move(keys)}, [] { return made<SceneGenerator, Lamps>("hall"); }};
}

TEST(viewer_keys, a_letter_that_two_scenes_declare_is_that_of_the_scene_that_is_shown) {
  const SceneEntry scenes[] = {lamps("hall", {{'K', "count", "3", "Three lamps."}, {'R', "count", "1", "One lamp."}}),
                               lamps("porch", {{'K', "count", "2", "Two lamps."}})};
  const KeyTable table(scenes);
  EXPECT_TRUE(table.find('K', 0, "hall")->effect == KeyEffect(SceneSetting{"hall", "count", "3"}));
  EXPECT_TRUE(table.find('K', 0, "porch")->effect == KeyEffect(SceneSetting{"porch", "count", "2"}));
  EXPECT_TRUE(table.find('K', 0, "bunny")->effect == KeyEffect(SceneSetting{"hall", "count", "3"}));
  EXPECT_TRUE(table.find('R', 0, "porch")->effect == KeyEffect(SceneSetting{"hall", "count", "1"}));
  EXPECT_EQ(table.find('T', 0, "composite"), nullptr);  // no scene of this table has it
  EXPECT_EQ(table.rows().size(), KeyTable({}).rows().size() + 3);
  EXPECT_TRUE(
      table.markdown().starts_with("| group | key | what it does | held |\n| --- | --- | --- | --- |\n"
                                   "| Scene hall | `K` | Three lamps. |  |\n|  | `R` | One lamp. |  |\n"
                                   "| Scene porch | `K` | Two lamps. |  |\n| Camera | "));
}

TEST(viewer_keys, a_declaration_that_cannot_be_is_refused_by_name) {
  const auto words = [](std::vector<SceneKey> keys) -> std::string {
    const SceneEntry scenes[] = {lamps("hall", std::move(keys))};
    try {
      const KeyTable table(scenes);
      return "nothing";
    } catch (const Error& error) {
      return error.what();
    }
  };
  EXPECT_EQ(words({{'r', "count", "1", "One."}}), "scene hall declares the key 'r', which is no letter A to Z");
  EXPECT_EQ(words({{'V', "count", "1", "One."}}), "scene hall declares the key V, which the viewer or that scene has already");
  EXPECT_EQ(words({{'R', "count", "1", "One."}, {'R', "count", "2", "Two."}}),
            "scene hall declares the key R, which the viewer or that scene has already");
  for (const char* part : {"hall", "cont", "count"})
    EXPECT_NE(words({{'R', "cont", "1", "One."}}).find(part), std::string::npos);
  for (const char* part : {"hall", "count", "10", "1 .. 9"})
    EXPECT_NE(words({{'R', "count", "10", "Ten."}}).find(part), std::string::npos) << part;
}

// A German or Serbian keyboard: the key right of T bears Z, the one right of left Shift Y. A French one bears A where Q was,
// comma where M was, and & where 1 was, which GLFW has no code for: it stays 1.
TEST(viewer_keys, the_cap_says_which_letter_a_key_is) {
  EXPECT_EQ(key_of_cap(GLFW_KEY_Y, "z"), GLFW_KEY_Z);
  EXPECT_EQ(key_of_cap(GLFW_KEY_Z, "y"), GLFW_KEY_Y);
  EXPECT_EQ(key_of_cap(GLFW_KEY_Q, "a"), GLFW_KEY_A);
  EXPECT_EQ(key_of_cap(GLFW_KEY_Q, "A"), GLFW_KEY_A);
  EXPECT_EQ(key_of_cap(GLFW_KEY_SEMICOLON, "m"), GLFW_KEY_M);
  EXPECT_EQ(key_of_cap(GLFW_KEY_M, ","), GLFW_KEY_COMMA);
  EXPECT_EQ(key_of_cap(GLFW_KEY_COMMA, ";"), GLFW_KEY_SEMICOLON);
  EXPECT_EQ(key_of_cap(GLFW_KEY_1, "&"), GLFW_KEY_1);
  EXPECT_EQ(key_of_cap(GLFW_KEY_K, "\u043a"), GLFW_KEY_K);  // Cyrillic: the place counts
  EXPECT_EQ(key_of_cap(GLFW_KEY_LEFT_BRACKET, "\u00fc"), GLFW_KEY_LEFT_BRACKET);
  EXPECT_EQ(key_of_cap(GLFW_KEY_K, ""), GLFW_KEY_K);
  EXPECT_EQ(key_of_cap(GLFW_KEY_KP_1, "1"), GLFW_KEY_KP_1);
  EXPECT_EQ(key_of_cap(GLFW_KEY_KP_DECIMAL, ","), GLFW_KEY_KP_DECIMAL);
  EXPECT_EQ(key_of_cap(GLFW_KEY_UNKNOWN, "k"), GLFW_KEY_K);
  // A keyboard of the United States: every key bears what it is.
  for (const char c : std::string_view("ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789',-./;=[\\]`"))
    EXPECT_EQ(key_of_cap(c, std::string(1, static_cast<char>(std::tolower(c)))), c);
}

double steps(const std::vector<HeldKeys::Steps>& all, const KeyEffect& effect) {
  double sum = 0;
  for (const auto& [row, count] : all) sum += row->effect == effect ? count : 0;
  return sum;
}

// One step at once; then, from 1/3 s on, 20 a second: at 1/3 + 0.1 s two more.
TEST(viewer_keys, a_held_key_steps_once_and_then_goes_on) {
  HeldKeys keys;
  EXPECT_FALSE(keys.any());
  keys.press(row_of(LightSteps{.x = -1}), 10);
  EXPECT_TRUE(keys.any());
  EXPECT_EQ(steps(keys.take(10), LightSteps{.x = -1}), 1);
  EXPECT_TRUE(keys.take(10.3).empty());
  EXPECT_NEAR(steps(keys.take(10 + 1.0 / 3 + 0.1), LightSteps{.x = -1}), 2, 1e-9);
  EXPECT_NEAR(steps(keys.take(10 + 1.0 / 3 + 0.15), LightSteps{.x = -1}), 1, 1e-9);
  keys.press(row_of(LightSteps{.x = -1}), 10.5);  // what a keyboard repeats by itself is no press
  EXPECT_NEAR(steps(keys.take(10 + 1.0 / 3 + 0.2), LightSteps{.x = -1}), 1, 1e-9);
  keys.release(GLFW_KEY_B);
  EXPECT_TRUE(keys.any());
  keys.release(GLFW_KEY_V);
  EXPECT_TRUE(keys.take(11).empty());
  EXPECT_FALSE(keys.any());
}

TEST(viewer_keys, a_press_between_two_calls_counts_each_time) {
  HeldKeys keys;
  for (const double now : {1.0, 1.01, 1.02}) {
    keys.press(row_of(OrbitSteps{.right = -1}), now);
    keys.release(GLFW_KEY_A);
  }
  keys.press(row_of(Action::save), 1.02);  // not held: once
  const std::vector<HeldKeys::Steps> all = keys.take(2);
  EXPECT_EQ(steps(all, OrbitSteps{.right = -1}), 3);
  EXPECT_EQ(steps(all, Action::save), 1);
  EXPECT_FALSE(keys.any());
  EXPECT_TRUE(keys.take(3).empty());
}

TEST(viewer_keys, nothing_leaps_after_a_pause) {
  HeldKeys keys;
  keys.press(row_of(FlySteps{.forward = 1}), 0);
  EXPECT_EQ(steps(keys.take(0), FlySteps{.forward = 1}), 1);
  EXPECT_NEAR(steps(keys.take(60), FlySteps{.forward = 1}), 5, 1e-9);  // a quarter of a second
  EXPECT_NEAR(steps(keys.take(60.05), FlySteps{.forward = 1}), 1, 1e-9);
  keys.release_all();
  EXPECT_TRUE(keys.take(61).empty());
}

// However often it is called: over one second 1 + 20 * 2/3 steps.
RC_GTEST_PROP(viewer_keys, steps_do_not_depend_on_the_frame_rate, ()) {
  const int calls = *rc::gen::inRange(5, 500);
  HeldKeys keys;
  keys.press(row_of(FlySteps{.up = 1}), 5);
  keys.press(row_of(FlySteps{.right = -1}), 5);
  double up = 0, left = 0;
  for (int i = 1; i <= calls; ++i) {
    const auto all = keys.take(5 + static_cast<double>(i) / calls);
    up += steps(all, FlySteps{.up = 1});
    left += steps(all, FlySteps{.right = -1});
  }
  RC_ASSERT(std::abs(up - (1 + 40.0 / 3)) < 1e-6);
  RC_ASSERT(std::abs(left - up) < 1e-9);
}

}  // namespace keys_test
