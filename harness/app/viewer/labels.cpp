#include "app/viewer/labels.h"

#include <imgui.h>

#include <algorithm>

#include "app/viewer/label_places.h"

namespace gnomon::viewer {

namespace {

constexpr ImU32 plain_text = IM_COL32(235, 235, 235, 255);

/// The columns of the picture that show a side: from, to.
struct Columns {
  double first, end;
};
Columns columns_of(const Composition& composition, int side) {
  const double all = composition.width, middle = composition.divider * all;
  if (composition.layout == Layout::split) return side == 0 ? Columns{0, middle} : Columns{middle, all};
  return side_at(composition, 0) == side ? Columns{0, all} : Columns{0, 0};
}

/// Draws words, and remembers where they are.
class Labels {
 public:
  explicit Labels(const PictureDrawing& drawing)
      : drawing_(drawing), places_({drawing.place.width, drawing.place.height}), around_(2.0 * drawing.plate()) {}

  /// In as many lines as a width needs.
  std::string lines(const std::string& words, double width) const {
    return Widgets::lines(words, static_cast<float>(width / drawing_.unit));
  }
  glm::dvec2 extent(const std::string& words) const { return drawing_.extent(words); }

  /// At that corner, or below what is there.
  void draw_below(const glm::dvec2& corner, const std::string& words, ImU32 color) {
    drawing_.words(places_.put_below(corner - around_, extent(words) + 2.0 * around_) + around_, words, color);
  }
  /// At the first free of these corners.
  void draw_free(std::span<const glm::dvec2> corners, const std::string& words, ImU32 color) {
    std::vector<glm::dvec2> wanted;
    for (const glm::dvec2& corner : corners) wanted.push_back(corner - around_);
    if (const auto corner = places_.put(wanted, extent(words) + 2.0 * around_)) drawing_.words(*corner + around_, words, color);
  }

 private:
  const PictureDrawing& drawing_;
  LabelPlaces places_;
  glm::dvec2 around_;  // the plate of words, and as much to the next one
};

/// The names of the sides in their upper corners, and why an answer is approximate.
void draw_titles(const PictureDrawing& drawing, const PanelData& shown, Labels& labels) {
  const double margin = 8 * drawing.scale * drawing.unit, font = ImGui::GetFontSize() * drawing.unit;
  for (int side = 0; side < 2; ++side) {
    const Columns columns = columns_of(shown.composition, side);
    const bool is_right = shown.composition.layout == Layout::split && side == 1;
    const double room = std::min(columns.end - columns.first - 2 * margin, 30 * font);
    const auto draw = [&](const std::string& words, ImU32 color) {
      const std::string lines = labels.lines(words, room);
      const double width = labels.extent(lines).x;
      if (width > room) return;  // not even a word
      labels.draw_below({is_right ? columns.end - margin - width : columns.first + margin, margin}, lines, color);
    };
    draw(shown.titles[side], plain_text);
    const SideState& state = shown.state.sides[side];
    if (!state.is_reference && state.is_approximate()) draw("approximate: " + state.answer->support.why(), warning_text);
  }
}

/// Words in the middle of some columns of the picture, in as many lines as they need.
void draw_notice(const PictureDrawing& drawing, Columns columns, const std::string& words, ImU32 color, Labels& labels) {
  const double font = ImGui::GetFontSize() * drawing.unit, room = columns.end - columns.first - 3 * font;
  if (room < 6 * font) return;
  const std::string lines = labels.lines(words, std::min(room, 34 * font));
  const glm::dvec2 middle((columns.first + columns.end) / 2, drawing.place.height * 0.4);  // above the divider's grip
  labels.draw_below(middle - labels.extent(lines) / 2.0, lines, color);
}

/// What a side without an answer waits for, or why it has none.
void draw_notices(const PictureDrawing& drawing, const Session& session, const PanelData& shown, Labels& labels) {
  const EngineState& state = shown.state;
  const auto draw = [&](Columns columns, const std::string& words, ImU32 color) {
    draw_notice(drawing, columns, words, color, labels);
  };
  const Columns all{0, static_cast<double>(drawing.place.width)};
  if (!state.trouble.empty()) return draw(all, state.trouble, warning_text);
  if (state.is_loading) return draw(all, "loading " + session.selection().scene, plain_text);
  for (int side = 0; side < 2; ++side) {
    const SideState& s = state.sides[side];
    const Columns columns = columns_of(shown.composition, side);
    if (s.phase == Phase::failed || s.phase == Phase::unsupported) {
      draw(columns, fmt::format("{}: {}", s.phase == Phase::failed ? "failed" : "unsupported", s.words), warning_text);
    } else if (s.is_reference ? !state.reference : !s.answer) {
      const std::string what = s.phase == Phase::starting || s.words.empty() ? "starting" : s.words;
      draw(columns, s.seconds >= 0.1 ? fmt::format("{} {:.1f} s", what, s.seconds) : what, plain_text);
    }
  }
}

/// Beside the handle, first on the side of the picture's middle, where there is most room.
void draw_light_name(const PictureDrawing& drawing, const Selection& selection, const glm::dvec2& handle, Labels& labels) {
  const Light& light = selection.light;
  const std::string name = selection.together.empty() ? light.name : std::string(whole_name(light.name));
  const glm::dvec2 extent = labels.extent(name);
  const double apart = (handle_radius + 5) * drawing.scale * drawing.unit, font = ImGui::GetFontSize() * drawing.unit;
  const bool is_right = handle.x > drawing.place.width / 2.0;
  const double near = is_right ? -apart - extent.x : apart, far = is_right ? apart : -apart - extent.x;
  // Above and below the handles of its size.
  const double above = (has_area(light) ? -2 : -0.5) * font, below = has_area(light) ? font : 0.5 * font;
  const glm::dvec2 corners[] = {handle + glm::dvec2(near, above),
                                handle + glm::dvec2(far, above),
                                handle + glm::dvec2(near, below),
                                handle + glm::dvec2(far, below),
                                handle + glm::dvec2(-extent.x / 2, -2 * apart - font),
                                handle + glm::dvec2(-extent.x / 2, 2 * apart)};
  labels.draw_free(corners, name, light_color);
}

}  // namespace

void draw_labels(const PictureDrawing& drawing, const Session& session, const PanelData& shown,
                 const std::optional<Handle>& light) {
  Labels labels(drawing);
  draw_titles(drawing, shown, labels);
  draw_notices(drawing, session, shown, labels);
  if (light) draw_light_name(drawing, session.selection(), light->shown, labels);
}

}  // namespace gnomon::viewer
