#pragma once
#include <string_view>
#include <vector>

#include "app/viewer/keys.h"

namespace gnomon::viewer {

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
