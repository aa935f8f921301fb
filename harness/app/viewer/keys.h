#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gnomon::viewer {

/// What a key does. The letters of the object, camera and light keys are those of Pljaskovic et al.
enum class Action {
  object_circle,
  object_triangle,
  object_sphere,
  object_cone,
  orbit_left,
  orbit_right,
  orbit_up,
  orbit_down,
  nearer,
  farther,
  light_left,
  light_right,
  light_down,
  light_up,
  fly_forward,
  fly_back,
  fly_left,
  fly_right,
  fly_up,
  fly_down,
  layout_left,
  layout_right,
  layout_split,
  layout_flicker,
  paint_shaded,
  paint_mask,
  paint_difference,
  paint_kinds,
  paint_causes,
  paint_classes,
  technique_before,
  technique_after,
  swap_sides,
  layer_after,
  silhouettes,
  magnifier,
  panels,
  reset_view,
  reset_light,
  save,
  copy_command,
  screenshot,
  help,
  quit,
  cancel,
};

/// One key is one row: it drives dispatch, the help, `--keys` and the page.
struct KeyRow {
  int key;                ///< GLFW_KEY_...
  int modifiers;          ///< GLFW_MOD_...
  std::string_view name;  ///< "K", "Ctrl+S", "Page Up"
  Action action;
  std::string_view group;     ///< heading in the help
  std::string_view sentence;  ///< "Shadowed object: circle."
  bool is_held = false;       ///< goes on while the key is held
};
/// In the order of the help; rows of one group, and those of one action, stand together.
std::span<const KeyRow> key_rows();
/// The row of a key with exactly these modifiers, but for the locks, and for Shift on keys that are held: that hand may be
/// about to drag. Null when it means nothing.
const KeyRow* find_key(int key, int modifiers);
/// "k v v Ctrl+S page up": names apart by blanks, whatever their case, with or without the blank inside. Throws Error with the
/// nearest name.
std::vector<const KeyRow*> parse_keys(const std::string& text);
/// The table of keys for docs/viewer.md, Markdown.
std::string keys_table();

/// The key that bears the letter, digit or sign of this key's cap. GLFW's codes are places on a keyboard of the United States,
/// where Y is what a German or Serbian one calls Z. `cap` is what glfwGetKeyName says. Keys that print nothing, or nothing that
/// GLFW has a code for (a Cyrillic letter), keep their place; so does the pad of digits.
int key_of_cap(int key, std::string_view cap);
/// The same for a key event. GLFW must be up.
int layout_key(int key, int scancode);

/// How many steps held keys make: one when pressed, and 20 a second from a third of a second on.
class HeldKeys {
 public:
  /// A key that is down already stays as it is; rows that are not held count once.
  void press(const KeyRow& row, double now);
  void release(int key);
  void release_all();
  bool any() const { return !held_.empty(); }
  struct Steps {
    Action action;
    double steps;
  };
  /// The steps since the last call, one entry a press; the first step of a press counts even when it was released before the
  /// call. Of a time without a call longer than a quarter of a second, only as much counts: nothing leaps after a pause.
  std::vector<Steps> take(double now);

 private:
  struct Held {
    const KeyRow* row;
    double repeats_from;  ///< time; later, the time up to which steps are counted
    bool is_new = true, is_released = false;
  };
  std::vector<Held> held_;
};

}  // namespace gnomon::viewer
