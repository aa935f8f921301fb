#include "app/viewer/keys.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <gnomon/error.h>

#include <algorithm>
#include <sstream>

#include "report/table/layout.h"

namespace gnomon::viewer {
namespace {

/// The keys that work in every scene.
std::vector<KeyRow> own_rows() {
  constexpr const char *camera = "Camera", *light = "Light", *animation = "Animation", *compare = "Compare",
                       *parameters = "Parameters", *layers = "Layers", *state = "State", *window = "Window";
  constexpr bool held = true;
  return {
      {GLFW_KEY_A, 0, "A", OrbitSteps{.right = -1}, camera, "Around the target to the left, 5 degrees.", held},
      {GLFW_KEY_D, 0, "D", OrbitSteps{.right = 1}, camera, "Around the target to the right, 5 degrees.", held},
      {GLFW_KEY_S, 0, "S", OrbitSteps{.up = 1}, camera, "Around the target upward, 5 degrees.", held},
      {GLFW_KEY_X, 0, "X", OrbitSteps{.up = -1}, camera, "Around the target downward, 5 degrees.", held},
      {GLFW_KEY_Y, 0, "Y", ZoomSteps{1}, camera, "Nearer to the target by a tenth of the way.", held},
      {GLFW_KEY_C, 0, "C", ZoomSteps{-1}, camera, "Farther from the target, as much as Y comes nearer.", held},
      {GLFW_KEY_UP, 0, "Up", FlySteps{.forward = 1}, camera, "Fly forward.", held},
      {GLFW_KEY_DOWN, 0, "Down", FlySteps{.forward = -1}, camera, "Fly back.", held},
      {GLFW_KEY_LEFT, 0, "Left", FlySteps{.right = -1}, camera, "Fly to the left.", held},
      {GLFW_KEY_RIGHT, 0, "Right", FlySteps{.right = 1}, camera, "Fly to the right.", held},
      {GLFW_KEY_PAGE_UP, 0, "Page Up", FlySteps{.up = 1}, camera, "Fly up.", held},
      {GLFW_KEY_PAGE_DOWN, 0, "Page Down", FlySteps{.up = -1}, camera, "Fly down.", held},
      {GLFW_KEY_HOME, 0, "Home", Action::reset_view, camera, "Back to the view as the scene has it."},

      {GLFW_KEY_V, 0, "V", LightSteps{.x = -1}, light, "Along -x by a fiftieth of the scene's diagonal.", held},
      {GLFW_KEY_B, 0, "B", LightSteps{.x = 1}, light, "Along +x by a fiftieth of the scene's diagonal.", held},
      {GLFW_KEY_N, 0, "N", LightSteps{.y = -1}, light, "Down by a fiftieth of the scene's diagonal.", held},
      {GLFW_KEY_M, 0, "M", LightSteps{.y = 1}, light, "Up by a fiftieth of the scene's diagonal.", held},
      {GLFW_KEY_END, 0, "End", Action::reset_light, light, "Back to the light as the scene has it."},
      {GLFW_KEY_E, 0, "E", Action::all_lights, light, "All lights together as one picture, or the chosen one alone."},

      {GLFW_KEY_SPACE, 0, "Space", Action::play, animation, "Play the animation from here on, or pause."},
      {GLFW_KEY_LEFT_BRACKET, 0, "[", FrameSteps{-1}, animation, "A frame back.", held},
      {GLFW_KEY_RIGHT_BRACKET, 0, "]", FrameSteps{1}, animation, "A frame on.", held},

      {GLFW_KEY_1, 0, "1", Layout::left, compare, "The left side alone."},
      {GLFW_KEY_2, 0, "2", Layout::right, compare, "The right side alone."},
      {GLFW_KEY_3, 0, "3", Layout::split, compare, "Both sides, with a divider to drag between them."},
      {GLFW_KEY_4, 0, "4", Layout::flicker, compare, "Both sides in turn."},
      {GLFW_KEY_5, 0, "5", Paint::shaded, compare, "Paint: the shaded scene."},
      {GLFW_KEY_6, 0, "6", Paint::mask, compare, "Paint: the visibility mask."},
      {GLFW_KEY_7, 0, "7", Paint::difference, compare, "Paint: the difference to the reference, or to the other side."},
      {GLFW_KEY_8, 0, "8", Paint::kinds, compare, "Paint: false dark and false lit pixels."},
      {GLFW_KEY_9, 0, "9", Paint::causes, compare, "Paint: the cause of each wrong pixel."},
      {GLFW_KEY_0, 0, "0", Paint::classes, compare, "Paint: the class of each pixel."},
      {GLFW_KEY_COMMA, 0, ",", Action::technique_before, compare, "The left side's technique: the one before."},
      {GLFW_KEY_PERIOD, 0, ".", Action::technique_after, compare, "The left side's technique: the one after."},
      {GLFW_KEY_TAB, 0, "Tab", Action::swap_sides, compare, "Swap the sides."},

      {GLFW_KEY_W, 0, "W", ParameterSteps{.rows = 1}, parameters, "Choose the next parameter, of the sides or the scene."},
      {GLFW_KEY_Q, 0, "Q", ParameterSteps{.rows = -1}, parameters, "Choose the parameter before."},
      {GLFW_KEY_MINUS, 0, "-", ParameterSteps{.values = -1}, parameters, "A smaller number, or the word before.", held},
      {GLFW_KEY_EQUAL, 0, "=", ParameterSteps{.values = 1}, parameters, "A larger number, or the word after.", held},

      {GLFW_KEY_G, 0, "G", Action::layer_after, layers, "The left side's next debug layer; after the last, none."},
      {GLFW_KEY_I, 0, "I", Action::contours, layers, "Contours of visibility 0.02, 0.5 and 0.98 on or off."},
      {GLFW_KEY_P, 0, "P", Action::profile, layers, "A profile along the row of the picked pixel, else the middle; or none."},
      {GLFW_KEY_O, 0, "O", Action::silhouettes, layers, "Silhouette edges on or off."},
      {GLFW_KEY_Z, 0, "Z", Action::magnifier, layers, "The magnifier on or off."},

      {GLFW_KEY_S, GLFW_MOD_CONTROL, "Ctrl+S", Action::save, state,
       "Save the scene, the command that renders it, mask and pictures."},
      {GLFW_KEY_C, GLFW_MOD_CONTROL, "Ctrl+C", Action::copy_command, state, "Copy the command that renders the left side."},
      {GLFW_KEY_F12, 0, "F12", Action::screenshot, state, "Save the window as a picture."},

      {GLFW_KEY_F1, 0, "F1", Action::help, window, "This help on or off."},
      {GLFW_KEY_H, 0, "H", Action::help, window, "This help on or off."},
      {GLFW_KEY_F2, 0, "F2", Action::panels, window, "The panels on or off."},
      {GLFW_KEY_ESCAPE, 0, "Escape", Action::cancel, window,
       "Close the help; without it, drop the picked pixel, then the profile."},
      {GLFW_KEY_Q, GLFW_MOD_CONTROL, "Ctrl+Q", Action::quit, window, "Quit."},
  };
}

/// Small ASCII letters, and no blanks: how names are compared.
std::string folded(std::string_view name) {
  std::string plain;
  for (const char c : name)
    if (c != ' ') plain += 'A' <= c && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return plain;
}

/// NAME=VALUE of a parameter; nothing of other words.
std::optional<ParameterSetting> setting_of(const std::string& word) {
  const std::size_t equal = word.find('=');
  if (equal == std::string::npos || equal == 0) return std::nullopt;
  ParameterSetting setting{word.substr(0, equal), word.substr(equal + 1)};
  if (setting.value.empty()) throw Error("{} sets no value", word);
  return setting;
}

/// What a scene declares, checked but for what other rows have.
std::vector<KeyRow> scene_rows(const SceneEntry& scene) {
  std::vector<KeyRow> rows;
  const auto generator = scene.make();
  for (const SceneKey& key : scene.about.keys) {
    if (key.letter < 'A' || key.letter > 'Z')
      throw Error("scene {} declares the key '{}', which is no letter A to Z", scene.id, key.letter);
    generator->parameter(key.parameter).set(std::string(key.value));
    rows.push_back({.key = key.letter,  // GLFW's codes of letters are those of ASCII
                    .modifiers = 0,
                    .name = std::string(1, key.letter),
                    .effect = SceneSetting{scene.id, std::string(key.parameter), std::string(key.value)},
                    .group = "Scene " + scene.id,
                    .sentence = std::string(key.sentence)});
  }
  return rows;
}

}  // namespace

KeyTable::KeyTable(std::span<const SceneEntry> scenes) {
  const std::vector<KeyRow> own = own_rows();
  for (const SceneEntry& scene : scenes) {
    if (scene.about.keys.empty()) continue;
    std::vector<KeyRow> taken = own;
    for (KeyRow& row : scene_rows(scene)) {
      const bool is_taken =
          std::ranges::any_of(taken, [&](const KeyRow& other) { return other.key == row.key && other.modifiers == 0; });
      if (is_taken) throw Error("scene {} declares the key {}, which the viewer or that scene has already", scene.id, row.name);
      taken.push_back(row);
      rows_.push_back(std::move(row));
    }
  }
  rows_.insert(rows_.end(), own.begin(), own.end());
}

const KeyRow* KeyTable::find(int key, int modifiers, std::string_view scene) const {
  const int plain = modifiers & ~(GLFW_MOD_CAPS_LOCK | GLFW_MOD_NUM_LOCK);
  const auto with = [&](int wanted) {
    const KeyRow* found = nullptr;
    for (const KeyRow& row : rows_) {
      if (row.key != key || row.modifiers != wanted) continue;
      const auto* const setting = std::get_if<SceneSetting>(&row.effect);
      if (!found || (setting && setting->scene == scene)) found = &row;
    }
    return found;
  };
  if (const KeyRow* exact = with(plain)) return exact;
  const KeyRow* shifted = with(plain & ~GLFW_MOD_SHIFT);
  return shifted && shifted->is_held ? shifted : nullptr;
}

const KeyRow* KeyTable::find_name(std::string_view name) const {
  const auto row = std::ranges::find(rows_, folded(name), [](const KeyRow& r) { return folded(r.name); });
  return row == rows_.end() ? nullptr : &*row;
}

std::vector<ScriptStep> KeyTable::parse(const std::string& text) const {
  std::istringstream stream(text);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  std::vector<ScriptStep> steps;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const KeyRow* row = i + 1 < words.size() ? find_name(words[i] + ' ' + words[i + 1]) : nullptr;
    // Two words are one key only where its name has a blank: "page up" is Page Up, but "F1 2" is not F12.
    if (row && row->name.find(' ') != std::string::npos)
      ++i;
    else
      row = find_name(words[i]);
    const std::optional<ParameterSetting> setting = row ? std::nullopt : setting_of(words[i]);
    if (!row && !setting) {
      std::vector<std::string> names, plain;
      for (const KeyRow& known : rows_) {
        names.push_back(known.name);
        plain.push_back(folded(known.name));
      }
      const std::size_t nearest = std::ranges::find(plain, nearest_word(folded(words[i]), plain)) - plain.begin();
      throw Error("there is no key {}; did you mean {}? There are: {}", words[i], names[nearest], joined(names, " "));
    }
    setting ? steps.emplace_back(*setting) : steps.emplace_back(row);
  }
  return steps;
}

