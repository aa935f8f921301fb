// Lines and handles over the picture. All places are computed in pixels of the picture.
#include "app/viewer/overlays.h"

#include <imgui.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "app/viewer/light_size.h"
#include "app/viewer/picture_view.h"
#include "measure/frame/light_rays.h"

namespace gnomon::viewer {

namespace {

constexpr double quick_ms = 6;       // a search for silhouettes that takes no longer is waited for
constexpr double near_share = 1e-3;  // what is nearer to the eye than this share of a segment's farther end is cut off

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
  void words(const glm::dvec2& p, const std::string& text, ImU32 color) const {
    const ImVec2 corner = at(p), size = ImGui::CalcTextSize(text.c_str());
    const float margin = 3 * scale;
    list.AddRectFilled({corner.x - margin, corner.y - margin / 2}, {corner.x + size.x + margin, corner.y + size.y + margin / 2},
                       IM_COL32(10, 10, 12, 205), margin);
    list.AddText(corner, color, text.c_str());
  }
};

/// A light with area to its size, and the handles that change it.
void draw_light_size(const PictureDrawing& drawing, const Light& light, std::span<const std::optional<glm::dvec2>> handles) {
  // Dark below, so that it is seen before a bright wall, too.
  const auto outline = light_outline(light, drawing.camera.eye);
  for (const auto& [from, to] : outline) drawing.segment(from, to, IM_COL32(0, 0, 0, 150), 3.5f);
  for (const auto& [from, to] : outline) drawing.segment(from, to, light_color, 1.5f);
  const float half = 3.5f * drawing.scale;
  for (const auto& handle : handles)
    if (handle) drawing.box(*handle, {half, half}, light_color, IM_COL32(0, 0, 0, 160));
}

/// The line of the profile, and where it begins.
void draw_profile_line(const PictureDrawing& drawing, const ProfileLine& line) {
  drawing.line(line.from, line.to, IM_COL32(0, 0, 0, 200), 3.5f);
  drawing.line(line.from, line.to, picked_color, 1.5f);
  drawing.disc(line.from, 4, picked_color);
  drawing.disc(line.to, 2.5f, picked_color);
}

constexpr ImU32 faint_light = IM_COL32(255, 214, 102, 110);

/// The light's handle with its name, a line down to the lowest height of the scene, and a cross there.
void draw_light(const PictureDrawing& drawing, const Scene& scene, const Selection& selection,
                const std::optional<Handle>& handle) {
  const Light& light = selection.light;
  const glm::dvec3 place = light_place(scene, light);
  const double ground = scene.bounds().min.y;
  const double arm = 0.5 * key_step(scene);
  const glm::dvec3 foot(place.x, ground, place.z);
  drawing.segment(place, foot, faint_light, 1);
  drawing.segment(foot - glm::dvec3(arm, 0, 0), foot + glm::dvec3(arm, 0, 0), faint_light, 1);
  drawing.segment(foot - glm::dvec3(0, 0, arm), foot + glm::dvec3(0, 0, arm), faint_light, 1);
  if (!handle) return;
  drawing.disc(handle->shown, handle_radius, light_color);
  // Towards the middle, where there is room.
  const std::string name = selection.together.empty() ? light.name : std::string(whole_name(light.name));
  const double width = ImGui::CalcTextSize(name.c_str()).x * drawing.unit,
               apart = (handle_radius + 5) * drawing.scale * drawing.unit;
  const bool is_right = handle->shown.x > drawing.place.width / 2.0;
  // Above the handles of its size.
  const double lines = has_area(light) ? 2 : 0.5;
  drawing.words(handle->shown + glm::dvec2(is_right ? -apart - width : apart, -lines * ImGui::GetFontSize() * drawing.unit),
                name, light_color);
}

/// Lights that are shown together with the one that can be moved: small, without handles.
void draw_other_lights(const PictureDrawing& drawing, const Scene& scene, const Selection& selection) {
  for (const Light& light : whole_lights(lights_of(selection))) {
    if (light.name == whole_name(selection.light.name)) continue;
    for (const auto& [from, to] : light_outline(light, drawing.camera.eye)) drawing.segment(from, to, faint_light, 1);
    if (const auto handle =
            light_handle(drawing.camera, light_place(scene, light), handle_margin * drawing.scale * drawing.unit))
      drawing.disc(handle->shown, 2.5f, light_color);
  }
}

/// The grip of the divider, whose line is of the picture itself.
void draw_divider(const PictureDrawing& drawing, const Composition& composition) {
  if (composition.layout != Layout::split) return;
  const ImVec2 half(3.5f * drawing.scale, 15 * drawing.scale);
  drawing.box({composition.divider * composition.width, composition.height / 2.0}, half, IM_COL32(235, 235, 235, 240),
              IM_COL32(12, 13, 15, 200), half.x);
}

/// The columns of the picture that show a side: from, to.
struct Columns {
  double first, end;
};
Columns columns_of(const Composition& composition, int side) {
  const double all = composition.width, middle = composition.divider * all;
  if (composition.layout == Layout::split) return side == 0 ? Columns{0, middle} : Columns{middle, all};
  return side_at(composition, 0) == side ? Columns{0, all} : Columns{0, 0};
}

/// The names of the techniques in the upper corners of their sides, and why an answer is approximate.
void draw_titles(const PictureDrawing& drawing, const Session& session, const PanelData& shown) {
  const double margin = 8 * drawing.scale * drawing.unit;
  const auto extent = [&](const std::string& text) {
    const ImVec2 size = ImGui::CalcTextSize(text.c_str());
    return glm::dvec2(size.x, size.y) * static_cast<double>(drawing.unit);
  };
  for (int side = 0; side < 2; ++side) {
    const auto columns = columns_of(shown.composition, side);
    const bool is_right = shown.composition.layout == Layout::split && side == 1;
    const std::string title = title_of(session, side);
    const double room = columns.end - columns.first - 2 * margin;
    const auto place = [&](const std::string& text, double y) {
      return glm::dvec2(is_right ? columns.end - margin - extent(text).x : columns.first + margin, y);
    };
    if (extent(title).x > room) continue;
    drawing.words(place(title, margin), title, IM_COL32(235, 235, 235, 235));
    const SideState& state = shown.state.sides[side];
    if (state.is_reference || !state.is_approximate()) continue;
    const double width = std::min(room / drawing.unit, 30.0 * ImGui::GetFontSize());
    const std::string words = Widgets::lines("approximate: " + state.answer->support.why(), static_cast<float>(width));
    if (extent(words).x <= room) drawing.words(place(words, 1.6 * margin + extent(title).y), words, warning_text);
  }
}

/// Words in the middle of some columns of the picture, in as many lines as they need.
void draw_notice(const PictureDrawing& drawing, Columns columns, const std::string& words, ImU32 color) {
  const double room = (columns.end - columns.first) / drawing.unit - 3.0 * ImGui::GetFontSize();
  if (room < 6 * ImGui::GetFontSize()) return;
  const std::string lines = Widgets::lines(words, static_cast<float>(std::min(room, 34.0 * ImGui::GetFontSize())));
  const ImVec2 size = ImGui::CalcTextSize(lines.c_str());
  const glm::dvec2 middle((columns.first + columns.end) / 2, drawing.place.height * 0.4);  // above the divider's grip
  drawing.words(middle - 0.5 * drawing.unit * glm::dvec2(size.x, size.y), lines, color);
}

/// What a side without an answer waits for, or why it has none.
void draw_notices(const PictureDrawing& drawing, const Session& session, const PanelData& shown) {
  const EngineState& state = shown.state;
  const Columns all{0, static_cast<double>(drawing.place.width)};
  if (!state.trouble.empty()) return draw_notice(drawing, all, state.trouble, warning_text);
  if (state.is_loading) return draw_notice(drawing, all, "loading " + session.selection().scene, IM_COL32(235, 235, 235, 255));
  for (int side = 0; side < 2; ++side) {
    const SideState& s = state.sides[side];
    const Columns columns = columns_of(shown.composition, side);
    const std::string& words = s.words;
    if (s.phase == Phase::failed || s.phase == Phase::unsupported) {
      draw_notice(drawing, columns, fmt::format("{}: {}", s.phase == Phase::failed ? "failed" : "unsupported", words),
                  warning_text);
    } else if (s.is_reference ? !state.reference : !s.answer) {
      const std::string what = s.phase == Phase::starting || words.empty() ? "starting" : words;
      draw_notice(drawing, columns, s.seconds >= 0.1 ? fmt::format("{} {:.1f} s", what, s.seconds) : what,
                  IM_COL32(235, 235, 235, 255));
    }
  }
}

/// Edges that the eye sees are bright, the others dark: each half of an edge as its middle is. In the window's own pixels, and
/// quick enough for every picture; the debug layers of techniques decide pixel by pixel.
void draw_silhouettes(const PictureDrawing& drawing, std::span<const Line> lines, const GBuffer& gbuffer) {
  const SeenPoints is_seen(gbuffer);
  const auto draw = [&](const Line& line, const glm::dvec3& from, const glm::dvec3& to) {
    const bool is_bright = is_seen((from + to) / 2.0);
    const auto part = [&](double linear) { return is_bright ? srgb(linear) : srgb(linear) * 2 / 5; };
    const glm::vec3& c = line.color;
    drawing.segment(from, to, IM_COL32(part(c.r), part(c.g), part(c.b), is_bright ? 235 : 120), 1.2f);
  };
  for (const Line& line : lines) {
    const glm::dvec3 middle = (line.from + line.to) / 2.0;
    draw(line, line.from, middle);
    draw(line, middle, line.to);
  }
}

/// Where a shadow ray from the pixel meets the nearest caster; nothing where none is in its way.
std::optional<glm::dvec3> find_caster_point(const Frame& frame, std::size_t pixel) {
  const GBuffer& g = frame.gbuffer;
  const LightRays rays(frame.scene(frame.light), frame.casters(frame.light), g, frame.light);
  const glm::dvec3 point = g.position(pixel);
  const double distance = rays.nearest(pixel).distance;
  return std::isfinite(distance) ? std::optional(point + distance * rays.toward_light(point)) : std::nullopt;
}

/// From the picked pixel's point to the light, or to the caster that stops the ray; and where the taps of the technique's own
/// explanation found something stored.
void draw_shadow_ray(const PictureDrawing& drawing, const Session& session, const PanelData& shown) {
  const std::shared_ptr<const Frame>& frame = shown.state.frame;
  const std::size_t index = *session.selection().picked;
  if (!frame || !frame->is_full() || index >= frame->gbuffer.size() || frame->gbuffer.is_background(index)) return;
  const glm::dvec3 point = frame->gbuffer.position(index), light = light_place(*session.scene(), frame->light);
  // Of several lights, that of the one that can be moved.
  const std::size_t chosen = frame->chosen();
  const auto& newest = shown.state.reference;
  const auto reference = newest && frame->is_together() ? (newest->lights.empty() ? nullptr : newest->lights[chosen]) : newest;
  const bool is_known = reference && newest->frame == frame && !reference->classes.empty();
  const bool is_dark = is_known && !is_lit(reference->mask[index]);
  // A pixel that is turned away from the light has no shadow ray: its line is thin and gray.
  const bool has_ray = !is_known || reference->classes[index] > PixelClass::F;
  const auto end = is_dark && has_ray ? find_caster_point(*frame, index) : std::nullopt;
  const ImU32 color = is_dark ? blocked_color : has_ray ? light_color : quiet_text;
  drawing.segment(point, end.value_or(light), color, has_ray ? 2 : 1);
  if (end) {
    drawing.segment(*end, light, IM_COL32(239, 83, 80, 90), 1);
    if (const auto p = project(drawing.camera, *end)) drawing.disc(*p, 3, blocked_color);
  }
  const SideState& side = shown.state.sides[shown.side];
  if (!side.explanation || side.explained != session.selection().picked) return;
  for (const Tap& tap : side.explanation->taps) {
    if (!std::isfinite(tap.stored)) continue;
    if (const auto p = project(drawing.camera, tap.origin + tap.stored * tap.direction)) drawing.disc(*p, 2.5f, tap_color);
  }
}

}  // namespace

