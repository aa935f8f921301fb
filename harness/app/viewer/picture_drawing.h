#pragma once
#include <imgui.h>

#include <algorithm>
#include <string>

#include "app/viewer/moves.h"
#include "app/viewer/panels.h"

namespace gnomon::viewer {

/// Draws in pixels of the picture onto a list in units of Dear ImGui.
struct PictureDrawing {
  ImDrawList& list;
  PixelRect place;
  Camera camera;
  float unit;   ///< framebuffer pixels of a unit
  float scale;  ///< of lines and texts

  ImVec2 at(const glm::dvec2& p) const {
    return {static_cast<float>(place.x + p.x) / unit, static_cast<float>(place.y + p.y) / unit};
  }
  void line(const glm::dvec2& a, const glm::dvec2& b, ImU32 color, float width = 1.5f) const {
    list.AddLine(at(a), at(b), color, width * scale);
  }
  /// A segment of space; its part behind the eye is cut off.
  void segment(glm::dvec3 a, glm::dvec3 b, ImU32 color, float width = 1.5f) const {
    double depth_a = glm::dot(a - camera.eye, camera.forward), depth_b = glm::dot(b - camera.eye, camera.forward);
    constexpr double near_share = 1e-3;  // what is nearer to the eye than this share of the farther end is cut off
    const double least = near_share * std::max(depth_a, depth_b);
    if (least <= 0) return;
    if (depth_a < least) a += (b - a) * ((least - depth_a) / (depth_b - depth_a));
    if (depth_b < least) b += (a - b) * ((least - depth_b) / (depth_a - depth_b));
    const auto p = project(camera, a), q = project(camera, b);
    if (p && q) line(*p, *q, color, width);
  }
  void disc(const glm::dvec2& p, float radius, ImU32 color) const {
    list.AddCircleFilled(at(p), (radius + 1) * scale, IM_COL32(0, 0, 0, 160));
    list.AddCircleFilled(at(p), radius * scale, color);
  }
  /// A rectangle about p with an edge as wide as a line of width 1.
  void box(const glm::dvec2& p, const ImVec2& half, ImU32 color, ImU32 edge_color, float rounding = 0) const {
    const ImVec2 c = at(p);
    for (const float edge : {scale, 0.0f})
      list.AddRectFilled({c.x - half.x - edge, c.y - half.y - edge}, {c.x + half.x + edge, c.y + half.y + edge},
                         edge > 0 ? edge_color : color, rounding);
  }
  /// Of words without their plate, pixels of the picture.
  glm::dvec2 extent(const std::string& text) const {
    const ImVec2 size = ImGui::CalcTextSize(text.c_str());
    return glm::dvec2(size.x, size.y) * static_cast<double>(unit);
  }
  /// How far the plate of words goes beyond them, pixels of the picture.
  glm::dvec2 plate() const { return glm::dvec2(3, 1.5) * static_cast<double>(scale * unit); }
  void words(const glm::dvec2& p, const std::string& text, ImU32 color) const {
    const ImVec2 low = at(p - plate()), high = at(p + extent(text) + plate());
    list.AddRectFilled(low, high, IM_COL32(10, 10, 12, 205), 3 * scale);
    list.AddText(at(p), color, text.c_str());
  }
};

}  // namespace gnomon::viewer
