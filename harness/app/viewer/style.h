#pragma once
#include <imgui.h>

namespace gnomon::viewer {

/// Dear ImGui's colors and distances, `scale` times as large.
void set_style(double scale);

// Colors that mean something.
inline constexpr ImU32 quiet_text = IM_COL32(146, 152, 161, 255);
inline constexpr ImU32 warning_text = IM_COL32(240, 160, 90, 255);
inline constexpr ImU32 light_color = IM_COL32(255, 214, 102, 255);
inline constexpr ImU32 blocked_color = IM_COL32(239, 83, 80, 255);
inline constexpr ImU32 picked_color = IM_COL32(255, 255, 255, 255);
/// Of the button that is chosen among several.
inline constexpr ImU32 chosen_color = IM_COL32(56, 104, 146, 255);
inline constexpr ImU32 tap_color = IM_COL32(102, 204, 255, 255);

/// Width of the controls at the left and height of the strip below, pixels at scale 1.
inline constexpr int panel_width = 320, strip_height = 220;

/// Of the light's handle, pixels at scale 1: how large it is, and how far inside the border it is shown at least.
inline constexpr float handle_radius = 6, handle_margin = 36;  // below the titles

/// Lengths that the panels share, in units of Dear ImGui.
struct Lengths {
  float panel, strip, label, gap;
};
Lengths lengths();

}  // namespace gnomon::viewer
