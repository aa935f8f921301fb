#pragma once
#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "measure/picture/picture.h"

struct GLFWwindow;

namespace gnomon::viewer {

/// What somebody did in the window. Places are framebuffer pixels from the top left, as all places here.
struct WindowEvent {
  enum class Kind { key, button, motion, wheel, focus_lost };
  Kind kind = Kind::motion;
  int code = 0;  ///< GLFW_KEY_..., by the letter on the key's cap, or GLFW_MOUSE_BUTTON_...
  int modifiers = 0;
  bool is_pressed = false;  ///< else released; a key that repeats by itself is no event
  glm::dvec2 place{0};
  double wheel = 0;
};

/// A window with an OpenGL context and Dear ImGui in it, and one picture as a texture. One at a time, in the main thread.
class Window {
 public:
  /// Creates it hidden. Throws Error when there is no display, or it gives no OpenGL 3.3.
  explicit Window(const std::string& title);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// Gives it a framebuffer of this size, or what the display has room for, and shows it.
  void show(int width, int height);
  glm::ivec2 size() const;  ///< of the framebuffer, pixels
  /// How many pixels make the width of one at an ordinary display.
  double scale() const;
  bool is_closing() const;

  /// Waits for something to happen, but no longer than this; below 0: as long as it takes.
  void wait(double seconds) const;
  /// What happened since the last call, in order.
  std::vector<WindowEvent> take_events();
  /// Whether Dear ImGui has yet to be given button events, which `take_events` returned already: it takes one for each picture.
  bool has_button_events() const;
  /// Ends the present or next wait. From any thread.
  static void wake();
  static double now();  ///< seconds

  /// The picture that `picture_texture` names: width * height, bytes R, G, B, A.
  void set_picture(std::span<const std::uint32_t> rgba, int width, int height);
  unsigned picture_texture() const { return texture_; }

  /// Calls of Dear ImGui are made between these two; the second draws them. `present` shows what was drawn.
  void begin_drawing();
  void end_drawing();
  void present();
  /// What was drawn since the last `present`.
  Picture read_picture() const;

  void set_clipboard(const std::string& text);

 private:
  void load_font();
  void pass_button_event();

  GLFWwindow* window_ = nullptr;
  unsigned texture_ = 0;
  glm::ivec2 texture_size_{0};
  double font_scale_ = 0;
  std::array<bool, 5> buttons_down_ = {};  // as they were passed to Dear ImGui
  glm::dvec2 passed_place_{0};
};

/// Framebuffer pixels of a unit of Dear ImGui, which counts as the window system does.
double pixels_per_unit();

/// While it lives, SIGTERM, SIGINT and SIGHUP request an end of the program instead of killing it, so that workers and scratch
/// files end with it. The second of a kind kills it. Those that were ignored stay ignored. One at a time.
class StopSignals {
 public:
  /// `asked` is called from a thread of its own, after `is_asked` has become true.
  explicit StopSignals(std::function<void()> asked);
  ~StopSignals();
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;

  bool is_asked() const { return is_asked_; }

 private:
  std::atomic<bool> is_asked_ = false;
  std::thread thread_;
};

}  // namespace gnomon::viewer
