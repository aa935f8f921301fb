// Which letter a key bears, and how often a key that is held counts.
#include "app/viewer/keyboard.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>

namespace gnomon::viewer {

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