void Overlays::draw(const PixelRect& place, const Session& session, const PanelData& shown) {
  const Composition& composition = shown.composition;
  const Scene* const scene = session.scene();
  if (!scene || place.width <= 0) return;
  const auto unit = static_cast<float>(pixels_per_unit());
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const PictureDrawing drawing{list, place, Camera(shown_view(session, composition), place.width, place.height), unit,
                               lengths().scale};
  list.PushClipRect(drawing.at({0, 0}), drawing.at({place.width, place.height}), true);
  const Frame* const seen = shown_frame(composition);
  is_complete_ = true;
  if (session.shows_silhouettes && seen) {
    const auto segments = finder_.find(seen->shared_scene(), seen->light);
    is_complete_ = segments != nullptr;
    if (segments) draw_silhouettes(drawing, *segments, seen->gbuffer);
  }
  if (session.picked()) {
    draw_shadow_ray(drawing, session, shown);
    const ImVec2 p = drawing.at(glm::dvec2(*session.picked()) + 0.5);
    list.AddCircle(p, 6 * drawing.scale, IM_COL32(0, 0, 0, 200), 0, 3 * drawing.scale);
    list.AddCircle(p, 6 * drawing.scale, picked_color, 0, 1.5f * drawing.scale);
  }
  if (session.profile) draw_profile_line(drawing, *session.profile);
  draw_titles(drawing, session, shown);
  draw_divider(drawing, composition);
  draw_other_lights(drawing, *scene, session.selection());
  draw_light_size(drawing, session.selection().light, shown_sizes(session, composition));
  draw_light(drawing, *scene, session.selection(), shown_handle(session, composition, drawing.scale * unit));
  draw_notices(drawing, session, shown);
  list.PopClipRect();
}

