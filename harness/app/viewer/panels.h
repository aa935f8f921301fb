#pragma once
#include "app/viewer/resolve_times.h"
#include "app/viewer/session.h"
#include "app/viewer/widgets.h"
#include "measure/scene/load.h"

namespace gnomon::viewer {

/// A rectangle in framebuffer pixels.
struct PixelRect {
  int x = 0, y = 0, width = 0, height = 0;
  bool holds(glm::dvec2 p) const { return p.x >= x && p.y >= y && p.x < x + width && p.y < y + height; }
};

/// Where things are in the window: controls at the left, the picture, below it the strip.
struct Arrangement {
  PixelRect controls, picture, strip;
};
Arrangement arrange(glm::ivec2 window, double scale, bool with_panels);

/// All that panels show beside the session. Made once a frame.
struct PanelData {
  const EngineState& state;
  const Composition& composition;
  const ResolveTimes& times;
  std::string titles[2];                    ///< of the sides; see title_of
  std::span<const LegendEntry> legends[2];  ///< of the sides
  glm::ivec2 pixel{-1};                     ///< of the picture: picked, else under the mouse; negative: none
  int side = 0;                             ///< that shows it
  unsigned texture = 0;                     ///< the picture
  double frames_per_second = 0;             ///< new frames that the picture showed within the last second
};

/// How many pixels to each side of one the magnifier shows.
inline constexpr int magnifier_reach = 8;
/// Whether the magnifier shows a pixel; plots take its place.
inline bool is_magnified(const Session& session, const PanelData& shown) {
  return session.shows_panels && session.shows_magnifier && !session.profile && !shown.state.curve && shown.pixel.x >= 0;
}

/// A fixed panel at a place; `ImGui::End` ends it whatever it returned.
bool begin_panel(const char* name, const PixelRect& place);

/// Choices and parameters. `scenes` is from `list_scenes`.
void draw_controls(const PixelRect& place, Session& session, const PanelData& shown, std::span<const SceneListing> scenes,
                   Widgets& widgets);
/// Numbers, legend, magnifier and the last message.
void draw_strip(const PixelRect& place, const Session& session, const PanelData& shown);
/// All keys and what the mouse does, over everything.
void draw_help(glm::ivec2 window, Session& session);

/// Of a scene that moves: which animation is shown, at which time, and whether it plays. Nothing of another.
void draw_animation(Session& session, Widgets& widgets);

// Parts of the strip.
void draw_numbers(const PanelData& shown, const Session& session);
void draw_legend(const PanelData& shown);
/// Masks and reference along the line that was drawn over the picture.
void draw_profile(const PanelData& shown, const ProfileLine& line);

/// Error against samples, both logarithmic, in the magnifier's place.
void draw_sample_curve(const SampleCurve& curve);

/// What the texel of the picked pixel holds and what is exact, over the depth along its ray; at the top of the facts.
void draw_depth_curve(const DepthCurve& curve, int side);

}  // namespace gnomon::viewer
