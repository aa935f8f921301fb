#pragma once
#include <gnomon/registry.h>

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "app/viewer/compose.h"

namespace gnomon::viewer {

/// What a key does that changes no camera, light, scene or paint.
enum class Action {
  technique_before,
  technique_after,
  swap_sides,
  layer_after,
  contours,
  profile,
  silhouettes,
  magnifier,
  panels,
  reset_view,
  reset_light,
  all_lights,
  play,
  save,
  copy_command,
  screenshot,
  help,
  quit,
  cancel,
};

// Steps of the camera and the light; `moved_by_key` defines one step.
struct OrbitSteps {
  int right = 0, up = 0;
  bool operator==(const OrbitSteps&) const = default;
};
struct ZoomSteps {
  int nearer = 0;
  bool operator==(const ZoomSteps&) const = default;
};
struct FlySteps {
  int right = 0, up = 0, forward = 0;
  bool operator==(const FlySteps&) const = default;
};
struct LightSteps {
  int x = 0, y = 0;
  bool operator==(const LightSteps&) const = default;
};
/// Frames of the animation that is shown.
struct FrameSteps {
  int frames = 0;
  bool operator==(const FrameSteps&) const = default;
};
/// Chooses a parameter of a side or the scene, or goes on in the values of the one that is chosen; `value_after` defines a
/// step.
struct ParameterSteps {
  int rows = 0, values = 0;
  bool operator==(const ParameterSteps&) const = default;
};
/// Shows a scene with one of its parameters set; that scene declares the key.
struct SceneSetting {
  std::string scene, parameter, value;
  bool operator==(const SceneSetting&) const = default;
};

/// What a key does.
using KeyEffect =
    std::variant<Action, OrbitSteps, ZoomSteps, FlySteps, LightSteps, FrameSteps, ParameterSteps, Layout, Paint, SceneSetting>;

/// The view after `count` steps: 5 degrees around the target, a tenth of the way to it, or `key_step` of flying each. Nothing
/// for keys that do not move the camera; `reset_view` is the session's.
std::optional<View> moved_by_key(const View& view, const Scene& scene, const KeyEffect& effect, double count);
/// The light after `count` steps: its handle moves by `key_step` each along the world's x or y. Nothing for other keys.
std::optional<Light> moved_by_key(const Light& light, const Scene& scene, const KeyEffect& effect, double count);

/// One key is one row: it drives dispatch, the help, `--keys` and the page.
struct KeyRow {
  int key;           ///< GLFW_KEY_...
  int modifiers;     ///< GLFW_MOD_...
  std::string name;  ///< "K", "Ctrl+S", "Page Up"
  KeyEffect effect;
  std::string group;     ///< heading in the help
  std::string sentence;  ///< "Shadowed object: circle."
  bool is_held = false;  ///< goes on while the key is held
};

/// A parameter by the name of its control, "left.resolution", and its value.
struct ParameterSetting {
  std::string name, value;
  bool operator==(const ParameterSetting&) const = default;
};
/// What a script does next: it presses a key, or sets a parameter.
using ScriptStep = std::variant<const KeyRow*, ParameterSetting>;

/// All keys: first those that scenes declare, then the viewer's own.
class KeyTable {
 public:
  /// Throws Error, which names the scene and the letter, when a scene declares a key that is no letter A to Z, that the viewer
  /// uses itself or that the scene declares twice, or a parameter or value that the scene does not have.
  explicit KeyTable(std::span<const SceneEntry> scenes);

  /// In the order of the help; rows of one group, and those of one effect, are neighbors.
  std::span<const KeyRow> rows() const { return rows_; }
  /// The row of a key with exactly these modifiers. Caps Lock and Num Lock do not count, and for keys that go on while they are
  /// held Shift does not: that hand may be about to drag. Of scenes that declare the same letter, `scene` comes first. Null
  /// when the key means nothing.
  const KeyRow* find(int key, int modifiers, std::string_view scene = "") const;
  /// "k left.resolution=512 v Ctrl+S page up": names apart by blanks, whatever their case, with or without the blank inside;
  /// NAME=VALUE sets a parameter of left, right or scene. Throws Error with the nearest name.
  std::vector<ScriptStep> parse(const std::string& text) const;
  /// For docs/viewer.md, Markdown.
  std::string markdown() const;

 private:
  const KeyRow* find_name(std::string_view name) const;

  std::vector<KeyRow> rows_;
};
/// That of the registry; made at the first call, which plugins are loaded before. Throws as the constructor does.
const KeyTable& key_table();

/// The key that bears the letter, digit or sign of this key's cap. GLFW's codes are places on a keyboard of the United States,
/// where Y is what a German or Serbian one calls Z. `cap` is from glfwGetKeyName. Keys that print nothing, or nothing that
/// GLFW has a code for (a Cyrillic letter), keep their place; so does the pad of digits.
int key_of_cap(int key, std::string_view cap);

/// How many steps held keys make: one when pressed, and 20 a second from a third of a second on.
class HeldKeys {
 public:
  /// A key that is down already stays as it is; rows that are not held count once.
  void press(const KeyRow& row, double now);
  void release(int key);
  void release_all();
  bool any() const { return !presses_.empty(); }
  struct Steps {
    const KeyRow* row;
    double count;
  };
  /// The steps since the last call, one entry a press; the first step of a press counts even when it was released before the
  /// call. Of a time without a call longer than a quarter of a second, only as much counts: nothing leaps after a pause.
  std::vector<Steps> take(double now);

 private:
  struct Press {
    const KeyRow* row;
    double repeats_from;  ///< time; later, the time up to which steps are counted
    bool is_new = true, is_released = false;
  };
  std::vector<Press> presses_;
};

}  // namespace gnomon::viewer
