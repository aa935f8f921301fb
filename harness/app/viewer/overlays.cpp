// Lines and handles over the picture. All places are computed in pixels of the picture.
#include "app/viewer/overlays.h"

#include <imgui.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "app/viewer/labels.h"
#include "app/viewer/light_size.h"
#include "app/viewer/picture_view.h"
#include "measure/frame/light_rays.h"

namespace gnomon::viewer {

namespace {

constexpr double quick_ms = 6;  // a search for silhouettes that takes no longer is waited for

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

/// The light's handle, a line down to the lowest height of the scene, and a cross there.
void draw_light(const PictureDrawing& drawing, const Scene& scene, const Light& light, const std::optional<Handle>& handle) {
  const glm::dvec3 place = light_place(scene, light);
  const double ground = scene.bounds().min.y;
  const double arm = 0.5 * key_step(scene);
  const glm::dvec3 foot(place.x, ground, place.z);
  drawing.segment(place, foot, faint_light, 1);
  drawing.segment(foot - glm::dvec3(arm, 0, 0), foot + glm::dvec3(arm, 0, 0), faint_light, 1);
  drawing.segment(foot - glm::dvec3(0, 0, arm), foot + glm::dvec3(0, 0, arm), faint_light, 1);
  if (handle) drawing.disc(handle->shown, handle_radius, light_color);
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

/// A frame around what the magnifier magnifies.
void draw_magnified(const PictureDrawing& drawing, const glm::ivec2& pixel) {
  const auto frame = [&](double beside, ImU32 color) {
    const glm::dvec2 reach(magnifier_reach + beside);
    drawing.list.AddRect(drawing.at(glm::dvec2(pixel) - reach), drawing.at(glm::dvec2(pixel) + 1.0 + reach), color, 0, 0,
                         drawing.scale);
  };
  frame(1.5, IM_COL32(0, 0, 0, 130));
  frame(0.5, IM_COL32(255, 255, 255, 150));
}

/// The grip of the divider, whose line is of the picture itself.
void draw_divider(const PictureDrawing& drawing, const Composition& composition) {
  if (composition.layout != Layout::split) return;
  const ImVec2 half(3.5f * drawing.scale, 15 * drawing.scale);
  drawing.box({composition.divider * composition.width, composition.height / 2.0}, half, IM_COL32(235, 235, 235, 240),
              IM_COL32(12, 13, 15, 200), half.x);
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
  if (is_magnified(session, shown)) draw_magnified(drawing, shown.pixel);
  if (session.profile) draw_profile_line(drawing, *session.profile);
  draw_divider(drawing, composition);
  draw_other_lights(drawing, *scene, session.selection());
  draw_light_size(drawing, session.selection().light, shown_sizes(session, composition));
  const std::optional<Handle> handle = shown_handle(session, composition, drawing.scale * unit);
  draw_light(drawing, *scene, session.selection().light, handle);
  draw_labels(drawing, session, shown, handle);
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
