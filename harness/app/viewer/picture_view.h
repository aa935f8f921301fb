#pragma once
#include <span>

#include "app/viewer/mouse.h"
#include "app/viewer/moves.h"
#include "app/viewer/panels.h"
#include "app/viewer/window.h"

namespace gnomon::viewer {

/// The picture as it was composed last, and what its colors mean. Keeps alive what its composition points at.
class Canvas {
 public:
  /// Composes anew when anything visible has changed; returns whether it did.
  bool compose(const Session& session, const EngineState& state, const PixelRect& place);

  /// Whether the state has other masks, verdicts or layers than those that the picture was composed of.
  bool is_outdated(const EngineState& state) const;

  /// Whether it was composed as the session now has it: layout, colors, divider and so on.
  bool shows_choices_of(const Session& session) const;

  const Composition& composition() const { return composition_; }
  std::span<const std::uint32_t> pixels() const { return pixels_; }
  std::span<const LegendEntry> legend_of(int side) const { return legends_[side]; }

 private:
  EngineState state_;
  Composition composition_;
  bool is_made_ = false;
  std::vector<std::uint32_t> pixels_;
  std::vector<LegendEntry> legends_[2];
};

/// The newest frame that a side shows; null where none does.
const Frame* shown_frame(const Composition& composition);
/// The view that the picture shows: of that frame, else the selected one.
View shown_view(const Session& session, const Composition& composition);
/// The light's handle, in pixels of the picture; nothing when the light is behind the eye.
std::optional<Handle> shown_handle(const Session& session, const Composition& composition, double scale);

/// The handles of the light's size, in pixels of the picture; nothing of one behind the eye.
std::vector<std::optional<glm::dvec2>> shown_sizes(const Session& session, const Composition& composition);

/// What the mouse does to the picture: camera, light, divider, picking. A gesture belongs to the picture from its press on,
/// wherever the mouse goes.
class PictureView {
 public:
  /// The window's events, in order. `is_covered`: a list or the help lies over the picture.
  void use(std::span<const WindowEvent> events, const PixelRect& place, const Composition& shown, bool is_covered, double scale,
           Session& session);
  bool is_dragging() const { return gesture_.is_drag(); }
  /// Where the mouse is in the picture; nothing outside it.
  std::optional<glm::dvec2> mouse() const { return mouse_; }
  /// What is dragged, or what a press now would grab: light, its size, or divider.
  DragKind handle() const { return handle_; }

 private:
  GrabTargets targets(const Composition& shown, const Session& session, double scale) const;
  void drag(const Composition& shown, Session& session);

  Gesture gesture_;
  DragKind handle_ = DragKind::nothing;
  std::optional<glm::dvec2> mouse_;
  // When the button went down.
  View view_;
  Light light_;
  std::optional<Camera> camera_;
  glm::dvec2 beside_{0};  // from the light's handle as it is shown to where the light is
};

}  // namespace gnomon::viewer
