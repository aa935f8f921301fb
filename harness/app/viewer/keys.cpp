#include "app/viewer/keys.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <gnomon/error.h>
#include <gnomon/param.h>

#include <algorithm>
#include <sstream>

#include "report/table/layout.h"

namespace gnomon::viewer {
namespace {

constexpr std::string_view object = "Object", camera = "Camera", light = "Light", compare = "Compare", layers = "Layers",
                           state = "State", window = "Window";
constexpr bool held = true;

constexpr KeyRow rows[] = {
    {GLFW_KEY_K, 0, "K", Action::object_circle, object, "Shadowed object of scene composite: circle."},
    {GLFW_KEY_L, 0, "L", Action::object_triangle, object, "Shadowed object of scene composite: triangle."},
    {GLFW_KEY_T, 0, "T", Action::object_sphere, object, "Shadowed object of scene composite: sphere."},
    {GLFW_KEY_U, 0, "U", Action::object_cone, object, "Shadowed object of scene composite: cone."},

    {GLFW_KEY_A, 0, "A", Action::orbit_left, camera, "Around the target to the left, 5 degrees.", held},
    {GLFW_KEY_D, 0, "D", Action::orbit_right, camera, "Around the target to the right, 5 degrees.", held},
    {GLFW_KEY_S, 0, "S", Action::orbit_up, camera, "Around the target upward, 5 degrees.", held},
    {GLFW_KEY_X, 0, "X", Action::orbit_down, camera, "Around the target downward, 5 degrees.", held},
    {GLFW_KEY_Y, 0, "Y", Action::nearer, camera, "Nearer to the target by a tenth of the way.", held},
    {GLFW_KEY_C, 0, "C", Action::farther, camera, "Farther from the target, as much as Y comes nearer.", held},
    {GLFW_KEY_UP, 0, "Up", Action::fly_forward, camera, "Fly forward.", held},
    {GLFW_KEY_DOWN, 0, "Down", Action::fly_back, camera, "Fly back.", held},
    {GLFW_KEY_LEFT, 0, "Left", Action::fly_left, camera, "Fly to the left.", held},
    {GLFW_KEY_RIGHT, 0, "Right", Action::fly_right, camera, "Fly to the right.", held},
    {GLFW_KEY_PAGE_UP, 0, "Page Up", Action::fly_up, camera, "Fly up.", held},
    {GLFW_KEY_PAGE_DOWN, 0, "Page Down", Action::fly_down, camera, "Fly down.", held},
    {GLFW_KEY_HOME, 0, "Home", Action::reset_view, camera, "Back to the view as the scene has it."},

    {GLFW_KEY_V, 0, "V", Action::light_left, light, "Along -x by a fiftieth of the scene's diagonal.", held},
    {GLFW_KEY_B, 0, "B", Action::light_right, light, "Along +x by a fiftieth of the scene's diagonal.", held},
    {GLFW_KEY_N, 0, "N", Action::light_down, light, "Down by a fiftieth of the scene's diagonal.", held},
    {GLFW_KEY_M, 0, "M", Action::light_up, light, "Up by a fiftieth of the scene's diagonal.", held},
    {GLFW_KEY_END, 0, "End", Action::reset_light, light, "Back to the light as the scene has it."},

    {GLFW_KEY_1, 0, "1", Action::layout_left, compare, "The left side alone."},
    {GLFW_KEY_2, 0, "2", Action::layout_right, compare, "The right side alone."},
    {GLFW_KEY_3, 0, "3", Action::layout_split, compare, "Both sides, with a divider to drag between them."},
    {GLFW_KEY_4, 0, "4", Action::layout_flicker, compare, "Both sides in turn."},
    {GLFW_KEY_5, 0, "5", Action::paint_shaded, compare, "Paint: the shaded scene."},
    {GLFW_KEY_6, 0, "6", Action::paint_mask, compare, "Paint: the visibility mask."},
    {GLFW_KEY_7, 0, "7", Action::paint_difference, compare, "Paint: where the sides differ."},
    {GLFW_KEY_8, 0, "8", Action::paint_kinds, compare, "Paint: false dark and false lit pixels."},
    {GLFW_KEY_9, 0, "9", Action::paint_causes, compare, "Paint: the cause of each wrong pixel."},
    {GLFW_KEY_0, 0, "0", Action::paint_classes, compare, "Paint: the class of each pixel."},
    {GLFW_KEY_COMMA, 0, ",", Action::technique_before, compare, "The left side's technique: the one before."},
    {GLFW_KEY_PERIOD, 0, ".", Action::technique_after, compare, "The left side's technique: the one after."},
    {GLFW_KEY_TAB, 0, "Tab", Action::swap_sides, compare, "Swap the sides."},

    {GLFW_KEY_G, 0, "G", Action::layer_after, layers, "The left side's next debug layer; after the last, none."},
    {GLFW_KEY_O, 0, "O", Action::silhouettes, layers, "Silhouette edges on or off."},
    {GLFW_KEY_Z, 0, "Z", Action::magnifier, layers, "The magnifier on or off."},

    {GLFW_KEY_S, GLFW_MOD_CONTROL, "Ctrl+S", Action::save, state,
     "Save the scene, the command that renders it, mask and pictures."},
    {GLFW_KEY_C, GLFW_MOD_CONTROL, "Ctrl+C", Action::copy_command, state, "Copy the command that renders the left side."},
    {GLFW_KEY_F12, 0, "F12", Action::screenshot, state, "Save the window as a picture."},

    {GLFW_KEY_F1, 0, "F1", Action::help, window, "This help on or off."},
    {GLFW_KEY_H, 0, "H", Action::help, window, "This help on or off."},
    {GLFW_KEY_F2, 0, "F2", Action::panels, window, "The panels on or off."},
    {GLFW_KEY_ESCAPE, 0, "Escape", Action::cancel, window, "Close the help; without it, drop the picked pixel."},
    {GLFW_KEY_Q, GLFW_MOD_CONTROL, "Ctrl+Q", Action::quit, window, "Quit."},
};

/// Small ASCII letters, and no blanks: how names are compared.
std::string folded(std::string_view name) {
  std::string plain;
  for (const char c : name)
    if (c != ' ') plain += 'A' <= c && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return plain;
}

const KeyRow* find_name(std::string_view name) {
  const auto row = std::ranges::find(rows, folded(name), [](const KeyRow& r) { return folded(r.name); });
  return row == std::end(rows) ? nullptr : &*row;
}

[[noreturn]] void refuse(const std::string& word) {
  std::vector<std::string> names, plain;
  for (const KeyRow& row : rows) names.emplace_back(row.name), plain.push_back(folded(row.name));
  const std::size_t nearest = std::ranges::find(plain, nearest_word(folded(word), plain)) - plain.begin();
  throw Error("there is no key {}; did you mean {}? There are: {}", word, names[nearest], fmt::join(names, " "));
}

}  // namespace

std::span<const KeyRow> key_rows() { return rows; }

const KeyRow* find_key(int key, int modifiers) {
  const int plain = modifiers & ~(GLFW_MOD_CAPS_LOCK | GLFW_MOD_NUM_LOCK);
  const auto with = [key](int wanted) -> const KeyRow* {
    const auto row = std::ranges::find_if(rows, [&](const KeyRow& r) { return r.key == key && r.modifiers == wanted; });
    return row == std::end(rows) ? nullptr : &*row;
  };
  if (const KeyRow* exact = with(plain)) return exact;
  const KeyRow* shifted = with(plain & ~GLFW_MOD_SHIFT);
  return shifted && shifted->is_held ? shifted : nullptr;
}

std::vector<const KeyRow*> parse_keys(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  std::vector<const KeyRow*> keys;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const KeyRow* row = i + 1 < words.size() ? find_name(words[i] + ' ' + words[i + 1]) : nullptr;
    // What two words say, neither says alone; but "F1 2" is not F12.
    if (row && row->name.find(' ') != std::string_view::npos)
      ++i;
    else if (!(row = find_name(words[i])))
      refuse(words[i]);
    keys.push_back(row);
  }
  return keys;
}