SilhouetteFinder::~SilhouetteFinder() {
  if (thread_.joinable()) thread_.join();
}

std::shared_ptr<const std::vector<Line>> SilhouetteFinder::find(const std::shared_ptr<const Scene>& scene, const Light& light) {
  if (!is_searching_ && (searched_scene_ != scene || !are_same(searched_light_, light))) {
    if (thread_.joinable()) thread_.join();
    const bool is_quick = adjacency_scene_ == scene && search_ms_ < quick_ms;
    searched_scene_ = scene;
    searched_light_ = light;
    is_searching_ = true;
    thread_ = std::thread([this, scene, light] { search(scene, light); });
    if (is_quick) thread_.join();
  }
  const std::lock_guard lock(mutex_);
  return found_for_ == scene && are_same(found_light_, light) ? found_ : nullptr;
}

void SilhouetteFinder::search(std::shared_ptr<const Scene> scene, Light light) {
  auto start = std::chrono::steady_clock::now();
  auto lines = std::make_shared<std::vector<Line>>();
  try {
    if (adjacency_scene_ != scene) {
      adjacency_ = EdgeAdjacency(*scene);
      adjacency_scene_ = scene;
      start = std::chrono::steady_clock::now();
    }
    adjacency_.find_silhouette(homogeneous_of_center(light), silhouette_);
    *lines = silhouette_lines(adjacency_, silhouette_);
  } catch (const std::exception&) {
    lines->clear();  // out of memory: the window goes on without silhouettes
    adjacency_scene_.reset();
  }
  {
    const std::lock_guard lock(mutex_);
    found_ = std::move(lines);
    found_for_ = std::move(scene);
    found_light_ = light;
  }
  search_ms_ = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  is_searching_ = false;
  changed_();
}

}  // namespace gnomon::viewer
