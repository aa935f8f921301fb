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

namespace {

using namespace gnomon;
using namespace gnomon::viewer;

const KeyRow& row_of(Action action) {
  for (const KeyRow& row : key_rows())
    if (row.action == action) return row;
  throw std::logic_error("an action without a key");
}

// The letters of Pljaskovic et al.: K, L, T, U change the object, Y, X, C, A, S, D move the camera, V, B, N, M the light.
TEST(viewer_keys, the_letters_of_the_paper_do_what_they_did_there) {
  std::map<std::string, std::string> groups;
  for (const char letter : std::string_view("KLTUYXCASDVBNM")) {
    const KeyRow* row = find_key(letter, 0);  // GLFW's codes of letters are ASCII
    ASSERT_TRUE(row) << letter;
    EXPECT_EQ(row->name, std::string(1, letter));
    groups[std::string(row->group)] += letter;
    EXPECT_EQ(row->is_held, row->group != "Object") << letter;
  }
  EXPECT_EQ(groups, (std::map<std::string, std::string>{{"Object", "KLTU"}, {"Camera", "YXCASD"}, {"Light", "VBNM"}}));
  EXPECT_EQ(find_key(GLFW_KEY_K, 0)->action, Action::object_circle);
  EXPECT_EQ(find_key(GLFW_KEY_L, 0)->action, Action::object_triangle);
  EXPECT_EQ(find_key(GLFW_KEY_T, 0)->action, Action::object_sphere);
  EXPECT_EQ(find_key(GLFW_KEY_U, 0)->action, Action::object_cone);
}

TEST(viewer_keys, every_key_has_its_action) {
  const std::pair<const char*, Action> promised[] = {{"A", Action::orbit_left},
                                                     {"D", Action::orbit_right},
                                                     {"S", Action::orbit_up},
                                                     {"X", Action::orbit_down},
                                                     {"Y", Action::nearer},
                                                     {"C", Action::farther},
                                                     {"V", Action::light_left},
                                                     {"B", Action::light_right},
                                                     {"N", Action::light_down},
                                                     {"M", Action::light_up},
                                                     {"Up", Action::fly_forward},
                                                     {"Down", Action::fly_back},
                                                     {"Left", Action::fly_left},
                                                     {"Right", Action::fly_right},
                                                     {"Page Up", Action::fly_up},
                                                     {"Page Down", Action::fly_down},
                                                     {"F1", Action::help},
                                                     {"H", Action::help},
                                                     {"1", Action::layout_left},
                                                     {"2", Action::layout_right},
                                                     {"3", Action::layout_split},
                                                     {"4", Action::layout_flicker},
                                                     {"5", Action::paint_shaded},
                                                     {"6", Action::paint_mask},
                                                     {"7", Action::paint_difference},
                                                     {"8", Action::paint_kinds},
                                                     {"9", Action::paint_causes},
                                                     {"0", Action::paint_classes},
                                                     {",", Action::technique_before},
                                                     {".", Action::technique_after},
                                                     {"Tab", Action::swap_sides},
                                                     {"G", Action::layer_after},
                                                     {"O", Action::silhouettes},
                                                     {"Z", Action::magnifier},
                                                     {"F2", Action::panels},
                                                     {"Home", Action::reset_view},
                                                     {"End", Action::reset_light},
                                                     {"Ctrl+S", Action::save},
                                                     {"Ctrl+C", Action::copy_command},
                                                     {"F12", Action::screenshot},
                                                     {"Ctrl+Q", Action::quit},
                                                     {"Escape", Action::cancel},
                                                     {"K", Action::object_circle},
                                                     {"L", Action::object_triangle},
                                                     {"T", Action::object_sphere},
                                                     {"U", Action::object_cone}};
  std::set<Action> done;
  for (const auto& [name, action] : promised) {
    const std::vector<const KeyRow*> keys = parse_keys(name);
    ASSERT_EQ(keys.size(), 1u) << name;
    EXPECT_EQ(keys[0]->action, action) << name;
    done.insert(action);
  }
  EXPECT_EQ(std::size(promised), key_rows().size());  // and no others
  // `cancel` is the last of the enumeration: none was forgotten.
  EXPECT_EQ(done.size(), static_cast<std::size_t>(Action::cancel) + 1);
}

TEST(viewer_keys, rows_are_told_apart_by_key_and_by_name) {
  std::set<std::pair<int, int>> keys;
  std::set<std::string_view> names;
  for (const KeyRow& row : key_rows()) {
    EXPECT_TRUE(keys.insert({row.key, row.modifiers}).second) << row.name;
    EXPECT_TRUE(names.insert(row.name).second) << row.name;
    EXPECT_EQ(find_key(row.key, row.modifiers), &row) << row.name;
    EXPECT_EQ(row.name.starts_with("Ctrl+"), row.modifiers == GLFW_MOD_CONTROL) << row.name;
    EXPECT_TRUE(row.sentence.ends_with('.')) << row.name;
    EXPECT_LE(row.sentence.size(), 80u) << row.name;  // one line of the help
  }
}

TEST(viewer_keys, groups_and_actions_stand_together) {
  const std::span<const KeyRow> rows = key_rows();
  std::set<std::string_view> groups;
  std::set<Action> actions;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (i == 0 || rows[i].group != rows[i - 1].group) {
      EXPECT_TRUE(groups.insert(rows[i].group).second) << rows[i].name;
    }
    if (i == 0 || rows[i].action != rows[i - 1].action) {
      EXPECT_TRUE(actions.insert(rows[i].action).second) << rows[i].name;
    }
  }
  EXPECT_EQ(groups, (std::set<std::string_view>{"Object", "Camera", "Light", "Compare", "Layers", "State", "Window"}));
}

