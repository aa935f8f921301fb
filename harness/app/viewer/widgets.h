#pragma once
#include <gnomon/param.h>

#include <functional>
#include <glm/glm.hpp>
#include <map>
#include <optional>
#include <span>
#include <string>

#include "measure/picture/shading.h"

namespace gnomon::viewer {

/// Dear ImGui's colors and distances, `scale` times as large.
void set_style(double scale);

// Colors that mean something, as Dear ImGui packs them (IM_COL32).
constexpr unsigned packed(unsigned r, unsigned g, unsigned b) { return 0xff000000 | b << 16 | g << 8 | r; }
constexpr unsigned packed(const Color& c) { return packed(c[0], c[1], c[2]); }
inline constexpr unsigned quiet_text = packed(146, 152, 161);
inline constexpr unsigned warning_text = packed(240, 160, 90);
inline constexpr unsigned light_color = packed(255, 214, 102);
inline constexpr unsigned blocked_color = packed(239, 83, 80);
inline constexpr unsigned picked_color = packed(255, 255, 255);
/// Of the button that is chosen among several.
inline constexpr unsigned chosen_color = packed(56, 104, 146);
inline constexpr unsigned tap_color = packed(102, 204, 255);

/// Width of the controls at the left and height of the strip below, pixels at scale 1.
inline constexpr int panel_width = 320, strip_height = 220;

/// Of the light's handle, pixels at scale 1: how large it is, and how far inside the border it is shown at least.
inline constexpr float handle_radius = 6, handle_margin = 36;  // below the titles

/// Lengths that the panels share, in units of Dear ImGui; `scale` is that of one pixel at scale 1.
struct Lengths {
  float scale, label, gap;
};
Lengths lengths();

/// Seconds that the mouse rests until a tooltip appears.
inline constexpr double tooltip_delay = 0.35;

/// Where a control was drawn, in framebuffer pixels from the top left.
struct ControlPlace {
  glm::dvec2 low{0}, high{0};
  bool is_visible = true;  ///< false: scrolled out of its panel
};
/// The controls of a frame by their names ("left.technique"), for those who use the window by script.
using ControlPlaces = std::map<std::string, ControlPlace>;

/// Draws controls in rows of a label and a widget, and notes where. Refused values (Error) go to `refused`.
class Widgets {
 public:
  Widgets(ControlPlaces& places, std::function<void(const std::string&)> refused)
      : places_(places), refused_(std::move(refused)) {}

  /// Notes the item that was drawn last.
  void note(const std::string& name);
  /// Begins a row: its label at the left, its widget fills the rest. The sentence is the label's tooltip. The share is of the
  /// usual width.
  void label(const std::string& words, const std::string& sentence = "", float share = 1);
  /// The tooltip of the item drawn last.
  static void tooltip(const std::string& words);
  /// Words in as many lines as they need in that width, ended at blanks alone; Dear ImGui ends them at points, too, amid
  /// numbers.
  static std::string lines(const std::string& words, float width);
  static void wrapped(const std::string& words);
  /// The same in a color.
  static void wrapped(const std::string& words, unsigned color);
  /// A button as wide as the room that is left.
  bool button(const std::string& name, const char* words, const std::string& sentence);
  /// One of several buttons, or of the rows of a list.
  struct Choice {
    std::string name, words, sentence = {};
    bool is_chosen = false, is_enabled = true;
  };
  /// Buttons that share a row, each as wide as its words need. The one that was pressed, or nothing.
  std::optional<std::size_t> buttons(std::span<const Choice> choices, float gap);
  /// A list that opens at a click on `shown`. The row that was chosen, or nothing.
  std::optional<std::size_t> list(const std::string& name, const std::string& shown, std::span<const Choice> choices,
                                  int flags = 0);
  /// Words at the right edge.
  static void right(const std::string& words);
  /// Runs what may throw Error.
  bool attempt(const std::function<void()>& work);

  /// A slider of a double, or of a float or int, whose number stands on a plate of its own: it can be read wherever the grab
  /// is. Ctrl+click on it types. Whether it was set.
  template <class T>
  static bool slider(const char* id, T& value, T low, T high, const char* format, int flags = 0);
  /// A row for each parameter: slider, list or box. Whether one was set.
  bool parameters(const std::string& prefix, Parametrized& object);
  /// The row of this name stands out; where it is newly so, its panel is scrolled to it.
  void mark(const std::string& name, bool is_new) {
    marked_ = name;
    is_newly_marked_ = is_new;
  }
  /// Notes the item that was drawn last, and whether the mouse drags it.
  void note_slider(const std::string& name);
  /// Whether the mouse drags a slider of this frame.
  bool is_dragging() const { return is_dragging_; }

 private:
  bool parameter(const std::string& name, Parameter& row);
  template <class T>
  bool number(const Number<T>& row, std::string& text);

  ControlPlaces& places_;
  std::function<void(const std::string&)> refused_;
  std::string marked_;
  bool is_newly_marked_ = false;
  bool is_dragging_ = false;
};

}  // namespace gnomon::viewer