std::string keys_table() {
  std::string table = "| group | key | what it does | held |\n| --- | --- | --- | --- |\n";
  std::string_view group;
  for (std::size_t i = 0; i < std::size(rows); ++i) {
    const KeyRow& row = rows[i];
    std::string keys = fmt::format("`{}`", row.name);
    for (; i + 1 < std::size(rows) && rows[i + 1].action == row.action; ++i) keys += fmt::format(", `{}`", rows[i + 1].name);
    table += fmt::format("| {} | {} | {} | {} |\n", row.group == group ? "" : row.group, keys, markdown_text(row.sentence),
                         row.is_held ? "goes on" : "");
    group = row.group;
  }
  return table;
}

int key_of_cap(int key, std::string_view cap) {
  if (cap.size() != 1 || key >= GLFW_KEY_ESCAPE) return key;  // keys from there on print nothing, or are on the pad
  const char c = cap[0];
  if ('a' <= c && c <= 'z') return GLFW_KEY_A + (c - 'a');
  // GLFW's codes of signs are those of ASCII.
  return ('A' <= c && c <= 'Z') || ('0' <= c && c <= '9') || std::string_view("',-./;=[\\]`").find(c) != std::string_view::npos
             ? c
             : key;
}

int layout_key(int key, int scancode) {
  const char* cap = glfwGetKeyName(key, scancode);
  return cap ? key_of_cap(key, cap) : key;
}

void HeldKeys::press(const KeyRow& row, double now) {
  constexpr double pause = 1.0 / 3;
  const auto is_down = [&](const Held& held) { return held.row->key == row.key && !held.is_released; };
  if (std::ranges::none_of(held_, is_down)) held_.push_back({&row, now + pause});
}

void HeldKeys::release(int key) {
  for (Held& held : held_) held.is_released = held.is_released || held.row->key == key;
}

void HeldKeys::release_all() {
  for (Held& held : held_) held.is_released = true;
}

std::vector<HeldKeys::Steps> HeldKeys::take(double now) {
  constexpr double a_second = 20, longest = 0.25;
  std::vector<Steps> all;
  for (Held& held : held_) {
    double steps = held.is_new ? 1 : 0;
    if (held.row->is_held && !held.is_released && now > held.repeats_from) {
      steps += a_second * std::min(now - held.repeats_from, longest);
      held.repeats_from = now;
    }
    held.is_new = false;
    if (steps > 0) all.push_back({held.row->action, steps});
  }
  std::erase_if(held_, [](const Held& held) { return held.is_released || !held.row->is_held; });
  return all;
}

}  // namespace gnomon::viewer