std::string KeyTable::markdown() const {
  std::string table = "| group | key | what it does | held |\n| --- | --- | --- | --- |\n";
  std::string_view group;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const KeyRow& row = rows_[i];
    std::string keys = fmt::format("`{}`", row.name);
    for (; i + 1 < rows_.size() && rows_[i + 1].effect == row.effect; ++i) keys += fmt::format(", `{}`", rows_[i + 1].name);
    table += fmt::format("| {} | {} | {} | {} |\n", row.group == group ? "" : row.group, keys, markdown_text(row.sentence),
                         row.is_held ? "goes on" : "");
    group = row.group;
  }
  return table;
}

const KeyTable& key_table() {
  static const KeyTable table(registry().scenes());
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

void HeldKeys::press(const KeyRow& row, double now) {
  constexpr double pause = 1.0 / 3;
  const auto is_down = [&](const Press& press) { return press.row->key == row.key && !press.is_released; };
  if (std::ranges::none_of(presses_, is_down)) presses_.push_back({&row, now + pause});
}

void HeldKeys::release(int key) {
  for (Press& press : presses_) press.is_released = press.is_released || press.row->key == key;
}

void HeldKeys::release_all() {
  for (Press& press : presses_) press.is_released = true;
}

std::vector<HeldKeys::Steps> HeldKeys::take(double now) {
  constexpr double a_second = 20, longest = 0.25;
  std::vector<Steps> all;
  for (Press& press : presses_) {
    double count = press.is_new ? 1 : 0;
    if (press.row->is_held && !press.is_released && now > press.repeats_from) {
      count += a_second * std::min(now - press.repeats_from, longest);
      press.repeats_from = now;
    }
    press.is_new = false;
    if (count > 0) all.push_back({press.row, count});
  }
  std::erase_if(presses_, [](const Press& press) { return press.is_released || !press.row->is_held; });
  return all;
}

}  // namespace gnomon::viewer
