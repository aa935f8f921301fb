#pragma once
#include <glm/glm.hpp>
#include <optional>
#include <string_view>
#include <vector>

namespace gnomon::viewer {

/// What a mouse button that is down does.
enum class DragKind {
  nothing,
  waiting,  ///< pressed on the picture; nothing has moved, and it may become a click
  orbit,
  look,
  pan,
  line,     ///< draws the line of the profile
  light,    ///< drags the light's handle
  size,     ///< drags a handle of the light's size
  divider,  ///< drags the divider
};

/// What a press can grab besides the picture itself. Places are framebuffer pixels, as everywhere here.
struct GrabTargets {
  std::optional<glm::dvec2> light;                    ///< where the light's handle is shown; nothing where it is not
  std::optional<double> divider;                      ///< its x; only in layout split
  double scale = 1;                                   ///< of the user interface: the distances below are so many times as large
  std::vector<std::optional<glm::dvec2>> sizes = {};  ///< where the handles of the light's size are
};

/// Distinguishes clicks and drags. The caller reports what happens over the picture, but no presses elsewhere. Points are
/// framebuffer pixels, times seconds; `button` and `modifiers` are GLFW_MOUSE_BUTTON_... and GLFW_MOD_...
class Gesture {
 public:
  static constexpr double click_distance = 3, click_seconds = 0.5, light_distance = 10, size_distance = 8, divider_distance = 5;

  /// While another button is down it is a move.
  void press(int button, int modifiers, glm::dvec2 cursor, double now, const GrabTargets& targets);
  /// A press that has moved farther than a click may, or is older, becomes a drag.
  void move(glm::dvec2 cursor, double now);
  /// The point that was clicked, when this ends a click. Of another button it is a move.
  std::optional<glm::dvec2> release(int button, glm::dvec2 cursor, double now);
  /// Ends whatever goes on; a release after it is none. For a window that loses the focus.
  void cancel() { kind_ = DragKind::nothing; }

  DragKind kind() const { return kind_; }
  bool is_drag() const { return kind_ != DragKind::nothing && kind_ != DragKind::waiting; }
  /// Shift was down when the light's handle was grabbed.
  bool is_vertical() const { return is_vertical_; }
  /// Which handle of the light's size was grabbed.
  std::size_t size() const { return size_; }
  /// Where the button went down, and where the mouse is.
  glm::dvec2 pressed_at() const { return pressed_at_; }
  glm::dvec2 cursor() const { return cursor_; }
  /// From the press to the cursor, of a drag; zero while it may become a click.
  glm::dvec2 moved() const { return is_drag() ? cursor_ - pressed_at_ : glm::dvec2(0); }
  /// Where the handle or divider goes that was grabbed: it keeps its offset to the cursor. Of other drags, the cursor.
  glm::dvec2 grabbed() const { return cursor_ + grab_offset_; }

 private:
  DragKind kind_ = DragKind::nothing, drag_kind_ = DragKind::nothing;
  int button_ = 0;
  bool may_click_ = false, is_vertical_ = false;
  std::size_t size_ = 0;
  double pressed_ = 0, scale_ = 1;
  glm::dvec2 pressed_at_{0}, cursor_{0}, grab_offset_{0};
};

/// One use of the mouse is one row, for the help and the page.
struct MouseRow {
  std::string_view name, sentence;
};
inline constexpr MouseRow mouse_rows[] = {
    {"Left drag", "The camera around the target; at the divider, the divider."},
    {"Left drag at the light", "The light, across the line of sight; with Shift, up and down."},
    {"Left drag at its rim", "At a handle of a light with area: its size."},
    {"Ctrl+left drag", "The line of a profile: masks and reference along it."},
    {"Right drag", "Look around from where the camera is."},
    {"Middle drag", "Camera and target aside; Shift+left drag too."},
    {"Wheel", "Nearer and farther."},
    {"Click", "Pick the pixel."},
};

}  // namespace gnomon::viewer