TEST(viewer_keys, modifiers_count_locks_do_not) {
  EXPECT_EQ(find_key(GLFW_KEY_S, 0)->action, Action::orbit_up);
  EXPECT_EQ(find_key(GLFW_KEY_S, GLFW_MOD_CONTROL)->action, Action::save);
  EXPECT_EQ(find_key(GLFW_KEY_S, GLFW_MOD_CONTROL | GLFW_MOD_CAPS_LOCK | GLFW_MOD_NUM_LOCK)->action, Action::save);
  EXPECT_EQ(find_key(GLFW_KEY_S, GLFW_MOD_CAPS_LOCK)->action, Action::orbit_up);
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
  for (const std::size_t i : picks) due.push_back(&key_rows()[i]), text += std::string(key_rows()[i].name) + ' ';
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

TEST(viewer_keys, the_page_has_every_key_once) {
  std::istringstream table(keys_table());
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
  EXPECT_EQ(lines[2], "| Object | `K` | Shadowed object of scene composite: circle. |  |");
  EXPECT_NE(keys_table().find("|  | `D` | Around the target to the right, 5 degrees. | goes on |\n"), std::string::npos);
  EXPECT_NE(keys_table().find("| Window | `F1`, `H` | This help on or off. |  |\n"), std::string::npos);
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

double steps(const std::vector<HeldKeys::Steps>& all, Action action) {
  double sum = 0;
  for (const HeldKeys::Steps& some : all) sum += some.action == action ? some.steps : 0;
  return sum;
}

// One step at once; then, from 1/3 s on, 20 a second: at 1/3 + 0.1 s two more.
TEST(viewer_keys, a_held_key_steps_once_and_then_goes_on) {
  HeldKeys keys;
  EXPECT_FALSE(keys.any());
  keys.press(row_of(Action::light_left), 10);
  EXPECT_TRUE(keys.any());
  EXPECT_EQ(steps(keys.take(10), Action::light_left), 1);
  EXPECT_TRUE(keys.take(10.3).empty());
  EXPECT_NEAR(steps(keys.take(10 + 1.0 / 3 + 0.1), Action::light_left), 2, 1e-9);
  EXPECT_NEAR(steps(keys.take(10 + 1.0 / 3 + 0.15), Action::light_left), 1, 1e-9);
  keys.press(row_of(Action::light_left), 10.5);  // what a keyboard repeats by itself is no press
  EXPECT_NEAR(steps(keys.take(10 + 1.0 / 3 + 0.2), Action::light_left), 1, 1e-9);
  keys.release(GLFW_KEY_B);
  EXPECT_TRUE(keys.any());
  keys.release(GLFW_KEY_V);
  EXPECT_TRUE(keys.take(11).empty());
  EXPECT_FALSE(keys.any());
}

TEST(viewer_keys, a_press_between_two_calls_counts_each_time) {
  HeldKeys keys;
  for (const double now : {1.0, 1.01, 1.02}) {
    keys.press(row_of(Action::orbit_left), now);
    keys.release(GLFW_KEY_A);
  }
  keys.press(row_of(Action::save), 1.02);  // not held: once
  const std::vector<HeldKeys::Steps> all = keys.take(2);
  EXPECT_EQ(steps(all, Action::orbit_left), 3);
  EXPECT_EQ(steps(all, Action::save), 1);
  EXPECT_FALSE(keys.any());
  EXPECT_TRUE(keys.take(3).empty());
}

TEST(viewer_keys, nothing_leaps_after_a_pause) {
  HeldKeys keys;
  keys.press(row_of(Action::fly_forward), 0);
  EXPECT_EQ(steps(keys.take(0), Action::fly_forward), 1);
  EXPECT_NEAR(steps(keys.take(60), Action::fly_forward), 5, 1e-9);  // a quarter of a second
  EXPECT_NEAR(steps(keys.take(60.05), Action::fly_forward), 1, 1e-9);
  keys.release_all();
  EXPECT_TRUE(keys.take(61).empty());
}

// However often it is asked: over one second 1 + 20 * 2/3 steps.
RC_GTEST_PROP(viewer_keys, steps_do_not_depend_on_the_frame_rate, ()) {
  const int calls = *rc::gen::inRange(5, 500);
  HeldKeys keys;
  keys.press(row_of(Action::fly_up), 5);
  keys.press(row_of(Action::fly_left), 5);
  double up = 0, left = 0;
  for (int i = 1; i <= calls; ++i) {
    const auto all = keys.take(5 + static_cast<double>(i) / calls);
    up += steps(all, Action::fly_up), left += steps(all, Action::fly_left);
  }
  RC_ASSERT(std::abs(up - (1 + 40.0 / 3)) < 1e-6);
  RC_ASSERT(std::abs(left - up) < 1e-9);
}

}  // namespace
