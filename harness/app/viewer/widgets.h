#pragma once
#include <gnomon/param.h>

#include <functional>
#include <glm/glm.hpp>
#include <map>
#include <optional>
#include <span>
#include <string>

namespace gnomon::viewer {

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
  struct ButtonRow {
    std::string name;
    const char* words;
    std::string sentence;
    bool is_chosen = false;
  };
  /// Buttons that share a row, each as wide as its words want. The one that was pressed, or nothing.
  std::optional<std::size_t> buttons(std::span<const ButtonRow> rows, float gap);
  /// Runs what may throw Error.
  bool attempt(const std::function<void()>& work);

  /// A row for each parameter: slider, list or box. Whether one was set.
  bool parameters(const std::string& prefix, Parametrized& object);
  /// Whether the mouse drags a slider of this frame.
  bool is_dragging() const { return is_dragging_; }
  void note_dragging();

 private:
  bool parameter(const std::string& name, Parameter& row);
  template <class T>
  bool number(const Number<T>& row, std::string& text);

  ControlPlaces& places_;
  std::function<void(const std::string&)> refused_;
  bool is_dragging_ = false;
};

}  // namespace gnomon::viewer
